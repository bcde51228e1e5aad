"""(4.9), (4.10) and (4.12): the forms of the solutions, run as recurrences and compared with the motion.

A form says how a function goes on in an interval: F'_{i,n+1} from F'_{i,n}, from F'_{i,0} = 0 on. Its coefficients are
those of the exact tables, its limits the cells of Tables 2 to 4, corrected where they need it; all else is as it reads.
A coefficient beyond the highest power does not exist, so that a limit may be neither too low nor too high.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, replace
from functools import cache
from itertools import product, tee
from typing import Any

from flint import fmpq

from wavesym.exact.increments import Increment
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds, items, sides, span
from wavesym.papers.exact_tables import INTERVALS as TABULATED
from wavesym.papers.exact_tables import Exact, building, collision, drive
from wavesym.papers.mutations import ends
from wavesym.papers.pielorz1979 import limits
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.transcription import entry as transcribed
from wavesym.papers.pielorz1979.transcription import paper
from wavesym.papers.pielorz1979.truth import Driven, loads
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Example, Reading, Test, by_size, case
from wavesym.papers.tree import Call, Symbol, Tree, latex

INTERVALS = {"I": 4, "II": 2, "III": 4}
"""The numbers n = 0, 1, ... that are tried; for each, example II has two intervals."""
SIZES = {"I": (4, 6, 8), "II": (1, 2, 3), "III": (2, 3, 4)}
_TABLES: Mapping[str, Callable[[int], Exact]] = {"I": collision, "II": drive, "III": building}
_WITHIN = (fmpq(0), fmpq(5, 7))
"""Where formulas are compared, as parts of an interval: at its start and inside."""


_LIMITING = ("n", "half", "i", limits.ALPHA, "j", "r", "l")
Definitions = Mapping[tuple[str, tuple[int, ...]], Tree]
"""L_0, r_0 and r_1, by letter and index."""


@cache
def moved(name: str, m: int) -> Driven:
    """An example under loads of several pieces; the building has equal floors, as (4.12) says."""
    exact = _TABLES[name](m)
    return Driven(exact, loads(exact))


def rates(exact: Exact) -> dict[int, fmpq]:
    """The rates of the bodies, by the number that kappa or gamma has for them: half of what both rods do to a body."""
    first = 1 if exact.interval == 1 else 0
    return {x + first: fmpq(node.radiation) for x, node in enumerate(exact.chain.nodes) if node.inertia}


@dataclass(frozen=True)
class Form:
    """A form as it reads: the step from interval to interval, the start, and the numbers n that it is said for."""

    name: str
    step: Tree
    start: Tree
    numbers: Tree

    @classmethod
    def of(cls, name: str, reading: Reading) -> Form:
        """MeaninglessError where it is none."""
        if len(found := items(reading.formula)) != 2:
            raise MeaninglessError("a form is two equations")
        return cls(name, *found, *reading.ranges)


class FormScope(Scope):
    """What the letters of a form mean for the functions f or g of a chain under loads.

    `definitions` are L_0, r_0 and r_1, by letter and index; `coefficient` is what F with indices is, the true one if
    nothing else is said.
    """

    def __init__(self, form: Form, driven: Driven, letter: str, definitions: Definitions | None = None) -> None:
        super().__init__({"m": driven.exact.m})
        self._form, self._driven, self._letter = form, driven, letter
        self._definitions = definitions or read_definitions()
        self._equations: dict[int, list[tuple[Tree, dict[str, Any], tuple[int, ...]]]] = {}
        self._totals: dict[tuple[int, int, fmpq], Any] = {}
        self._known: dict[tuple[Any, ...], Any] = {}
        self._open: set[tuple[int, int, fmpq]] = set()
        self._rates = rates(driven.exact)

    def total(self, rod: int, number: int, z: fmpq) -> Any:
        """F' of a rod at z as the form of interval 1, 2, ... has it; MeaninglessError."""
        key = rod, number, z
        if key in self._open:
            raise MeaninglessError(f"F'_{{{rod}, {number}}} is given by itself")
        if key not in self._totals:
            self._open.add(key)
            try:
                self._totals[key] = self._given(rod, number, z)
            finally:
                self._open.discard(key)
        return self._totals[key]

    def _given(self, rod: int, number: int, z: fmpq) -> Any:
        if rod not in self._equations:
            self._equations[rod] = list(self._for(rod))
        found = []
        for equation, place, given in self._equations[rod]:
            left, right = sides(equation)
            with self.binding({**place, "z": z}):
                if given == (rod, number) and self.value(left.arguments[0]) == z:  # type: ignore[union-attr]
                    found.append((right, self.bound))
        if len(found) != 1:
            raise MeaninglessError(f"F'_{{{rod}, {number}}} is given {len(found)} times")
        ((right, bound),) = found
        with self.binding(bound):
            return self.value(right)

    def _for(self, rod: int) -> Iterator[tuple[Tree, dict[str, Any], tuple[int, ...]]]:
        """The equations for a rod, each with its place and the indices of what it gives."""
        numbers = span(self._form.numbers, self, most=INTERVALS[self._form.name])
        halves = limits.HALVES if self._form.name == "II" else (None,)
        places: list[dict[str, Any]] = [{"i": rod, "n": n, "half": half} for n in numbers for half in halves]
        for equation, place in ((self._form.start, {"i": rod}), *((self._form.step, place) for place in places)):
            with self.binding(place):
                yield equation, place, self.indices(_derivative(sides(equation)[0]).function)

    def call(self, call: Call) -> Any:
        """F' itself: what the form gives for another interval."""
        rod, number = self.indices(_derivative(call).function)
        return self.total(rod, number, fmpq(self.value(call.arguments[0])))

    def symbol(self, symbol: Symbol) -> Any:
        """Coefficients, loads, rates, and the cells of the tables."""
        name, indices = symbol.name, self.indices(symbol)
        chain = self._driven.exact.chain
        if name == "F" and symbol.above:
            return self.coefficient(indices, self.upper(symbol))
        if symbol.accent == r"\bar" and name == "M" and len(indices) == 2:
            return self._driven.piece(f"M{indices[0]}", indices[1]).weight
        if symbol.accent or symbol.above or symbol.primes:
            return super().symbol(symbol)
        if name == r"\kappa" and len(indices) == 1 and self._form.name != "II":
            return _known(chain.parameters.kappa, indices[0], r"\kappa")
        if name == r"\gamma" and len(indices) == 1 and self._form.name == "II":
            return _known(self._rates, indices[0], r"\gamma")
        if name == r"\tau" and indices:
            return self._driven.piece(
                *((f"M{indices[0]}", indices[1]) if len(indices) == 2 else ("a", indices[0]))
            ).time
        if name == "m" and len(indices) == 1:
            return self._last(indices[0])
        return self.value(self._cell(symbol, indices)) if name == "w" else self._limit(symbol, indices)

    def _limit(self, symbol: Symbol, indices: tuple[int, ...]) -> Any:
        """A limit of a sum or an end of a range, kept for the letters that it may depend on."""
        key = symbol.name, indices, *map(self.bound.get, _LIMITING)
        if key not in self._known:
            self._known[key] = self.value(self._cell(symbol, indices))
        return self._known[key]

    def _cell(self, symbol: Symbol, indices: tuple[int, ...]) -> Tree:
        if (symbol.name, indices) in self._definitions:
            return self._definitions[symbol.name, indices]
        return limits.cell(self._form.name, self._letter, symbol, self)

    def _last(self, index: int) -> int:
        """m_s and m_1: the number of the last piece of a load."""
        source = f"M{index}" if self._form.name == "II" else "a"
        if source not in self._driven.loads or (source == "a" and index != 1):
            raise MeaninglessError(f"m_{index} is not defined")
        return len(self._driven.loads[source]) - 1

    def coefficient(self, lower: tuple[int, ...], upper: tuple[int, ...]) -> fmpq:
        """The coefficient with these indices; MeaninglessError where there is none."""
        increment = self._increment(upper)
        if len(lower) < 2:  # of the family with rate 0, where 0 is as good as none
            (power,) = (0,) if not lower else (1,) if lower == (0,) else (None,)
            powers = increment.get(fmpq(0), [])
            if power is None:
                raise MeaninglessError(f"F_{lower[0]} is not defined")
            return powers[power] if power < len(powers) else fmpq(0)
        body, power = lower
        powers = increment.get(_known(self._rates, body, "the rate"), [])
        if not 0 <= power < len(powers):
            raise MeaninglessError(f"there is no coefficient of power {power} at the rate of body {body}")
        return powers[power]

    def _increment(self, upper: tuple[int, ...]) -> Increment:
        name = self._form.name
        if len(upper) != {"I": 2, "II": 3, "III": 3}[name]:
            raise MeaninglessError(f"coefficients of example {name} do not have {len(upper)} upper indices")
        if name == "III":
            return self._driven.gain(self._letter, upper[1], upper[2], "ab", upper[0])
        return self._driven.gain(self._letter, upper[0], upper[-1], "impact" if name == "I" else f"M{upper[1]}")


