"""FMUs whose parameters a simulator sets: held against the exact values of the scene that has them."""

from fractions import Fraction

import numpy as np
import pytest

import wavesym
from tests.running.test_fmu_simulated import GEARS, LOADS, OUTPUTS, PANEL, SPACINGS, known, level, missed, stepped
from tests.running.test_model_units import drive
from tests.support.fmus import VERSIONS, Instance, broken, made, needs_fmpy

pytestmark = [needs_fmpy, pytest.mark.slow]

SET = {"kappa_1": 2.0, "kappa_2": 0.25, "inertia_1": 0.5, "inertia_2": 3.0, "inertia_3": 1.5}
CHANGE = {"system.kappa": [2, "1/4"], "system.inertia": ["1/2", 3, "3/2"]}
OWN = {"kappa_1": 1.0, "kappa_2": 0.5, "inertia_1": 1.0, "inertia_2": 2.0, "inertia_3": 1.0}


@pytest.fixture(scope="module", params=VERSIONS)
def gears(request, tmp_path_factory):
    """The FMU of GEARS in a version, and where it is extracted."""
    folder = tmp_path_factory.mktemp(request.param)
    return made(GEARS, folder, request.param), folder / "extracted"


def changed(spacing: Fraction, count: int) -> wavesym.Scene:
    """The scene of `known` with other shafts and discs."""
    return known(spacing, count).with_(CHANGE)


@pytest.mark.parametrize("step", SPACINGS)
def test_a_set_of_parameters_is_the_scene_that_has_it(gears, step):
    length, jumps = float(Fraction(step)), Fraction(SPACINGS[step])
    points = [k * length for k in range(int(6 / length) + 1)]
    instance = Instance(*gears).begin(SET)
    assert instance.get(list(SET)) == list(SET.values())
    found = stepped(instance, points, jumps)
    taus = [min(tau, 6.0) for tau in points[1:]]
    count = int(6 / jumps) + 1
    assert missed(found, taus, changed(jumps, count)) < 1e-12
    assert missed(found, taus, known(jumps, count)) > 1e-2
    assert not instance.said
    instance.end()


def test_start_values_in_fmpys_own_simulation(gears):
    from fmpy import simulate_fmu

    signal = np.array([(0.0, 1.0), (2.0, 1.0), (2.0, -0.5), (9.0, -0.5)], dtype=[("time", "f8"), ("load@M1", "f8")])
    path, _ = gears
    found = simulate_fmu(
        str(path), stop_time=6.0, output_interval=0.25, input=signal, output=OUTPUTS, start_values={"kappa_1": 3.0}
    )
    held = [{"body": 1, "times": [0, 2], "steps": [1, "-3/2"]}]
    scene = GEARS.with_({"load": held, "system.kappa": [3, "1/2"]})
    assert missed([list(row)[1:] for row in found], list(found["time"]), scene) < 1e-12


def test_two_instances_with_different_parameters_at_once(gears):
    first, second = Instance(*gears).begin(SET), Instance(*gears).begin()
    found: dict[Instance, list[list[float]]] = {first: [], second: []}
    for k in range(32):
        for instance, rows in found.items():
            instance.put({name: level(k, j) for j, name in enumerate(LOADS)})
            instance.step(k / 8, 0.125)
            rows.append(instance.get(OUTPUTS))
    taus = [(k + 1) / 8 for k in range(32)]
    assert missed(found[first], taus, changed(PANEL, 33)) < 1e-12
    assert missed(found[second], taus, known(PANEL, 33)) < 1e-12
    for instance in found:
        instance.end()


def test_reset_returns_to_the_scene_and_a_state_has_its_parameters(gears):
    points = [k / 8 for k in range(33)]
    first = Instance(*gears).begin(SET)
    whole = stepped(first, points, PANEL)
    first.slave.reset()
    assert first.get(list(OWN)) == list(OWN.values())
    first.begin(SET)
    half = stepped(first, points[:17], PANEL)
    kept = first.bytes_of(first.keep())
    second = Instance(*gears).begin()
    second.step(0.0, 0.7)
    second.back(second.of_bytes(kept))
    assert second.get(list(SET)) == list(SET.values())
    assert half + stepped(second, points[16:], PANEL) == whole
    for instance in (first, second):
        instance.end()


def test_bad_parameters_are_refused_and_change_nothing(gears):
    instance = Instance(*gears)
    for name, value in {"kappa_1": -1.0, "kappa_2": 0.0, "inertia_1": float("nan"), "inertia_3": float("inf")}.items():
        refused(instance, lambda name=name, value=value: instance.put({"kappa_1": 7.0, name: value}))
    assert instance.get(list(OWN)) == list(OWN.values())
    # numbers by themselves, but too light for the degree: seen when all of them are known
    instance.put({"kappa_1": 1e6})
    refused(instance, lambda: instance.get(OUTPUTS))
    assert instance.get(["kappa_1", "kappa_2"]) == [1e6, 0.5]
    if instance.two:
        instance.slave.setupExperiment(startTime=0.0)
        instance.slave.enterInitializationMode()
    else:
        instance.slave.enterInitializationMode(startTime=0.0)
    refused(instance, instance.slave.exitInitializationMode)
    instance.put(SET)
    instance.slave.exitInitializationMode()
    for call in (lambda: instance.put({"kappa_1": 2.0}), lambda: instance.put({"load@M1": 1.0, "inertia_1": 1.0})):
        refused(instance, call)
    points = [k / 8 for k in range(17)]
    assert missed(stepped(instance, points, PANEL), points[1:], changed(PANEL, 17)) < 1e-12
    instance.end()


