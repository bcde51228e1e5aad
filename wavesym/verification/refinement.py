"""What solutions with N, 2N and 4N steps say of their own error, and what the truth says of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Solutions:
    """An output with N, 2N and 4N steps, its true values at the same instants, and what rounding may have added.

    `scale` is what errors are relative to. Without a `truth` they are differences from the best solution.
    """

    values: tuple[Array, Array, Array]
    truth: Array | None
    rounding: float
    scale: float

    def _largest(self, difference: Array) -> float:
        return float(np.max(np.abs(difference))) / self.scale

    def plain(self) -> Refinement:
        """The last solution. Where errors fall at least as the step does, theirs is less than the last difference."""
        _, half, quarter = self.values
        return self._refinement(quarter, self._largest(quarter - half))

    def extrapolated(self) -> Refinement:
        """The last two, of a method whose error is a series in the step's square; the same holds for what is left."""
        coarse, half, quarter = self.values
        first, last = half + (half - coarse) / 3, quarter + (quarter - half) / 3
        return self._refinement(last, self._largest(last - first))

    def wandering(self) -> Refinement:
        """The last solution, where errors do not fall evenly, but in two halvings by a half: both differences count."""
        coarse, half, quarter = self.values
        return self._refinement(quarter, self._largest(quarter - half) + self._largest(half - coarse))

    def _refinement(self, best: Array, between: float) -> Refinement:
        truth = best if self.truth is None else self.truth
        coarse, half, quarter = (self._largest(values - truth) for values in self.values)
        rounding = self.rounding / self.scale
        return Refinement((coarse, half, quarter), self._largest(best - truth), between, rounding, best)


@dataclass(frozen=True)
class Refinement:
    """Errors at N, 2N and 4N, that of what is best, and what it may be: what lies `between` solutions, and rounding.

    `values` are those of what is best.
    """

    errors: tuple[float, float, float]
    best: float
    between: float
    rounding: float
    values: Array

    @property
    def allowed(self) -> float:
        """What the best error may be."""
        return self.between + self.rounding

    @property
    def right(self) -> bool:
        """Whether it is; never where something is NaN."""
        return self.best <= self.allowed

    def cells(self, steps: int) -> Mapping[str, str]:
        """The columns of a table, N = `steps`; the order is observed where errors are more than rounding."""
        seen = [error for error in self.errors if error > self.rounding]
        order = f"{math.log2(seen[-2] / seen[-1]):.1f}" if len(seen) > 1 else "-"
        cells = dict(zip(("at N", "at 2N", "at 4N"), map(shown, self.errors), strict=True))
        best = {} if self.best == self.errors[-1] else {"extrapolated": shown(self.best)}
        return {"N": str(steps), **cells, "order": order, **best, "allowed": shown(self.allowed)}


def shown(error: float) -> str:
    """An error as a cell of a table."""
    return f"{error:.1e}" if error else "0"
