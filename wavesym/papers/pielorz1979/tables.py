"""The test of tables: what a cell, a head or a formula of the text says, among all others as they should be.

Forms are run against the motion, and the highest powers of the coefficients that they request are compared with those
of the exact tables. Each function of a table is in it once, and each z in one interval.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cache, partial
from itertools import product
from typing import Any

from wavesym.derivation.table import Function as TableFunction
from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, constants_in, holds, items, places, sides, span
from wavesym.papers.mutations import ends
from wavesym.papers.pielorz1979.forms import (
    ALPHA,
    EXACT,
    FORMS,
    SIZES,
    TABLE,
    WITHIN,
    Form,
    FormScope,
    Function,
    compare_at,
    form_cases,
    form_chain,
    functions,
    numbers,
    reading_of,
    right_form,
    right_form_cases,
    rows,
    single_range,
)
from wavesym.papers.pielorz1979.powers import PAIRS, power_cases, right_power_cases
from wavesym.papers.pielorz1979.transcript import entries, ids, right_reading
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Reading, Test, faults
from wavesym.papers.tree import (
    Blank,
    Call,
    Number,
    Power,
    Symbol,
    Tree,
    latex,
    parts_of,
    replace_part,
    symbols,
)

EXAMPLE = {table: name for name, table in TABLE.items()}
_SIZES = {"T2": (4, 6, 8), "T3": (1, 2, 3, 4), "T4": range(2, 7)}
_POWERS = "the degrees of the exact tables, all rates different"
_REST = 4


def form(entry: PaperEntry) -> Test:
    """A form whole, for all functions of its table."""
    name = entry.subject["example"]

    def cases(reading: Reading) -> Iterator[Case]:
        read = Form.from_reading(name, reading)
        yield from right_form_cases(name) if read == right_form(name) else form_cases(read)

    return Test(
        "the motion, exact, under loads with several delayed pieces; "
        f"m = {', '.join(map(str, SIZES[name]))}; coefficients of the exact tables, limits of the corrected tables",
        cases,
    )


def part_of_form(entry: PaperEntry) -> Test:
    """A part of a form that the text repeats, put in its place: H of (4.12), the exponential of (4.10).

    H has the H(0) of its range; 0 and 1 where there is none.
    """
    name = entry.subject["example"]
    is_step = name == "III"

    def cases(reading: Reading, at_0: Iterable[int] = (0, 1) if is_step else (1,)) -> Iterator[Case]:
        right = right_form(name)
        own = {part for part in parts_of(right.step) if _is_step(part) or _is_exponential(part)}
        (part,) = (part for part in own if isinstance(part, Call) is is_step)
        values_at_0 = [
            int(Scope().value(value)) for left, value in constants_in(reading.ranges).items() if left == _AT_0
        ]
        if len(values_at_0) != len(reading.ranges):
            raise MeaninglessError("a range of something else")
        tried = replace(right, step=replace_part(right.step, part, reading.formula))
        for value in values_at_0 or at_0:
            scope = type("At0", (FormScope,), {"heaviside_at_0": value})
            for found in form_cases(tried, scope=scope, chains=2):
                yield replace(found, place={"H(0)": value, **found.place}) if is_step else found

    return Test(
        f"the motion, by {FORMS[name]} with it",
        cases,
        conventions={"H(0) = 1": lambda reading: cases(reading, (1,))} if is_step else {},
    )


_AT_0 = read_formula("H(0)")


def _is_step(part: Tree) -> bool:
    return isinstance(part, Call) and part.function == Symbol("H")


def _is_exponential(part: Tree) -> bool:
    return isinstance(part, Power) and part.base == Symbol("e")


def cell(entry: PaperEntry) -> Test:
    """A cell of Tables 2 to 4."""
    name, row = EXAMPLE[entry.id[:2]], entry.subject["row"]
    own_faults = partial(_faults, entry)
    if row in "dw":
        return Test("the motion under delayed moments, by (4.10)", partial(_in_motion, entry.id), faults=own_faults)
    m, n = zip(*PAIRS[name], strict=True)
    return Test(
        f"{_POWERS}, m = {min(m)} ... {max(m)}, n = 0 ... {max(n)}",
        partial(_cell_cases, entry, name),
        faults=own_faults,
        conventions={"functions that rest have no power": partial(_while_moving, entry)} if name == "III" else {},
    )


def _in_motion(id: str, reading: Reading) -> Iterable[Case]:
    return right_form_cases("II") if reading == right_reading(id) else form_cases(right_form("II"), {id: reading})


def _cell_cases(entry: PaperEntry, name: str, reading: Reading) -> Iterable[Case]:
    row = entry.subject["row"]  # "alpha2.K_1", of the second part
    part = int(row[5]) if name == "II" and row[7] in "KL" else None
    if reading == right_reading(entry.id):
        return right_power_cases(name, entry.heads, part)
    return power_cases(name, {entry.id: reading}, entry.heads, part=part)


def _while_moving(entry: PaperEntry, reading: Reading) -> Iterator[Case]:
    """Without those of n = 0 of the functions g, which rest then: text.8."""
    for tried in _cell_cases(entry, "III", reading):
        if tried.place["n"] or not str(tried.place["function"]).startswith("g"):
            yield tried


def _faults(entry: PaperEntry, right: Reading) -> Iterable[tuple[str, Reading]]:
    """Those of the formula, and of a range that is the cell's own: the others are faults of the heads."""
    if isinstance(right.formula, Blank):
        return [(f"{digit} for {latex(right.formula)}", Reading(Number(digit), right.ranges)) for digit in "01"]
    return faults(right, kept_ranges=tuple(map(read_range, entry.ranges)))