def _derivative(tree: Tree) -> Call:
    """F' with two indices, of one argument."""
    if isinstance(tree, Call) and len(tree.arguments) == 1:
        function = tree.function
        if function.name == "F" and function.primes == 1 and len(function.below) == 2:
            return tree
    raise MeaninglessError(f"{latex(tree)} is no derivative of a function")


def _known(values: Mapping[int, Any], index: int, name: str) -> Any:
    if index not in values:
        raise MeaninglessError(f"{name} has no number {index}")
    return values[index]


def form(entry: Entry) -> Test:
    """Adapter: a form whole, for all functions of its table."""
    name = entry.about["example"]
    return Test(
        "the motion, exact, under loads with several delayed pieces; "
        f"m = {', '.join(map(str, SIZES[name]))}; coefficients of the exact tables, limits of the corrected tables",
        lambda reading: copy(_kept(Form.of(name, reading))),
    )


@cache
def _kept(form: Form) -> Iterator[Case]:
    """The cases of a form; what copies of this iterator reach is kept, as some records differ in what is printed only."""
    (cases,) = tee(form_cases(form), 1)
    return cases


def form_cases(
    form: Form, definitions: Definitions | None = None, scope: type[FormScope] | None = None
) -> Iterator[Case]:
    """All functions of the form's table at the starts of the first intervals and inside, then in the last interval.

    A value there has the increments of all intervals in it, and exponentials of different exponents are independent.
    """
    scopes: dict[tuple[int, str], FormScope] = {}
    most = INTERVALS[form.name]
    for m, n in by_size((m, n) for m in SIZES[form.name] for n in (0, 1, most)):
        driven = moved(form.name, m)
        for letter, rod in limits.functions(form.name, m):
            made = scopes.setdefault((m, letter), (scope or FormScope)(form, driven, letter, definitions))
            for start, number in list(starts(form.name, n))[-1 if n == most else 0 :]:
                for part in _WITHIN if n < most else _WITHIN[1:]:
                    yield _compared(made, driven, (letter, rod), number, start + part * driven.exact.interval)


