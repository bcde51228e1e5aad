"""Modes whose numbers are given when they run: many sets, each a model with modes of its own, in NumPy."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from math import ceil

import numpy as np
from flint import fmpq

from wavesym.errors import CostError, UnservedError, WavesymError
from wavesym.mechanics.loads import AppliedLoad, AppliedRecord
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.mode_sets.modes import ModesOfSet
from wavesym.programs.mode_sets.parameters import ModeParameters
from wavesym.programs.modes.evaluator import modes
from wavesym.programs.modes.loads import Roughness, linear_loads, sampled_roughness
from wavesym.results.many_records import ManyRecords, RecordedExtremes, SharedModes
from wavesym.running.sets import Array, FoundSets, no_sets

_TOGETHER = 64  # sets whose modes are found at once: what a cache holds
_MOST_SAMPLES = 1 << 20
_BAD = 1


class ModalSets:
    """Sets of numbers of a model with modes. `given` has a row for each set, with all fields side by side.

    ToleranceError where modes do not serve the model's own numbers to its tolerance.
    """

    def __init__(self, parameters: ModeParameters) -> None:
        self._parameters = parameters
        parameters.like.refuse()
        _ = parameters.fewest
        self.model, self.fields = parameters.model, parameters.fields
        self.tau_max = parameters.model.horizon()

    def values(self, given: Array, tau: Array) -> FoundSets:
        """Of shape (sets, 1, outputs, times)."""
        found = no_sets(len(given), (1, len(self.model.probes), len(tau)))
        inside = (tau >= 0) & (tau <= self.tau_max)
        found.values[:] = np.nan
        for row, each in self._fill(given, found, tau[inside]):
            found.values[row, 0, :, inside] = each.histories[0].T
        return found

    def peaks(self, given: Array) -> FoundSets:
        """Of shape (sets, outputs, 4): the least value, its tau, the greatest value, its tau."""
        found = no_sets(len(given), (len(self.model.probes), 4))
        found.values[:] = np.nan
        for row, each in self._fill(given, found, np.empty(0)):
            if np.isfinite(each.bounds[0]):  # else nothing is known
                found.values[row, :, ::2], found.values[row, :, 1::2] = each.values[0], each.taus[0]
        return found

    def misfit(self, tau: Array, data: Array) -> Callable[[Array], FoundSets]:
        """What makes of `given` the sums of the squares of all misfits, of shape (sets,). `data` of shape
        (outputs, times) is NaN where there is none.
        """

        def misfits(given: Array) -> FoundSets:
            found = self.values(given, tau)
            return found._replace(values=np.nansum((found.values[:, 0] - data) ** 2, axis=(1, 2)))

        return misfits

    def tangents(self, given: Array, tau: Array) -> FoundSets:
        raise UnservedError(
            f"gradients: by {' and '.join(field.name for field in self.fields)}, for which modes have none; take "
            "differences of `run`"
        )

    def bounds(self, given: Array) -> FoundSets:
        """The bound of each output, of shape (sets, outputs): that of a program of proved modes, and how far values
        are from those of this program at the instants where a load may bend. Infinite where there is none."""
        found = no_sets(len(given), (len(self.model.probes),))
        grid = np.asarray(self._spacing * np.arange(int(self.tau_max / self._spacing) + 1), np.float64)
        values = self.values(given, grid)
        found.status[:], found.estimate[:], found.values[:] = values.status, values.estimate, np.nan
        for row in np.flatnonzero(values.status == 0).tolist():
            found.values[row] = np.inf
            with suppress(WavesymError), np.errstate(all="ignore"):
                proved = modes(self._parameters.exact(given[row]), DOUBLE)
                off = np.abs(values.values[row, 0] - proved.scheme.evaluate(grid)).max(axis=1)
                largest = np.array([output.largest for output in proved.outputs])
                bounds = np.array([output.bound for output in proved.outputs])
                found.values[row] = bounds + np.where(off > 0, off / largest, 0.0)
        return found

    def _fill(self, given: Array, found: FoundSets, tau: Array) -> Iterator[tuple[int, RecordedExtremes]]:
        """The responses, once status and estimate of all sets are known but for those to come."""
        found.status[:], found.estimate[:] = np.where(self._parameters.refused(given), _BAD, 0), np.nan
        for row, each in self.responses(given, tau):
            found.estimate[row] = each.bounds[0]
            yield row, each

    def responses(self, given: Array, tau: Array) -> Iterator[tuple[int, RecordedExtremes]]:
        """Extremes of the sets whose numbers are good, by their rows, and histories at `tau`."""
        (rows,) = np.nonzero(~self._parameters.refused(given))
        for first in range(0, len(rows), _TOGETHER):
            some = rows[first : first + _TOGETHER]
            sets, damping = self._parameters.mode_sets(given[some]), self._parameters.damping(given[some])
            factors = self._parameters.factors(given[some])
            for number, row in enumerate(some.tolist()):
                chain = ModesOfSet(replace(self.model, damping=damping[number]), sets, number)
                shared = SharedModes(chain, self._spacing)
                own = None if factors is None else factors[number]
                yield row, shared.extremes(self._records(own), tau.tolist())

    @cached_property
    def _loads(self) -> tuple[Array, tuple[int, ...], tuple[Roughness, ...]]:
        """Of each amplitude its samples, (n, amplitudes), which load it is of, and its roughness."""
        like = self._parameters.like
        count = ceil(self.tau_max / self._spacing) + 2
        if count > _MOST_SAMPLES:
            raise CostError(
                f"load: {count} samples, {self._spacing:g} apart in tau, the limit is {_MOST_SAMPLES} (times with a "
                "larger common measure, or a shorter horizon, help)"
            )
        every: Sequence[AppliedLoad] = self._parameters.amplitudes or [
            AppliedRecord(pair[1] or pair[0], fmpq(0), fmpq(1), tuple(x for x in self.model.loads if x.source in pair))
            for pair in like.sources
        ]
        samples, loads = np.zeros((count, len(every))), []
        for column, amplitude in zip(samples.T, every, strict=True):
            acting = linear_loads(amplitude.changes, like.sources, like.model.until, like.model.describe_step)
            loads.append(next(j for j, pair in enumerate(like.sources) if amplitude.source in pair))
            column[:] = acting.sampled(self._step, count)[:, loads[-1]]
        return samples, tuple(loads), tuple(map(sampled_roughness, samples.T))

    @property
    def _step(self) -> fmpq:
        return self._parameters.like.loads.spacing(self.model.until, self.model.spacing)

    @cached_property
    def _spacing(self) -> float:
        return nearest(self._step)

    def _records(self, own: Array | None) -> ManyRecords:
        """The loads, each amplitude multiplied by its factor, as one record."""
        samples, loads, rough = self._loads
        factors = np.ones(len(loads)) if own is None else own
        count = len(self._parameters.like.sources)
        made = np.zeros((len(samples), count))
        for column, load, factor in zip(samples.T, loads, factors, strict=True):
            made[:, load] += factor * column
        if len(set(loads)) == len(loads) == count:  # each is one load
            order = np.argsort(loads)
            return ManyRecords(made[None], 0.0, self._spacing, [[rough[k] for k in order]], factors[None, order])
        summed = [sampled_roughness(column) for column in made.T]
        return ManyRecords(made[None], 0.0, self._spacing, [summed], np.ones((1, count)))
