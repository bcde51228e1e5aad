"""What is kept of cases, as arrays over the dimensions of a sweep; NaN where there is nothing yet, or never."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesym.sweeps.plan import OUTPUT, SAMPLE, SweepPlan

Numbers = NDArray[np.float64]


class KeptArray(NamedTuple):
    """An array of the store: its name, the dimensions that it has beside those of the sweep, and what it is."""

    name: str
    dimensions: tuple[str, ...]
    what: str


_STATISTICS = {
    "min": "least value",
    "max": "greatest value",
    "tau_min": "tau at which it first has its least value",
    "tau_max": "tau at which it first has its greatest value",
    "arrival": "tau at which it first differs from 0",
}


def kept_arrays(plan: SweepPlan) -> list[KeptArray]:
    """The arrays of a sweep."""
    made = [KeptArray(name, (OUTPUT,), _STATISTICS[name]) for name in plan.summary]
    made.append(KeptArray("bound", (), "error of values, relative to each output's largest"))
    if plan.histories:
        made.append(KeptArray("history", (OUTPUT, SAMPLE), "values at equally spaced times, both ends included"))
        made.append(KeptArray("until", (), "tau of the last of these times"))
    if plan.time_unit:
        made.append(KeptArray("time_per_tau", (), f"what one tau is, in {plan.time_unit}"))
    return made


def sizes(plan: SweepPlan) -> dict[str, int]:
    """How long the dimensions are that are not varied."""
    return {OUTPUT: len(plan.outputs), SAMPLE: plan.histories or 0}


@dataclass
class CaseValues:
    """What is kept of one case: arrays by name, over the outputs and samples that they have."""

    arrays: Mapping[str, Numbers | float]
    how: str


@dataclass
class BatchValues:
    """What came of a batch: `arrays` over its part of the dimensions, the reasons of cases that failed by their place
    in the sweep, and how the others were computed."""

    arrays: dict[str, Numbers]
    failed: dict[tuple[int, ...], str] = field(default_factory=dict)
    how: dict[str, int] = field(default_factory=dict)

    @classmethod
    def empty(cls, plan: SweepPlan, region: tuple[slice, ...]) -> BatchValues:
        """Nothing yet."""
        shape, lengths = [part.stop - part.start for part in region], sizes(plan)
        return cls(
            {
                each.name: np.full((*shape, *(lengths[name] for name in each.dimensions)), np.nan)
                for each in kept_arrays(plan)
            }
        )

    def put(self, region: tuple[slice, ...], place: tuple[int, ...], case: CaseValues) -> None:
        """One case at its place."""
        at = tuple(k - part.start for k, part in zip(place, region, strict=True))
        for name, values in case.arrays.items():
            if name in self.arrays:
                self.arrays[name][at] = values
        self.how[case.how] = self.how.get(case.how, 0) + 1

    def join(self, region: tuple[slice, ...], place: tuple[int, ...], other: BatchValues) -> None:
        """The case at a place as another computation of the batch has it."""
        at = tuple(k - part.start for k, part in zip(place, region, strict=True))
        for name, values in other.arrays.items():
            self.arrays[name][at] = values[at]
        self.failed |= other.failed
        for how, count in other.how.items():
            self.how[how] = self.how.get(how, 0) + count