def definition(entry: PaperEntry) -> Test:
    """L_0, r_0 and r_1, by what Table 3 is with them."""
    heads = ids("function", "T3")
    return Test(
        "the moments that act, and the degrees of the exact tables, by Table 3",
        lambda reading: power_cases("II", {entry.id: reading}, heads, most_n=1),
    )


def cells_in_text(entry: PaperEntry) -> Test:
    """Cells of the column of Table 3 that the text repeats: the moments of its first group, or a highest power.

    Its range is that of the column: r from s_1 to R_1, or l from L_(beta-1) + 1 to L_beta.
    """
    column = "T3.even.f.alpha1"

    def cases(reading: Reading) -> Iterator[Case]:
        left, right = sides(reading.formula)
        id = f"{column}.{latex(left).replace('{', '').replace('}', '')}"
        if id not in entries() or not isinstance(left, Symbol) or left.name not in ("s", "K"):
            raise MeaninglessError(f"{latex(left)} is no cell")
        for m, i, scope in first_columns():
            at = {"m": m, "function": f"f_{i}"}
            if left.name == "s":
                first, last = (scope.whole(read_formula(rf"{end}_\alpha")) for end in "sR")
                yield Case(
                    {**at, "claim": "r"}, span(single_range("r", reading.ranges), scope), tuple(range(first, last + 1))
                )
            for r, s in moments(scope, "even", i, 1) if left.name == "K" else ():
                with scope.bind({"r": r}):
                    (beta,) = scope.indices(left)
                    first, last = (scope.whole(read_formula(f"L_{number}")) for number in (beta - 1, beta))
                    own = span(single_range("l", reading.ranges), scope)
                    yield Case({**at, "s": s, "claim": "l"}, own, tuple(range(first + 1, last + 1)))
        yield from power_cases("II", {id: Reading(right, right_reading(id).ranges)}, ("T3.even.f",), part=part)

    part = None if entry.id.endswith("group") else 1
    return Test(f"{_POWERS}, the moments that act, and the ranges of this column of Table 3", cases)


def first_columns() -> Iterator[tuple[int, int, FormScope]]:
    """f in the even half of Table 3, its first part: m, i, and the scope at i and n = 0."""
    for m in range(1, 6):
        for i in range(1, m + 1):
            scope = FormScope(right_form("II"), form_chain("II", m), "f")
            with scope.bind({"i": i, "n": 0, "half": "even", ALPHA: 1}):
                yield m, i, scope


