"""FMUs do in a simulator what the scene says: held against the exact values of the same loads, known in advance."""

from fractions import Fraction
from itertools import pairwise
from random import Random

import numpy as np
import pytest

import wavesym
from tests.support.fmus import VERSIONS, Instance, broken, made, needs_fmpy

pytestmark = [needs_fmpy, pytest.mark.slow]

GEARS = wavesym.Scene(
    name="gears",
    system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    load=[{"body": 1, "times": [0], "steps": [1]}, {"body": 3, "times": [0], "steps": [1]}],
    output={
        "until": 6,
        "tolerance": "1e-12",
        "strain": [0, "1/2", "1-"],
        "velocity": [0, 1],
        "displacement": [0, 2],
    },
)
LOADS = ["load@M1", "load@M3"]
OUTPUTS = ["strain@0", "strain@1/2", "strain@1-", "velocity@0", "velocity@1", "displacement@0", "displacement@2"]
TOWER = wavesym.Scene(
    name="tower",
    system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
    load=[{"times": [0], "a": [1], "b": [0]}],
    output={"until": 5, "tolerance": "1e-12", "velocity": [0, 2], "displacement": [0], "acceleration": [1]},
)
PANEL = Fraction(1, 8)
SPACINGS = {"1": "1", "1/4": "1/4", "1/8": "1/8", "0.1": "1/2", "0.3": "3/2"}
"""By step: the time between jumps, at which both steps and panels end."""


def level(k: int, j: int) -> float:
    """What load j is from the k-th jump on."""
    return ((5 * k * k + 3 * k + 4 * j) % 11 - 5) / 4


def known(spacing: Fraction, count: int) -> wavesym.Scene:
    """The scene with such loads."""
    times = [k * spacing for k in range(count)]
    steps = [[level(k, j) - (level(k - 1, j) if k else 0) for k in range(count)] for j in range(2)]
    tables = [{"body": body, "times": times, "steps": row} for body, row in zip((1, 3), steps, strict=True)]
    return GEARS.with_({"load": tables})


def missed(found: list[list[float]], taus: list[float], scene: wavesym.Scene) -> float:
    """The largest error of an output, relative to its largest value."""
    true = wavesym.evaluator(scene)(taus)
    return float(np.max(np.max(np.abs(np.array(found).T - true), axis=1) / np.max(np.abs(true), axis=1)))


def stepped(instance: Instance, points: list[float], jumps: Fraction, start: float = 0.0) -> list[list[float]]:
    """The outputs at these points after the first, while loads jump at multiples of a time."""
    found = []
    for at, then in pairwise(points):
        k = int((Fraction(at - start) + Fraction(1, 10**9)) / jumps)
        instance.put({name: level(k, j) for j, name in enumerate(LOADS)})
        instance.step(at, then - at)
        found.append(instance.get(OUTPUTS))
    return found


@pytest.fixture(scope="module", params=VERSIONS)
def gears(request, tmp_path_factory):
    """The FMU of GEARS in a version, and where it is extracted."""
    folder = tmp_path_factory.mktemp(request.param)
    return made(GEARS, folder, request.param), folder / "extracted"


@pytest.mark.parametrize("step", SPACINGS)
def test_steps_of_any_length_give_exact_values(gears, step):
    length, jumps = float(Fraction(step)), Fraction(SPACINGS[step])
    for points in ([k * length for k in range(int(6 / length) + 1)], summed(length, int(6 / length))):
        instance = Instance(*gears).begin()
        found = stepped(instance, points, jumps)
        assert missed(found, [min(tau, 6.0) for tau in points[1:]], known(jumps, int(6 / jumps) + 1)) < 1e-12
        assert not instance.said
        instance.end()


def summed(length: float, count: int) -> list[float]:
    """A clock that adds up, with what rounding makes of that."""
    points = [0.0]
    for _ in range(count):
        points.append(points[-1] + length)
    return points


def test_variable_steps_and_another_start(gears):
    """Steps of any length that end where loads jump, in a simulation that begins at 100.25."""
    drawn, start = Random(3), 100.25
    inner = {round(drawn.uniform(0, 6), 3) for _ in range(60)}
    points = [start + tau for tau in sorted(inner | {k / 4 for k in range(25)})]
    instance = Instance(*gears).begin(start=start, stop=start + 6)
    found = stepped(instance, points, Fraction(1, 4), start)
    assert missed(found, [tau - start for tau in points[1:]], known(Fraction(1, 4), 25)) < 1e-12
    assert instance.get(["time"]) == [start + 6]
    with pytest.raises(Exception, match="status 3"):
        instance.step(start + 6, 0.1)
    instance.end()


