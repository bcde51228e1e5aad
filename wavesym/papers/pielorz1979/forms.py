"""(4.9), (4.10) and (4.12): the forms of the solutions, run as recurrences and compared with the motion.

A form says how a function goes on in an interval: F'_{i,n+1} from F'_{i,n}, from F'_{i,0} = 0 on. Its coefficients are
those of the exact tables, its limits the cells of Tables 2 to 4, corrected where they need it; all else is as it reads.
A coefficient beyond the highest power does not exist, so that a limit may be neither too low nor too high.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cache
from itertools import tee
from typing import Any, NamedTuple

from flint import fmpq

from wavesym.exact.increments import Increment
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds, items, sides, span
from wavesym.papers.exact_tables import Exact, building, collision, drive
from wavesym.papers.mutations import ends
from wavesym.papers.pielorz1979 import limits
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.transcript import entry as transcribed
from wavesym.papers.pielorz1979.transcript import paper
from wavesym.papers.pielorz1979.truth import Driven, loads
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Example, Reading, Test, by_size, case
from wavesym.papers.tree import Call, Progression, Symbol, Tree, latex

INTERVALS = {"I": 4, "II": 2, "III": 4}
"""The numbers n = 0, 1, ... that are tried; for each, example II has two intervals."""
SIZES = {"I": (4, 6, 8), "II": (1, 2, 3), "III": (2, 3, 4)}
_TABLES: Mapping[str, Callable[[int], Exact]] = {"I": collision, "II": drive, "III": building}
_WITHIN = (fmpq(0), fmpq(5, 7))
"""Where formulas are compared, as parts of an interval: at its start and inside."""

_LIMITING = ("n", "half", "i", limits.ALPHA, "j", "r", "l")
Words = Mapping[str, str]
"""The words of a sentence, by their places."""
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
        found = items(reading.formula)
        if len(found) != 2:
            raise MeaninglessError("a form is two equations")
        return cls(name, *found, only("n", reading.ranges))


class _Given(NamedTuple):
    """An equation at a place: the indices of the F' that it gives, its argument, and what it is."""

    indices: tuple[int, ...]
    argument: Tree
    right: Tree
    place: Mapping[str, Any]


class FormScope(Scope):
    """What the letters of a form mean for the functions f or g of a chain under loads.

    `definitions` are L_0, r_0 and r_1, by letter and index; `coefficient` is what F with indices is, the true one if
    nothing else is said.
    """

    def __init__(self, form: Form, driven: Driven, letter: str, definitions: Definitions | None = None) -> None:
        super().__init__({"m": driven.exact.m})
        self._form, self._driven, self._letter = form, driven, letter
        self._definitions = definitions or read_definitions()
        self._equations: dict[int, list[_Given]] = {}
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
        for given, argument, right, place in self._equations[rod]:
            with self.binding({**place, "z": z}):
                if given == (rod, number) and self.value(argument) == z:
                    found.append((right, self.bound))
        if len(found) != 1:
            raise MeaninglessError(f"F'_{{{rod}, {number}}} is given {len(found)} times")
        ((right, bound),) = found
        with self.binding(bound):
            return self.value(right)

    def _for(self, rod: int) -> Iterator[_Given]:
        """The equations for a rod."""
        numbers = span(self._form.numbers, self, most=INTERVALS[self._form.name])
        halves = limits.HALVES if self._form.name == "II" else (None,)
        places: list[dict[str, Any]] = [{"i": rod, "n": n, "half": half} for n in numbers for half in halves]
        for equation, place in ((self._form.start, {"i": rod}), *((self._form.step, place) for place in places)):
            left, right = sides(equation)
            call = _derivative(left)
            with self.binding(place):
                yield _Given(self.indices(call.function), call.arguments[0], right, place)

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
            return known(chain.parameters.kappa, indices[0], r"\kappa")
        if name == r"\gamma" and len(indices) == 1 and self._form.name == "II":
            return known(self._rates, indices[0], r"\gamma")
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
        powers = increment.get(known(self._rates, body, "the rate"), [])
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


def known(values: Mapping[int, Any], index: int, name: str) -> Any:
    """A value by its number; MeaninglessError where there is none."""
    if index not in values:
        raise MeaninglessError(f"{name} has no number {index}")
    return values[index]


def only(letters: str, ranges: Sequence[Tree]) -> Progression:
    """The one range that there must be, of one of some letters; MeaninglessError."""
    if len(ranges) == 1 and isinstance(ranges[0], Progression) and latex(ranges[0].variable) in letters:
        return ranges[0]
    raise MeaninglessError(f"the range of {letters} is not given")


def form(entry: Entry) -> Test:
    """Adapter: a form whole, for all functions of its table."""
    name = entry.about["example"]

    def cases(reading: Reading) -> Iterator[Case]:
        yield from copy(_kept(Form.of(name, reading)))

    return Test(
        "the motion, exact, under loads with several delayed pieces; "
        f"m = {', '.join(map(str, SIZES[name]))}; coefficients of the exact tables, limits of the corrected tables",
        cases,
    )


@cache
def _kept(form: Form) -> Iterator[Case]:
    """The cases of a form; what copies of this iterator reach is kept, as some records differ only as printed."""
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
    return case(at, lambda: scope.total(rod, number, z), true, true != 0, shown(driven.exact, letter, rod, number))


def shown(exact: Exact, letter: str, rod: int, number: int) -> Callable[[], Example]:
    """The scene of a chain under its loads, and where its table has what a function gains in an interval."""
    return lambda: example(
        exact,
        loads(exact),
        exact.interval * number + exact.m,
        {"velocity": [f"{rod - 1}+" if letter == "f" else f"{rod}-"]},
        "wavesym tables SCENE",
        f"{letter} of rod {rod}, interval {number}: its rates and coefficients",
    )()


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
    numbers = only("nd", reading.ranges)
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
                    variable = latex(numbers.variable)
                    with scope.binding({variable: value, "z": z, "i": rod}):
                        if holds(reading.formula, scope):
                            inside.append(value if variable == "d" else scope.whole(left.function.below[1]))
                if z.denom() != 1:
                    yield Case({"z": z, "claim": "in one interval"}, len(inside), 1)
                for number in inside:
                    yield _compared(scope, driven, (letter, rod), number, z)


def corrected(entry: Entry) -> Reading:
    """A record as it holds."""
    text, ranges = (entry.slip.corrected, entry.slip.ranges) if entry.slip else (entry.printed, None)
    said = entry.ranges if ranges is None else ranges
    return Reading(read_formula(text), tuple(map(read_range, (*said, *entry.inferred))))


FORMS = {"I": "(4.9)", "II": "(4.10)", "III": "(4.12)"}
"""The form of each example's solutions."""


@cache
def right_form(example: str) -> Form:
    """The form of an example's solutions as corrected."""
    return Form.of(example, corrected(transcribed(FORMS[example])))


@cache
def read_definitions() -> Definitions:
    """L_0, r_0 and r_1 as they hold."""
    return {
        key: tree
        for entry in paper().entries()
        if entry.kind == "form constant"
        for key, tree in defined(corrected(entry)).items()
    }


def defined(reading: Reading) -> Definitions:
    """What an equation defines."""
    left, right = sides(reading.formula)
    if not isinstance(left, Symbol):
        raise MeaninglessError(f"{latex(left)} is no letter")
    return {(left.name, Scope().indices(left)): right}
