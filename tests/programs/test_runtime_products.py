"""Products on the way to a law are numbers with all their digits, or the parameters are refused."""

import numpy as np
import pytest
from flint import fmpq
from wavesym.programs.runtime.arrays.laws import allowed, array_laws, array_slopes

import wavesym
from wavesym.numbers.doubles import rational
from wavesym.numbers.ratio import Ratio
from wavesym.programs.request import Request
from wavesym.programs.runtime.making import runtime_program
from wavesym.scene import lower

LINKED = wavesym.Scene(
    name="linked",
    system={"type": "chain", "parts": ["free", {"rod": 1}, {"dashpot": 1}, {"rod": 1, "impedance": 2}, {"mass": 1}]},
    output={"until": 4, "velocity": ["1/2", "3/2"]},
)
LAWS = runtime_program(lower(LINKED), Request(runtime=("mass", "dashpot", "impedance")), ()).laws
FEW = fmpq(1, 10**14)
NORMAL, LARGEST = fmpq(1, 2**1022), fmpq(2**1023)


def lost(given, slopes):
    """Whether a law, or a derivative, that is a normal number has lost digits."""
    values = {label: rational(value) for label, value in zip(LAWS.places, given, strict=True)}
    with np.errstate(all="ignore"):
        found = (array_slopes if slopes else array_laws)(LAWS, np.array([given]))
    if slopes:
        pairs = [(slope, found[name][lane, k, 0]) for lane, name, k, slope in LAWS.slopes]
    else:
        pairs = [(of, found[name][k, 0]) for name, every in LAWS.functions.items() for k, of in enumerate(every)]
    for function, value in pairs:
        exact = function.at(values) if isinstance(function, Ratio) else function
        if NORMAL <= abs(exact) <= LARGEST and not (
            np.isfinite(value) and abs(rational(float(value)) - exact) <= FEW * abs(exact)
        ):
            return True
    return False


def accepted(given, slopes):
    with np.errstate(all="ignore"):
        return bool(allowed(LAWS, np.array([given]), LAWS.every_slope if slopes else LAWS.every).all())


@pytest.mark.parametrize("slopes", [False, True])
def test_no_law_has_lost_digits_that_is_not_refused(slopes):
    """Numbers from anywhere, and all about as large."""
    draw = np.random.default_rng(26)
    sets = [10.0 ** draw.uniform(-300, 300, 4) for _ in range(30)]
    sets += [10.0 ** (size + draw.uniform(-1, 1, 4)) for size in range(-300, 301, 30)]
    told = [(accepted(given, slopes), lost(given.tolist(), slopes)) for given in sets]
    assert set(told) >= {(True, False), (False, True)}
    assert (True, True) not in told


@pytest.mark.parametrize(("size", "slopes"), [(1e-150, False), (1e150, False), (1e-70, True), (1e70, True)])
def test_what_is_fine_is_not_refused(size, slopes):
    assert accepted((size, 1.1 * size, 1.3 * size, size), slopes)