def starts(name: str, n: int) -> Iterator[tuple[int, int]]:
    """Where the intervals of a number n begin, with their own numbers 1, 2, ..."""
    yield from ((2 * n, 2 * n + 1), (2 * n + 1, 2 * n + 2)) if name == "II" else ((2 * n, n + 1),)


def _compared(scope: FormScope, driven: Driven, function: tuple[str, int], number: int, z: fmpq) -> Case:
    letter, rod = function
    true = driven.wave(letter, rod, z)
    at = {"m": driven.exact.m, "function": f"{letter}'_{rod}", "z": z, "interval": number}
    return case(at, lambda: scope.total(rod, number, z), true, true != 0, _shown(driven, letter, rod, number))


def _shown(driven: Driven, letter: str, rod: int, number: int) -> Callable[[], Example]:
    place = f"{rod - 1}+" if letter == "f" else f"{rod}-"
    return example(
        driven.exact,
        driven.loads,
        driven.exact.interval * number + driven.exact.m,
        {"velocity": [place]},
        "wavesym tables SCENE",
        f"{letter} of rod {rod}, interval {number}: its rates and coefficients",
    )


def interval(entry: Entry) -> Test:
    """Adapter: where z lies when a form is said to hold."""
    told = transcribed(entry.about["form"])
    name = told.about["example"]
    right = Form.of(name, corrected(told))

    def read(text: str, ranges: Iterable[str]) -> Reading:
        return Reading(read_range(text), tuple(map(read_range, ranges)))

    return Test(
        f"{told.id} as corrected in every interval that z is said to lie in, against the motion; inside of intervals, "
        "every z in one of them",
        lambda reading: _interval_cases(right, reading),
        read,
        lambda reading: _interval_faults(reading),
    )


