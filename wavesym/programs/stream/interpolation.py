"""Polynomials through the values at the zeros of a Chebyshev polynomial: the instants of a panel, -1 to 1 here."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from math import cos, pi

import numpy as np
from flint import arb, ctx, fmpq
from numpy.polynomial.chebyshev import chebval

from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import midpoint

ORDERS = 3
_BITS = 128
_LOOKED = 3  # instants for each degree


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
def kinks(degree: int) -> tuple[tuple[float, float], ...]:
    """How wrong interpolation is, at most, where a jump, a kink or a bend is between two instants.

    A jump (order 0), a kink (1) or a bend (2) is (u - place)**order / order! from a place on, and 0 before.

    Args:
        degree: Of the polynomial, through the values at degree + 1 points.

    Returns:
        By order, for any place between the first and the last point, the largest error on -1 ... 1, and the largest
        root of the integral of its square. Both are looked for at places that are zeros of a Chebyshev polynomial
        between each two points, the first at such instants on both sides of each: it is a polynomial of the place
        and of how far
        along a side one is, and so is the square of the second, so that `_grid_factor` says how much larger it may be
        elsewhere.
    """
    at, back = np.array(points(degree)), np.array(transform(degree))
    count = _LOOKED * (degree + ORDERS)
    shares = (1 + np.array(points(count - 1))) / 2
    weights = _weights(count)
    most = np.zeros((ORDERS, 2))
    # the points are the same from either end
    for left, right in pairwise(at[: degree // 2 + 2]):
        places = left + shares * (right - left)
        after = places[:, None] + np.outer(1 - places, shares)
        instants = np.stack([-1 + np.outer(1 + places, shares), after])
        lengths = np.stack([1 + places, 1 - places])
        for order in range(ORDERS):
            coefficients = back @ _bent(at[:, None], places[None, :], order)
            errors = chebval(instants, coefficients[..., None], tensor=False)
            errors[1] -= _bent(after, places[:, None], order)
            square = np.sum(lengths * (errors**2 @ weights), axis=0)
            most[order] = np.maximum(most[order], (np.max(np.abs(errors)), np.sqrt(np.max(square))))
    margins = _grid_factor(degree + ORDERS, count) ** 2, np.sqrt(_grid_factor(2 * (degree + ORDERS), count))
    # the same on every machine
    return tuple(
        (_three_digits(1.001 * margins[0] * one), _three_digits(1.001 * margins[1] * two)) for one, two in most
    )


def _three_digits(value: float) -> float:
    return float(f"{value:.3g}")


def _weights(count: int) -> Array:
    """Of the zeros of T_count on 0 ... 1, for integrals of polynomials of a lower degree (Fejer's first rule)."""
    angles = pi * (2 * np.arange(count) + 1) / (2 * count)
    orders = np.arange(1, count // 2 + 1)
    weights: Array = (1 - 2 * np.cos(2 * np.outer(angles, orders)) @ (1 / (4.0 * orders**2 - 1))) / count
    return weights


def _bent(u: Array, place: Array, order: int) -> Array:
    return np.where(u >= place, (u - place) ** order / (1, 1, 2)[order], 0.0)


def _grid_factor(degree: int, count: int) -> float:
    """How many times as large as at the zeros of T_count a polynomial of a lower degree may be, at most.

    Source: Ehlich and Zeller, Schwankung von Polynomen zwischen Gitterpunkten, Math. Zeitschrift 86 (1964).
    """
    return 1 / cos(pi * degree / (2 * count))
