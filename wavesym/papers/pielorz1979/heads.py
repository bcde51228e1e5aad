"""The heads of Tables 2 to 4: the functions, sizes and intervals that their cells are for.

Heads are tried by what they cover: every function once, every instant in one interval.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial
from itertools import product
from typing import Any

from flint import fmpq

from wavesym.exact.table import Function
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import holds
from wavesym.papers.exact_tables import Exact
from wavesym.papers.pielorz1979.cells import KINDS, Indices, listed, numbers, right, right_ranges, value
from wavesym.papers.pielorz1979.transcript import entries
from wavesym.papers.pielorz1979.truth import Driven, Step, instants
from wavesym.papers.record import Case, Reading, Test


def interval_or_size(entry: Entry) -> Test:
    """A range in the head of a table: instants z and numbers n, or sizes m."""
    if entry.about.get("of") == "m":
        return Test("the functions that the derived laws tell apart, for every m", partial(_covered, entry))
    return Test(
        "the motion under loads from z = 0 on: increments up to the interval of z, for every z in one",
        partial(_intervals, entry),
    )


def function(entry: Entry) -> Test:
    """The functions that a row or column is about."""
    return Test("the functions that the derived laws tell apart, for every m", partial(_covered, entry))


def _covered(entry: Entry, reading: Reading) -> Iterator[Case]:
    """Every function once; those that differ by a delay, or in the first interval alone, are one."""
    table = entry.id[:2]
    group = entry.id.rsplit(".", 1)[0] if table == "T3" else table
    heads = [e.id for e in entries().values() if e.kind == "function" and e.id.startswith(f"{group}.")]
    for m in KINDS[table].sizes:
        named: dict[str, list[tuple[str, int]]] = {}
        for id in heads:
            tried = id == entry.id
            said = reading.ranges if tried else right_ranges(id)
            block = id.rsplit(".", 1)[0]
            if table == "T4":
                condition = reading.formula if block == entry.id else right(block)
                said = (*said, condition)
            named[id] = list(listed(reading.formula if tried else right(id), said, m))
        everything = [x for functions in named.values() for x in functions]
        own = named.get(entry.id, everything)
        for family in _families(table, m):
            count = sum(x in family for x in everything)
            if count == 0 or not set(family).isdisjoint(own):
                names = ", ".join(f"{letter}_{i}" for letter, i in family)
                yield Case({"m": m, "functions": names, "claim": "how often"}, count, 1)
        for letter, i in sorted(set(own) - {x for family in _families(table, m) for x in family}):
            yield Case({"m": m, "function": f"{letter}_{i}", "claim": "exists"}, True, False)


@cache
def _families(table: str, m: int) -> tuple[tuple[tuple[str, int], ...], ...]:
    """Functions that are one but for a delay and the first interval: those next to bodies without mass, or to ends."""
    exact = KINDS[table].tables(m)
    found: list[list[tuple[str, int]]] = []
    for key in product("fg", range(1, exact.m + 1)):
        same = next((family for family in found if _alike(exact, family[0], key)), None)
        found.remove(same) if same else None
        found.append([*(same or []), key])
    return tuple(map(tuple, sorted(found)))


def _alike(exact: Exact, one: tuple[str, int], other: tuple[str, int]) -> bool:
    rows = [(r[Function(*one)][1:], r[Function(*other)][1:]) for r in exact.responses.values()]
    return any(
        all(a[max(by, 0) : len(a) + min(by, 0)] == b[max(-by, 0) : len(b) + min(-by, 0)] for a, b in rows)
        for by in (-1, 0, 1)
    )


def _intervals(entry: Entry, reading: Reading) -> Iterator[Case]:
    """Every z from 0 on is in one interval, and what has been gained up to it is the motion."""
    table = entry.id[:2]
    kind = KINDS[table]
    heads = [e.id for e in entries().values() if e.kind == "range" and not e.about and e.id.startswith(table)]
    for m, z in product(kind.sizes[:2], instants(8)):
        found: list[int] = []
        for id in heads:
            where, ranges = (reading.formula, reading.ranges) if id == entry.id else (right(id), right_ranges(id))
            within = (n for n in numbers(ranges, kind.most_n) if holds(where, Indices({"n": n, "z": z})))
            found += (value(id.replace("range", "d"), n=n) if table == "T3" else n + 1 for n in within)
        for letter, i in product("fg", range(1, m + 1)):
            sums = tuple(_gained(table, m, letter, i, number, z) for number in found)
            true = _motion(table, m).wave(letter, i, z)
            yield Case({"m": m, "function": f"{letter}_{i}", "z": z}, sums, (true,), true != 0)


@cache
def _motion(table: str, m: int) -> Driven:
    """A chain under a unit of every source, from z = 0 on."""
    exact = KINDS[table].tables(m)
    return Driven(exact, {source: (Step(fmpq(0), fmpq(1)),) for source in exact.responses})


@cache
def _gained(table: str, m: int, letter: str, i: int, number: int, z: fmpq) -> Any:
    """The sum of the increments up to a number, begun or not."""
    motion = _motion(table, m)
    step = motion.exact.interval
    total: Any = 0
    for source, d in product(motion.loads, range(1, number + 1)):
        total = total + motion.increment(source, letter, i, d, z - step * (d - 1))
    return total