def _interval_faults(reading: Reading) -> Iterator[tuple[str, Reading]]:
    for change, wrong in ends(reading.formula):
        yield change, replace(reading, formula=wrong)
    for change, wrong in ends(reading.ranges[0]):
        yield change, replace(reading, ranges=(wrong,))


def _interval_cases(form: Form, reading: Reading) -> Iterator[Case]:
    (numbers,) = reading.ranges
    step = items(form.step)[0]
    left = sides(step)[0]
    assert isinstance(left, Call)
    for m in SIZES[form.name][1:2]:
        driven = moved(form.name, m)
        for letter, rod in limits.functions(form.name, m):
            scope = FormScope(form, driven, letter)
            until, most = (4, 6) if form.name == "II" else (6, 4)
            for z in (start + part for start in range(until) for part in _WITHIN):
                inside = []
                for value in span(numbers, scope, most=most):
                    variable = latex(numbers.variable)  # type: ignore[union-attr]
                    with scope.binding({variable: value, "z": z, "i": rod}):
                        if holds(reading.formula, scope):
                            inside.append(value if variable == "d" else scope.whole(left.function.below[1]))
                if z.denom() != 1:
                    yield Case({"z": z, "claim": "in one interval"}, len(inside), 1)
                for number in inside:
                    yield _compared(scope, driven, (letter, rod), number, z)


class RateScope(Scope):
    """kappa and J of a drive."""

    def __init__(self, exact: Exact) -> None:
        super().__init__({"m": exact.m})
        self._parameters = exact.chain.parameters

    def symbol(self, symbol: Symbol) -> Any:
        """kappa_i or J_i."""
        known = {r"\kappa": self._parameters.kappa, "J": self._parameters.inertia}.get(symbol.name)
        if known is None or len(symbol.below) != 1:
            return super().symbol(symbol)
        return _known(known, self.indices(symbol)[0], symbol.name)


def rate(entry: Entry) -> Test:
    """Adapter: gamma_i; the formulas of (4.11) together give every one once."""
    others = [corrected(other) for other in paper().entries() if other.kind == "rate" and other.id != entry.id]
    return Test(
        "the rates of the discs by their derived node laws, m = 1 ... 5",
        lambda reading: _rate_cases(reading, others),
    )


def _rate_cases(reading: Reading, others: Iterable[Reading]) -> Iterator[Case]:
    for m in range(1, 6):
        exact = drive(m)
        scope = RateScope(exact)
        true = rates(exact)
        parameters = {"kappa": dict(exact.chain.parameters.kappa), "J": dict(exact.chain.parameters.inertia)}
        given = [number for other in (reading, *others) for number, _ in _rates_given(other, scope)]
        yield Case({"m": m, "claim": "the gamma that are given"}, sorted(given), sorted(true))
        for number, value in _rates_given(reading, scope):
            yield case({"m": m, "i": number, **parameters}, value, true.get(number))