def moments(scope: FormScope, half: str, rod: int, alpha: int) -> list[tuple[int, int]]:
    """The r and s that Table 3 has in a part of a half."""
    found = []
    with scope.bind({"n": 0, "half": half, "i": rod, ALPHA: alpha}):
        first, last = (scope.whole(read_formula(rf"{end}_\alpha")) for end in "sR")
        for r in range(first, last + 1):
            with scope.bind({"r": r}):
                found.append((r, scope.whole(read_formula("s"))))
    return found


def function(entry: PaperEntry) -> Test:
    """The functions that a row or column is about, or the sizes m of a block."""

    def cases(reading: Reading) -> Iterator[Case]:
        table = entry.id[:2]
        group = f"{entry.id.rpartition('.')[0]}." if table == "T3" else f"{table}."
        for m in _SIZES[table]:
            named = rows(group, m, {entry.id: reading})
            everything = [function for row in named.values() for function in row]
            own = named.get(entry.id, everything)
            families = _families(EXAMPLE[table], m)
            for family in families:
                count = sum(function in family for function in everything)
                if count == 0 or not set(family).isdisjoint(own):
                    names = ", ".join(f"{letter}_{i}" for letter, i in family)
                    yield Case({"m": m, "functions": names, "claim": "how often"}, count, 1)
            for letter, i in sorted(set(own) - {x for family in families for x in family}):
                yield Case({"m": m, "function": f"{letter}_{i}", "claim": "exists"}, True, False)

    return Test("the functions that the derived laws tell apart, for every m", cases)


@cache
def _families(name: str, m: int) -> tuple[tuple[Function, ...], ...]:
    """Functions that are one but for a delay and the first interval: those next to bodies without mass, or to ends."""
    found: list[list[Function]] = []
    for key in product("fg", range(1, m + 1)):
        same = next((family for family in found if _are_alike(name, m, family[0], key)), [])
        found = [family for family in found if family is not same] + [[*same, key]]
    return tuple(map(tuple, sorted(found)))


def _are_alike(name: str, m: int, one: Function, other: Function) -> bool:
    responses = EXACT[name](m).responses.values()
    gains = [(r[TableFunction(*one)][1:], r[TableFunction(*other)][1:]) for r in responses]
    return any(
        all(a[max(by, 0) : len(a) + min(by, 0)] == b[max(-by, 0) : len(b) + min(-by, 0)] for a, b in gains)
        for by in (-1, 0, 1)
    )


def range_of_table(entry: PaperEntry) -> Test:
    """A range in the head of a table: instants z and numbers n, or sizes m."""
    if entry.subject.get("of") == "m":
        return function(entry)
    name = EXAMPLE[entry.id[:2]]
    heads = [id for id in ids("range", entry.id[:2]) if id.endswith("range")]
    return Test(
        "the motion, by the form as corrected, for every z in one interval",
        lambda reading: _interval_cases(name, [reading_of(id, {entry.id: reading}) for id in heads], ends_too=True),
    )


def interval(entry: PaperEntry) -> Test:
    """Where z lies when a form is said to hold."""
    name = entry.subject["example"]

    def read(text: str, ranges: Iterable[str]) -> Reading:
        return Reading(read_range(text), tuple(map(read_range, ranges)))

    return Test(
        f"{FORMS[name]} as corrected in every interval that z is said to lie in, against the motion; inside of "
        "intervals, every z in one of them",
        lambda reading: _interval_cases(name, [reading], ends_too=False),
        read,
        partial(faults, of_formula=ends),
    )


def _interval_cases(name: str, heads: list[Reading], ends_too: bool) -> Iterator[Case]:
    """Every z is in one interval, for which the form gives the motion."""
    m = SIZES[name][1]
    for z in (start + part for start in range(6) for part in WITHIN):
        inside = [number for half, head in enumerate(heads) for number in _intervals_at(name, head, half, z)]
        if ends_too or z.denom() != 1:
            yield Case({"z": z, "claim": "in one interval"}, len(inside), 1)
        for (letter, rod), number in product(functions(name, m), inside):
            yield compare_at(_right_scope(name, letter), form_chain(name, m), (letter, rod), number, z)


