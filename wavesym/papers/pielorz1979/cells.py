"""Tables 2 to 4, cell by cell and head by head: the highest powers of (4.9), (4.10) and (4.12).

A cell is tried among the others of its row or column, which are as they should be, against the degrees of the exact
tables; a power below 0 says that there is no such term, a dash that there is no such part. Heads are tried by what they
cover: every function once, every instant in one interval.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import product
from typing import Any

from flint import fmpq

from wavesym.exact.table import Function
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds, span
from wavesym.papers.exact_tables import Exact, building, collision, drive, gammas
from wavesym.papers.mutations import ends, mutations
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.transcription import entry as record
from wavesym.papers.pielorz1979.transcription import paper
from wavesym.papers.pielorz1979.truth import Driven, Loads, Step, driven, instants
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Example, Nothing, Reading, Test, by_size, faults
from wavesym.papers.tree import Blank, Number, Progression, Relation, Symbol, Tree, latex


@dataclass(frozen=True)
class Kind:
    """What a table is about: its example, and the sizes and intervals that it is tried with."""

    example: str
    tables: Callable[[int], Exact]
    sizes: Sequence[int]
    most_n: int


KINDS: Mapping[str, Kind] = {
    "T2": Kind("I", collision, range(4, 11, 2), 8),
    "T3": Kind("II", drive, range(1, 7), 5),
    "T4": Kind("III", building, range(2, 8), 8),
}
PARTS = {"T2": (1, 2), "T3": (1, 2, 3)}


class Indices(Scope):
    """The letters of a cell: those bound, and r_0, r_1, the parities of i and of i+1 that the text defines."""

    def symbol(self, symbol: Symbol) -> Any:
        match symbol:
            case Symbol("r", below=(Number("0" | "1" as parity),)) if "i" in self.bound:
                return (self.bound["i"] + 1 + int(parity)) % 2
        return super().symbol(symbol)


# the tables as they should be


@cache
def right(id: str) -> Tree:
    """A cell, or the formula of a head, as it should be; KeyError where there is none."""
    entry = record(id)
    return read_formula(entry.slip.corrected if entry.slip else entry.printed)


@cache
def right_ranges(id: str) -> tuple[Tree, ...]:
    """The ranges of a cell or a head as they should be."""
    entry = record(id)
    said = entry.ranges if entry.slip is None or entry.slip.ranges is None else entry.slip.ranges
    return tuple(map(read_range, said))


def value(id: str, **indices: int) -> fmpq | int:
    """The value of a cell as it should be, such as value("T3.even.f.alpha1.K_1", m=4, n=2, i=3, r=1, l=2)."""
    return _known(id, tuple(sorted(indices.items())))


@cache
def _known(id: str, indices: tuple[tuple[str, int], ...]) -> fmpq | int:
    return _plain(Indices(dict(indices)).value(right(id)))


def _plain(value: Any) -> Any:
    """A whole number as one."""
    return int(value.numer()) if isinstance(value, fmpq) and value.denom() == 1 else value
