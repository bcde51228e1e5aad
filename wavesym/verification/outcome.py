"""What a check finds: cells of a table, and whether all is as it may be."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wavesym.verification.reference import Known

FINE = 1e-6
"""Integrations are refined until their own bound is as small as this, as long as that does not take too long."""

MOST_MOVED = 2e8
"""As long as they move no more points than that."""

NO_GRID = "on no grid that is not too fine the same happens at contacts"
"""Why central differences are refused."""


LOOSE = 1e-2
"""An integration that may be more wrong than this part of an output's largest value does not judge it."""


@dataclass(frozen=True)
class IntegratedOutput:
    """An output as an integration has it: `values` at `taus`, none wrong by more than `allowed`.

    Its instants may keep `clear` of fronts.
    """

    taus: Sequence[float]
    values: NDArray[np.float64]
    allowed: float
    clear: bool = False

    @property
    def size(self) -> float:
        """The largest absolute value."""
        return float(np.max(np.abs(self.values), initial=0.0))

    @property
    def steepest(self) -> float:
        """How fast it changes, at most."""
        return float(np.max(np.abs(np.diff(self.values) / np.diff(self.taus)), initial=0.0))

    @property
    def judges(self) -> bool:
        """Whether it is exact enough to judge the output by; what is 0 throughout has to be 0 but for rounding."""
        return len(self.values) > 0 and self.allowed <= LOOSE * (self.size or 1.0)


@dataclass(frozen=True)
class Outcome:
    """What a check found for a subject, an output or another: cells by column, and whether all is as it may be.

    `note` is for what does not fit into a column, `integral` for programs to be compared with.
    """

    subject: str
    cells: Mapping[str, str]
    passed: bool
    note: str = ""
    integral: IntegratedOutput | None = None


@dataclass(frozen=True)
class Check:
    """A check, and what stands over the table of its outcomes."""

    title: str
    run: Callable[[Known], Sequence[Outcome]]
