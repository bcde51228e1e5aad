"""The heads of Tables 2 to 4, and where z lies in the text: functions and instants that they cover, each once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache
from itertools import product

from flint import fmpq

from wavesym.derivation.table import Function
from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds, places
from wavesym.papers.exact_tables import Exact
from wavesym.papers.mutations import ends
from wavesym.papers.pielorz1979.cells import EXAMPLE
from wavesym.papers.pielorz1979.forms import SIZES, TABLES, WITHIN, FormScope, compared, moved, numbers, right_form
from wavesym.papers.pielorz1979.tabled import as_tried, functions, rows
from wavesym.papers.pielorz1979.transcript import ids
from wavesym.papers.reader import read_range
from wavesym.papers.record import Case, Reading, Test

_MOST_M = {"T2": (4, 6, 8), "T3": (1, 2, 3, 4), "T4": range(2, 7)}


def function(entry: PaperEntry) -> Test:
    """The functions that a row or column is about, or the sizes m of a block."""

    def cases(reading: Reading) -> Iterator[Case]:
        table = entry.id[:2]
        group = f"{entry.id.rpartition('.')[0]}." if table == "T3" else f"{table}."
        for m in _MOST_M[table]:
            named = rows(group, m, {entry.id: reading})
            everything = [function for row in named.values() for function in row]
            own = named.get(entry.id, everything)
            for family in _families(table, m):
                count = sum(function in family for function in everything)
                if count == 0 or not set(family).isdisjoint(own):
                    names = ", ".join(f"{letter}_{i}" for letter, i in family)
                    yield Case({"m": m, "functions": names, "claim": "how often"}, count, 1)
            for letter, i in sorted(set(own) - {x for family in _families(table, m) for x in family}):
                yield Case({"m": m, "function": f"{letter}_{i}", "claim": "exists"}, True, False)

    return Test("the functions that the derived laws tell apart, for every m", cases)


@cache
def _families(table: str, m: int) -> tuple[tuple[tuple[str, int], ...], ...]:
    """Functions that are one but for a delay and the first interval: those next to bodies without mass, or to ends."""
    exact = TABLES[EXAMPLE[table]](m)
    found: list[list[tuple[str, int]]] = []
    for key in product("fg", range(1, m + 1)):
        same = next((family for family in found if _alike(exact, family[0], key)), [])
        found = [family for family in found if family is not same] + [[*same, key]]
    return tuple(map(tuple, sorted(found)))


def _alike(exact: Exact, one: tuple[str, int], other: tuple[str, int]) -> bool:
    gains = [(r[Function(*one)][1:], r[Function(*other)][1:]) for r in exact.responses.values()]
    return any(
        all(a[max(by, 0) : len(a) + min(by, 0)] == b[max(-by, 0) : len(b) + min(-by, 0)] for a, b in gains)
        for by in (-1, 0, 1)
    )


def interval_or_size(entry: PaperEntry) -> Test:
    """A range in the head of a table: instants z and numbers n, or sizes m."""
    if entry.about.get("of") == "m":
        return function(entry)
    name = EXAMPLE[entry.id[:2]]
    heads = [id for id in ids("range", entry.id[:2]) if id.endswith("range")]
    return Test(
        "the motion, by the form as corrected, for every z in one interval",
        lambda reading: _interval_cases(name, [as_tried(id, {entry.id: reading}) for id in heads], ends_too=True),
    )


def interval(entry: PaperEntry) -> Test:
    """Where z lies when a form is said to hold."""
    form = entry.about["form"]
    name = {"(4.9)": "I", "(4.10)": "II", "(4.12)": "III"}[form]

    def read(text: str, ranges: Iterable[str]) -> Reading:
        return Reading(read_range(text), tuple(map(read_range, ranges)))

    def interval_faults(right: Reading) -> Iterator[tuple[str, Reading]]:
        yield from ((change, replace(right, formula=wrong)) for change, wrong in ends(right.formula))
        yield from ((change, replace(right, ranges=(wrong,))) for change, wrong in ends(right.ranges[0]))

    return Test(
        f"{form} as corrected in every interval that z is said to lie in, against the motion; inside of intervals, "
        "every z in one of them",
        lambda reading: _interval_cases(name, [reading], ends_too=False),
        read,
        interval_faults,
    )


def _interval_cases(name: str, heads: list[Reading], ends_too: bool) -> Iterator[Case]:
    """Every z is in one interval, for which the form gives the motion."""
    m = SIZES[name][1]
    for z in (start + part for start in range(6) for part in WITHIN):
        inside = [number for half, head in enumerate(heads) for number in _inside(name, head, half, z)]
        if ends_too or z.denom() != 1:
            yield Case({"z": z, "claim": "in one interval"}, len(inside), 1)
        for letter, rod in functions(name, m):
            for number in inside:
                yield compared(_scope(name, letter), moved(name, m), (letter, rod), number, z)


@cache
def _scope(name: str, letter: str) -> FormScope:
    """The form as it is right, with what is known of it."""
    return FormScope(right_form(name), moved(name, SIZES[name][1]), letter)


def _inside(name: str, head: Reading, half: int, z: fmpq) -> list[int]:
    """The numbers 1, 2, ... of the intervals in which z lies."""
    found = []
    for place in places(head.ranges, Scope(), 6 if name == "II" else 4):
        if holds(head.formula, Scope({**place, "z": z})):
            if len(place) != 1 or not place.keys() <= {"n", "d"}:
                raise MeaninglessError("no interval has a number")
            found += [place["d"]] if "d" in place else [numbers(name, place["n"])[half]]
    return found
