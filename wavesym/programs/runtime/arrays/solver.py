"""How the states of a joint move on a panel: x' = rates x + f, as series, of all sets at once.

Integrated once, 2 k x_k + G (x_(k-1) - x_(k+1)) = r_k with G = -half the length times rates: eliminated from the
highest k down, where x_0 counts twice.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.runtime.engine import Array


class ArraySolver:
    """`rates` of shape (states, states, sets), `half` the length of the panel."""

    def __init__(self, rates: Array, half: float, degree: int) -> None:
        self._rates, self._half, self._degree = rates, half, degree
        g = -half * np.moveaxis(rates, -1, 0)
        one = np.eye(len(rates))
        self._solve, self._down, first, last = np.zeros((4, degree + 2, *g.shape))
        for k in range(degree, 0, -1):
            self._solve[k] = _inverse(2 * k * one + g @ self._down[k + 1])
            self._down[k] = self._solve[k] @ g
            first[k] = (-1) ** k * one - first[k + 1] @ self._down[k + 1]
            last[k] = one - last[k + 1] @ self._down[k + 1]
        self._first, self._last = first, last
        self._start = _inverse(one - 2 * first[1] @ self._down[1])
        self._end = one - 2 * last[1] @ self._down[1]

    def moved(self, f: Array, state: Array) -> tuple[Array, Array]:
        """The series x, and the state at the end of the panel, from that at its start: f of shape
        (degree + 2, ..., states, sets), `state` (..., states, sets).
        """
        x = np.zeros_like(f)
        if not len(self._rates):
            return x, state
        y, ended, begun = np.zeros_like(state), np.zeros_like(state), state
        for k in range(self._degree, 0, -1):
            r = self._half * ((2 * f[0] if k == 1 else f[k - 1]) - f[k + 1])
            x[k] = y = _apply(self._solve[k], r) + _apply(self._down[k], y)
            begun = begun - _apply(self._first[k], y)
            ended = ended + _apply(self._last[k], y)
        x[0] = _apply(self._start, begun)
        ended = ended + _apply(self._end, x[0])
        before = 2 * x[0]
        for k in range(1, self._degree + 1):
            x[k] = before = x[k] - _apply(self._down[k], before)
        return x, ended

    def missed(self, f: Array, x: Array, is_mass: NDArray[np.bool_]) -> Array:
        """What the polynomials miss, as velocities: the one term that does not fit. What a spring misses of its length
        counts by the acceleration that it makes, for half a panel.
        """
        rest = f[self._degree] + np.einsum("ijs,...js->...is", self._rates, x[self._degree])
        pull = np.max(self._half * np.abs(self._rates), axis=0, initial=1.0)
        weight = np.where(is_mass[:, None], 1.0, pull)
        found: Array = np.sum(weight * np.abs(rest), axis=-2) * self._half / (2 * (self._degree + 1))
        return found


def _apply(matrix: Array, vector: Array) -> Array:
    """(sets, states, states) times (..., states, sets)."""
    found: Array = np.einsum("sij,...js->...is", matrix, vector)
    return found


def _inverse(matrix: Array) -> Array:
    """NaN where there is none."""
    found = np.full_like(matrix, np.nan)
    try:
        found[:] = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        if len(matrix) > 1:  # of one set, at least
            found = np.concatenate([_inverse(each[None]) for each in matrix])
    return found
