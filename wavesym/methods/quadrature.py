"""Gauss's rule, and Lagrange's and Legendre's polynomials: what integrates and interpolates values at points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from flint import arb, arb_mat, ctx
from numpy.polynomial import legendre

from wavesym.numbers.arrays import Array

_BITS = 256  # of Gauss's rule before it is rounded


@dataclass(frozen=True)
class Gauss:
    """Gauss's rule on [0, 1]: points, weights, the integrals from 0 to each point, and Legendre's coefficients."""

    nodes: Array
    weights: Array
    until: Array
    series: Array

    def interpolation(self, local: Array) -> Array:
        """From values at the points to values at others (n,) of [0, 1]: shape (n, points)."""
        return np.asarray(legendre.legvander(2 * local - 1, len(self.nodes) - 1) @ self.series)


@cache
def gauss(points: int) -> Gauss:
    """Gauss's rule with so many points, each number rounded once: NumPy has weights that are wrong by up to 1e-12."""
    with ctx.workprec(_BITS):
        rule = (arb.legendre_p_root(points, k, weight=True) for k in reversed(range(points)))
        nodes, weights = zip(*rule, strict=True)
        values = [_legendre(node, points) for node in nodes]
        series = [[(2 * j + 1) * w * p[j] / 2 for w, p in zip(weights, values, strict=True)] for j in range(points)]
        # P_j integrated from -1 on is (P_(j+1) - P_(j-1))/(2 j + 1)
        integrals = [[1 + p[1], *((p[j + 1] - p[j - 1]) / (2 * j + 1) for j in range(1, points))] for p in values]
        until = arb_mat(integrals) * arb_mat(series)
        on_unit = _round(arb_mat([[(x + 1) / 2 for x in nodes], [w / 2 for w in weights]]))
    return Gauss(on_unit[0], on_unit[1], _round(until) / 2, _round(arb_mat(series)))


def _legendre(x: arb, degree: int) -> list[arb]:
    """Legendre's polynomials P_0 ... P_degree at x."""
    values = [arb(1), x]
    for j in range(1, degree):
        values.append(((2 * j + 1) * x * values[j] - j * values[j - 1]) / (j + 1))
    return values


def _round(matrix: arb_mat) -> Array:
    return np.array([[float(value.mid()) for value in row] for row in matrix.tolist()])


def lagrange(s: Array, first: int, points: int) -> Array:
    """Lagrange's polynomials on the points first, first + 1, ... at s: shape (len(s), points)."""
    places = range(first, first + points)
    return np.stack(
        [np.prod([(s - other) / (place - other) for other in places if other != place], axis=0) for place in places],
        axis=1,
    )
