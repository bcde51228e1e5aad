"""What is kept of cases, as arrays over the dimensions of a sweep; NaN where there is nothing yet, or never."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.results.statistics import ARRAYS, LINK_ARRAYS
from wavesym.sweeps.batches import Place
from wavesym.sweeps.plan import LINK, OUTPUT, SAMPLE, SweepPlan


class KeptArray(NamedTuple):
    """An array of the store: its name, its dimensions beside those of the sweep, what it is, and its unit."""

    name: str
    dimensions: tuple[str, ...]
    what: str
    unit: str = ""


def kept_arrays(plan: SweepPlan) -> list[KeptArray]:
    """The arrays of a sweep."""
    made = [KeptArray(name, (OUTPUT,), ARRAYS[name]) for name in plan.summary if name in ARRAYS]
    made += [
        KeptArray(name, (LINK,), LINK_ARRAYS[name], plan.link_unit) for name in plan.summary if name in LINK_ARRAYS
    ]
    made.append(KeptArray("bound", (), "error of values, relative to each output's largest"))
    if plan.histories:
        made.append(KeptArray("history", (OUTPUT, SAMPLE), "values at equally spaced times, both ends included"))
        made.append(KeptArray("until", (), "tau of the last of these times"))
    if plan.time_unit:
        made.append(KeptArray("time_per_tau", (), f"what one tau is, in {plan.time_unit}"))
    return made


def sizes(plan: SweepPlan) -> dict[str, int]:
    """How long the dimensions are that are not varied."""
    return {OUTPUT: len(plan.outputs), SAMPLE: plan.histories or 0, LINK: len(plan.links)}


@dataclass
class CaseValues:
    """What is kept of one case: arrays by name, over the outputs and samples that they have."""

    arrays: Mapping[str, Array | float]
    how: str


@dataclass
class BatchValues:
    """What came of some cases of a batch: `arrays` over the `places` of these in the sweep, in their order, the reasons
    of cases that failed, by place, and how the others were computed."""

    places: list[Place]
    arrays: dict[str, Array]
    failed: dict[Place, str] = field(default_factory=dict)
    how: dict[str, int] = field(default_factory=dict)

    @classmethod
    def empty(cls, plan: SweepPlan, places: list[Place]) -> BatchValues:
        """Nothing yet."""
        lengths = sizes(plan)
        shapes = {each.name: [lengths[name] for name in each.dimensions] for each in kept_arrays(plan)}
        return cls(places, {name: np.full((len(places), *shape), np.nan) for name, shape in shapes.items()})

    def put(self, row: int, case: CaseValues) -> None:
        """One case, of the place with this number."""
        for name, values in case.arrays.items():
            if name in self.arrays:
                self.arrays[name][row] = values
        self.how[case.how] = self.how.get(case.how, 0) + 1

    def join(self, other: BatchValues) -> None:
        """Some of these cases as another computation has them."""
        row = {place: k for k, place in enumerate(self.places)}
        rows = [row[place] for place in other.places]
        for name, values in other.arrays.items():
            self.arrays[name][rows] = values
        self.failed = {place: reason for place, reason in self.failed.items() if place not in set(other.places)}
        self.failed |= other.failed
        for how, count in other.how.items():
            self.how[how] = self.how.get(how, 0) + count
