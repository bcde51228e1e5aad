"""Tables 2 to 4, cell by cell, by the coefficients that the forms ask for with them: all that there are, each once.

A cell is tried among the others, which are as they should be, against the degrees of the exact tables.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from copy import copy
from functools import cache, partial
from itertools import product, tee
from typing import Any

from flint import fmpq

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.exact_tables import INTERVALS, Exact
from wavesym.papers.mutations import ends, mutations
from wavesym.papers.pielorz1979 import tabled
from wavesym.papers.pielorz1979.forms import TABLES, FormScope, form_cases, kept_cases, numbers, rates, right_form
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.tabled import Tried
from wavesym.papers.pielorz1979.transcript import ids, settled
from wavesym.papers.pielorz1979.truth import DrivenChain, LoadStep
from wavesym.papers.reader import read_range
from wavesym.papers.record import Case, Nothing, Reading, Reproduction, Test, by_size, case
from wavesym.papers.tree import Blank, Call, Number, Power, Series, Symbol, latex

EXAMPLE = {"T2": "I", "T3": "II", "T4": "III"}
PAIRS = {
    "I": tuple(by_size(product((4, 6, 10), range(5)))),
    "II": tuple(by_size(product((1, 2, 3, 5), range(3)))),
    "III": tuple(by_size(product((2, 3, 4, 5), range(6)))),
}
"""The m and n that are tried."""
MOST_N = {name: max(n for _, n in pairs) for name, pairs in PAIRS.items()}
Indices = tuple[int, ...]


class Asked(FormScope):
    """A form that keeps which coefficients it asks for in one interval; all else is a factor 1.

    `part` is the one part of the moments, alpha, that is looked at.
    """

    def __init__(
        self, name: str, driven: DrivenChain, letter: str, tried: Tried | None = None, part: int | None = None
    ) -> None:
        super().__init__(right_form(name), driven, letter, tried, MOST_N[name])
        self._part = part
        self._asked: list[tuple[Indices, Indices]] = []

    def asked(self, rod: int, number: int) -> list[tuple[Indices, Indices]]:
        """The lower and upper indices of the coefficients for a rod in interval 1, 2, ..., in their order."""
        self._asked = []
        self._total(rod, number, fmpq(0))
        return self._asked

    def coefficient(self, lower: Indices, upper: Indices) -> Any:
        self._where(upper)  # as many as the form's coefficients have
        self._asked.append((lower, upper))
        return 0

    def series(self, series: Series) -> Any:
        if series.variable.name != tabled.ALPHA or self._part is None:
            return super().series(series)
        with self.binding({tabled.ALPHA: self._part}):
            return self.value(series.body)

    def call(self, call: Call) -> Any:
        return 0

    def step(self, value: Any) -> Any:
        return 1

    def raised(self, power: Power) -> Any:
        return 1

    def symbol(self, symbol: Symbol) -> Any:
        return 1 if symbol.accent or symbol.name == r"\tau" else super().symbol(symbol)

    def last(self, source: str) -> int:
        """Moments that do not exist are asked for, too."""
        return len(self._driven.loads.get(source, (None,))) - 1


Powers = dict[tuple[str, str], Any]
"""The highest powers, by source (in example II, where each has its own) and rate."""


class Counted:
    """The highest powers of a chain's functions, as a form says them and as they are."""

    def __init__(self, name: str, exact: Exact) -> None:
        self.name, self.exact = name, exact
        self.driven = DrivenChain(exact, {source: (LoadStep(fmpq(0), fmpq(1)),) for source in exact.responses})
        self._rates = {body: str(rate) for body, rate in rates(exact).items()}
        self._true: dict[tuple[str, int, int], Powers] = {}

    def said(self, asked: Iterable[tuple[Indices, Indices]]) -> Powers:
        """Those of the coefficients asked for; all powers of a rate where any is asked for more than once."""
        found: dict[tuple[str, str], list[int]] = {}
        twice = set()
        for (lower, upper), times in Counter(asked).items():
            if len(lower) == 2:
                rate = self._rates.get(lower[0], f"of no body: number {lower[0]}")
                key = (f"M{upper[1]}" if self.name == "II" else "", rate)
                found.setdefault(key, []).extend([lower[1]] * times)
                if times > 1:
                    twice.add(key)
        return {key: tuple(sorted(powers)) if key in twice else max(powers) for key, powers in found.items()}

    def true(self, letter: str, rod: int, number: int) -> Powers:
        """Those of the exact tables."""
        key = letter, rod, number
        if key not in self._true:
            found: Powers = {}
            for source in self.exact.responses:
                for rate, powers in self.exact.increment(source, letter, rod, number).items():
                    if rate != 0:
                        of = (source if self.name == "II" else "", str(rate))
                        found[of] = max(found.get(of, 0), len(powers) - 1)
            self._true[key] = found
        return self._true[key]

    def acting(self, half: str, letter: str, rod: int) -> tuple[int, ...]:
        """The moments that change a function in some interval of a half."""
        first = 1 + tabled.HALVES.index(half)
        gains = {s: self.exact.responses[f"M{s}"] for s in range(1, self.exact.m + 2)}
        return tuple(
            s
            for s in gains
            if any(self.exact.increment(f"M{s}", letter, rod, n) for n in range(first, INTERVALS["II"] + 1, 2))
        )

    def cases(self, scope: Asked, letter: str, rod: int, number: int, at: Mapping[str, object]) -> Iterator[Case]:
        """One for every rate that a function has, or is said to have, in an interval."""
        true, at = self.true(letter, rod, number), {**at, "function": f"{letter}_{rod}"}
        try:
            asked = scope.asked(rod, number)
        except MeaninglessError as error:
            yield Case(at, Nothing(str(error)), {" ".join(key).strip(): power for key, power in true.items()})
            return
        said, sources = self.said(asked), {f"M{upper[1]}" if self.name == "II" else "" for _, upper in asked}
        for key in {**{key: power for key, power in true.items() if key[0] in sources}, **said}:
            where = {**at, "moment": key[0], "rate": key[1]} if key[0] else {**at, "rate": key[1]}
            highest = true.get(key, -1)
            told = partial(self._example, letter, rod, number, *key, highest)
            yield Case(where, said.get(key, -1), highest, key in true, told)

    def _example(self, letter: str, rod: int, number: int, source: str, rate: str, highest: int) -> Reproduction:
        """The table of the exact increments, where the highest power is read off."""
        gains = {s: self.exact.increment(s, letter, rod, number) for s in self.exact.responses}
        by_source = {s: {str(r): len(powers) for r, powers in gain.items()} for s, gain in gains.items()}
        source = source or max(by_source, key=lambda s: by_source[s].get(rate, 0))
        what = f"its highest power is {highest}" if highest >= 0 else "there is none"
        look = f"{letter} of rod {rod}, source {source}, interval {number}, rate {rate}: {what}"
        loads = {source: (LoadStep(fmpq(0), fmpq(1)),)}
        until = self.exact.interval * number
        return example(self.exact, loads, until, {"strain": ["1-"]}, "wavesym tables SCENE", look)()