def test_a_load_may_go_in_straight_lines(gears):
    """linear: to the value that is set, at the end of the step; from the first value at the start."""
    times = [Fraction(k, 4) for k in range(20)]
    slopes = [level(k + 1, 0) - level(k, 0) for k in range(20)]
    ramps = [4 * (slope - (slopes[k - 1] if k else 0)) for k, slope in enumerate(slopes)]
    load = {"body": 1, "times": times, "steps": [level(0, 0)] + [0] * 19, "ramps": ramps}
    instance = Instance(*gears).begin({"load@M1": level(0, 0)}, linear=True)
    found, taus = [], []
    for k in range(20):
        instance.put({"load@M1": level(k + 1, 0)})
        instance.step(k / 4, 0.25)
        found.append(instance.get(OUTPUTS))
        taus.append((k + 1) / 4)
    assert missed(found, taus, GEARS.with_({"load": [load]})) < 1e-12
    instance.end()


def test_reset_state_and_a_second_instance(gears):
    points = [k / 8 for k in range(33)]
    first = Instance(*gears).begin()
    whole = stepped(first, points, PANEL)
    first.slave.reset()
    first.begin()
    again = stepped(first, points[:17], PANEL)
    state, kept = first.keep(), None
    second = Instance(*gears).begin({"load@M1": 9.0})
    second.step(0.0, 0.7)  # goes its own way at once
    kept = first.bytes_of(state)
    assert again + stepped(first, points[16:], PANEL) == whole
    first.back(state)
    assert stepped(first, points[16:], PANEL) == whole[16:]
    second.back(second.of_bytes(kept))
    assert stepped(second, points[16:], PANEL) == whole[16:]
    for damaged in (kept[:-1], kept + bytes(8), kept[:99] + bytes([kept[99] ^ 1]) + kept[100:], b"0" + kept[1:]):
        with pytest.raises(Exception, match="status 3"):
            second.of_bytes(damaged)
    for instance in (first, second):
        instance.end()


def test_bad_calls_return_errors_and_change_nothing(gears):
    instance = Instance(*gears)
    linear = instance.references["linear"]
    refused(instance, [lambda: instance.slave.setBoolean([linear, 1], [True, True])])
    assert not instance.slave.getBoolean([linear])[0]
    bad = [
        lambda: instance.step(0.0, 0.1),
        lambda: instance.slave.exitInitializationMode(),
        lambda: instance.slave.terminate(),
    ]
    refused(instance, bad)
    instance.begin({"load@M1": 1.0})
    instance.step(0.0, 0.5)
    before = instance.get(OUTPUTS), instance.bytes_of(instance.keep())
    numbers = instance.slave.setReal if instance.two else instance.slave.setFloat64
    bad = [
        lambda: instance.put({"load@M1": float("nan")}),
        lambda: instance.put({"load@M1": 2.0, "load@M3": float("inf")}),
        lambda: instance.put({"velocity@0": 1.0}),
        lambda: instance.put({"panel": 1.0}),
        lambda: numbers([999], [1.0]),
        lambda: instance.slave.setBoolean([instance.references["linear"]], [True]),
        lambda: instance.slave.getBoolean([1]),
        lambda: (instance.slave.getReal if instance.two else instance.slave.getFloat64)([999]),
        lambda: (instance.slave.getInteger if instance.two else instance.slave.getInt32)([1]),
        lambda: instance.step(0.5, -0.1),
        lambda: instance.step(0.5, 0.0),
        lambda: instance.step(0.5, float("nan")),
        lambda: instance.step(0.5, 1e300),
        lambda: instance.step(0.6, 0.1),
        lambda: instance.step(float("nan"), 0.1),
        lambda: instance.slave.enterInitializationMode(),
    ]
    refused(instance, bad)
    assert (instance.get(OUTPUTS), instance.bytes_of(instance.keep())) == before
    instance.slave.terminate()
    refused(instance, [lambda: instance.step(0.5, 0.1), lambda: instance.put({"load@M1": 1.0})])
    instance.end()


def test_outputs_that_are_no_numbers_are_an_error(gears):
    """Of waves as of modes; a state from before is as good as ever."""
    instance = Instance(*gears).begin({"load@M1": 1.0})
    instance.step(0.0, 0.5)
    state, before = instance.keep(), instance.get(OUTPUTS)
    instance.put({"load@M1": 1.7e308})
    with pytest.raises(Exception, match="status 3"):
        go_on(instance, 80)
    assert not np.all(np.isfinite(instance.get(OUTPUTS)))
    instance.back(state)
    assert instance.get(OUTPUTS) == before
    instance.step(0.5, 0.5)
    assert np.all(np.isfinite(instance.get(OUTPUTS)))
    instance.end()


