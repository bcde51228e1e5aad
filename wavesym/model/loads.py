"""Loads, reduced to unit responses."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from flint import fmpq


@dataclass(frozen=True)
class Applied:
    """`weight` times the unit response to `source` from `time` (in tau) on.

    `source` is that of a `UnitLoad` of the chain, or "impact" (a chain that its own start moves).
    """

    source: str
    time: fmpq
    weight: fmpq


def merged(loads: Iterable[Applied]) -> tuple[Applied, ...]:
    """Loads of the same source and time as one, none of weight 0, sorted by time and then by source."""
    weights: dict[tuple[str, fmpq], fmpq] = {}
    for load in loads:
        at = load.source, load.time
        weights[at] = weights.get(at, fmpq(0)) + load.weight
    # M2 comes before M10: a shorter name is a smaller number
    ordered = sorted(weights, key=lambda at: (at[1], len(at[0]), at[0]))
    return tuple(Applied(*at, weights[at]) for at in ordered if weights[at])
