"""Modes whose numbers are given when they run: many sets, each a model with modes of its own, in C."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
from math import ceil, log2
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import WavesymError
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.mode_sets.making import ModeSetsTables
from wavesym.programs.mode_sets.parameters import ModeParameters
from wavesym.programs.modes.evaluator import modes
from wavesym.programs.request import Request
from wavesym.running.native import FAST, address, library, struct_size
from wavesym.running.sets import FoundSets, no_sets
from wavesym.running.toolchain import compiler
from wavesym.targets.files import runtime_sets

Array = NDArray[np.float64]

_WHERE, _MANY = ctypes.c_void_p, ctypes.c_size_t
_BAD = 1
_MOST_MODES = 600  # of a set that needs more than the scene's own numbers
_MOST_SHORT = 64.0  # times the tolerance: more modes are not taken at once than that needs
_STEP = 2.0**-14  # of a parameter, over which differences are taken


class ModeSetResponses(NamedTuple):
    """Of each set its status, 1 where it is refused, its estimate, extremes (sets, outputs, 4): the least value, its
    tau, the greatest value, its tau; and histories (sets, outputs, instants): NaN of those that are refused."""

    status: NDArray[np.int32]
    estimate: Array
    peaks: Array
    values: Array


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

        A parameter that is 0, and may not be less, is changed upwards alone.
        """
        own, (sets, count) = self.values(given, tau), given.shape
        found = no_sets(sets, (1 + count, *own.values.shape[2:]), (1 + count,))
        found.status[:], found.estimate[:, 0], found.values[:, 0] = own.status, own.estimate, own.values[:, 0]
        for parameter in range(count):
            size = np.abs(given[:, parameter])
            by = _STEP * np.where(size > 0, size, 1.0)
            near, far = (self._difference(given, own, parameter, times * by, tau) for times in (1, 2))
            slopes = (4 * near - far) / 3
            wrong, largest = (np.abs(each).max(axis=2, initial=0.0) for each in (slopes - near, slopes))
            relative = np.divide(wrong, largest, out=np.zeros_like(wrong), where=largest > 0)
            found.values[:, 1 + parameter] = slopes
            found.estimate[:, 1 + parameter] = relative.max(axis=1) + own.estimate
        return found

    def _difference(self, given: Array, own: FoundSets, parameter: int, by: Array, tau: Array) -> Array:
        """Derivatives by one parameter to the second order of its change."""

        def values_after(times: float) -> Array:
            other = given.copy()
            other[:, parameter] += times * by
            return self._horizon_responses(other, tau, given).values

        up, down, width = values_after(1), values_after(-1), 2 * by[:, None, None]
        made: Array = (up - down) / width
        refused = np.isnan(down).all(axis=(1, 2)) & (own.status != _BAD)
        if refused.any():
            made[refused] = ((4 * up - values_after(2) - 3 * own.values[:, 0]) / width)[refused]
        return made

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

    def responses(self, given: Array, tau: Array, like: Array | None = None) -> ModeSetResponses:
        """Those at instants of the horizon in any order: of each set by as many modes as its tolerance needs, or that
        of the set beside it in `like`."""
        found, tolerance = self._by_modes(0, given, tau), nearest(self.model.tolerance)
        estimate = found.estimate.copy() if like is None else self._by_modes(0, like, np.empty(0)).estimate
        doublings = np.zeros(len(given), int)
        while (short := (estimate > tolerance) & (doublings < self._most_doublings)).any():
            shortage = np.minimum(estimate[short] / tolerance, _MOST_SHORT)
            doublings[short] += np.ceil(np.log2(shortage) / 2).astype(int)
            doublings = np.minimum(doublings, self._most_doublings)
            for count in np.unique(doublings[short]).tolist():
                rows = short & (doublings == count)
                more = self._by_modes(count, given[rows], tau)
                found.status[rows], found.estimate[rows], found.peaks[rows], found.values[rows] = more
                estimate[rows] = more.estimate
                if like is not None:
                    estimate[rows] = self._by_modes(count, like[rows], np.empty(0)).estimate
        return found

    @cached_property
    def _most_doublings(self) -> int:
        """How often the number of modes can be doubled."""
        most = min(_MOST_MODES, self.parameters.like.most)
        return max(ceil(log2(most / self.parameters.fewest)), 0)

    def _horizon_responses(self, given: Array, tau: Array, like: Array | None = None) -> ModeSetResponses:
        """Responses at instants of which some may be outside the horizon, and NaN."""
        inside = (tau >= 0) & (tau <= self.tau_max)
        found = self.responses(given, tau[inside], like)
        values = np.full((len(given), len(self.model.probes), len(tau)), np.nan)
        values[:, :, inside] = found.values
        return found._replace(values=values)

    def _by_modes(self, doublings: int, given: Array, tau: Array) -> ModeSetResponses:
        """Those by so many modes."""
        run = getattr(self._library(doublings), f"{self.model.name}_sets")
        run.argtypes = [_WHERE, _MANY, _WHERE, _WHERE, _MANY, _WHERE, _WHERE, _WHERE, _WHERE]
        room = np.empty(struct_size(self._library(doublings), "model") + 64, np.uint8)
        room = room[-room.ctypes.data % 64 :]
        order = np.argsort(tau, kind="stable")
        numbers, instants = np.ascontiguousarray(given), np.ascontiguousarray(tau[order])
        sets, outputs = len(given), len(self.model.probes)
        found = ModeSetResponses(
            np.empty(sets, np.int32),
            np.empty(sets),
            np.full((sets, outputs, 4), np.nan),
            np.full((sets, outputs, len(tau)), np.nan),
        )
        rows = [address(each) for each in (found.status, found.estimate, found.peaks, found.values)]
        run(address(numbers), sets, address(room), address(instants), len(tau), *rows)
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
