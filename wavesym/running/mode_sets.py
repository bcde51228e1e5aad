"""Modes whose numbers are given when they run: many sets, each a model with modes of its own, in NumPy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cached_property

import numpy as np

from wavesym.errors import UnservedError, WavesymError
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.mode_sets.loads import SampledAmplitudes, sampled_amplitudes
from wavesym.programs.mode_sets.modes import ModesOfSet
from wavesym.programs.mode_sets.parameters import ModeParameters
from wavesym.programs.modes.evaluator import modes
from wavesym.programs.modes.loads import sampled_roughness
from wavesym.results.many_records import ManyRecords, RecordedExtremes, SharedModes
from wavesym.results.near_zero import zero_within
from wavesym.running.compiled_modes import CompiledModeSets, ModeSetResponses
from wavesym.running.sets import Array, FoundSets, no_sets

_TOGETHER = 64  # sets whose modes are found at once: what a cache holds
_WORTH_COMPILING = 256  # sets: so many take as long in NumPy as a compiler does
_BAD = 1


class ModalSets:
    """Sets of numbers of a model with modes. `given` has a row for each set, with all fields side by side.

    ToleranceError where modes do not serve the model's own numbers to its tolerance.
    """

    def __init__(self, parameters: ModeParameters, expected: int = 0) -> None:
        """`expected` is how many sets there will be in all, where that is known."""
        self._parameters, self._expected = parameters, expected
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
        """Extremes of the sets whose numbers are good, by their rows, and histories at `tau`.

        Many sets are computed in C where there is a compiler; those that need more modes than others are not.
        """
        (rows,) = np.nonzero(~self._parameters.refused(given))
        if max(len(rows), self._expected) >= _WORTH_COMPILING and CompiledModeSets.is_possible():
            tolerance, left = nearest(self.model.tolerance), []
            for first in range(0, len(rows), _TOGETHER):
                some = rows[first : first + _TOGETHER]
                found = self._compiled.responses(given[some], tau)
                enough = found.estimate <= tolerance
                left.append(some[~enough])
                for number in np.flatnonzero(enough).tolist():
                    yield int(some[number]), _extremes(found, number, self._parameters.fewest)
            rows = np.concatenate(left)
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
    def _compiled(self) -> CompiledModeSets:
        return CompiledModeSets(self._parameters)

    @cached_property
    def _amplitudes(self) -> SampledAmplitudes:
        return sampled_amplitudes(self._parameters)

    @property
    def _spacing(self) -> float:
        return nearest(self._amplitudes.step)

    def _records(self, own: Array | None) -> ManyRecords:
        """The loads, each amplitude multiplied by its factor, as one record."""
        known = self._amplitudes
        samples, loads, rough = known.samples, known.loads, known.rough
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


def _extremes(found: ModeSetResponses, number: int, modes: int) -> RecordedExtremes:
    """Those of one set."""
    rows, bounds = found.peaks[number : number + 1], found.estimate[number : number + 1]
    values, taus = rows[:, :, ::2].copy(), rows[:, :, 1::2].copy()
    zero_within(values, taus, bounds[:, None, None], 0.0)  # all are at rest at first
    return RecordedExtremes(values, taus, bounds, modes, found.values[number : number + 1])
