"""Products on the way to a law are numbers with all their digits, or the parameters are refused."""

from types import SimpleNamespace

import numpy as np
import pytest
from flint import fmpq

import wavesym
from wavesym.numbers.doubles import rational
from wavesym.numbers.ratio import Ratio
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.request import Request
from wavesym.programs.runtime.making import runtime_program
from wavesym.scene import lower
from wavesym.targets.c.runtime import assignments, product_lines, slopes

LINKED = wavesym.Scene(
    name="linked",
    system={"type": "chain", "parts": ["free", {"rod": 1}, {"dashpot": 1}, {"rod": 1, "impedance": 2}, {"mass": 1}]},
    output={"until": 4, "velocity": ["1/2", "3/2"]},
)
LAWS = runtime_program(lower(LINKED), Request(runtime=("mass", "dashpot", "impedance")), ()).laws
FEW = fmpq(1, 10**14)
NORMAL, LARGEST = fmpq(1, 2**1022), fmpq(2**1023)


def in_c(expressions, given):
    """What C makes of expressions in doubles."""
    places = zip(LAWS.places.values(), map(np.float64, given), strict=True)
    parameters = SimpleNamespace(**{field.name: {} for field in LAWS.fields})
    for (name, k), value in places:
        getattr(parameters, name)[k] = value
    with np.errstate(all="ignore"):
        return [np.float64(eval(text.replace("p->", "p."), {"p": parameters})) for text in expressions]


def lost(given, derived):
    """Whether a law, or a derivative, that is a normal number has lost digits."""
    values = {label: rational(value) for label, value in zip(LAWS.places, given, strict=True)}
    if derived:
        functions = [slope for *_, slope in LAWS.slopes]
        lines = [line for _, of in slopes(LAWS, LAWS.functions, DOUBLE) for line in of]
    else:
        functions = [function for of in LAWS.functions.values() for function in of]
        lines = list(assignments(LAWS, LAWS.functions, DOUBLE))
    found = in_c((text for _, text in lines), given)
    for function, value in zip(functions, found, strict=True):
        exact = function.evaluate(values) if isinstance(function, Ratio) else function
        if NORMAL <= abs(exact) <= LARGEST and not (
            np.isfinite(value) and abs(rational(float(value)) - exact) <= FEW * abs(exact)
        ):
            return True
    return False


def accepted(given, derived):
    """Whether what is multiplied on the way is a number with all its digits."""
    sizes = np.abs(
        in_c(product_lines(LAWS, [slope for *_, slope in LAWS.slopes] if derived else LAWS.every, DOUBLE), given)
    )
    return bool(np.all((sizes >= np.finfo(np.float64).tiny) & np.isfinite(sizes)))


@pytest.mark.quick(1)
@pytest.mark.parametrize("derived", [False, True])
def test_no_law_has_lost_digits_that_is_not_refused(derived):
    """Numbers from anywhere, and all about as large."""
    draw = np.random.default_rng(26)
    sets = [10.0 ** draw.uniform(-300, 300, 4) for _ in range(30)]
    sets += [10.0 ** (size + draw.uniform(-1, 1, 4)) for size in range(-300, 301, 30)]
    told = [(accepted(given, derived), lost(given.tolist(), derived)) for given in sets]
    assert set(told) >= {(True, False), (False, True)}
    assert (True, True) not in told


@pytest.mark.parametrize(("size", "derived"), [(1e-150, False), (1e150, False), (1e-70, True), (1e70, True)])
def test_what_is_fine_is_not_refused(size, derived):
    assert accepted((size, 1.1 * size, 1.3 * size, size), derived)
