"""Loads, reduced to unit responses."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import groupby

from flint import fmpq


@dataclass(frozen=True)
class AppliedLoad:
    """`weight` times the unit response to `source` from `time` (in tau) on.

    `source` is that of a `UnitLoad` of the chain, or "impact" (a chain that its own start moves).
    """

    source: str
    time: fmpq
    weight: fmpq

    @property
    def changes(self) -> tuple[AppliedLoad, ...]:
        """What it is made of where its weight is 1."""
        return (AppliedLoad(self.source, self.time, fmpq(1)),)


@dataclass(frozen=True)
class AppliedRecord(AppliedLoad):
    """`weight` times all `samples` together, each a unit response with a weight, in the order of time."""

    samples: tuple[AppliedLoad, ...]

    @property
    def changes(self) -> tuple[AppliedLoad, ...]:
        """What it is made of where its weight is 1."""
        return self.samples


def power_source(ramp: str, power: int) -> str:
    """What the unit load is called that grows with a power of the time, beside a ramp of this name."""
    return f"{ramp}^{power}"


def merge_loads(loads: Iterable[AppliedLoad]) -> tuple[AppliedLoad, ...]:
    """Loads of the same source and time as one, none of weight 0, sorted by time and then by source."""
    # M2 comes before M10: a shorter name is a smaller number; sorted, as an fmpq is slow to hash
    ordered = sorted(loads, key=lambda load: (load.time, len(load.source), load.source))
    summed = (
        replace(first, weight=sum((load.weight for load in others), first.weight)) if others else first
        for _, (first, *others) in groupby(ordered, key=lambda load: (load.time, load.source))
    )
    return tuple(load for load in summed if load.weight)