@cache
def _right_scope(name: str, letter: str) -> FormScope:
    return FormScope(right_form(name), form_chain(name, SIZES[name][1]), letter)


def _intervals_at(name: str, head: Reading, half: int, z: Any) -> list[int]:
    """The numbers 1, 2, ... of the intervals in which z lies."""
    found = []
    for place in places(head.ranges, Scope(), 6 if name == "II" else 4):
        if holds(head.formula, Scope({**place, "z": z})):
            if len(place) != 1 or not place.keys() <= {"n", "d"}:
                raise MeaninglessError("no interval has a number")
            found += [place["d"]] if "d" in place else [numbers(name, place["n"])[half]]
    return found


def rest(entry: PaperEntry) -> Test:
    """Functions of Table 4 that are 0 in some intervals; the first ones are tried."""

    def cases(reading: Reading) -> Iterator[Case]:
        left, right = sides(reading.formula)
        if not isinstance(left, Call) or left.function.name != "g" or left.function.primes != 1:
            raise MeaninglessError(f"{latex(left)} is no derivative of g")
        for m in range(2, 6):
            stated = set()
            for j in range(1, _REST + 1):
                scope = Scope({"m": m, "j": j, "n": j - 1, "z": 1})
                for place in places([single_range("i", reading.ranges)], scope):
                    with scope.bind(place):
                        if scope.value(left.arguments[0]) == 1:
                            stated.add((*scope.indices(left.function), scope.value(right)))
            listed = [rod for letter, rod in functions("III", m) if letter == "g"]
            exact = EXACT["III"](m)
            true = {
                (i, j, 0)
                for i, j in product(listed, range(1, _REST + 1))
                if not any(exact.increment(source, "g", i, j) for source in exact.responses)
            }
            yield Case({"m": m, "claim": "rod, interval and value of g' at rest"}, sorted(stated), sorted(true))

    return Test("what the functions g of Table 4 gain in exact tables with equal floors, m = 2 ... 5", cases)


def coefficients(entry: PaperEntry) -> Test:
    """The list of coefficients, against those that the corrected forms have."""

    def cases(reading: Reading) -> Iterator[Case]:
        stated = [_shape(tree) for tree in items(reading.formula)]
        bodies = (
            tree.subscript[0]
            for tree in items(reading.formula)
            if isinstance(tree, Symbol) and len(tree.subscript) == 2
        )
        yield Case({"claim": "a letter for the body"}, all(isinstance(body, Symbol) for body in bodies), True)
        true = {_shape(tree) for name in FORMS for tree in symbols(right_form(name).step) if tree.superscript}
        yield Case({"claim": "coefficients: upper indices, lower ones"}, sorted(stated), sorted(true))

    return Test("the coefficients of (4.9), (4.10) and (4.12) as they run against the motion", cases)


def _shape(tree: Tree) -> tuple[str, str]:
    """The letters above, and those below, with a word for the body, which is a number or a letter."""
    match tree:
        case Symbol("F", subscript=()):
            below = "none"
        case Symbol("F", subscript=(Number(digits),)):
            below = digits
        case Symbol("F", subscript=(_, last)):
            below = f"body, {latex(last)}"
        case Symbol("F"):
            below = ", ".join(map(latex, tree.subscript))
        case _:
            raise MeaninglessError(f"{latex(tree)} is no coefficient")
    return ", ".join(map(latex, tree.superscript)), below


TESTS: Mapping[str, Callable[[PaperEntry], Test]] = {
    "cell": cell,
    "cells in text": cells_in_text,
    "coefficients": coefficients,
    "form": form,
    "form constant": definition,
    "function": function,
    "interval": interval,
    "part of form": part_of_form,
    "range": range_of_table,
    "rest": rest,
}
"""What is tried for a kind of record."""
