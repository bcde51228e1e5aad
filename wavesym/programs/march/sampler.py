"""Outputs on a window: as linear functionals of its waves for the generator, as stretches for the programs."""

from __future__ import annotations

from math import inf

import numpy as np
from flint import fmpq

from wavesym.numbers.doubles import nearest, not_below
from wavesym.programs.march.operator import Array
from wavesym.programs.march.plan import Plan, Watched
from wavesym.programs.march.run import Block

SAMPLES = 17
"""Points per window, both ends among them, at which the generator looks for an output's largest value."""


class OutputSampler:
    """An output at `SAMPLES` points of every window; of the last one as far as the horizon goes."""

    def __init__(self, plan: Plan, output: Watched, degree: int) -> None:
        self._output = output
        ends = np.linspace(0.0, 1.0, SAMPLES), np.linspace(0.0, plan.tau_max % 1.0, SAMPLES)
        self._functionals = [
            [
                nearest(each.gain) * _functional(plan, each.delay, degree, points, integral=each.summed)
                for points in ends
            ]
            for each in output.heard
        ]
        self._coming = plan.windows
        self._total = 0.0

    def values(self, block: Block) -> Array:
        """Shape (windows, SAMPLES); blocks come in order, as integrals are summed up."""
        windows = len(block.after)
        self._coming -= windows
        values, sums = np.zeros((windows, SAMPLES)), np.zeros((windows, SAMPLES))
        for heard, (whole, last) in zip(self._output.heard, self._functionals, strict=True):
            series = _pairs(block, heard.way, heard.column)
            total = sums if heard.summed else values
            total += series @ whole
            if self._coming == 0:
                total[-1] += series[-1] @ (last - whole)
        before = self._total + np.concatenate([[0.0], np.cumsum(sums[:, -1])])
        self._total = float(before[-1])
        return np.asarray(values + sums + before[:-1, np.newaxis])

    def size(self, block: Block, weights: Array, *, summed: bool) -> Array:
        """The weighted absolute coefficients of what it hears, or of what it sums up, the larger panel; (windows,)."""
        heard = self._output.part(summed=summed)
        totals = [np.zeros((len(block.after), block.after.shape[2])) for _ in range(2)]
        for total, waves in zip(totals, (block.before, block.after), strict=True):
            for each in heard:
                total += abs(nearest(each.gain)) * (np.abs(waves[:, each.way, :, each.column + 1]) @ weights)
        return np.asarray(np.max(np.maximum(*totals), axis=-1))


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
