"""Outputs on a window: as linear functionals of its waves for the generator, as stretches for the programs."""

from __future__ import annotations

from math import inf

import numpy as np
from flint import fmpq

from wavesym.numbers.doubles import nearest, not_below
from wavesym.programs.march.operator import Array
from wavesym.programs.march.plan import Plan, Watched
from wavesym.programs.march.run import LEFT, RIGHT, Block

SAMPLES = 17
"""Points per window, both ends among them, at which the generator looks for an output's largest value."""


class OutputSampler:
    """An output at `SAMPLES` points of every window; of the last one as far as the horizon goes."""

    def __init__(self, plan: Plan, output: Watched, degree: int) -> None:
        self._output = output
        self._sign = -1.0 if output.quantity == "strain" else 1.0
        self._sums = output.quantity == "displacement"
        self._whole, self._last = (self._functionals(plan, degree, end) for end in (1.0, plan.tau_max % 1.0))
        self._coming = plan.windows
        self._total = 0.0

    def _functionals(self, plan: Plan, degree: int, end: float) -> tuple[Array, Array]:
        """For the wave to the left and the one to the right, up to `end` after the start of a window."""
        left, right = (
            _functional(plan, delay, degree, np.linspace(0.0, end, SAMPLES), integral=self._sums)
            for delay in (1 - self._output.delay, self._output.delay)
        )
        return left, self._sign * right

    def values(self, block: Block) -> Array:
        """Shape (windows, SAMPLES); blocks come in order, as a displacement is summed up."""
        left = _pairs(block, LEFT, self._output.left)
        right = _pairs(block, RIGHT, self._output.right)
        values = left @ self._whole[0] + right @ self._whole[1]
        self._coming -= len(values)
        if self._coming == 0:
            values[-1] = left[-1] @ self._last[0] + right[-1] @ self._last[1]
        if self._sums:
            before = self._total + np.concatenate([[0.0], np.cumsum(values[:, -1])])
            self._total = float(before[-1])
            values = values + before[:-1, np.newaxis]
        return np.asarray(values)

    def size(self, block: Block, weights: Array) -> Array:
        """The weighted absolute coefficients of its two waves on each window, the larger panel; shape (windows,)."""
        totals = []
        for waves in (block.before, block.after):
            right = np.abs(waves[:, RIGHT, :, self._output.right + 1]) @ weights
            left = np.abs(waves[:, LEFT, :, self._output.left + 1]) @ weights
            totals.append(np.max(right + left, axis=-1))
        return np.asarray(np.maximum(*totals))


def _pairs(block: Block, direction: int, column: int) -> Array:
    """Each window's coefficients after those of the window before: (windows, 2 * panels * coefficients)."""
    both = (waves[:, direction, :, column + 1] for waves in (block.before, block.after))
    return np.concatenate([waves.reshape(len(waves), -1) for waves in both], axis=1)


def _functional(plan: Plan, delay: fmpq, degree: int, points: Array, *, integral: bool) -> Array:
    """What maps the coefficients of `_pairs` to values, or integrals since the window began, at points of a window."""
    result = np.zeros((2, len(plan.panels), degree + 1, len(points)))
    stretches = plan.stretches(delay)
    counts_from = [*(not_below(max(stretch.start, fmpq(0))) for stretch in stretches), inf]
    for k, stretch in enumerate(stretches):
        length = nearest(plan.panels[stretch.panel].length)
        start = nearest(stretch.start)
        last = k == len(stretches) - 1
        end = 1.0 if last else nearest(stretches[k + 1].start)
        here = (points >= counts_from[k]) & (points < counts_from[k + 1])
        at = result[1 - stretch.back, stretch.panel]
        if integral:
            low = _antiderivative(np.array([2 * (max(start, 0.0) - start) / length - 1]), degree)
            reached = np.clip(points, max(start, 0.0), end)
            at += (_antiderivative(2 * (reached - start) / length - 1, degree) - low) * length / 2
        else:
            at[:, here] = _basis(2 * (points[here] - start) / length - 1, degree)
    return result.reshape(-1, SAMPLES)


def _basis(u: Array, degree: int) -> Array:
    return np.asarray(np.cos(np.outer(np.arange(degree + 1), np.arccos(np.clip(u, -1, 1)))))


def _antiderivative(u: Array, degree: int) -> Array:
    """Antiderivatives of T_0 ... T_degree at u."""
    chebyshev = _basis(u, degree + 1)
    result = np.empty((degree + 1, len(u)))
    result[0] = chebyshev[1]
    result[1] = chebyshev[2] / 4
    for k in range(2, degree + 1):
        result[k] = chebyshev[k + 1] / (2 * (k + 1)) - chebyshev[k - 1] / (2 * (k - 1))
    return result