@cache
def counted(name: str, m: int) -> Counted:
    """An example with all rates different."""
    return Counted(name, TABLES[name](m))


def cell(entry: PaperEntry) -> Test:
    """A cell of a table."""
    name, row = EXAMPLE[entry.id[:2]], entry.about["row"]
    faults = partial(_faults, entry)
    if row in "dw":
        return Test("the motion under delayed moments, by (4.10)", partial(_in_motion, entry.id), faults=faults)
    return Test(
        f"the degrees of the exact tables, all rates different, m = {PAIRS[name][0][0]} ... {PAIRS[name][-1][0]}, "
        f"n = 0 ... {MOST_N[name]}",
        partial(_cases, entry, name),
        faults=faults,
        conventions={"functions that rest have no power": partial(_while_moving, entry)} if name == "III" else {},
    )


def _in_motion(id: str, reading: Reading) -> Iterator[Case]:
    if reading == settled(id):
        yield from copy(kept_cases(right_form("II")))
    else:
        yield from form_cases(right_form("II"), {id: reading})


def _cases(entry: PaperEntry, name: str, reading: Reading) -> Iterator[Case]:
    row = entry.about["row"]  # "alpha2.K_1", of the second part
    part = int(row[5]) if name == "II" and row[7] in "KL" else None
    if reading == settled(entry.id):
        yield from copy(_kept(name, entry.heads, part))
    else:
        yield from counted_cases(name, {entry.id: reading}, entry.heads, part=part)


