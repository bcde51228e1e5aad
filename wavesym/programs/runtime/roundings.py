"""How often a law is rounded where it is computed in floating-point numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from flint import fmpq, fmpq_mpoly

from wavesym.numbers.ratio import Ratio
from wavesym.programs.runtime.units import Function

OPEN = 1e30
"""Where nothing is known: terms that may cancel."""


def most_roundings(laws: Mapping[str, Iterable[Function]], positive: Iterable[str]) -> float:
    """The most of any law. `positive` are the symbols that are; sums of what they are in have terms of one sign.

    Each number in a law is rounded, each operation, and each parameter that is the scene's decimal.
    """
    given = frozenset(positive)
    return max((_roundings(function, given) for functions in laws.values() for function in functions), default=1.0)


def _roundings(function: Function, positive: frozenset[str]) -> float:
    if not isinstance(function, Ratio):
        return 1.0
    names = function.ring.names
    below = [(function.ring.forms[form], power) for form, power in function.denominator.items()]
    sums = [(function.numerator, 1), *below]
    return sum(power * (1 + _of_sum(polynomial, names, positive)) for polynomial, power in sums)


def _of_sum(polynomial: fmpq_mpoly, names: tuple[str, ...], positive: frozenset[str]) -> float:
    terms = {powers: fmpq(value) for powers, value in polynomial.to_dict().items()}
    if len(terms) > 1:
        signed = {value > 0 for value in terms.values()}
        of = {name for powers in terms for name, power in zip(names, powers, strict=True) if power}
        if len(signed) > 1 or not of <= positive:
            return OPEN
    return len(terms) + max((2.0 + sum(map(int, powers)) for powers in terms), default=0.0)
