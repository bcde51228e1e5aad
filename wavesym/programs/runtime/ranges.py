"""How large and how small parameters may be, so that no product on the way to a law leaves the floating-point numbers.

A product beyond the largest number makes a quotient 0, one below the smallest normal number loses digits, and nothing
tells afterwards: what would be wrong is the chain itself. So the parameters are refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import ceil, floor, log10

from flint import fmpq, fmpq_mpoly

from wavesym.errors import RangeError
from wavesym.numbers.doubles import nearest
from wavesym.numbers.ratio import Ratio
from wavesym.numbers.reals import Real
from wavesym.programs.runtime.laws import RuntimeLaws
from wavesym.programs.runtime.units import Function

Ranges = Mapping[str, tuple[float, float]]
"""Of each field of positive numbers the least and the largest of them, powers of 10."""


def ranges(laws: RuntimeLaws, real: Real) -> Ranges:
    """Those that the laws ask for. RangeError where the scene's own numbers are outside."""
    found = _ranges(laws, [function for functions in laws.functions.values() for function in functions], real)
    for field in laws.fields:
        least, largest = found.get(field.name, (0.0, 0.0))
        if field.positive and not all(least <= nearest(value) <= largest for value in field.values):
            raise RangeError(
                f"--runtime: {field.name} from {least:g} to {largest:g} expected in {real.name} precision, beyond "
                "which products are no numbers (fewer joints without mass side by side help)"
            )
    return found


def slope_ranges(laws: RuntimeLaws, real: Real) -> Ranges:
    """Those that their derivatives ask for."""
    return _ranges(laws, [slope for *_, slope in laws.slopes], real)


def _ranges(laws: RuntimeLaws, functions: Iterable[Function], real: Real) -> Ranges:
    smallest, largest = _log(real.smallest / (2 * real.roundoff)), _log(real.largest)
    positive = {label: field.name for field in laws.fields if field.positive for label in field.labels}
    sizes = {
        label: _log(unit.size) for field in laws.fields for label, unit in zip(field.labels, field.units, strict=True)
    }
    found = dict.fromkeys(positive.values(), (smallest, largest))
    for symbols, factors in (product for function in set(functions) for product in _products(function)):
        degree = sum(_degree(factor) for factor in factors)
        extents = [_extent(factor, [sizes[name] for name in symbols]) for factor in factors]
        low, high = (sum(ends) for ends in zip(*extents, strict=True))
        names = {symbols[place] for factor in factors for place, power in enumerate(factor.degrees()) if power}
        for name in names & positive.keys():
            least, most = found[positive[name]]
            found[positive[name]] = (
                max(least, sizes[name] + (smallest - low) / degree),
                min(most, sizes[name] + (largest - high) / degree),
            )
    return {name: (float(f"1e{ceil(least)}"), float(f"1e{floor(most)}")) for name, (least, most) in found.items()}


def _products(function: Function) -> Iterator[tuple[tuple[str, ...], tuple[fmpq_mpoly, ...]]]:
    """What stands above and below the line, where it is rounded: the symbols, and the factors."""
    if isinstance(function, Ratio):
        forms = [(function.ring.forms[form], power) for form, power in sorted(function.denominator.items())]
        below = tuple(form for form, power in forms for _ in range(power))
        for factors in ((function.numerator,), below):
            if any(_is_rounded(factor) for factor in factors) or len(factors) > 1:
                yield function.ring.names, factors


def _is_rounded(polynomial: fmpq_mpoly) -> bool:
    terms = polynomial.to_dict()
    return len(terms) > 1 or any(abs(fmpq(value)) != 1 or sum(powers) > 1 for powers, value in terms.items())


def _degree(polynomial: fmpq_mpoly) -> int:
    return max(sum(map(int, powers)) for powers in polynomial.to_dict())


def _extent(polynomial: fmpq_mpoly, sizes: Sequence[float]) -> tuple[float, float]:
    """How small and how large, 0 at most and at least, a term and what it begins with are where all parameters are a
    dimensionless 1; and the sum."""
    low = high = 0.0
    terms = polynomial.to_dict()
    for powers, value in terms.items():
        size = _log(abs(fmpq(value)))
        low, high = min(low, size), max(high, size)
        for power, unit in zip(powers, sizes, strict=True):
            size += int(power) * unit
            low, high = min(low, size), max(high, size)
    return low, high + log10(max(len(terms), 1))


def _log(value: fmpq) -> float:
    """To the base 10, of any size."""
    return log10(int(value.p)) - log10(int(value.q))
