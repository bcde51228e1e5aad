"""Modes whose numbers are given when they run: many sets, each a model with modes of its own, in C."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
from math import ceil, log2
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import WavesymError
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.mode_sets.making import ModeSetsTables
from wavesym.programs.mode_sets.parameters import ModeParameters
from wavesym.programs.modes.evaluator import modes
from wavesym.programs.request import Request
from wavesym.running.native import FAST, call, library, room
from wavesym.running.sets import FoundSets, no_sets
from wavesym.running.toolchain import compiler
from wavesym.targets.files import runtime_sets

_BAD = 1
_MOST_MODES = 600  # of a set that needs more than the scene's own numbers
_MOST_SHORT = 64.0  # times the tolerance: more modes are not taken at once than that needs
_STEP = 2.0**-14  # of a parameter, over which differences are taken, first
_TRIES, _MOST_SCALE = 3, 2.0**12  # of others, each so many times larger or smaller
_LARGEST = {"damping": 2.0**-4, "load": np.inf}


class ModeSetResponses(NamedTuple):
    """Of each set its status, 1 where it is refused, its estimate, what rounding may do to outputs (sets, outputs),
    extremes (sets, outputs, 4): the least value, its tau, the greatest value, its tau; and histories (sets, outputs,
    instants): NaN of those that are refused."""

    status: NDArray[np.int32]
    estimate: Array
    rounding_errors: Array
    peaks: Array
    values: Array

    def rows(self, some: NDArray[np.bool_]) -> ModeSetResponses:
        """Those of some sets."""
        return ModeSetResponses._make(each[some] for each in self)

    def put(self, rows: NDArray[np.bool_], others: ModeSetResponses) -> None:
        """Take others for some sets."""
        arrays: tuple[Any, ...] = self
        for own, other in zip(arrays, others, strict=True):
            own[rows] = other


class _Slopes(NamedTuple):
    """Derivatives of sets by a parameter, of shape (sets, outputs, times), their estimates, and how many times as large
    a step may be better."""

    slopes: Array
    estimate: Array
    scale: Array


def _relative_error(wrong: Array, largest: Array) -> Array:
    """How wrong what is found is, relative to the largest true value: of that no more is known than `largest`, which is
    as `wrong`, leaves. Infinite where it leaves nothing."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(wrong > 0, np.where(wrong < largest, wrong / (largest - wrong), np.inf), wrong)