def go_on(instance, count):
    for k in range(1, count):
        instance.step(k / 2, 0.5)


def refused(instance, calls):
    for number, call in enumerate(calls):
        told = len(instance.said)
        with pytest.raises(Exception, match="status 3"):
            call()
        assert len(instance.said) == told + 1, number


def test_what_a_load_does_at_once_is_seen_at_once(tmp_path):
    """A foundation without mass: its velocity follows the load before the step, as its dependencies say."""
    for version in VERSIONS:
        instance = Instance(made(TOWER, tmp_path / version, version), tmp_path / version / "extracted")
        instance.begin({"load@a": 1.0})
        names = [output.name for output in instance.description.modelVariables if output.causality == "output"]
        direct = {
            unknown.variable.name: [known.name for known in unknown.dependencies]
            for unknown in instance.description.outputs
        }
        assert direct == {name: ["load@a"] if name == "velocity@0" else [] for name in names}
        instance.step(0.0, 0.375)
        before, state = instance.get(names), instance.keep()
        instance.put({"load@a": -3.0})
        after = instance.get(names)
        assert [name for name, one, two in zip(names, before, after, strict=True) if one != two] == ["velocity@0"]
        true = wavesym.evaluator(TOWER.with_({"load": [{"times": [0, "3/8"], "a": [1, -4], "b": [0, 0]}]}))
        assert np.max(np.abs(np.array(after) - true([0.375])[:, 0])) < 1e-12
        for value in (5.0, 7.0, -3.0):  # a simulator that tries values takes the last one, and nothing is lost
            instance.put({"load@a": value})
            instance.get(names)
        instance.step(0.375, 0.625)
        found = instance.get(names)
        instance.back(state)
        instance.put({"load@a": -3.0})
        instance.step(0.375, 0.625)
        assert instance.get(names) == found
        instance.end()


def test_a_jump_inside_of_a_panel_is_exact(gears):
    instance = Instance(*gears).begin({"load@M1": 1.0})
    instance.step(0.0, 0.3)
    instance.put({"load@M1": -1.0})
    found, times = [], [0.3 + k / 2 for k in range(1, 6)]
    for tau in times:
        instance.step(tau - 0.5, 0.5)
        found.append(instance.get(OUTPUTS))
    true = GEARS.with_({"load": [{"body": 1, "times": [0, Fraction(0.3)], "steps": [1, -2]}]})
    assert missed(found, times, true) < 1e-12
    assert instance.get(["lost"])[0] < 1e-11
    assert not instance.said
    instance.end()


def test_more_jumps_than_there_is_room_for_are_told_once(gears):
    """Each at another place of a window."""
    instance = Instance(*gears).begin()
    drawn, at = Random(7), 0.0
    while not instance.said:
        assert at < 20
        instance.put({"load@M1": drawn.uniform(-1, 1)})
        step = drawn.uniform(0.005, 0.015)
        instance.step(at, step)
        at += step
    assert at > 5
    assert instance.get(["lost"])[0] > 1e-12
    for k in range(50):
        instance.put({"load@M1": drawn.uniform(-1, 1)})
        instance.step(at + k / 64, 1 / 64)
    assert len(instance.said) == 1
    instance.end()


STOREYS = [{"count": 3, "height": "3.5 m", "stiffness": "678 MN/m", "column_mass": "10.871 t", "floor_mass": "350 t"}]
SHAKEN = wavesym.Scene(
    name="shaken",
    units={"length": "mm"},
    system={
        "type": "building",
        "base": "ground",
        "damping": 0.05,
        "storey": STOREYS,
    },
    load=[{"spacing": "0.02 s", "samples": [0, 0.1, -0.2, 0.15, 0.3, -0.1, 0], "unit": "g"}],
    output={"until": "0.5 s", "tolerance": "1e-6", "displacement": [3], "drift": [1], "velocity": [2]},
)


