"""Modes of many sets of numbers in doubles, against proved modes."""

from dataclasses import replace

import numpy as np
import pytest
from flint import fmpq

from tests.programs.test_modal_systems import PUSH, UNDAMPED
from tests.support.modal import building, chain, samples
from wavesym.errors import UnservedError
from wavesym.mechanics.network import Network
from wavesym.programs.mode_sets.modes import ModesOfSet, mode_sets
from wavesym.programs.modes.undamped import UndampedModes

FIXED = chain(
    ["fixed", {"rod": 1}, {"mass": 1, "name": "n"}, {"rod": 1}, {"mass": 1}, {"rod": 1}, "fixed"],
    [PUSH],
    tolerance="1e-3",
    strain=["0", "1-", "3-"],
    displacement=["n", "3/2"],
    until=6,
)
SPRUNG = chain(
    [
        {"motion": "acceleration", "name": "m"},
        {"spring": 3},
        {"mass": 1, "name": "n"},
        {"spring": 2},
        {"mass": 2},
        {"rod": "1/7", "impedance": 4},
        {"joint": True},
        {"rod": "1/5", "impedance": 2},
        {"mass": 1, "name": "top"},
    ],
    [{"at": "m", "times": [0, 1], "ramps": [1, -2]}],
    tolerance="1e-3",
    relative=["n", "top"],
    acceleration=["top"],
    velocity=["n"],
    until=9,
)
ALIKE = building(["1/20"] * 11, [samples(6)], until=40, tolerance="1e-2", drift=[1, 10], force=[0], acceleration=[10])
MODELS = {**UNDAMPED, "fixed at both ends": FIXED, "springs and rods": SPRUNG, "ten storeys alike": ALIKE}


def changed(model, factor):
    """The same model, the numbers of its first point with a mass, and of its last rod, `factor` times as large."""
    network = model.network
    points = list(network.points)
    first = next(k for k, point in enumerate(points) if point.mass != 0)
    points[first] = replace(points[first], mass=points[first].mass * factor)
    last = network.bars[-1]
    bars = [*network.bars[:-1], replace(last, impedance=last.impedance * factor, speed=last.speed * factor)]
    return replace(model, network=Network(tuple(points), tuple(bars), network.links), preset=None)


@pytest.mark.parametrize("name", MODELS)
def test_modes_in_doubles_are_the_proved_ones(name):
    """Frequencies, what outputs and loads have of modes, static shapes and all sums, for each of three sets."""
    models = [changed(MODELS[name], fmpq(factor)) for factor in (1, fmpq(3, 2), fmpq(4, 7))]
    sets, count = mode_sets(models, 1), 24
    found = sets.projection(count)
    for number, model in enumerate(models):
        true, near = UndampedModes(model.to_horizon()).project(count), found.of(number)
        assert ModesOfSet(model, sets, number).looseness(count).max() < 1e-7
        # a rigid motion is exact in both
        assert np.all(np.abs(near.w**2 - true.w**2) <= found.wrong[number] + 1e-15 * true.w**2)
        signs = np.sign(np.vstack([true.shares * near.shares, true.outputs * near.outputs]).sum(axis=0))
        gaps = np.diff(true.w**2, prepend=-np.inf, append=np.inf)
        loose = found.wrong[number] / np.minimum(gaps[:-1], gaps[1:]) + found.blurred[number] + 1e-14
        for field in ("outputs", "shares"):
            rows = getattr(true, field)
            assert np.all(np.abs(signs * getattr(near, field) - rows) <= 10 * loose * np.abs(rows).max())
        for field in ("imposed", "static"):
            rows = getattr(true, field)
            assert np.abs(getattr(near, field) - rows).max() <= 1e-12 * np.abs(rows).max()
        for one, other in zip(true.totals, near.totals, strict=True):
            assert one == pytest.approx(other, rel=1e-11)
        assert all((one == other).all() for one, other in zip(true.powers, near.powers, strict=True))


def test_equal_frequencies_are_known_to_be_loose():
    """Two branches alike have a mode in which the rest is still: which shapes doubles find is open."""
    arm = [{"spring": 1}, {"mass": 1}]
    model = chain(
        ["fixed", {"spring": 1}, {"mass": 1, "name": "n"}],
        [PUSH],
        [{"from": "n", "name": name, "parts": arm} for name in ("a", "b", "c")],
        displacement=["n"],
        until=6,
    )
    sets = mode_sets([model, model], 1)
    assert ModesOfSet(model, sets, 1).looseness(4).max() > 1e-3


def test_models_that_differ_in_more_than_numbers_are_refused():
    with pytest.raises(UnservedError, match="differ in more than numbers"):
        mode_sets([FIXED, SPRUNG], 1)


def test_an_output_that_symmetry_alone_makes_0_is_not_0_for_all_sets():
    """In the middle of a chain pushed alike from both sides nothing moves, as long as both halves are alike."""
    push = {key: PUSH[key] for key in ("times", "ramps")}
    model = chain(
        [{"mass": 1, "name": "l"}, {"rod": 1}, {"mass": 1, "name": "n"}, {"rod": 1}, {"mass": 1, "name": "r"}],
        [{"at": "l", **push}, {"at": "r", **push, "ramps": [-x for x in PUSH["ramps"]]}],
        displacement=["n", "l"],
        until=6,
    )
    assert UndampedModes(model).zero_outputs == (True, False)
    assert mode_sets([model], 1).zero_outputs == (False, False)
