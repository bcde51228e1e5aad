"""How large and small parameters may be: where products on the way to a law are numbers, laws are right."""

from itertools import product

import numpy as np
import pytest
from flint import fmpq

import wavesym
from wavesym.errors import RangeError
from wavesym.numbers.doubles import rational
from wavesym.numbers.ratio import Ratio
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.request import Request
from wavesym.programs.runtime.arrays.laws import allowed, array_laws, array_slopes
from wavesym.programs.runtime.making import runtime_program
from wavesym.programs.runtime.ranges import ranges, slope_ranges
from wavesym.scene import lower



def laws_of(size, precision="double"):
    """Of two rods that a dashpot links; all numbers of the chain are so large."""
    rods = [{"rod": 1, "impedance": size}, {"dashpot": size}, {"rod": 1, "impedance": 2 * size}]
    scene = wavesym.Scene(
        name="linked",
        system={"type": "chain", "parts": ["free", *rods, {"mass": size}]},
        output={"until": 4, "tolerance": "1e-4", "velocity": ["1/2", "3/2"]},
    )
    request = Request(runtime=("mass", "dashpot", "impedance"), precision=precision)
    return runtime_program(lower(scene), request, ()).laws


LAWS = laws_of(1)
FEW = fmpq(1, 10**14)
NORMAL, LARGEST = fmpq(1, 2**1022), fmpq(2**1023)


def lost(given, slopes=False):
    """Whether a law, or a derivative, that is a normal number has lost digits."""
    values = {label: rational(value) for label, value in zip(LAWS.places, given, strict=True)}
    with np.errstate(all="ignore"):
        found = (array_slopes if slopes else array_laws)(LAWS, np.array([given]))
    if slopes:
        pairs = [(slope, found[name][lane, k, 0]) for lane, name, k, slope in LAWS.slopes]
    else:
        pairs = [(of, found[name][k, 0]) for name, all_of in LAWS.functions.items() for k, of in enumerate(all_of)]
    for function, value in pairs:
        exact = function.at(values) if isinstance(function, Ratio) else function
        if NORMAL <= abs(exact) <= LARGEST:
            if not np.isfinite(value) or abs(rational(float(value)) - exact) > FEW * abs(exact):
                return True
    return False


@pytest.mark.parametrize("slopes", [False, True])
def test_laws_are_right_at_the_ends_of_ranges(slopes):
    found = (slope_ranges if slopes else ranges)(LAWS, DOUBLE)
    ends = [(1.1 * least, 0.9 * largest) for least, largest in found.values()]
    mass, dashpot, impedance = ends
    for given in product(mass, dashpot, impedance, impedance):
        assert allowed(LAWS, np.array([given]), found).all()
        assert not lost(given, slopes)
    beyond = [*ends[0], ends[1][0] / 10, ends[2][0], ends[2][0]]
    assert not allowed(LAWS, np.array([[beyond[0], *beyond[2:]]]), found).any()


@pytest.mark.parametrize(("size", "slopes"), [(1e-160, False), (1e160, False), (1e-90, True), (1e90, True)])
def test_they_would_be_wrong_beyond(size, slopes):
    """Though nothing overflows: a product that does makes quotients 0."""
    given = (size, 1.1 * size, 1.3 * size, size)
    assert lost(given, slopes)
    assert not allowed(LAWS, np.array([given]), (slope_ranges if slopes else ranges)(LAWS, DOUBLE)).any()


def test_a_scene_out_of_range_is_refused():
    assert ranges(laws_of(10**17, "single"), SINGLE)["impedance"] == (1e-18, 1e18)
    with pytest.raises(RangeError, match="dashpot from 1e-18 to 1e.18 expected in single precision"):
        ranges(laws_of(10**19, "single"), SINGLE)
