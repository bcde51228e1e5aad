"""The light cone is as wide as waves run, to the node."""

from dataclasses import replace
from fractions import Fraction

import pytest
from flint import fmpq

from wavesym.mechanics.damping import Damping
from wavesym.numbers.doubles import rational
from wavesym.scene import Scene, lower


def tower(places, until="1"):
    system = {"type": "building", "m": 100, "kappa": [1] * 101, "base": "force"}
    return lower(Scene(name="tower", system=system, output={"until": until, "strain": places}))


@pytest.mark.parametrize(
    ("outputs", "until", "first", "last"),
    [
        (["99/2"], 3, 47, 52),
        (["99/2"], 3.5, 46, 53),  # a wave sent at 0 arrives at 3.5, and its jump is seen then
        (["99/2"], 3.4999999999999996, 47, 52),
        (["99/2"], Fraction(1, 10), 49, 50),  # the ends of its rod
        (["50-"], Fraction(1, 10), 49, 50),
        (["50+"], Fraction(1, 10), 50, 51),
        (["50-"], 2, 48, 52),
        ([0], 2, 0, 2),
        ([100], 2, 98, 100),
        (["10-", "40-"], 5, 5, 45),
        (["50-"], 1e9, 0, 100),
    ],
)
def test_the_cone(outputs, until, first, last):
    reached = tower(outputs).joints_in_reach(rational(until))
    assert (min(reached), max(reached)) == (first, last)


@pytest.mark.parametrize(
    ("damping", "nodes"), [(None, 4), (Damping((fmpq(0),)), 4), (Damping((fmpq(0), fmpq(1, 20))), 101)]
)
def test_damped_modes_have_no_cone(damping, nodes):
    """Each is damped as a whole: all of the chain acts on an output, and is told with it."""
    model = replace(tower(["1-"], until=2), damping=damping)
    assert len(model.joints_in_reach(model.until)) == nodes
    assert len(model.letters["kappa"]) == (3 if nodes == 4 else 101)
