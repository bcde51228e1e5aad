"""Tables 2 to 4, cell by cell: the highest powers of (4.9), (4.10) and (4.12).

A cell is tried among the others of its row or column, which are as they should be, against the degrees of the exact
tables; a power below 0 says that there is no such term, a dash that there is no such part.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import chain, product
from typing import Any

from flint import fmpq

from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds, sides, span
from wavesym.papers.exact_tables import Exact, building, collision, drive, gammas
from wavesym.papers.mutations import ends, mutations
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.transcript import entries
from wavesym.papers.pielorz1979.truth import Loads, Step, driven, instants
from wavesym.papers.reader import UnreadableError, read_formula, read_range
from wavesym.papers.record import Case, Example, Reading, Test, by_size, case
from wavesym.papers.tree import Blank, Number, Progression, Symbol, Tree, latex


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
    """The letters of a cell: those bound, and r_0, r_1 as the text under (4.11) has them."""

    def symbol(self, symbol: Symbol) -> Any:
        match symbol:
            case Symbol("r", below=(Number("0" | "1" as index),)) if "i" in self.bound:
                return _parity(index, self.bound["i"])
        return super().symbol(symbol)


@cache
def _parity(index: str, i: int) -> Any:
    _, cases = sides(right(f"(4.11).r_{index}"))
    return Scope({"i": i}).value(cases)


# the tables as they should be


@cache
def right(id: str) -> Tree:
    """A cell, or the formula of a head, as it should be; KeyError where there is none, MeaninglessError."""
    entry = entries()[id]
    try:
        return read_formula(entry.slip.corrected if entry.slip else entry.printed)
    except UnreadableError as error:
        raise MeaninglessError(str(error)) from None


@cache
def right_ranges(id: str) -> tuple[Tree, ...]:
    """The ranges of a cell or a head as they should be."""
    entry = entries()[id]
    said = entry.ranges if entry.slip is None or entry.slip.ranges is None else entry.slip.ranges
    return tuple(map(read_range, said))


def value(id: str, **indices: int) -> Any:
    """The value of a cell as it should be, such as value("T3.even.f.alpha1.K_1", m=4, n=2, i=3, r=1, l=2)."""
    return _known(id, tuple(sorted(indices.items())))


@cache
def _known(id: str, indices: tuple[tuple[str, int], ...]) -> Any:
    return _plain(Indices(dict(indices)).value(right(id)))


def _plain(value: Any) -> Any:
    """A whole number as one."""
    return int(value.numer()) if isinstance(value, fmpq) and value.denom() == 1 else value


# cells


@dataclass(frozen=True)
class Term:
    """Where a power is: a function, an interval, a body's rate, and the source, or all of them."""

    table: str
    m: int
    letter: str
    rod: int
    number: int
    body: int
    source: str | None = None

    @property
    def exact(self) -> Exact:
        return KINDS[self.table].tables(self.m)

    @property
    def rate(self) -> fmpq:
        """The rate of the body: gamma of a drive, 2 kappa, or kappa of a roof, which has columns on one side only."""
        if self.table == "T3":
            return gammas(self.exact)[self.body]
        kappa = self.exact.chain.parameters.kappa
        return fmpq(kappa[self.body]) * (1 if self.table == "T4" and self.body == self.m else 2)

    def example(self) -> Example:
        """The table of the exact increments, where the highest power is read off."""
        source = self.source or max(self.exact.responses, key=lambda source: highest(replace(self, source=source)))
        degree = highest(replace(self, source=source))
        what = f"its highest power is {degree}" if degree >= 0 else "there is none"
        look = f"{self.letter} of rod {self.rod}, source {source}, interval {self.number}, rate {self.rate}: {what}"
        loads = {source: (Step(fmpq(0), fmpq(1)),)}
        until = self.exact.interval * self.number
        return example(self.exact, loads, until, {"strain": ["1-"]}, "wavesym tables SCENE", look)()


