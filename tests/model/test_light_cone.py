"""The light cone is as wide as waves run, to the node."""

from fractions import Fraction

import pytest

from wavesym.model.chain import chain
from wavesym.model.light_cone import light_cone
from wavesym.scene import Observable, Scene

TOWER = chain(
    Scene(
        name="tower",
        system={"type": "building", "m": 100, "kappa": [1] * 101, "base": "force"},
        output={"until": 1, "strain": ["1/2"]},
    )
)


def at(x, side=0):
    return Observable("strain", Fraction(x), side, "")


@pytest.mark.parametrize(
    ("outputs", "until", "first", "last"),
    [
        ([at("99/2")], 3, 47, 52),
        ([at("99/2")], 3.5, 46, 53),  # a wave sent at 0 arrives at 3.5, and its jump is seen then
        ([at("99/2")], 3.4999999999999996, 47, 52),
        ([at("99/2")], Fraction(1, 10), 49, 50),  # the ends of its rod
        ([at(50)], Fraction(1, 10), 49, 50),
        ([at(50, +1)], Fraction(1, 10), 50, 51),
        ([at(50, -1)], 2, 48, 52),
        ([at(0)], 2, 0, 2),
        ([at(100)], 2, 98, 100),
        ([at(10), at(40)], 5, 5, 45),
        ([at(50)], 1e9, 0, 100),
    ],
)
def test_the_cone(outputs, until, first, last):
    assert light_cone(TOWER, outputs, until) == range(first, last + 1)
