"""(4.9), (4.10) and (4.12): the forms of the solutions, run as recurrences and compared with the motion.

A form says how a function goes on in an interval: F'_{i,n+1} from F'_{i,n}, from F'_{i,0} = 0 on. Its coefficients are
those of the exact tables, its limits the cells of Tables 2 to 4, corrected where they need it; all else is as it reads.
A coefficient beyond the highest power does not exist, so that a limit may be neither too low nor too high.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cache
from itertools import tee
from typing import Any

from flint import fmpq

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, items, places, sides
from wavesym.papers.exact_tables import Exact, building, collision, drive
from wavesym.papers.pielorz1979 import tabled
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.tabled import Tried
from wavesym.papers.pielorz1979.transcript import settled
from wavesym.papers.pielorz1979.truth import DrivenChain, loads
from wavesym.papers.record import Case, Reading, Reproduction, Test, by_size, case
from wavesym.papers.tree import Call, Progression, Symbol, Tree, latex

FORMS = {"I": "(4.9)", "II": "(4.10)", "III": "(4.12)"}
"""The form of each example's solutions."""
INTERVALS = {"I": 4, "II": 2, "III": 4}
"""The numbers n = 0, 1, ... that are tried; for each, example II has two intervals."""
SIZES = {"I": (4, 6, 8), "II": (1, 2, 3), "III": (2, 3, 4)}
TABLES: Mapping[str, Callable[[int], Exact]] = {"I": collision, "II": drive, "III": building}
WITHIN = (fmpq(0), fmpq(5, 7))
"""Where formulas are compared, as parts of an interval: at its start and inside."""


@cache
def moved(name: str, m: int) -> DrivenChain:
    """An example under loads of several pieces; the building has equal floors, as (4.12) says."""
    exact = TABLES[name](m)
    return DrivenChain(exact, loads(exact))


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


@cache
def right_form(name: str) -> Form:
    """The form of an example's solutions as corrected."""
    return Form.of(name, settled(FORMS[name]))


class FormScope(Scope):
    """What the letters of a form mean for the functions f or g of a chain under loads.

    `tried` are cells and definitions that are not taken as they are right.
    """

    def __init__(
        self, form: Form, driven: DrivenChain, letter: str, tried: Tried | None = None, most_n: int | None = None
    ) -> None:
        super().__init__({"m": driven.exact.m})
        self._form, self._driven, self._letter, self._tried = form, driven, letter, tried or {}
        self._most_n = INTERVALS[form.name] if most_n is None else most_n
        self._places: dict[int, list[tuple[tuple[int, ...], Tree, Tree, dict[str, Any]]]] = {}
        self._totals: dict[tuple[int, int, int, int], Any] = {}
        self._limits: dict[tuple[Any, ...], tabled.Limit] = {}
        self._rates = rates(driven.exact)

    def total(self, rod: int, number: int, z: fmpq) -> Any:
        """F' of a rod at z as the form of interval 1, 2, ... has it; MeaninglessError."""
        key = rod, number, int(z.p), int(z.q)  # which are hashed faster than z
        if key not in self._totals:
            self._totals[key] = None
            self._totals[key] = self._total(rod, number, z)
        if self._totals[key] is None:
            raise MeaninglessError(f"F'_{{{rod}, {number}}} is given by itself")
        return self._totals[key]

    def _total(self, rod: int, number: int, z: fmpq) -> Any:
        if rod not in self._places:
            self._places[rod] = list(self._given(rod))
        found = []
        for given, argument, right, place in self._places[rod]:
            if given == (rod, number):
                with self.binding({**place, "z": z}):
                    if self.value(argument) == z:
                        found.append((right, self.bound))
        if len(found) != 1:
            raise MeaninglessError(f"F'_{{{rod}, {number}}} is given {len(found)} times")
        ((right, bound),) = found
        with self.binding(bound):
            return self.value(right)

    def _given(self, rod: int) -> Iterator[tuple[tuple[int, ...], Tree, Tree, dict[str, Any]]]:
        """What the form gives for a rod: the indices of an F', its argument, what it is, and at which n."""
        halves = tabled.HALVES if self._form.name == "II" else (None,)
        numbers = places([self._form.numbers], self, self._most_n)
        steps = [(self._form.step, {**place, "half": half}) for place in numbers for half in halves]
        for equation, place in ((self._form.start, self.bound), *steps):
            left, right = sides(equation)
            with self.binding({**place, "i": rod}):
                yield self.indices(derivative(left).function), derivative(left).arguments[0], right, self.bound

    def call(self, call: Call) -> Any:
        """F' itself: what the form gives for another interval."""
        rod, number = self.indices(derivative(call).function)
        return self.total(rod, number, fmpq(self.value(call.arguments[0])))

    def symbol(self, symbol: Symbol) -> Any:
        """Coefficients, loads, rates, and the cells of the tables."""
        name, indices = symbol.name, self.indices(symbol)
        if name == "F" and symbol.above:
            return self.coefficient(indices, self.upper(symbol))
        if symbol.accent == r"\bar" and name == "M" and len(indices) == 2:
            return self._driven.piece(f"M{indices[0]}", indices[1]).weight
        if symbol.accent or symbol.above or symbol.primes:
            return super().symbol(symbol)
        if name == r"\kappa" and len(indices) == 1 and self._form.name != "II":
            return known(self._driven.exact.chain.parameters.kappa, indices[0], r"\kappa")
        if name == r"\gamma" and len(indices) == 1 and self._form.name == "II":
            return known(self._rates, indices[0], r"\gamma")
        if name == r"\tau" and indices:
            source, number = (f"M{indices[0]}", indices[1]) if len(indices) == 2 else ("a", indices[0])
            return self._driven.piece(source, number).time
        if name == "m" and len(indices) == 1:
            return self.last(f"M{indices[0]}" if self._form.name == "II" else "a" if indices == (1,) else "")
        key = name, indices, *map(self.bound.get, ("n", "half", "i", tabled.ALPHA))
        if key not in self._limits:
            self._limits[key] = tabled.limit(self._form.name, self._letter, name, indices, self, self._tried)
        limit = self._limits[key]
        if name == "w":  # depends on loads
            return self.value(limit.tree)
        place = tuple(map(self.bound.get, tabled.LETTERS))
        if place not in limit.known:
            limit.known[place] = self.value(limit.tree)
        return limit.known[place]

    def last(self, source: str) -> int:
        """m_s and m_1: the number of the last piece of a load."""
        return len(known(self._driven.loads, source, "the load")) - 1

    def coefficient(self, lower: tuple[int, ...], upper: tuple[int, ...]) -> Any:
        """The coefficient with these indices; MeaninglessError where there is none."""
        increment = self._driven.gain(self._letter, *self._where(upper))
        if len(lower) < 2:  # of the family with rate 0, where 0 is as good as none
            power = known({(): 0, (0,): 1}, lower, "F")
            powers = increment.get(fmpq(0), [])
            return powers[power] if power < len(powers) else fmpq(0)
        body, power = lower
        powers = increment.get(known(self._rates, body, "the rate"), [])
        if not 0 <= power < len(powers):
            raise MeaninglessError(f"there is no coefficient of power {power} at the rate of body {body}")
        return powers[power]

    def _where(self, upper: tuple[int, ...]) -> tuple[int, int, str, int | None]:
        """Rod, interval, source and piece by upper indices."""
        match self._form.name, upper:
            case "I", (rod, interval):
                return rod, interval, "impact", None
            case "II", (rod, s, interval):
                return rod, interval, f"M{s}", None
            case "III", (k, rod, interval):
                return rod, interval, "ab", k
        raise MeaninglessError(f"coefficients of example {self._form.name} do not have {len(upper)} upper indices")