def _rates_given(reading: Reading, scope: RateScope) -> list[tuple[int, Callable[[], Any]]]:
    """The number of every gamma, and what makes its value; once where the left index has no i, else for every i."""
    found = []
    for equation in items(reading.formula):
        left, right = sides(equation)
        if not isinstance(left, Symbol) or left.name != r"\gamma":
            raise MeaninglessError(f"{latex(left)} is no gamma")
        plain = _means(left, scope)
        for place in [{}] if plain else [{"i": i} for i in span(reading.ranges[0], scope)]:
            with scope.binding(place):
                found.append((scope.indices(left)[0], _later(scope, place, right)))
    return found


def _means(left: Symbol, scope: RateScope) -> bool:
    try:
        scope.indices(left)
    except MeaninglessError:
        return False
    return True


def _later(scope: RateScope, place: Mapping[str, int], tree: Tree) -> Callable[[], Any]:
    def value() -> Any:
        with scope.binding(place):
            return scope.value(tree)

    return value


def definition(entry: Entry) -> Test:
    """Adapter: L_0, r_0 and r_1, by what Table 3 makes of them."""
    form = Form.of("II", corrected(transcribed("(4.10)")))

    def cases(reading: Reading) -> Iterator[Case]:
        known = {**read_definitions(), **_defined(reading)}
        if len(known) > len(read_definitions()):
            raise MeaninglessError(f"{latex(reading.formula)} defines what is used nowhere")
        if entry.id == "(4.10).L_0":
            yield from form_cases(form, known)
        else:
            yield from _moment_cases(form, known)

    against = "the motion, by (4.10)" if entry.id == "(4.10).L_0" else "the moments that act in a half, by exact tables"
    return Test(against, cases)


def _moment_cases(form: Form, known: Definitions) -> Iterator[Case]:
    """r from s_1 to R_2 counts the moments that act in a half, each once."""
    for m in range(1, 6):
        driven = moved("II", m)
        for half, (letter, rod) in product(limits.HALVES, limits.functions("II", m)):
            scope = FormScope(form, driven, letter, known)
            at = {"m": m, "half": half, "function": f"{letter}_{rod}", "claim": "moments s"}
            true = acting(driven.exact, half, letter, rod)
            yield case(at, lambda: tuple(s for _, s in moments(scope, half, rod)), true)  # noqa: B023


def moments(scope: FormScope, half: str, rod: int, parts: tuple[int, ...] = (1, 2)) -> list[tuple[int, int]]:
    """The r and s that Table 3 has in a half, in the order of their parts alpha."""
    found = []
    for alpha in parts:
        with scope.binding({"n": 0, "half": half, "i": rod, limits.ALPHA: alpha}):
            first, last = (scope.whole(read_formula(rf"{end}_\alpha")) for end in "sR")
            for r in range(first, last + 1):
                with scope.binding({"r": r}):
                    found.append((r, scope.whole(read_formula("s"))))
    return found


def acting(exact: Exact, half: str, letter: str, rod: int) -> tuple[int, ...]:
    """The moments that change a function in some interval of a half, in their order."""
    numbers = range(1 if half == "even" else 2, TABULATED["II"] + 1, 2)
    return tuple(
        s for s in range(1, exact.m + 2) if any(exact.increment(f"M{s}", letter, rod, number) for number in numbers)
    )


def corrected(entry: Entry) -> Reading:
    """A record as it holds."""
    text, ranges = (entry.slip.corrected, entry.slip.ranges) if entry.slip else (entry.printed, None)
    said = entry.ranges if ranges is None else ranges
    return Reading(read_formula(text), tuple(map(read_range, (*said, *entry.inferred))))


@cache
def read_definitions() -> Definitions:
    """L_0, r_0 and r_1 as they hold."""
    return {
        key: tree
        for entry in paper().entries()
        if entry.kind == "definition"
        for key, tree in _defined(corrected(entry)).items()
    }


def _defined(reading: Reading) -> Definitions:
    left, right = sides(reading.formula)
    if not isinstance(left, Symbol):
        raise MeaninglessError(f"{latex(left)} is no letter")
    return {(left.name, Scope().indices(left)): right}
