"""Values, derivatives and peaks of many sets in NumPy, a part of them at a time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wavesym.errors import UnservedError
from wavesym.programs.program import Program
from wavesym.programs.runtime.arrays.march import ArrayMarch
from wavesym.programs.runtime.arrays.peaks import array_peaks
from wavesym.programs.runtime.arrays.tables import ArrayTables
from wavesym.programs.runtime.arrays.values import array_values
from wavesym.programs.runtime.engine import Array, FoundSets, no_sets

_SERIES = 1 << 27  # bytes of series at a time


class ArraySets:
    """An `Engine` that needs no compiler."""

    def __init__(self, program: Program) -> None:
        self._tables = ArrayTables(program)

    def values(self, given: Array, tau: Array) -> FoundSets:
        """See `Engine`."""
        shape = (1, self._tables.outputs, len(tau))
        return self._some(given, shape, lambda march: array_values(self._tables, march, tau))

    def tangents(self, given: Array, tau: Array) -> FoundSets:
        """See `Engine`."""
        shape = (1 + given.shape[1], self._tables.outputs, len(tau))
        return self._some(given, shape, lambda march: array_values(self._tables, march, tau), lanes=True)

    def misfit(self, tau: Array, data: Array) -> Callable[[Array], FoundSets]:
        """See `Engine`."""

        def misfits(march: ArrayMarch) -> Array:
            sums = np.nansum((array_values(self._tables, march, tau)[:, 0] - data) ** 2, axis=(1, 2))
            return np.where(march.status == 0, sums, np.nan)

        return lambda given: self._some(given, (), misfits)

    def bounds(self, given: Array) -> FoundSets:
        """See `Engine`."""
        raise UnservedError(f"bounds: {len(given)} sets given without a C compiler, one is expected")

    def peaks(self, given: Array) -> FoundSets:
        """See `Engine`."""
        return self._some(given, (self._tables.outputs, 4), lambda march: array_peaks(self._tables, march))

    def _some(
        self, given: Array, shape: tuple[int, ...], read: Callable[[ArrayMarch], Array], *, lanes: bool = False
    ) -> FoundSets:
        estimates = (1 + given.shape[1],) if lanes else ()
        found = no_sets(len(given), shape, estimates)
        sizes = self._tables.sizes
        of_set = 8 * sizes["windows"] * sizes["strands"] * (sizes["degree"] + 2) * (1 + lanes * given.shape[1])
        step = max(1, _SERIES // of_set)
        for begin in range(0, len(given), step):
            here = slice(begin, begin + step)
            march = ArrayMarch(self._tables, given[here], lanes=lanes)
            found.status[here], found.estimate[here] = march.status, march.estimate.T if lanes else march.estimate[0]
            found.values[here] = read(march)
        return found