class ModalSets:
    """Sets of numbers of a model with modes. `given` has a row for each set, with all fields side by side.

    CompilerError where there is no C compiler. ToleranceError where modes do not serve the model's own numbers to its
    tolerance, UnservedError for what modes do not have.
    """

    def __init__(self, parameters: ModeParameters) -> None:
        compiler()
        self.parameters = parameters
        parameters.like.refuse()
        _ = parameters.fewest
        self.model, self.fields = parameters.model, parameters.fields
        self.tau_max = parameters.model.horizon()
        self._libraries: dict[int, ctypes.CDLL] = {}

    def values(self, given: Array, tau: Array) -> FoundSets:
        """Of shape (sets, 1, outputs, times)."""
        found = self._horizon_responses(given, tau)
        return FoundSets(found.status, found.estimate, found.values[:, None])

    def peaks(self, given: Array) -> FoundSets:
        """Of shape (sets, outputs, 4): the least value, its tau, the greatest value, its tau."""
        found = self.responses(given, np.empty(0))
        found.peaks[np.isinf(found.estimate)] = np.nan  # nothing is known
        return FoundSets(found.status, found.estimate, found.peaks)

    def misfit(self, tau: Array, data: Array) -> Callable[[Array], FoundSets]:
        """What makes of `given` the sums of the squares of all misfits, of shape (sets,). `data` of shape
        (outputs, times) is NaN where there is none.
        """

        def misfits(given: Array) -> FoundSets:
            found = self.values(given, tau)
            sums = np.nansum((found.values[:, 0] - data) ** 2, axis=(1, 2))
            return found._replace(values=np.where(found.status == _BAD, np.nan, sums))

        return misfits

    def tangents(self, given: Array, tau: Array) -> FoundSets:
        """The values, then their derivatives by each parameter, of shape (sets, 1 + parameters, outputs, times), and as
        many estimates: differences, extrapolated, of models with as many modes.

        Where the first step is not good to the tolerance others are taken, and of all the best. What modes left out add
        is twice what as many modes again add, at most: it falls at least as their number rises.
        """
        own, (sets, count) = self._horizon_responses(given, tau), given.shape
        finer = self._horizon_responses(given, tau, more=1) if self._most_doublings else None
        found = no_sets(sets, (1 + count, *own.values.shape[1:]), (1 + count,))
        found.status[:], found.estimate[:, 0], found.values[:, 0] = own.status, own.estimate, own.values
        for parameter, most in enumerate(self._largest_steps(given).T):
            size = np.abs(given[:, parameter])
            step = _STEP * np.where(size > 0, size, 1.0)
            best = self._difference(given, own, parameter, step, tau)
            scale, taken = best.scale.copy(), step.copy()
            for _ in range(_TRIES):
                poor = best.estimate > nearest(self.model.tolerance)
                if not poor.any():
                    break
                step[poor] = np.minimum(step * scale, most)[poor]
                tried = self._difference(given[poor], own.rows(poor), parameter, step[poor], tau)
                scale[poor] = tried.scale
                better = tried.estimate < best.estimate[poor]
                rows = np.flatnonzero(poor)[better]
                best.slopes[rows], best.estimate[rows] = tried.slopes[better], tried.estimate[better]
                taken[rows] = step[rows]
            found.values[:, 1 + parameter] = best.slopes
            found.estimate[:, 1 + parameter] = best.estimate + own.estimate
            if finer is not None:
                change = np.abs(self._difference(given, finer, parameter, taken, tau, more=1).slopes - best.slopes)
                largest = np.abs(best.slopes).max(axis=2, initial=0.0)
                added = 2 * change.max(axis=2, initial=0.0)
                found.estimate[:, 1 + parameter] += _relative_error(added, largest).max(axis=1)
        return found

    def _largest_steps(self, given: Array) -> Array:
        """Those of each parameter: of one that has to be positive, a part of it."""
        return np.stack(
            [
                np.full(len(given), _LARGEST[name]) if name in _LARGEST else np.abs(size) / 16
                for name, size in zip(self._names, given.T, strict=True)
            ],
            axis=1,
        )

    def _difference(
        self, given: Array, own: ModeSetResponses, parameter: int, step: Array, tau: Array, more: int = 0
    ) -> _Slopes:
        """Derivatives by one parameter, by differences of the second order over `step` and twice that, extrapolated.

        The nearer one is wrong by about a third of how far they are apart, and by what turns of fast modes are missed;
        both by what rounding does to values, over the step. A parameter that may not be so much less is changed upwards
        alone.
        """
        rounded, points, values = own.rounding_errors.copy(), {0: given[:, parameter]}, {0: own.values}

        def value_at(times: int) -> None:
            other = given.copy()
            other[:, parameter] += times * step
            found = self._horizon_responses(other, tau, given, more)
            points[times], values[times] = other[:, parameter], found.values
            np.fmax(rounded, found.rounding_errors, out=rounded)

        def central(k: int) -> Array:
            return (values[k] - values[-k]) / (points[k] - points[-k])[:, None, None]

        def upwards(k: int) -> Array:
            return (4 * values[k] - values[2 * k] - 3 * values[0]) / (points[2 * k] - points[0])[:, None, None]

        for times in (1, 2, -1, -2):
            value_at(times)
        near, far, weight = central(1), central(2), np.full(len(given), 1.5)
        refused = np.isnan(values[-2]).all(axis=(1, 2)) & (own.status != _BAD)
        if refused.any():
            value_at(4)
            near[refused], far[refused], weight[refused] = upwards(1)[refused], upwards(2)[refused], 6.0
        slopes = (4 * near - far) / 3
        curved, largest = (np.abs(each).max(axis=2, initial=0.0) for each in (slopes - near, slopes))
        curved += self._missed_turns(given, parameter, step)
        noise = weight[:, None] * rounded / step[:, None]
        wrong = curved + noise
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.nanmax(noise / largest, axis=1) / np.nanmax(2 * curved / largest, axis=1)
        scale = np.nan_to_num(np.cbrt(ratio), nan=1.0, posinf=_MOST_SCALE)
        return _Slopes(
            slopes, _relative_error(wrong, largest).max(axis=1), np.clip(scale, 1 / _MOST_SCALE, _MOST_SCALE)
        )

    def _missed_turns(self, given: Array, parameter: int, step: Array) -> Array:
        """What these differences miss of derivatives by turns of modes, (sets, outputs): in w t half of a change of a
        parameter relative to it, in z w t all of one of a damping ratio z; nothing of loads."""
        name, missed = self._names[parameter], np.zeros((len(given), len(self.model.probes)))
        if name == "load":
            return missed
        unit = np.full(len(given), 0.5) if name == "damping" else np.abs(given[:, parameter])
        c, numbers = self._library(max(self._libraries)), np.ascontiguousarray(given)
        call(c, f"{self.model.name}_missed", numbers, step / unit, len(given), room(c, "model"), missed, result=None)
        return missed / unit[:, None]

    @cached_property
    def _names(self) -> list[str]:
        """The field of each parameter."""
        return [field.name for field in self.fields for _ in field.values]

    def bounds(self, given: Array) -> FoundSets:
        """The bound of each output, of shape (sets, outputs): that of a program of proved modes, and how far values
        are from those of this program at the instants where a load may bend. Infinite where there is none."""
        found = no_sets(len(given), (len(self.model.probes),))
        spacing = nearest(ModeSetsTables(self.parameters).amplitudes.step)
        grid = np.asarray(spacing * np.arange(int(self.tau_max / spacing) + 1), np.float64)
        values = self.values(given, grid)
        found.status[:], found.estimate[:], found.values[:] = values.status, values.estimate, np.nan
        for row in np.flatnonzero(values.status == 0).tolist():
            found.values[row] = np.inf
            with suppress(WavesymError), np.errstate(all="ignore"):
                proved = modes(self.parameters.exact(given[row]), DOUBLE)
                off = np.abs(values.values[row, 0] - proved.scheme.evaluate(grid)).max(axis=1)
                largest = np.array([output.largest for output in proved.outputs])
                bounds = np.array([output.bound for output in proved.outputs])
                found.values[row] = bounds + np.where(off > 0, off / largest, 0.0)
        return found

    def responses(self, given: Array, tau: Array, like: Array | None = None, more: int = 0) -> ModeSetResponses:
        """Those at instants of the horizon in any order: of each set by as many modes as its tolerance needs, or that
        of the set beside it in `like`; their number is doubled `more` times."""
        found, tolerance = self._by_modes(0, given, tau), nearest(self.model.tolerance)
        estimate = found.estimate.copy() if like is None else self._by_modes(0, like, np.empty(0)).estimate
        doublings = np.zeros(len(given), int)
        while (short := (estimate > tolerance) & (doublings < self._most_doublings)).any():
            shortage = np.minimum(estimate[short] / tolerance, _MOST_SHORT)
            doublings[short] += np.ceil(np.log2(shortage) / 2).astype(int)
            doublings = np.minimum(doublings, self._most_doublings)
            for count in np.unique(doublings[short]).tolist():
                rows = short & (doublings == count)
                refined = self._by_modes(count, given[rows], tau)
                found.put(rows, refined)
                estimate[rows] = refined.estimate
                if like is not None:
                    estimate[rows] = self._by_modes(count, like[rows], np.empty(0)).estimate
        if more:
            doublings = np.minimum(doublings + more, self._most_doublings)
            for count in np.unique(doublings).tolist():
                found.put(doublings == count, self._by_modes(count, given[doublings == count], tau))
        return found

    @cached_property
    def _most_doublings(self) -> int:
        """How often the number of modes can be doubled."""
        most = min(_MOST_MODES, self.parameters.like.most)
        return max(ceil(log2(most / self.parameters.fewest)), 0)

    def _horizon_responses(
        self, given: Array, tau: Array, like: Array | None = None, more: int = 0
    ) -> ModeSetResponses:
        """Responses at instants of which some may be outside the horizon, and NaN."""
        inside = (tau >= 0) & (tau <= self.tau_max)
        found = self.responses(given, tau[inside], like, more)
        values = np.full((len(given), len(self.model.probes), len(tau)), np.nan)
        values[:, :, inside] = found.values
        return found._replace(values=values)

    def _by_modes(self, doublings: int, given: Array, tau: Array) -> ModeSetResponses:
        """Those by so many modes."""
        c, order = self._library(doublings), np.argsort(tau, kind="stable")
        sets, outputs = len(given), len(self.model.probes)
        found = ModeSetResponses(
            np.empty(sets, np.int32),
            np.empty(sets),
            np.full((sets, outputs), np.nan),
            np.full((sets, outputs, 4), np.nan),
            np.full((sets, outputs, len(tau)), np.nan),
        )
        memory, numbers = room(c, "model"), np.ascontiguousarray(given)
        call(c, f"{self.model.name}_sets", numbers, sets, memory, tau[order], len(tau), *found, result=None)
        found.status[found.status != _BAD] = 0
        back = np.empty_like(order)
        back[order] = np.arange(len(order))
        return found._replace(values=found.values[:, :, back])

    def _library(self, doublings: int) -> ctypes.CDLL:
        if doublings not in self._libraries:
            names = tuple(field.name for field in self.fields)
            program = ModeSetsTables(self.parameters, doublings=doublings).program(Request(runtime=names))
            files, name = runtime_sets(program, ("peaks",)), self.model.name
            header = f"{name}.h"
            self._libraries[doublings] = library(files[f"{name}.c"], FAST, (header, files[header]))
        return self._libraries[doublings]
