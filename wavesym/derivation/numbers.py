"""The exact number that a derived expression stands for, once i, m and the parameters are known."""

from __future__ import annotations

from collections.abc import Mapping

from flint import fmpq
from sympy import Add, Expr, Indexed, Mul, Pow, Rational, Symbol

from wavesym.mechanics.node import Parameters

_FIELDS = {"kappa": "kappa", "J": "inertia", "v": "velocity"}


def number(expression: Expr, places: Mapping[str, int], parameters: Parameters | None) -> fmpq:
    """`expression` with `places` for its symbols and `parameters` for kappa, J and v. TypeError for anything else."""
    match expression:
        case Rational():
            return fmpq(int(expression.p), int(expression.q))
        case Symbol():
            return fmpq(places[expression.name])
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