def derivative(tree: Tree) -> Call:
    """F' with two indices, of one argument; MeaninglessError."""
    match tree:
        case Call(Symbol("F", primes=1, below=(_, _)), (_,)):
            return tree
    raise MeaninglessError(f"{latex(tree)} is no derivative of a function")


def known(values: Mapping[Any, Any], index: Any, name: str) -> Any:
    """A value by its number; MeaninglessError where there is none."""
    if index not in values:
        raise MeaninglessError(f"{name} has no number {index}")
    return values[index]


def only(letters: str, ranges: Sequence[Tree]) -> Progression:
    """The one range that there must be, of one of some letters; MeaninglessError."""
    if len(ranges) == 1 and isinstance(ranges[0], Progression) and latex(ranges[0].variable) in letters:
        return ranges[0]
    raise MeaninglessError(f"the range of {letters} is not given")


def form(entry: PaperEntry) -> Test:
    """A form whole, for all functions of its table."""
    name = entry.about["example"]

    def cases(reading: Reading) -> Iterator[Case]:
        yield from copy(kept_cases(Form.of(name, reading)))

    return Test(
        "the motion, exact, under loads with several delayed pieces; "
        f"m = {', '.join(map(str, SIZES[name]))}; coefficients of the exact tables, limits of the corrected tables",
        cases,
    )


@cache
def kept_cases(form: Form) -> Iterator[Case]:
    """The cases of a form; what copies of this iterator reach is kept, as some records differ only as printed."""
    return tee(form_cases(form), 1)[0]


def form_cases(form: Form, tried: Tried | None = None, scope: type[FormScope] = FormScope) -> Iterator[Case]:
    """All functions of the form's table at the starts of the first intervals and inside, then in the last interval.

    A value there has the increments of all intervals in it, and exponentials of different exponents are independent.
    """
    scopes: dict[tuple[int, str], FormScope] = {}
    most = INTERVALS[form.name]
    for m, n in by_size((m, n) for m in SIZES[form.name] for n in (0, 1, most)):
        driven = moved(form.name, m)
        for letter, rod in tabled.functions(form.name, m):
            made = scopes.setdefault((m, letter), scope(form, driven, letter, tried))
            for number in numbers(form.name, n)[-1 if n == most else 0 :]:
                for part in WITHIN if n < most else WITHIN[1:]:
                    yield compared(made, driven, (letter, rod), number, driven.exact.interval * (number - 1 + part))


def numbers(name: str, n: int) -> tuple[int, ...]:
    """The numbers 1, 2, ... of the intervals that have the number n in a form."""
    return (2 * n + 1, 2 * n + 2) if name == "II" else (n + 1,)


def compared(scope: FormScope, driven: DrivenChain, function: tuple[str, int], number: int, z: fmpq) -> Case:
    """A function at z, by the form of an interval and by the motion."""
    letter, rod = function
    true = driven.wave(letter, rod, z)
    at = {"m": driven.exact.m, "function": f"{letter}'_{rod}", "z": z, "interval": number}
    return case(at, lambda: scope.total(rod, number, z), true, true != 0, shown(driven.exact, function, number))


def shown(exact: Exact, function: tuple[str, int], number: int) -> Callable[[], Reproduction]:
    """The scene of a chain under its loads, and where its table has what a function gains in an interval."""
    letter, rod = function
    return lambda: example(
        exact,
        loads(exact),
        exact.interval * number + exact.m,
        {"velocity": [f"{rod - 1}+" if letter == "f" else f"{rod}-"]},
        "wavesym tables SCENE",
        f"{letter} of rod {rod}, interval {number}: its rates and coefficients",
    )()