def refused(instance: Instance, call) -> None:
    """With an error and one line in the log."""
    told = len(instance.said)
    with pytest.raises(Exception, match="status 3"):
        call()
    assert len(instance.said) == told + 1


@pytest.mark.parametrize("version", VERSIONS)
def test_parameters_have_units(version, tmp_path):
    first, other, numbers = drive()
    held = [{"body": 1, "times": ["0 s"], "steps": ["15 N*m"]}]
    first, other = (wavesym.Scene(**scene | {"load": held}) for scene in (first, other))
    instance = Instance(made(first, tmp_path, version), tmp_path / "extracted")
    variables = {one.name: one for one in instance.description.modelVariables}
    assert {variables[f"inertia_{k}"].unit for k in (1, 2, 3)} == {"kg*m^2"}
    assert variables["kappa_1"].unit is None
    assert (variables["kappa_1"].causality, variables["kappa_1"].variability) == ("parameter", "fixed")
    given = {f"{name}_{k}": value for name in ("kappa", "inertia") for k, value in enumerate(numbers[name], 1)}
    instance.begin({"load@M1": 15.0, **given})
    names = [one.name for one in instance.description.modelVariables if one.causality == "output"]
    found, times = [], [1e-4 * k for k in range(1, 15)]
    for time in times:
        instance.step(time - 1e-4, 1e-4)
        found.append(instance.get(names))
    response = wavesym.evaluator(other)
    assert missed(found, [time * response.tau_max / 1.5e-3 for time in times], other) < 1e-11
    instance.end()


def test_a_chain_has_the_parameters_that_are_asked_for(tmp_path):
    system = {"type": "chain", "parts": ["free", {"rod": 1}, {"mass": "1/2", "name": "disc"}, {"rod": 1}, "fixed"]}
    load = [{"at": "disc", "times": [0], "steps": [1]}]
    output = {"until": 4, "tolerance": "1e-12", "velocity": ["disc"], "strain": ["1/2"]}
    scene = wavesym.Scene(name="chained", system=system, load=load, output=output)
    instance = Instance(made(scene, tmp_path, "fmu2", runtime=["mass"]), tmp_path / "extracted")
    found = [one for one in instance.description.modelVariables if one.causality == "parameter"]
    assert [(one.name, one.description) for one in found[:1]] == [
        ("mass_point_1", "mass of disc at 1; may be set until initialization is over")
    ]
    instance.begin({"mass_point_1": 2.0, "load@disc": 1.0})
    rows = []
    for k in range(32):
        instance.step(k / 8, 0.125)
        rows.append(instance.get(["strain@1/2", "velocity@disc"]))
    heavier = scene.with_({"system.parts[2].mass": 2})
    assert missed(rows, [(k + 1) / 8 for k in range(32)], heavier) < 1e-12
    instance.end()


@pytest.mark.parametrize("version", VERSIONS)
def test_it_is_valid(version, tmp_path):
    """With units, parameters and several loads, by fmpy's validation."""
    from fmpy.validation import validate_fmu

    first, _, _ = drive()
    held = [{"body": body, "times": ["0 s"], "steps": ["15 N*m"]} for body in (1, 3)]
    assert validate_fmu(str(made(wavesym.Scene(**first | {"load": held}), tmp_path, version))) == []


FAULTS = {
    "the stream is not made anew": ("s->now.unmade = 1;\n        } else {", "} else {"),
    "a bad number is taken": ("(positive[k] && !(value > 0))", "0"),
    "a refusal is not told": (
        "|| make(s) != FINE) {\n        return WRONG;\n    }\n    if (STEPPED)",
        ") {\n return WRONG;\n }\n if (STEPPED)",
    ),
}
SEEN_BY = {
    "the stream is not made anew": lambda it: test_a_set_of_parameters_is_the_scene_that_has_it(it, "1/4"),
    "a bad number is taken": lambda it: test_bad_parameters_are_refused_and_change_nothing(it),
    "a refusal is not told": lambda it: test_bad_parameters_are_refused_and_change_nothing(it),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_broken_wrapper_is_seen(fault, tmp_path):
    path = made(GEARS, tmp_path, "fmu2")
    broken(path, tmp_path / "wrong", *FAULTS[fault])
    with pytest.raises((AssertionError, pytest.fail.Exception)):
        SEEN_BY[fault]((path, tmp_path / "wrong"))