def _while_moving(entry: PaperEntry, reading: Reading) -> Iterator[Case]:
    """Without those of n = 0 of the functions g, which rest then: text.8."""
    for tried in _cases(entry, "III", reading):
        if tried.at["n"] or not str(tried.at["function"]).startswith("g"):
            yield tried


@cache
def _kept(name: str, heads: tuple[str, ...], part: int | None) -> Iterator[Case]:
    """The cases of a row or column in which all is right; what copies of this iterator reach is kept."""
    return tee(counted_cases(name, {}, heads, part=part), 1)[0]


@cache
def _rows(table: str, m: int) -> dict[str, list[tuple[str, int]]]:
    return tabled.rows(f"{table}.", m, {})


def counted_cases(
    name: str, tried: Tried, heads: Iterable[str], most_n: int | None = None, part: int | None = None
) -> Iterator[Case]:
    """The functions of some rows or columns: in example II their moments, and in all their highest powers.

    Of a `part` of the moments only the powers, as these do not say which moments there are.
    """
    (table,) = (table for table, example in EXAMPLE.items() if example == name)
    scopes: dict[tuple[int, str], Asked] = {}
    for m, n in (pair for pair in PAIRS[name] if most_n is None or pair[1] <= most_n):
        chain = counted(name, m)
        for head, (letter, rod) in ((id, function) for id, row in _rows(table, m).items() for function in row):
            if head not in heads:
                continue
            scope = scopes.setdefault((m, letter), Asked(name, chain.driven, letter, tried, part))
            half = head.split(".")[1]
            number = numbers(name, n)[half == "odd"]
            if name == "II" and n == 0 and part is None:
                at = {"m": m, "function": f"{letter}_{rod}", "claim": "moments s"}
                yield case(at, partial(_moments, scope, rod, number), chain.acting(half, letter, rod))
            yield from chain.cases(scope, letter, rod, number, {"m": m, "n": n})


def _moments(scope: Asked, rod: int, number: int) -> tuple[int, ...]:
    return tuple(sorted(upper[1] for lower, upper in scope.asked(rod, number) if not lower))


def _faults(entry: PaperEntry, right: Reading) -> Iterator[tuple[str, Reading]]:
    """Those of the formula, and of a range that is the cell's own: the others are faults of the heads."""
    if isinstance(right.formula, Blank):
        for digit in "01":
            yield f"{digit} for {latex(right.formula)}", Reading(Number(digit), right.ranges)
        return
    for change, formula in mutations(right.formula):
        yield change, Reading(formula, right.ranges)
    for place, range_ in enumerate(right.ranges):
        if range_ not in map(read_range, entry.ranges):
            for change, wrong in ends(range_):
                yield change, Reading(right.formula, (*right.ranges[:place], wrong, *right.ranges[place + 1 :]))


def definition(entry: PaperEntry) -> Test:
    """L_0, r_0 and r_1, by what Table 3 is with them."""
    heads = ids("function", "T3")
    return Test(
        "the moments that act, and the degrees of the exact tables, by Table 3",
        lambda reading: counted_cases("II", {entry.id: reading}, heads, most_n=1),
    )
