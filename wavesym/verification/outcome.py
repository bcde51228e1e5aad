"""What a check finds: cells of a table, and whether all is as it may be."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from wavesym.verification.reference import Known

FINE = 1e-6
"""Integrations are refined until their own bound is as small as this, as long as that does not take too long."""

MOST_MOVED = 2e8
"""As long as they move no more points than that."""

NO_GRID = "on no grid that is not too fine the same happens at contacts"
"""Why central differences are refused."""


@dataclass(frozen=True)
class Outcome:
    """What a check found for a subject, an output or another: cells by column, and whether all is as it may be.

    `note` is for what does not fit into a column.
    """

    subject: str
    cells: Mapping[str, str]
    passed: bool
    note: str = ""


@dataclass(frozen=True)
class Check:
    """A check, and what stands over the table of its outcomes."""

    title: str
    run: Callable[[Known], Sequence[Outcome]]