@cache
def highest(term: Term) -> int:
    """The highest power, -1 where there is no such term; MeaninglessError where there is no such function or body."""
    try:
        return term.exact.degree(term.letter, term.rod, term.number, term.rate, term.source)
    except (KeyError, IndexError):
        raise MeaninglessError(f"there is no power of {term}") from None


def _compared(where: Mapping[str, int], claimed: Sequence[Any], term: Term | None) -> Case:
    """The highest powers that the ranges claim which have a body, with that of the term, where there is such a body."""
    said = tuple(max(power, -1) for power in claimed)  # all below 0 say that there is no term
    if term is None:
        return Case(where, said, (), False)
    true = highest(term)
    if len(said) == 1:
        return Case(where, said[0], true, true >= 0, term.example)
    return Case(where, said, (true,), true >= 0, term.example)


def cell(entry: Entry) -> Test:
    """A cell of a table."""
    table, row = entry.about["table"], entry.about["row"]
    if table[:2] == "T3" and row in "dw":
        return Test(
            "the motion under delayed moments, interval by interval",
            partial(_steps, entry),
            faults=partial(_cell_faults, entry),
        )
    trial = {"T2": _collision, "T3": _drive, "T4": _building}[table[:2]]
    kind = KINDS[table[:2]]
    return Test(
        f"the degrees of the exact tables, all rates different, m = {kind.sizes[0]} ... {kind.sizes[-1]}, "
        f"n = 0 ... {kind.most_n}",
        partial(trial, entry),
        faults=partial(_cell_faults, entry),
    )


def _cell_faults(entry: Entry, right: Reading) -> Iterator[tuple[str, Reading]]:
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


@dataclass(frozen=True)
class _Cells:
    """The cells of a row or column as they should be, but for the one that is tried; None for a dash."""

    pattern: str
    tried: Entry
    reading: Reading

    def __call__(self, name: str, **indices: int) -> Any:
        id = self.pattern.format(name)
        tree = self.reading.formula if id == self.tried.id else right(id)
        if isinstance(tree, Blank):
            return None
        return _plain(Indices(indices).value(tree)) if id == self.tried.id else value(id, **indices)


def _functions(entry: Entry, ranges: Iterable[Tree], table: str) -> Iterator[tuple[int, int, str, int, bool]]:
    """m, n, and the functions that a cell is about; whether it says anything of that n."""
    kind = KINDS[table]
    (head,) = (id for id in entry.heads if entries()[id].kind == "function")
    said = (*ranges, *right_ranges(head))
    for m, n in by_size(product(kind.sizes, range(kind.most_n + 1))):
        for letter, i in listed(right(head), said, m):
            yield m, n, letter, i, n in numbers(said, kind.most_n)


def listed(function: Tree, ranges: Iterable[Tree], m: int) -> Iterator[tuple[str, int]]:
    """The functions that a head names for an m: none where a condition on m does not hold."""
    if not isinstance(function, Symbol):
        raise MeaninglessError(f"{latex(function)} is no function")
    scope = Indices({"m": m})
    if all(holds(range_, scope) for range_ in ranges if _restricts(range_)):
        running = _progression(ranges, "i")
        for i in span(running, scope) if running else (None,):
            with scope.binding({} if i is None else {"i": i}):
                yield (function.name, *scope.indices(function))  # type: ignore[misc]


def _restricts(range_: Tree) -> bool:
    """Whether a range is a condition on m: not on z, and no running i or n."""
    if isinstance(range_, Progression):
        return range_.variable == Symbol("m")
    return "z" not in latex(range_)


def numbers(ranges: Iterable[Tree], most: int) -> tuple[int, ...]:
    """The n of some ranges, up to `most`."""
    running = _progression(ranges, "n")
    return span(running, Scope(), most) if running else ()


def _progression(ranges: Iterable[Tree], name: str) -> Progression | None:
    return next((r for r in ranges if isinstance(r, Progression) and r.variable == Symbol(name)), None)


