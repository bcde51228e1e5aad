"""The exact number that a derived expression stands for, once i, m and the parameters are known, and the way back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod
from typing import TYPE_CHECKING

from flint import fmpq, fmpq_mpoly
from sympy import Add, Expr, Indexed, IndexedBase, Integer, Mul, Pow, Rational, Symbol

from wavesym.mechanics.node import Parameters

if TYPE_CHECKING:
    from wavesym.numbers.ratio import Ratio

_FIELDS = {"kappa": "kappa", "J": "inertia", "v": "velocity", "b": "dashpot"}


def number(expression: Expr, places: Mapping[str, int | fmpq], parameters: Parameters | None) -> fmpq:
    """`expression` with `places` for its symbols and `parameters` for kappa, J and v. TypeError for anything else."""
    match expression:
        case Rational():
            return fmpq(int(expression.p), int(expression.q))
        case Symbol():
            return fmpq(0) + places[expression.name]  # which may be a rational function
        case Indexed():
            index = int(number(expression.indices[0], places, None))
            value: fmpq = getattr(parameters, _FIELDS[str(expression.base)])[index]
            return value
        case Add():
            return sum((number(part, places, parameters) for part in expression.args), fmpq(0))
        case Mul():
            product = fmpq(1)
            for part in expression.args:
                product *= number(part, places, parameters)
            return product
        case Pow(base=base, exp=exponent) if exponent.is_Integer:
            return number(base, places, parameters) ** int(exponent)
    raise TypeError(f"no exact number: {expression}")


def symbol(name: str) -> Indexed:
    """kappa[3] for kappa_3."""
    base, _, index = name.rpartition("_")
    return IndexedBase(base)[int(index)]


def expression(value: Ratio | fmpq | int) -> Expr:
    """An exact number or rational function as an expression, kappa[3] for its symbol kappa_3."""
    if isinstance(value, (int, fmpq)):
        return _rational(fmpq(value))
    names = value.ring.names
    below = [_polynomial(value.ring.forms[form], names) ** power for form, power in sorted(value.denominator.items())]
    return _polynomial(value.numerator, names) / prod(below, start=Integer(1))


def _polynomial(polynomial: fmpq_mpoly, names: Sequence[str]) -> Expr:
    # of hundreds of names, a term has a few
    terms = (
        _rational(value)
        * prod((symbol(name) ** int(e) for name, e in zip(names, powers, strict=True) if e), start=Integer(1))
        for powers, value in polynomial.to_dict().items()
    )
    return sum(terms, Integer(0))


def _rational(value: fmpq) -> Rational:
    return Rational(int(value.p), int(value.q))
