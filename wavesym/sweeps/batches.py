"""Which cases are computed together. A batch is one unit of work, and one chunk of every array of the store."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from itertools import product
from math import ceil, prod

import numpy as np

from wavesym.sweeps.plan import SweepPlan

_MOST_BATCHES = 5000  # where each case is computed by itself: so many files of every array at most
_RECORDS = 1000  # at once: with their values at all samples some hundred MB
_SETS, _FEWEST_SETS, _PARTS = 2048, 64, 8  # of parameters at once: enough of them, and of batches for all workers
_NUMBERS = 1 << 23  # of histories in a batch


@dataclass(frozen=True)
class Batches:
    """The cases of a sweep as batches, numbered from 0: blocks of `chunk` cases in each dimension.

    `kind` is how they are computed: "recorded", "parameters" or "single". `together` says of each dimension whether
    the cases of a batch may differ in it.
    """

    kind: str
    shape: tuple[int, ...]
    chunk: tuple[int, ...]
    together: tuple[bool, ...] = ()

    @property
    def grid(self) -> tuple[int, ...]:
        """How many there are in each dimension."""
        return tuple(ceil(n / size) for n, size in zip(self.shape, self.chunk, strict=True))

    def __len__(self) -> int:
        return prod(self.grid)

    def at(self, batch: int) -> tuple[int, ...]:
        """Its place in the grid."""
        return tuple(int(k) for k in np.unravel_index(batch, self.grid))

    def region(self, batch: int) -> tuple[slice, ...]:
        """Its cases, in each dimension."""
        ends = zip(self.at(batch), self.chunk, self.shape, strict=True)
        return tuple(slice(k * size, min((k + 1) * size, n)) for k, size, n in ends)

    def places(self, batch: int) -> list[tuple[int, ...]]:
        """The indices of its cases, in order."""
        return list(product(*(range(part.start, part.stop) for part in self.region(batch))))

    def mark(self, plan: SweepPlan, batch: int) -> str:
        """A name for what becomes of a batch: a hash of all that goes into it."""
        return hashlib.sha256(f"{plan.sha256} {self.kind} {self.chunk} {batch}".encode()).hexdigest()


def batches(plan: SweepPlan, kind: str, together: tuple[bool, ...] = ()) -> Batches:
    """The batches of a sweep; `together` says of each dimension whether its cases can be parts of one batch."""
    fit = max(1, _NUMBERS // (len(plan.outputs) * (plan.histories or 1)))
    if kind == "recorded":
        return Batches(kind, plan.shape, (*(1 for _ in plan.shape[:-1]), min(plan.shape[-1], _RECORDS, fit)))
    if kind == "parameters":
        most = min(max(_FEWEST_SETS, min(_SETS, plan.cases // _PARTS)), fit)
        return Batches(kind, plan.shape, _blocks(plan.shape, together, most), together)
    return Batches(kind, plan.shape, _blocks(plan.shape, (True,) * len(plan.shape), ceil(plan.cases / _MOST_BATCHES)))


def _blocks(shape: tuple[int, ...], together: tuple[bool, ...], most: int) -> tuple[int, ...]:
    """The last dimensions whole, as far as `most` cases go, and a part of the one before."""
    chunk = []
    for n, joined in reversed(list(zip(shape, together, strict=True))):
        size = min(n, most) if joined else 1
        chunk.append(size)
        most = max(most // size, 1) if size == n or not joined else 1
    return tuple(reversed(chunk))