@pytest.mark.parametrize("version", VERSIONS)
def test_damped_modes_in_seconds_and_millimetres(version, tmp_path):
    """A record whose samples are given at the ends of steps; steps of one and of several samples."""
    path = made(SHAKEN, tmp_path, version)
    instance = Instance(path, tmp_path / "extracted").begin()
    names = ["velocity@2", "displacement@3", "drift@1"]
    samples = [0, 0.1, -0.2, 0.15, 0.3, -0.1, 0, 0, 0, 0, 0, 0]
    found, times = [], []
    for k, sample in enumerate(samples[1:]):
        instance.put({"load@a": sample * 9.80665})
        instance.step(0.02 * k, 0.02)
        found.append(instance.get(names))
        times.append(0.02 * (k + 1))
    instance.step(0.22, 0.1)
    found.append(instance.get(names))
    seconds = float(wavesym.evaluator(SHAKEN).tau_max) / 0.5
    taus = [time * seconds for time in [*times, 0.32]]
    assert missed(found, taus, SHAKEN) < 1e-6
    for wrong in (0.03, 0.005):
        with pytest.raises(Exception, match="status 3"):
            instance.step(0.32, wrong)
    variables = {one.name: one for one in instance.description.modelVariables}
    assert variables["load@a"].unit == "m/s^2"
    assert variables["drift@1"].unit == "mm"
    instance.put({"load@a": 1.7e308})
    with pytest.raises(Exception, match="status 3"):
        instance.step(0.32, 20.0)  # beyond all numbers, on the way
    instance.end()


def test_held_loads_of_modes_add_up(tmp_path):
    """What a load that changes does is the sum of what its changes do, each from its instant on."""
    path = made(SHAKEN, tmp_path, "fmu2")
    names = ["velocity@2", "displacement@3", "drift@1"]

    def ran(loads, first=None, **linear):
        instance = Instance(path, tmp_path / "extracted").begin({} if first is None else {"load@a": first}, **linear)
        rows = []
        for k, load in enumerate(loads):
            instance.put({"load@a": load})
            instance.step(k * 0.02, 0.02)
            rows.append(instance.get(names))
        instance.end()
        return np.array(rows)

    one = ran([1.0] * 20, linear=False)
    assert np.array_equal(one, ran([1.0] * 20, first=1.0, linear=True))
    both = ran([2.0] * 7 + [-1.0] * 13, linear=False)
    both[7:] += 3 * one[:13]
    assert np.max(np.abs(both - 2 * one)) < 1e-12 * np.max(np.abs(one))
    assert np.max(np.abs(one[0])) > 0


def test_undamped_waves_in_seconds(tmp_path):
    """Loads that jump at every third panel, in steps of a panel; then a long step."""
    scene = wavesym.Scene(
        name="frame",
        units={"length": "mm"},
        system={"type": "building", "base": "ground", "storey": STOREYS},
        load=[{"times": ["0 s"], "a": ["0.1 g"], "b": ["0 g/s"]}],
        output={"until": "0.5 s", "tolerance": "1e-12", "displacement": [3], "drift": [1]},
    )
    instance = Instance(made(scene, tmp_path, "fmu2"), tmp_path / "extracted")
    (panel,) = instance.get(["panel"])
    instance.begin({"load@a": 0.980665})
    names, found, times = ["displacement@3", "drift@1"], [], []
    for k in range(8):
        instance.step(k * panel, panel)
        times.append((k + 1) * panel)
        found.append(instance.get(names))
    instance.step(8 * panel, 0.3)
    found.append(instance.get(names))
    times.append(8 * panel + 0.3)
    response = wavesym.evaluator(scene)
    assert missed(found, [time * response.tau_max / 0.5 for time in times], scene) < 1e-12
    instance.end()


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize("milliseconds", ["1", "0.1", "0.618033988749895"])
def test_samples_in_seconds_meet_the_tolerance(milliseconds, linear, tmp_path):
    """Steps that have no measure in common with the panels, of which the scene says nothing."""
    step = Fraction(milliseconds) / 1000
    samples = [(37 * k * k) % 101 - 50 for k in range(1, 50)]
    times = [f"{k * step} s" for k in range(len(samples) + 1)]
    if linear:
        loads = {"spacing": f"{step} s", "samples": [0, *samples], "unit": "m/s^2"}
    else:
        jumps = [later - sooner for sooner, later in pairwise([0, *samples])]
        loads = {"times": times[:-1], "a": [f"{jump} m/s^2" for jump in jumps], "b": ["0 m/s^3"] * len(jumps)}
    scene = wavesym.Scene(
        name="frame",
        units={"length": "mm"},
        system={"type": "building", "base": "ground", "storey": STOREYS},
        load=[{"times": ["0 s"], "a": ["1 m/s^2"], "b": ["0 m/s^3"]}],
        output={"until": times[-1], "tolerance": "1e-9", "strain": ["1/2"], "displacement": [1], "drift": [1]},
    )
    instance = Instance(made(scene, tmp_path, "fmu2"), tmp_path / "extracted").begin(linear=linear)
    found = []
    for k, sample in enumerate(samples):
        instance.put({"load@a": sample})
        instance.step(float(k * step), float((k + 1) * step) - float(k * step))
        found.append(instance.get(["strain@1/2", "displacement@1", "drift@1"]))
    true = scene.with_({"load": [loads]})
    until = wavesym.evaluator(true).tau_max
    wrong = missed(found, [min((k + 1) * until / len(found), until) for k in range(len(found))], true)
    assert wrong < 1e-11
    assert wrong < instance.get(["lost"])[0] < 1e-8
    assert not instance.said
    instance.end()


