"""What a polynomial on a panel makes of a kink: how wrong interpolation is where a load changes inside of a panel.

What loads do is known at any time; on a panel it is kept as the polynomial through the values at its Chebyshev points.
(t - t0)**k / k! from t0 on, a jump (k = 0), a kink (1) or a bend (2), is no polynomial. Its largest error depends on
which points t0 lies between, and is worst about midway.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
from flint import arb, ctx, fmpq
from numpy.typing import NDArray

from wavesym.numbers.doubles import midpoint

Array = NDArray[np.float64]

ORDERS = 3
_BITS = 128
_PLACES = (0.25, 0.5, 0.75)  # of t0 between two points
_LOOKED = 40  # instants between two points


def points(degree: int) -> tuple[float, ...]:
    """The zeros of T_(degree + 1), from the first to the last, each rounded once."""
    size = degree + 1
    with ctx.workprec(_BITS):
        return tuple(midpoint(-arb.cos_pi_fmpq(fmpq(2 * n + 1, 2 * size))) for n in range(size))


def transform(degree: int) -> tuple[tuple[float, ...], ...]:
    """From values at `points` to Chebyshev coefficients: rows are coefficients, each number rounded once."""
    size = degree + 1
    with ctx.workprec(_BITS):
        return tuple(
            tuple(
                midpoint((-1) ** k * arb.cos_pi_fmpq(fmpq(k * (2 * n + 1), 2 * size)) * (2 if k else 1) / size)
                for n in range(size)
            )
            for k in range(size)
        )


@cache
def kinks(degree: int) -> tuple[tuple[float, ...], ...]:
    """By order k, for t0 between points n and n + 1, n = 0 ... degree - 1: the largest error; the panel is 2 long."""
    at, instants = np.array(points(degree)), np.linspace(-1, 1, _LOOKED * (degree + 1))
    back = np.cos(np.outer(np.arccos(instants), np.arange(degree + 1))) @ np.array(transform(degree))
    rows = []
    for order in range(ORDERS):
        row = []
        for left, right in pairwise(at):
            errors = (_missed(left + place * (right - left), order, at, instants, back) for place in _PLACES)
            row.append(float(f"{max(errors):.2g}"))  # the same on every machine
        rows.append(tuple(row))
    return tuple(rows)


def _missed(begin: float, order: int, at: Array, instants: Array, back: Array) -> float:
    def bent(u: Array) -> Array:
        return np.where(u >= begin, (u - begin) ** order / (1, 1, 2)[order], 0.0)

    return float(np.max(np.abs(back @ bent(at) - bent(instants))))
