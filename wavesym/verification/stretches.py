"""Stretches of time in each of which values have to be compared: between events, changes of loads, and tenths."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from wavesym.numbers.arrays import Array

Stretch = tuple[float, float]

PARTS = 400
"""Stretches are looked into that are longer than all of the time over that: shorter ones are hardly resolved."""

_TENTHS = 10


def stretches(until: float, times: Iterable[float]) -> list[Stretch]:
    """Those of [0, until] between `times`, and between tenths of it, without those that are too short."""
    inside = {time for time in times if 0 < time < until}
    cuts = sorted({0.0, until, *inside, *(until * k / _TENTHS for k in range(1, _TENTHS))})
    return [(begin, end) for begin, end in pairwise(cuts) if end - begin > until / PARTS]


def unseen_stretches(parts: Sequence[Stretch], taus: Array) -> list[Stretch]:
    """Those inside which none of ascending instants lies."""
    return [(begin, end) for begin, end in parts if not len(_numbers_in(begin, end, taus))]


def middles(parts: Sequence[Stretch], taus: Array) -> Array:
    """Of ascending instants the numbers of those in the middle of the ones in each stretch."""
    found = [here[len(here) // 2] for begin, end in parts if len(here := _numbers_in(begin, end, taus))]
    return np.array(found, dtype=int)


def _numbers_in(begin: float, end: float, taus: Array) -> range:
    return range(int(np.searchsorted(taus, begin, "right")), int(np.searchsorted(taus, end, "left")))
