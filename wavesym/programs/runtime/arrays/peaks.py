"""The least and the greatest value of each output, between samples, too: what templates/c/runtime/peaks.c does."""

from __future__ import annotations

from itertools import product

import numpy as np

from wavesym.programs.runtime.arrays.march import ArrayMarch
from wavesym.programs.runtime.arrays.tables import ArrayTables, Ints
from wavesym.programs.runtime.arrays.values import chebyshev
from wavesym.programs.runtime.engine import Array

_POINTS = 16
_DEEPEST = 60
_CLOSELY = 8
_AT_ONCE = 1 << 10


class _Part:
    """An output on a section of all windows of a phase: of all sets, one polynomial on each."""

    def __init__(self, tables: ArrayTables, series: Array, phase: int, section: int, output: int) -> None:
        self._tables, self._series, self._phase = tables, series, phase
        self._strands = [int(strand) for strand in tables.strands(section, output)]
        begin, end = tables.section(phase, section)
        windows = tables.windows(phase)
        ends = np.minimum(end, tables.tau_max - tables.begins(windows))
        self.windows = windows[ends >= begin]
        self.t = begin + (ends[ends >= begin] - begin)[:, None] * np.linspace(0, 1, _POINTS)

    def tau(self, windows: Ints, t: Array) -> Array:
        """The instants that are t in the cycles of windows."""
        found: Array = self._tables.begins(windows) + t
        return found

    def survey(self) -> Array:
        """At `t`: of shape (windows, points, sets)."""
        found = np.zeros((*self.t.shape, self._series.shape[-1]))
        for strand in self._strands:
            found += self._weights(strand, self.t) @ self._series[self.windows, strand]
        return found

    def at(self, window: Ints, sets: Ints, t: Array) -> Array:
        """Of each of `sets` at an instant of its own."""
        found = np.zeros_like(t)
        for strand in self._strands:
            found += np.sum(self._weights(strand, t) * self._series[window, strand, :, sets], axis=1)
        return found

    def bend(self, noise: Array) -> Array:
        """At most so large is the second derivative, of shape (windows, sets): |T_k''| <= k^2 (k^2 - 1) / 3."""
        squares = np.arange(self._series.shape[2], dtype=np.float64) ** 2
        found = np.zeros((len(self.windows), self._series.shape[-1]))
        for strand in self._strands:
            sizes = np.abs(self._series[self.windows, strand])
            sizes = np.where(sizes > noise, sizes, 0.0)
            scale = self._tables["strand_scale"][strand]
            found += np.einsum("k,wks->ws", squares * (squares - 1), sizes) * (scale * scale / 3)
        return found

    def _weights(self, strand: int, t: Array) -> Array:
        return chebyshev(self._tables.on(strand, t, self._phase), self._series.shape[2] - 1)


