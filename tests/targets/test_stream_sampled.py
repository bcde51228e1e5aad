"""Streams under samples at any instants, against sums of exact responses: right to the tolerance, and what is lost,
where there is no room for all instants, is never more than the stream says."""

from fractions import Fraction
from random import Random

import numpy as np
import pytest
from flint import arb, fmpq

import wavesym
from tests.support.drives import DRIVE, EVERY
from tests.support.sampled import Superposed, driven
from tests.support.streamed import built
from wavesym import api
from wavesym.programs.request import Request
from wavesym.targets.c import stream as written

UNTIL = Fraction(6)
GOLDEN = 0.37 * (5**0.5 - 1) / 2
SYSTEMS = {
    "drive": (
        {"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
        [{"body": 1}, {"body": 3}],
        {"strain": ["1/3000", "1-"], "velocity": [1], "displacement": [0]},
    ),
    "quick drive": (
        {"type": "drive", "m": 2, "kappa": [9, "5/2"], "inertia": [1, "1/7", 1]},
        [{"body": 1}],
        {"strain": ["1/2"], "velocity": [0], "displacement": [2]},
    ),
    "base force": (
        {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
        [{}],
        {"strain": ["1/4", "1+"], "velocity": [0, 2], "displacement": ["7/5"]},
    ),
    "base moves": (
        {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "ground"},
        [{}],
        {"strain": ["1/4", "1+"], "velocity": [0, 2], "displacement": ["7/5"]},
    ),
    "shafts that differ": (
        DRIVE,
        [{"at": "motor"}, {"at": "end"}],
        {"strain": ["1-", "5/2+"], "velocity": ["motor", "1/4"], "displacement": ["end"]},
    ),
    "every joint": (
        EVERY,
        [{"at": "ground"}, {"at": "seat"}],
        {"strain": ["1-", "side:1/2-"], "velocity": ["floor", "hung", "seat"], "displacement": ["hung"]},
    ),
    "hung": (
        EVERY,
        [{"at": "hung"}, {"at": "gear"}],
        {"velocity": ["floor", "hung", "side:3/2"], "displacement": ["seat"]},
    ),
}
SAMPLINGS = {
    "golden": [GOLDEN] * 26,
    "milliseconds": [0.001 / 0.0019807331558814928] * 11,
    "a tenth": [0.1] * 59,
    "long": [1.618] * 3,
    "changing": [10 ** Random(k).uniform(-3, -0.3) for k in range(14)],
    "tiny": [1e-3] * 24 + [0.41371] * 14,  # no front arrives as outputs are read
}
TOLERANCE = 1e-9


def made(system, places, output, tolerance=TOLERANCE):
    """The scene, and what its exact responses are taken from."""
    table = {"name": "sampled", "system": system, "output": {"until": UNTIL, "tolerance": tolerance, **output}}
    step = {"times": [0], "a": [1], "b": [0]} if system["type"] == "building" else {"times": [0], "steps": [1]}
    scene = wavesym.Scene(**table, load=[place | step for place in places])
    return scene, Superposed(table if system["type"] == "chain" else scene, places, UNTIL)


def samples(count, loads, seed=1):
    """Numbers from -1 to 1."""
    drawn = Random(seed)
    return [[drawn.uniform(-1, 1) for _ in range(loads)] for _ in range(count)]


def combined(*quick):
    """All of them, of which few are quick."""
    every = [(system, sampling, held) for system in SYSTEMS for sampling in SAMPLINGS for held in (False, True)]
    marked = [pytest.param(*one, marks=() if one in quick else pytest.mark.slow) for one in every]
    return pytest.mark.parametrize(("system", "sampling", "held"), marked)


@pytest.mark.quick(1)
@combined(("drive", "golden", False), ("base force", "changing", True))
def test_any_sampling_meets_the_tolerance(system, sampling, held):
    """An output that hears a load at once, or a moment later, is as exact as all others."""
    scene, truth = made(*SYSTEMS[system])
    loads = samples(len(SAMPLINGS[sampling]), len(SYSTEMS[system][1]))
    record = driven(built(scene).start(), SAMPLINGS[sampling], loads, held=held)
    worst = np.max(truth.missed(record, 2))
    assert worst < TOLERANCE / 10
    assert worst < record.lost[-1]
    # steep ramps cost digits of the bound before they cost any
    assert max(record.status) == 0 or (sampling in ("tiny", "a tenth") and not held)


@pytest.mark.quick(1)
@pytest.mark.parametrize("room", [0, pytest.param(5, marks=pytest.mark.slow)])
@combined(("drive", "changing", False), ("base force", "golden", True))
def test_no_more_is_lost_than_is_said(system, sampling, held, room):
    """Where there is no room for most of the instants."""
    scene, truth = made(*SYSTEMS[system])
    loads = samples(len(SAMPLINGS[sampling]), len(SYSTEMS[system][1]))
    record = driven(built(scene, room=room).start(), SAMPLINGS[sampling], loads, held=held)
    worst = np.max(truth.missed(record, 2))
    assert worst < record.lost[-1]
    assert max(record.status) == 2 or worst < TOLERANCE


def test_rounding_at_the_end_of_a_panel_is_no_output_yet():
    """At 1/2 a wave arrives as the first step ends: it is 1e-18 there, and 1e5 times that was said to be lost."""
    scene, _ = made(*SYSTEMS["drive"])
    record = driven(built(scene).start(), [0.5] * 8, samples(8, 2), held=True)
    sizes = np.abs(np.concatenate(record.found))
    assert 0 < np.min(sizes[sizes > 0]) < 1e-15
    assert max(record.lost) < 1e-3


FAULTS = {
    "a kink": ("        lose(state, energy, missed);\n", ""),
    "a wave": ("    state->lost_wave += wave;\n", ""),
    "an energy": ("    state->lost_energy += energy;\n", ""),
}


@pytest.mark.slow
def test_a_bound_without_one_of_its_parts_is_less(monkeypatch):
    """What is lost at massless points is lost as waves, what is left of it as energy: without either it is less."""
    scene, truth = made(*SYSTEMS["base force"])

    def ran(fault, sampling):
        def spoiled(of, *files, kernels=written.kernels, **given):
            text = kernels(of, *files, **given)
            if fault and "stream/stream.c" in files:
                assert text.count(FAULTS[fault][0]) == 1
                return text.replace(*FAULTS[fault])
            return text

        loads = samples(len(SAMPLINGS[sampling]), 1)
        with monkeypatch.context() as patch:
            patch.setattr(written, "kernels", spoiled)
            return driven(built(scene, room=0).start(), SAMPLINGS[sampling], loads, held=True)

    right = ran(None, "golden")
    assert np.max(truth.missed(right, 2)) < right.lost[-1]
    assert all(ran(fault, "golden").lost[-1] < 0.7 * right.lost[-1] for fault in ("a wave", "an energy"))
    unseen = ran("a kink", "changing")
    assert unseen.lost[-1] < np.max(truth.missed(unseen, 2))


STOREY = {"height": "3.5 m", "stiffness": "678 MN/m", "column_mass": "2.66 t", "floor_mass": "35 t"}
RECORD = [0, *(((37 * k * k) % 101 - 50) / 50 for k in range(1, 40)), 0]


def shaken(spacing):
    """Two storeys in SI under a record."""
    return wavesym.Scene(
        name="shaken",
        units={"length": "mm"},
        system={"type": "building", "base": "ground", "storey": [{"count": 2, **STOREY}]},
        load=[{"spacing": f"{spacing} s", "samples": RECORD, "unit": "m/s^2"}],
        output={
            "until": f"{float(spacing) * 44} s",
            "tolerance": "1e-9",
            "velocity": [1],
            "drift": [1],
            "strain": ["1/2"],
        },
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "spacing", ["0.001", pytest.param("0.0002", marks=pytest.mark.slow), pytest.param("0.02", marks=pytest.mark.slow)]
)
def test_a_record_in_seconds_has_room_for_all_of_its_samples(spacing):
    """Samples whose spacing has no measure in common with the panels.

    What is lost is told of the largest value of each output: within 9 ms a floor hardly moves, however large waves are.
    """
    scene = shaken(spacing)
    response = wavesym.evaluator(scene)
    stream = built(scene, room=None if spacing == "0.02" else 40).start()
    dtau = response.tau_max / 44
    found = []
    for sample in [*RECORD[1:], 0.0, 0.0, 0.0]:
        status, out = stream.step(dtau, [sample])
        assert status == 0
        found.append(out)
    true = response([min((k + 1) * dtau, response.tau_max) for k in range(len(found))])
    worst = np.max(np.abs(np.array(found).T - true) / np.max(np.abs(true), axis=1, keepdims=True))
    assert worst < 1e-10
    assert worst < stream.lost < (1e-8 if spacing == "0.0002" else 1e-9)


@pytest.mark.slow
def test_room_is_known_from_the_scene_and_from_the_step():
    """All instants of the record but 0; of steps those inside of panels, none where panels end with all of them."""

    def room(scene, step=None):
        return api.program(scene, Request(stream=True, step=step)).constants["breakpoints"]

    long = shaken("0.001").with_({"load": [{"spacing": "0.001 s", "samples": RECORD * 9, "unit": "m/s^2"}]})
    kept = room(long.with_({"output.until": "0.5 s"}))
    assert len(RECORD) * 9 - 12 < kept < len(RECORD) * 9  # some samples lie on a line with their neighbours
    drive = made(*SYSTEMS["drive"])[0]
    assert room(drive) == 256
    steps = {"1/8": 0, "37/100": 0, "1/5000": 4992, "371/10000": 161}
    assert {step: room(drive, fmpq(*Fraction(step).as_integer_ratio())) for step in steps} == steps


BAR = {
    "type": "chain",
    "parts": ["absorbing", {"rod": 1}, {"mass": 1, "name": "disc"}, {"rod": 2}, "absorbing"],
}


@pytest.mark.slow
def test_instants_of_which_nothing_is_left_are_free_again():
    """Waves leave the bar: room for few instants is enough for any number of them."""
    scene, truth = made(BAR, [{"at": "disc"}], {"velocity": ["disc"], "strain": ["2"]})
    stream = built(scene.with_({"output.until": 900}), room=20).start()
    drawn = Random(4)
    for _ in range(2000):
        status, _ = stream.step(GOLDEN, [drawn.uniform(-1, 1)])
    assert status == 0
    stream.step(0.0, [0.0])
    stream.step(400.0, [0.0])
    # all is as at the start
    record = driven(stream, SAMPLINGS["golden"], samples(26, 1), held=False)
    assert max(record.status) == 0
    assert np.max(np.abs(truth.values(record, [9, 19]) - np.array(record.found)[[9, 19]].T)) < 1e-10


def test_a_step_far_below_a_panel_is_a_jump():
    """So steep a ramp would leave nothing of the digits of what follows."""
    scene, _ = made(*SYSTEMS["drive"])
    for brief in (1e-8, 1e-12, 1e-30):
        stream = built(scene).start()
        stream.step(0.3, [0.0, 0.0])
        stream.step(brief, [1.0, -1.0])
        steps, loads = [0.31] * 12, [[1.0, -1.0]] * 12
        found = np.array([stream.step(dtau, row)[1] for dtau, row in zip(steps, loads, strict=True)])
        other = built(scene).start()
        other.step(0.3 + brief / 2, [0.0, 0.0])
        record = driven(other, [0.31 + brief / 2, *steps[1:]], loads, held=True)
        assert np.max(np.abs(found - np.array(record.found))) < 1e-12


def test_what_is_moved_to_an_edge_counts_as_lost():
    """Instants that are as near as rounding of times are one: a steep load is wrong by what it does in between."""
    bend = Fraction(1, 8) - Fraction(1, 2**43)
    scene = wavesym.Scene(
        name="steep",
        system=SYSTEMS["base force"][0],
        load=[{"times": [0, bend], "a": [0, 0], "b": [0, 64]}],
        output={"until": 1, "tolerance": TOLERANCE, "velocity": [0], "displacement": [0]},
    )
    stream = built(scene).start()
    stream.step(float(bend), [0.0])
    taus, found, lost = [float(bend) + k / 64 for k in range(1, 50)], [], []
    for k in range(1, 50):
        found.append(stream.step(1 / 64, [float(k)])[1])
        lost.append(stream.lost)
    true = wavesym.evaluator(scene)(taus)
    wrong = np.max(np.abs(np.array(found).T - true) / np.abs(true), axis=0)
    assert np.max(wrong) > 1e-13
    assert np.all(wrong <= lost)


@pytest.mark.parametrize("early", [1e-13, pytest.param(3e-14, marks=pytest.mark.slow)])
def test_what_is_read_just_before_an_edge_is_known_as_well(early):
    """There a panel is over already: an integral goes on to the edge, a kink there is in what is read."""
    damped = {"type": "chain", "parts": ["fixed", {"rod": 1}, {"mass": 1, "dashpot": 2, "name": "disc"}]}
    scene = wavesym.Scene(
        name="near",
        system=damped,
        load=[{"at": "disc", "times": [0], "steps": [1]}],
        output={"until": 3, "tolerance": TOLERANCE, "displacement": ["disc"], "force": ["1-", "1/2"]},
    )
    step = 0.125 - early
    stream = built(scene).start()
    stream.step(0.0, [1.0])
    _, out = stream.step(step, [1.0])
    rate = arb(3)  # until the wave comes back v' + 3 v = 1
    time = arb(fmpq(*step.as_integer_ratio()))
    true = float((time - (1 - (-rate * time).exp()) / rate) / rate)
    assert abs(out[0] - true) < 0.1 * early * 0.1
    # the front arrives at the edge: nothing is true of what is read before
    other = built(scene).start()
    other.step(0.0, [1.0])
    _, out = other.step(4 * step + 3 * early, [1.0])
    assert abs(out[2]) > 0
    assert other.lost >= 1
