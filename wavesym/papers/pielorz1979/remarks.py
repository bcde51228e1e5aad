"""Formulas within the text of section 4: which functions rest, H, the moments and powers of one column of Table 3,
and which coefficients the solutions have."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

from flint import fmpq

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, given, items, places, sides, span
from wavesym.papers.exact_tables import building, drive
from wavesym.papers.exponentials import exponential
from wavesym.papers.pielorz1979.cells import counted
from wavesym.papers.pielorz1979.equations import within
from wavesym.papers.pielorz1979.forms import FORMS, FormScope, form_cases, moved, only, rates, right_form, shown
from wavesym.papers.pielorz1979.tabled import ALPHA, functions
from wavesym.papers.pielorz1979.transcript import ids, settled
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Reading, Test, case
from wavesym.papers.tree import Call, Number, Symbol, Tree, latex, replaced, symbols

MOST_N = 4


def rest(entry: PaperEntry) -> Test:
    """Functions of Table 4 that are 0 in some intervals; the intervals 1 ... MOST_N are tried."""

    def cases(reading: Reading) -> Iterator[Case]:
        left, right = sides(reading.formula)
        if not isinstance(left, Call) or left.function.name != "g" or left.function.primes != 1:
            raise MeaninglessError(f"{latex(left)} is no derivative of g")
        for m in range(2, 6):
            said = set()
            for j in range(1, MOST_N + 1):
                scope = Scope({"m": m, "j": j, "n": j - 1, "z": fmpq(1)})
                for place in places([only("i", reading.ranges)], scope):
                    with scope.binding(place):
                        if scope.value(left.arguments[0]) == 1:
                            said.add((*scope.indices(left.function), scope.value(right)))
            listed = [rod for letter, rod in functions("III", m) if letter == "g"]
            true = {(i, j, 0) for i in listed for j in range(1, MOST_N + 1) if not building(m).alive("g", i, j)}
            yield Case({"m": m, "claim": "rod, interval and value of g' at rest"}, sorted(said), sorted(true))

    return Test("what the functions g of Table 4 gain in exact tables with equal floors, m = 2 ... 5", cases)


def _columns() -> Iterator[tuple[int, int, FormScope]]:
    """f in the even half of Table 3: m, i, and the scope at i and n = 0."""
    for m in range(1, 6):
        for i in range(1, m + 1):
            scope = FormScope(right_form("II"), moved("II", m), "f")
            with scope.binding({"i": i, "n": 0, "half": "even"}):
                yield m, i, scope


def moments(scope: FormScope, half: str, rod: int, alpha: int) -> list[tuple[int, int]]:
    """The r and s that Table 3 has in a part of a half."""
    found = []
    with scope.binding({"n": 0, "half": half, "i": rod, ALPHA: alpha}):
        first, last = (scope.whole(read_formula(rf"{end}_\alpha")) for end in "sR")
        for r in range(first, last + 1):
            with scope.binding({"r": r}):
                found.append((r, scope.whole(read_formula("s"))))
    return found


def group(entry: PaperEntry) -> Test:
    """The moments of the first group, for f in the even half."""

    def cases(reading: Reading) -> Iterator[Case]:
        left, right = sides(reading.formula)
        if left != Symbol("s"):
            raise MeaninglessError(f"{latex(left)} is no moment")
        for m, i, scope in _columns():
            before = tuple(s for s in counted("II", m).acting("even", "f", i) if s <= i)  # body s stands at x = s - 1
            found = []
            for place in places([only("r", reading.ranges)], scope):
                with scope.binding(place):
                    found.append(scope.whole(right))
            yield Case({"m": m, "function": f"f_{i}", "claim": "moments"}, tuple(found), before)

    return Test("the moments that act in the even half from bodies on the left of the rod, m = 1 ... 5", cases)


def power(entry: PaperEntry) -> Test:
    """A highest power of the first group, for f in the even half; together they have every l once."""
    others = [settled(id) for id in ids("power") if id != entry.id]

    def cases(reading: Reading) -> Iterator[Case]:
        _, right = sides(reading.formula)
        letters = sorted(latex(sides(other.formula)[0]) for other in (reading, *others))
        yield Case({"claim": "letters"}, letters, ["K_{1}", "K_{2}", "K_{3}"])
        for m, i, scope in _columns():
            exact, known = drive(m), rates(drive(m))
            for r, s in moments(scope, "even", i, 1):
                at = {"m": m, "function": f"f_{i}", "s": s}
                with scope.binding({"r": r, ALPHA: 1}):
                    own = span(only("l", reading.ranges), scope)
                    bodies = [*own, *(body for other in others for body in span(only("l", other.ranges), scope))]
                    yield Case({**at, "claim": "bodies l"}, sorted(bodies), sorted(known))
                    for n, body in product(range(MOST_N + 1), sorted({*known} & {*own})):
                        true = exact.degree("f", i, 2 * n + 1, known[body], f"M{s}")
                        with scope.binding({"n": n, "l": body}):
                            said = max(scope.whole(right), -1)
                        told = shown(exact, ("f", i), 2 * n + 1)
                        yield Case({**at, "n": n, "l": body}, said, true, true >= 0, told)

    return Test(
        "highest powers of the exact tables, m = 1 ... 5, n = 0 ... 4; every l in one of the three ranges", cases
    )


def heaviside(entry: PaperEntry) -> Test:
    """H in (4.12), with the H(0) of its range; with 0 and with 1 where there is none."""

    def cases(reading: Reading) -> Iterator[Case]:
        at_0 = [int(Scope().value(value)) for left, value in given(reading.ranges).items() if left == _AT_0]
        if len(at_0) != len(reading.ranges):
            raise MeaninglessError("a range of something else")
        form = right_form("III")
        (own,) = {part for part in within(form.step) if isinstance(part, Call) and part.function == Symbol("H")}
        tried = replace(form, step=replaced(form.step, own, reading.formula))
        for value in at_0 or (0, 1):
            scope = type("At0", (FormScope,), {"heaviside_at_0": value})
            for found in form_cases(tried, scope=scope):
                yield replace(found, at={"H(0)": value, **found.at})

    one = read_range("H(0) = 1")
    return Test(
        "the motion, by (4.12) with it",
        cases,
        conventions={"H(0) = 1": lambda reading: cases(Reading(reading.formula, (one,)))},
    )


_AT_0 = read_formula("H(0)")


def factor(entry: PaperEntry) -> Test:
    """The exponential of example II at a power."""

    def cases(reading: Reading) -> Iterator[Case]:
        z = fmpq(9, 2)
        for m, i, scope in _columns():
            driven = moved("II", m)
            for s, body in product(range(1, m + 2), repeat=2) if m < 4 else ():
                true = exponential(-rates(driven.exact)[body] * (z - driven.loads[f"M{s}"][0].time))
                with scope.binding({"l": body, "z": z, "s": s, "k": 0}):
                    at = {"m": m, "function": f"f_{i}", "s": s, "l": body}
                    yield case(at, lambda: scope.value(reading.formula), true)  # noqa: B023

    return Test("the exponential of the body's rate since the interval began and the moment came", cases)


def coefficients(entry: PaperEntry) -> Test:
    """The list of coefficients, against those that the corrected forms have."""

    def cases(reading: Reading) -> Iterator[Case]:
        said = [_shape(tree) for tree in items(reading.formula)]
        bodies = (tree.below[0] for tree in items(reading.formula) if isinstance(tree, Symbol) and len(tree.below) == 2)
        yield Case({"claim": "a letter for the body"}, all(isinstance(body, Symbol) for body in bodies), True)
        true = {_shape(tree) for form in FORMS for tree in symbols(right_form(form).step) if tree.above}
        yield Case({"claim": "coefficients: upper indices, lower ones"}, sorted(said), sorted(true))

    return Test("the coefficients of (4.9), (4.10) and (4.12) as they run against the motion", cases)


def _shape(tree: Tree) -> tuple[str, str]:
    """The letters above, and those below, with a word for the body, which is a number or a letter."""
    match tree:
        case Symbol("F", below=()):
            below = "none"
        case Symbol("F", below=(Number(digits),)):
            below = digits
        case Symbol("F", below=(_, last)):
            below = f"body, {latex(last)}"
        case Symbol("F"):
            below = ", ".join(map(latex, tree.below))
        case _:
            raise MeaninglessError(f"{latex(tree)} is no coefficient")
    return ", ".join(map(latex, tree.above)), below