class _Summit:
    """Of each set the greatest value seen, or of the negative where `sign` is -1, and its tau."""

    def __init__(self, sign: int, sets: int) -> None:
        self.sign = sign
        self.best, self.tau = np.full(sets, -np.inf), np.full(sets, np.nan)

    def see(self, sets: Ints, values: Array, tau: Array) -> None:
        """Take what is higher."""
        heights = self.sign * values
        order = np.argsort(heights, kind="stable")  # of several of one set the last one stays, and is the highest
        best, when = np.full_like(self.best, -np.inf), np.full_like(self.tau, np.nan)
        best[sets[order]], when[sets[order]] = heights[order], tau[order]
        higher = best > self.best
        self.best, self.tau = np.where(higher, best, self.best), np.where(higher, when, self.tau)

    def explore(self, part: _Part, survey: Array, bend: Array, slack: Array) -> None:
        """Look for what is higher between the instants of a survey, closely where it can be.

        `bend` is the bound of a whole panel. Near a front, or where an output comes to rest, that is far too large:
        there four times the largest second difference is taken.
        """
        heights = self.sign * survey
        steps = np.diff(part.t, axis=1)[:, :, None]
        limit = np.maximum(heights[:, :-1], heights[:, 1:]) + bend[:, None] * steps * steps / 8
        row, gap, sets = np.nonzero(limit > self.best + slack)
        for begin in range(0, len(row), _AT_ONCE):
            some = slice(begin, begin + _AT_ONCE)
            places = np.linspace(0, 1, _POINTS) / _CLOSELY + np.arange(_CLOSELY)[:, None] / _CLOSELY
            left, width = part.t[row[some], gap[some]], steps[row[some], gap[some], 0]
            t = (left[:, None, None] + width[:, None, None] * places).reshape(-1, _POINTS)
            window, members = (np.repeat(of[some], _CLOSELY) for of in (part.windows[row], sets))
            values = part.at(np.repeat(window, _POINTS), np.repeat(members, _POINTS), t.ravel()).reshape(t.shape)
            self.see(np.repeat(members, _POINTS), values.ravel(), part.tau(window[:, None], t).ravel())
            each = np.repeat(width, _CLOSELY) / (_CLOSELY * (_POINTS - 1))
            seen = 4 * np.abs(np.diff(values, 2, axis=1)).max(axis=1) / (each * each)
            bends = np.minimum(seen, np.repeat(bend[row[some], sets[some]], _CLOSELY))
            window, members, bends = (np.repeat(of, _POINTS - 1) for of in (window, members, bends))
            (left, right), (at_left, at_right) = (
                (of[:, :-1].ravel(), of[:, 1:].ravel()) for of in (t, self.sign * values)
            )
            self._climb(part, window, members, bends, left, right, at_left, at_right, slack)

    def _climb(
        self,
        part: _Part,
        window: Ints,
        sets: Ints,
        bends: Array,
        left: Array,
        right: Array,
        at_left: Array,
        at_right: Array,
        slack: Array,
    ) -> None:
        """Between ends no higher than h an output rises to h + bend * width^2 / 8 at most: halve, until that is no more
        than `slack` above the best.
        """
        for _ in range(_DEEPEST):
            limit = np.maximum(at_left, at_right) + bends * (right - left) ** 2 / 8
            some = limit > self.best[sets] + slack[sets]
            if not some.any():
                break
            window, sets, bends = window[some], sets[some], bends[some]
            left, right, at_left, at_right = left[some], right[some], at_left[some], at_right[some]
            middle = left + (right - left) / 2
            values = part.at(window, sets, middle)
            self.see(sets, values, part.tau(window, middle))
            at_middle = self.sign * values
            left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
            at_left, at_right = np.concatenate([at_left, at_middle]), np.concatenate([at_middle, at_right])
            window, sets, bends = np.tile(window, 2), np.tile(sets, 2), np.tile(bends, 2)


def array_peaks(tables: ArrayTables, march: ArrayMarch) -> Array:
    """Of shape (sets, outputs, 4): the least value, its tau, the greatest value, its tau."""
    found = np.empty((len(march.status), tables.outputs, 4))
    longest = max(series.shape[1] for series in march.series)
    series = np.zeros((len(march.series), tables.sizes["strands"], longest, len(found)))
    for window, of in enumerate(march.series):
        series[window, :, : of.shape[1]] = of[:, :, 0]
    series[..., march.status != 0] = 0
    for output in range(tables.outputs):
        places = product(range(tables.cycle), range(tables.sizes["sections"]))
        every = (_Part(tables, series, phase, section, output) for phase, section in places)
        parts = [part for part in every if len(part.windows)]
        least, greatest = _extremes(parts, len(found), tables.unit)
        found[:, output] = np.stack([-least.best, least.tau, greatest.best, greatest.tau], axis=1)
    found[march.status != 0] = np.nan
    return found


def _extremes(parts: list[_Part], sets: int, unit: float) -> tuple[_Summit, _Summit]:
    """Of one output: first of all instants surveyed, then of all between them that may be higher."""
    least, greatest = _Summit(-1, sets), _Summit(1, sets)
    surveys = [part.survey() for part in parts]
    every = np.arange(sets)
    for part, survey in zip(parts, surveys, strict=True):
        flat, tau = survey.reshape(-1, sets), part.tau(part.windows[:, None], part.t).ravel()
        for summit in (least, greatest):
            highest = np.argmax(summit.sign * flat, axis=0)
            summit.see(every, flat[highest, every], tau[highest])
    slack = 4 * unit * np.maximum(np.abs(least.best), np.abs(greatest.best))
    for part, survey in zip(parts, surveys, strict=True):
        bend = part.bend(slack)
        least.explore(part, survey, bend, slack)
        greatest.explore(part, survey, bend, slack)
    return least, greatest