COLLISION = wavesym.Scene.from_toml("collision_m4")


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("scene", [GEARS, TOWER, SHAKEN, COLLISION], ids=lambda scene: scene.name)
def test_it_is_valid_and_simulates(scene, version, tmp_path):
    """By fmpy's validation, and by its simulation, in which nobody knows of wavesym."""
    from fmpy import simulate_fmu
    from fmpy.validation import validate_fmu

    path = made(scene, tmp_path, version)
    assert validate_fmu(str(path)) == []
    found = simulate_fmu(str(path))
    assert len(found) > 10
    assert all(np.isfinite(found[name]).all() for name in found.dtype.names)


def test_a_signal_through_fmpys_own_simulation(gears):
    from fmpy import simulate_fmu

    signal = np.array([(0.0, 1.0), (2.0, 1.0), (2.0, -0.5), (9.0, -0.5)], dtype=[("time", "f8"), ("load@M1", "f8")])
    path, _ = gears
    found = simulate_fmu(str(path), stop_time=6.0, output_interval=0.25, input=signal, output=OUTPUTS)
    scene = GEARS.with_({"load": [{"body": 1, "times": [0, 2], "steps": [1, "-3/2"]}]})
    rows = [list(row)[1:] for row in found]
    assert missed(rows, list(found["time"]), scene) < 1e-12


FAULTS = {
    "a time": ("to_tau(&s->now, then) - to_tau(&s->now, s->now.time)", "step * 1.0000001"),
    "a load held": (
        "    if (!s->now.linear) {\n        stream_step(&s->now.stream, 0, s->now.input, s->now.output);\n    }\n",
        "",
    ),
    "a first value": (
        "    } else {\n        stream_step(&s->now.stream, 0, s->now.input, s->now.output);\n    }",
        "    }",
    ),
    "a check": ("check != checksum(kept)", "0"),
    "a number": ('return is_number(value) ? FINE : refuse(s, "an input", value, "a finite number");', "return FINE;"),
    "an order": ('need(s, s->now.phase == STEPPING, "doStep") != FINE', "0"),
    "a trial": (
        "memcpy(&s->trial, &s->now.stream, stream_used(&s->now.stream));",
        "stream_start(&s->trial, s->now.parameter);",
    ),
}
SEEN_BY = {
    "a time": lambda it: test_steps_of_any_length_give_exact_values(it, "0.1"),
    "a load held": lambda it: test_steps_of_any_length_give_exact_values(it, "1/4"),
    "a first value": lambda it: test_a_load_may_go_in_straight_lines(it),
    "a check": lambda it: test_reset_state_and_a_second_instance(it),
    "a number": lambda it: test_bad_calls_return_errors_and_change_nothing(it),
    "an order": lambda it: test_bad_calls_return_errors_and_change_nothing(it),
    "a trial": lambda it: follows_at_once(it),
}


def follows_at_once(tower):
    instance = Instance(*tower).begin({"load@a": 1.0})
    instance.step(0.0, 0.375)
    instance.put({"load@a": -3.0})
    true = wavesym.evaluator(TOWER.with_({"load": [{"times": [0, "3/8"], "a": [1, -4], "b": [0, 0]}]}))([0.375])
    found = instance.get(["velocity@0", "velocity@2", "displacement@0", "acceleration@1"])
    assert np.max(np.abs(np.array(found) - true[:, 0])) < 1e-12
    instance.end()


@pytest.mark.parametrize("fault", FAULTS)
def test_a_broken_wrapper_is_seen(fault, tmp_path):
    scene = TOWER if fault == "a trial" else GEARS
    path = made(scene, tmp_path, "fmu2")
    SEEN_BY[fault]((path, tmp_path / "right"))
    broken(path, tmp_path / "wrong", *FAULTS[fault])
    with pytest.raises((AssertionError, pytest.fail.Exception)):
        SEEN_BY[fault]((path, tmp_path / "wrong"))