def _collision(entry: Entry, reading: Reading) -> Iterator[Case]:
    """Table 2: kappa_1, the inner bodies j in two parts, kappa_(m-1)."""
    column = entry.about["column"]
    cells = _Cells(f"T2.{entry.about['row']}.{{}}", entry, reading)
    for m, n, letter, i, said in _functions(entry, reading.ranges, "T2"):
        if column in ("K_1", "K_m-1"):
            yield _power(cells, Term("T2", m, letter, i, n + 1, _body(column, m)), column, said)
        else:
            yield from _inner_bodies(Term("T2", m, letter, i, n + 1, 0), cells)


_LIMIT = read_formula("E(K/2)")
"""The highest power of an inner body, by (4.9)."""


def _inner_bodies(term: Term, cells: _Cells) -> Iterator[Case]:
    """For every inner body: one part has it, and its highest power is right."""
    inner = range(1, (term.m - 4) // 2 + 1)
    where = {"m": term.m, "n": term.number - 1, "i": term.rod}
    claimed: dict[int, list[Any]] = {j: [] for j in inner}
    for part in PARTS["T2"]:
        members = _whole_range(cells(f"j_0,{part}", **where), cells(f"j_{part}", **where))
        for j in members or (1,):
            power = cells(f"K_j,{part}", **where, j=j)
            if (power is None) is not (members is None):
                raise MeaninglessError("a part is given whole or not at all")
            if members:
                claimed.setdefault(j, []).append(_plain(Scope({"K": power}).value(_LIMIT)))
    for j in sorted(claimed):
        yield _compared({**where, "j": j}, claimed[j], replace(term, body=2 * j + 1) if j in inner else None)


def _whole_range(first: Any, last: Any) -> range | None:
    """From first to last; None where both are dashes. MeaninglessError where they are no numbers of terms."""
    if first is None and last is None:
        return None
    if not (isinstance(first, int) and isinstance(last, int)):
        raise MeaninglessError(f"from {first or '—'} to {last or '—'}")
    return range(first, last + 1)


def _building(entry: Entry, reading: Reading) -> Iterator[Case]:
    """Table 4: the floors' rate 2 kappa_1 and the roof's kappa_m."""
    column = entry.about["column"]
    cells = _Cells(f"{entry.about['table']}.{entry.about['row']}.{{}}", entry, reading)
    for m, n, letter, i, said in _functions(entry, reading.ranges, "T4"):
        yield _power(cells, Term("T4", m, letter, i, n + 1, _body(column, m)), column, said)


def _power(cells: _Cells, term: Term, column: str, said: bool) -> Case:
    """The highest power of one body."""
    where = {"m": term.m, "n": term.number - 1, "i": term.rod}
    return _compared(where, [cells(column, **where) if said else -1], term)


def _body(column: str, m: int) -> int:
    """The body that a column's label K_(...) names."""
    return Indices({"m": m}).whole(read_formula(column.removeprefix("K_")))


def _drive(entry: Entry, reading: Reading) -> Iterator[Case]:
    """Table 3: the moments s in two parts, and for each the bodies l in three ranges."""
    half, letter = entry.about["table"], entry.about["column"]
    alpha, name = entry.about["row"].split(".")
    parts = [_Cells(f"{half}.{letter}.alpha{a}.{{}}", entry, reading) for a in (1, 2)]
    tried = parts[int(alpha[-1]) - 1]
    for m, n, _, i, said in _functions(entry, reading.ranges, "T3"):
        at = {"m": m, "n": n, "i": i}
        if not said:
            raise MeaninglessError(f"says nothing of n = {n}")
        if name[0] not in "sR":
            yield from _bodies(tried, int(alpha[-1]), name, Term("T3", m, letter, i, value(f"{half}.d", n=n), 0), at)
        elif n == 0:
            true = _acting(drive(m), letter, i, value(f"{half}.d", n=KINDS["T3"].most_n))
            yield case({"m": m, "i": i, "claim": "moments s"}, partial(_all_moments, parts, at), true)


def _all_moments(parts: Iterable[_Cells], at: Mapping[str, int]) -> tuple[Any, ...]:
    return tuple(sorted(s for alpha, part in enumerate(parts, 1) for _, s in _moments(part, alpha, at)))


def _moments(part: _Cells, alpha: int, at: Mapping[str, int]) -> list[tuple[int, Any]]:
    """The r and the s of a part, r from s_alpha to R_alpha."""
    here = {"m": at["m"], "i": at["i"]}
    found = _whole_range(part(f"s_{alpha}", **here), part(f"R_{alpha}", **here))
    return [(r, part("s", **here, r=r)) for r in found or ()]


def _acting(exact: Exact, letter: str, i: int, number: int) -> tuple[int, ...]:
    """The moments by which a function changes in an interval; MeaninglessError where there is no such function."""
    try:
        return tuple(s for s in range(1, exact.m + 2) if exact.increment(f"M{s}", letter, i, number))
    except (KeyError, IndexError):
        raise MeaninglessError(f"there is no interval {number} of {letter}_{i}") from None


def _bodies(part: _Cells, alpha: int, name: str, term: Term, at: Mapping[str, int]) -> Iterator[Case]:
    """For every moment of the part, every body is in one of the three ranges, and its highest power is right."""
    everybody = range(1, term.m + 2)
    for r, s in _moments(part, alpha, at):
        here = {**at, "r": r}
        last = [0, *(part(f"L_{beta}", **here) for beta in PARTS["T3"])]
        ranges = {beta: _whole_range(last[beta - 1] + 1, last[beta]) or () for beta in PARTS["T3"]}
        for body in ranges[int(name[-1])] if name[0] == "K" else sorted({*everybody, *chain(*ranges.values())}):
            claimed = [part(f"K_{beta}", **here, l=body) for beta, members in ranges.items() if body in members]
            true = replace(term, body=body, source=f"M{s}") if body in everybody else None
            yield _compared({**at, "s": s, "l": body}, claimed, true)


def _steps(entry: Entry, reading: Reading) -> Iterator[Case]:
    """F' under delayed moments is the sum of increments number d at w, each from its start on."""
    for m, z in product((1, 2), instants(5)):
        motion = driven("II", m)
        begun = list(_begun(motion.loads, entry, reading, z))
        for letter, i in product("fg", range(1, m + 1)):
            total: Any = 0
            for source, weight, number, w in begun:
                total = total + weight * motion.increment(source, letter, i, number, w)
            yield Case({"m": m, "function": f"{letter}_{i}", "z": z}, total, motion.wave(letter, i, z), total != 0)


def _begun(loads: Loads, entry: Entry, reading: Reading, z: fmpq) -> Iterator[tuple[str, fmpq, int, fmpq]]:
    """The pieces of moments and the intervals that have begun for them: source, weight, d and w."""
    for half in ("T3.even", "T3.odd"):
        d, w = (reading.formula if f"{half}.{name}" == entry.id else right(f"{half}.{name}") for name in "dw")
        for n in numbers(reading.ranges, 2):
            number = Indices({"n": n}).whole(d)
            for source, pieces in loads.items():
                for k, piece in enumerate(pieces):
                    since = _Delayed({"n": n, "z": z, "s": int(source[1:]), "k": k}, loads).value(w)
                    if since >= 0:
                        yield source, piece.weight, number, since


class _Delayed(Indices):
    """With the times tau_(s,k) at which moments change."""

    def __init__(self, bound: Mapping[str, Any], loads: Loads) -> None:
        super().__init__(bound)
        self._loads = loads

    def symbol(self, symbol: Symbol) -> Any:
        if symbol.name == r"\tau":
            s, k = self.indices(symbol)
            pieces = self._loads.get(f"M{s}", ())
            if not 0 <= k < len(pieces):
                raise MeaninglessError(f"M_{s} has no step {k}")
            return pieces[k].time
        return super().symbol(symbol)
