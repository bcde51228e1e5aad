"""Which cases are computed together. A batch is one unit of work, and one chunk of every array of the store."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import ceil, prod

import numpy as np

from wavesym.sweeps.plan import SweepPlan

_MOST_BATCHES = 5000  # where each case is computed by itself: so many files of every array at most
_GROUP = 64  # cases that share work: with more of them one that is wanted alone would take long
_RECORDS = 16 * _GROUP  # in a batch: with their values at all samples some hundred MB
_SETS, _PARTS = 32 * _GROUP, 8  # of parameters in a batch: enough of them, and of batches for all workers
_NUMBERS = 1 << 23  # of histories in a batch

Place = tuple[int, ...]
"""The index of a case in each dimension."""
Task = tuple[int, list[Place] | None]
"""A batch, and which places of it; None for all."""


@dataclass(frozen=True)
class Batches:
    """The cases of a sweep as batches, numbered from 0: blocks of `chunk` cases in each dimension.

    `kind` is how they are computed: "recorded", "parameters", "structures" or "single". `is_joined` says of each
    dimension whether the cases of a batch may differ in it.
    """

    kind: str
    shape: tuple[int, ...]
    chunk: tuple[int, ...]
    is_joined: tuple[bool, ...] = ()

    @property
    def grid(self) -> tuple[int, ...]:
        """How many there are in each dimension."""
        return tuple(ceil(n / size) for n, size in zip(self.shape, self.chunk, strict=True))

    def __len__(self) -> int:
        return prod(self.grid)

    def place(self, batch: int) -> Place:
        """Its place in the grid."""
        return tuple(int(k) for k in np.unravel_index(batch, self.grid))

    def region(self, batch: int) -> tuple[slice, ...]:
        """Its cases, in each dimension."""
        ends = zip(self.place(batch), self.chunk, self.shape, strict=True)
        return tuple(slice(k * size, min((k + 1) * size, n)) for k, size, n in ends)

    def count(self, batch: int) -> int:
        """How many cases are in it."""
        return prod(part.stop - part.start for part in self.region(batch))

    def places(self, batch: int) -> list[Place]:
        """The indices of its cases, in order."""
        return list(product(*(range(part.start, part.stop) for part in self.region(batch))))

    def holds(self, batch: int, case: int) -> bool:
        """Whether a case, by its number in the sweep, is in it."""
        if not 0 <= case < prod(self.shape):
            return False
        place = np.unravel_index(case, self.shape)
        return all(part.start <= k < part.stop for k, part in zip(place, self.region(batch), strict=True))

    def groups(self, batch: int) -> Iterator[list[Place]]:
        """Its cases as they share work. Those of a group depend on each other to the last bits, and on no others."""
        places = self.places(batch)
        return (places[first : first + _GROUP] for first in range(0, len(places), _GROUP))

    def cut(self, batch: int, places: list[Place], count: int) -> list[list[Place]]:
        """Some of its cases in about so many parts: of whole groups where these share work, if there are several."""
        size = ceil(len(places) / count)
        wanted = set(places)
        groups = [some for group in self.groups(batch) if (some := [place for place in group if place in wanted])]
        if self.kind == "single" or len(groups) == 1:
            return [places[first : first + size] for first in range(0, len(places), size)]
        parts = [groups[0]]
        for group in groups[1:]:
            if len(parts[-1]) + len(group) > size:
                parts.append(group)
            else:
                parts[-1] = [*parts[-1], *group]
        return parts

    def touching(self, part: tuple[slice, ...]) -> Iterator[int]:
        """The batches with cases in a part of the dimensions."""
        ends = zip(part, self.chunk, strict=True)
        for place in product(*(range(each.start // size, -(-each.stop // size)) for each, size in ends)):
            yield int(np.ravel_multi_index(place, self.grid))

    def mark(self, sweep: str, batch: int) -> str:
        """A name for what becomes of a batch: a hash of all that goes into it, that of the `sweep` among it."""
        return hashlib.sha256(f"{sweep} {self.kind} {self.chunk} {batch}".encode()).hexdigest()


def batches(plan: SweepPlan, kind: str, together: tuple[bool, ...] = ()) -> Batches:
    """The batches of a sweep; `together` says of each dimension whether its cases can be parts of one batch."""
    fit = max(1, _NUMBERS // (len(plan.outputs) * (plan.histories or 1)))
    if kind == "recorded":
        return Batches(kind, plan.shape, (*(1 for _ in plan.shape[:-1]), min(plan.shape[-1], _RECORDS, fit)))
    if kind in ("parameters", "structures"):
        most = max(_GROUP, min(_SETS, plan.cases // _PARTS // _GROUP * _GROUP))
        return Batches(kind, plan.shape, _blocks(plan.shape, together, min(most, fit)), together)
    return Batches(kind, plan.shape, _blocks(plan.shape, (True,) * len(plan.shape), ceil(plan.cases / _MOST_BATCHES)))


def _blocks(shape: tuple[int, ...], together: tuple[bool, ...], most: int) -> tuple[int, ...]:
    """The last dimensions whole, as far as `most` cases go, and a part of the one before."""
    chunk = []
    for n, joined in reversed(list(zip(shape, together, strict=True))):
        size = min(n, most) if joined else 1
        chunk.append(size)
        most = max(most // size, 1) if size == n or not joined else 1
    return tuple(reversed(chunk))
