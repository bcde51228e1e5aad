"""Formulas within the text of section 4: which functions rest, the moments and powers of one column of Table 3, and
which coefficients the solutions have."""

from __future__ import annotations

from collections.abc import Iterator

from flint import fmpq

from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, items, sides, span
from wavesym.papers.exact_tables import building, drive
from wavesym.papers.exponentials import exponential
from wavesym.papers.pielorz1979 import limits
from wavesym.papers.pielorz1979.form_constants import acting, moments
from wavesym.papers.pielorz1979.forms import (
    FORMS,
    FormScope,
    corrected,
    moved,
    only,
    rates,
    right_form,
    shown,
)
from wavesym.papers.pielorz1979.transcript import paper
from wavesym.papers.record import Case, Reading, Test, case
from wavesym.papers.tree import Call, Number, Symbol, Tree, latex, symbols

SIZES = range(1, 6)
MOST_N = 4


def rest(entry: Entry) -> Test:
    """Adapter: functions of Table 4 that are 0 in some intervals; the intervals 1 ... MOST_N are tried."""
    return Test("what the functions g of Table 4 gain in exact tables with equal floors, m = 2 ... 5", _rest_cases)


def _rest_cases(reading: Reading) -> Iterator[Case]:
    left, right = sides(reading.formula)
    if not isinstance(left, Call) or left.function.name != "g" or left.function.primes != 1:
        raise MeaninglessError(f"{latex(left)} is no derivative of g")
    for m in range(2, 6):
        said = set()
        for j in range(1, MOST_N + 1):
            scope = Scope({"m": m, "j": j, "n": j - 1, "z": fmpq(1)})
            for i in span(only("i", reading.ranges), scope):
                with scope.binding({"i": i}):
                    rod, interval = scope.indices(left.function)
                    if scope.value(left.arguments[0]) == 1:
                        said.add((rod, interval, scope.value(right)))
        listed = [rod for letter, rod in limits.functions("III", m) if letter == "g"]
        true = {(i, j, 0) for i in listed for j in range(1, MOST_N + 1) if not building(m).alive("g", i, j)}
        yield Case({"m": m, "claim": "rod, interval and value of g' at rest"}, sorted(said), sorted(true))


def group(entry: Entry) -> Test:
    """Adapter: the moments of the first group, for f in the even half."""
    return Test("the moments that act in the even half from bodies on the left of the rod, m = 1 ... 5", _group_cases)


def _group_cases(reading: Reading) -> Iterator[Case]:
    left, right = sides(reading.formula)
    for m in SIZES:
        exact = drive(m)
        for i in range(1, m + 1):
            scope = FormScope(right_form("II"), moved("II", m), "f")
            before = tuple(s for s in acting(exact, "even", "f", i) if s - 1 <= i - 1)  # body s stands at x = s - 1
            with scope.binding({"i": i, "n": 0, "half": "even"}):
                at = {"m": m, "function": f"f_{i}", "claim": "moments"}
                yield case(at, lambda: _numbers(scope, reading, left, right), before)  # noqa: B023


def _numbers(scope: FormScope, reading: Reading, left: Tree, right: Tree) -> tuple[int, ...]:
    if left != Symbol("s"):
        raise MeaninglessError(f"{latex(left)} is no moment")
    found = []
    for r in span(only("r", reading.ranges), scope):
        with scope.binding({"r": r}):
            found.append(scope.whole(right))
    return tuple(found)


def power(entry: Entry) -> Test:
    """Adapter: a highest power of the first group, for f in the even half; together they have every l once."""
    others = [corrected(other) for other in paper().entries() if other.kind == "power" and other.id != entry.id]
    return Test(
        "highest powers of the exact tables, m = 1 ... 5, n = 0 ... 4; every l in one of the three ranges",
        lambda reading: _power_cases(reading, others),
    )


def _power_cases(reading: Reading, others: list[Reading]) -> Iterator[Case]:
    _, right = sides(reading.formula)
    letters = sorted(latex(sides(other.formula)[0]) for other in (reading, *others))
    yield Case({"claim": "letters"}, letters, ["K_{1}", "K_{2}", "K_{3}"])
    for m in SIZES:
        exact, known = drive(m), rates(drive(m))
        for i in range(1, m + 1):
            scope = FormScope(right_form("II"), moved("II", m), "f")
            for r, s in moments(scope, "even", i, (1,)):
                with scope.binding({"half": "even", "i": i, "r": r, "n": 0, limits.ALPHA: 1}):
                    bodies = sorted(
                        body for other in (reading, *others) for body in span(only("l", other.ranges), scope)
                    )
                    at = {"m": m, "function": f"f_{i}", "s": s}
                    yield Case({**at, "claim": "bodies l"}, bodies, sorted(known))
                    for n in range(MOST_N + 1):
                        for body in {*known} & {*span(only("l", reading.ranges), scope)}:
                            true = exact.degree("f", i, 2 * n + 1, known[body], f"M{s}")
                            with scope.binding({"n": n, "l": body}):
                                where = {**at, "n": n, "l": body}
                                told = shown(exact, "f", i, 2 * n + 1)
                                yield case(where, lambda: max(scope.whole(right), -1), true, true >= 0, told)  # noqa: B023


def factor(entry: Entry) -> Test:
    """Adapter: the exponential of example II at a power."""

    def cases(reading: Reading) -> Iterator[Case]:
        for m in (1, 2, 3):
            driven = moved("II", m)
            for i in range(1, m + 1):
                scope = FormScope(right_form("II"), driven, "f")
                for s, body in ((s, body) for s in range(1, m + 2) for body in range(1, m + 2)):
                    z = fmpq(9, 2)
                    since = z - driven.loads[f"M{s}"][0].time
                    bound = {"half": "even", "n": 0, "i": i, "l": body, "z": z, "s": s, "k": 0}
                    with scope.binding(bound):
                        at = {"m": m, "function": f"f_{i}", "s": s, "l": body}
                        true = exponential(-rates(driven.exact)[body] * since)
                        yield case(at, lambda: scope.value(reading.formula), true)  # noqa: B023

    return Test("the exponential of the body's rate since the interval began and the moment came", cases)


def coefficients(entry: Entry) -> Test:
    """Adapter: the list of coefficients, against those that the corrected forms have."""

    def cases(reading: Reading) -> Iterator[Case]:
        said = [_shape(tree) for tree in items(reading.formula)]
        bodies = (tree.below[0] for tree in items(reading.formula) if isinstance(tree, Symbol) and len(tree.below) == 2)
        yield Case({"claim": "a letter for the body"}, all(isinstance(body, Symbol) for body in bodies), True)
        true = {_shape(tree) for form in FORMS for tree in symbols(right_form(form).step) if tree.above}
        yield Case({"claim": "coefficients: upper indices, lower ones"}, sorted(said), sorted(true))

    return Test("the coefficients of (4.9), (4.10) and (4.12) as they run against the motion", cases)


def _shape(tree: Tree) -> tuple[str, str]:
    """The letters above, and those below, with a dot for the body, which is a number or a letter."""
    if not isinstance(tree, Symbol) or tree.name != "F":
        raise MeaninglessError(f"{latex(tree)} is no coefficient")
    match tree.below:
        case ():
            below = "none"
        case (Number(digits),):
            below = digits
        case (_, last):
            below = f"body, {latex(last)}"
        case _:
            below = ", ".join(map(latex, tree.below))
    return ", ".join(map(latex, tree.above)), below
