"""Bodies on a panel: the velocity that solves q'/rate + q = p, as a series."""

from __future__ import annotations

import numpy as np

from wavesym.programs.runtime.engine import Array


class ArrayBodies:
    """The elimination of q_k + x_k (q_(k-1) - q_(k+1)) = x_k (p_(k-1) - p_(k+1)) from the highest k down.

    `step` is rate times length, of shape (nodes, sets), 0 for nodes without inertia.
    """

    def __init__(self, step: Array, degree: int) -> None:
        self._ratio, first, last = np.zeros((3, degree + 2, *step.shape))
        ratio = self._ratio
        for k in range(degree, 0, -1):
            ratio[k] = step / (4 * k + step * ratio[k + 1])
            first[k] = (-1) ** k - ratio[k + 1] * first[k + 1]
            last[k] = 1 - ratio[k + 1] * last[k + 1]
        begun = 2 * ratio[1] * first[1]
        self._first, self._last = first, last
        self._slack, self._loss = -begun / (1 - begun), 2 * ratio[1] * last[1]
        self.leak = step / (4 * (degree + 1))
        """What a polynomial misses, of the last coefficient of q - p."""

    def moved(self, p: Array, velocity: Array) -> tuple[Array, Array]:
        """q, and the velocity at the end of the panel, from that at its start."""
        q = np.empty_like(p)
        degree = len(p) - 1
        y, begun, ended = np.zeros((3, *p.shape[1:]))
        for k in range(degree, 0, -1):
            change = (2 * p[0] if k == 1 else p[k - 1]) - (p[k + 1] if k < degree else 0.0)
            y = self._ratio[k] * change + self._ratio[k] * y
            q[k] = y
            begun += self._first[k] * y
            ended += self._last[k] * y
        begun = velocity - begun
        q[0] = begun - self._slack * begun
        velocity = q[0] + (ended - self._loss * q[0])
        before = 2 * q[0]
        for k in range(1, degree + 1):
            before = q[k] - self._ratio[k] * before
            q[k] = before
        return q, velocity
