"""(4.9), (4.10) and (4.12): the forms of the solutions, run as recurrences with the limits of Tables 2 to 4.

A form says how a function goes on in an interval: F'_{i,n+1} from F'_{i,n}, from F'_{i,0} = 0 on. Its coefficients are
those of the exact tables, its limits the cells of Tables 2 to 4, corrected where they need it; all else is as it reads.
A coefficient beyond the highest power does not exist, so that a limit may be neither too low nor too high.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from flint import fmpq

from wavesym.papers.evaluation import MeaninglessError, Scope, holds, items, missing_meaning, places, sides
from wavesym.papers.pielorz1979.chains import Exact, LoadedChain, building, collision, drive, example, loads
from wavesym.papers.pielorz1979.transcript import entries, ids, right_reading
from wavesym.papers.record import Case, Reading, Reproduction, by_size, case
from wavesym.papers.tree import Blank, Call, Minus, Number, Progression, Symbol, Tree, latex

FORMS = {"I": "(4.9)", "II": "(4.10)", "III": "(4.12)"}
"""The form of each example's solutions."""
TABLE = {"I": "T2", "II": "T3", "III": "T4"}
EXACT: Mapping[str, Callable[[int], Exact]] = {"I": collision, "II": drive, "III": building}
INTERVALS = {"I": 3, "II": 2, "III": 3}
"""The numbers n = 0, 1, ... that forms are tried with; for each, example II has two intervals."""
SIZES = {"I": (4, 6, 8), "II": (1, 2, 3), "III": (2, 3, 4)}
WITHIN = (fmpq(0), fmpq(5, 7))
"""Where formulas are compared, as parts of an interval: at its start and inside."""
HALVES = ("even", "odd")
"""The halves of Table 3, in the order of their intervals."""
ALPHA = r"\alpha"

Changes = Mapping[str, Reading]
"""Records that are taken otherwise than they are right, by id."""
Function = tuple[str, int]
"""f or g, and the number of its rod."""
Indices = tuple[int, ...]


@cache
def form_chain(name: str, m: int) -> LoadedChain:
    """An example under loads of several pieces; the building has equal floors, as (4.12) says."""
    exact = EXACT[name](m)
    return LoadedChain(exact, loads(exact))


# the tables as they should be


def reading_of(id: str, changes: Changes) -> Reading:
    """A record as it is changes, or as it is right; KeyError, MeaninglessError."""
    return changes[id] if id in changes else right_reading(id)


def rows(group: str, m: int, changes: Changes) -> dict[str, list[Function]]:
    """The functions that rows or columns of a table are for, by the ids of their heads."""
    found: dict[str, list[Function]] = {}
    for id in ids("function", group):
        head, block, scope = reading_of(id, changes), id.rpartition(".")[0], Scope({"m": m})
        function = head.formula
        if not isinstance(function, Symbol) or len(function.subscript) != 1:
            raise MeaninglessError(f"{latex(function)} is no function")
        sizes = (reading_of(block, changes).formula,) if block in entries() else ()
        found[id] = []
        for place in places((*sizes, *head.ranges), scope):
            with scope.bind(place):
                found[id].append((function.name, *scope.indices(function)))  # type: ignore[arg-type]
    return found


@cache
def right_rows(group: str, m: int) -> dict[str, list[Function]]:
    """The same as they are right."""
    return rows(group, m, {})


@cache
def functions(name: str, m: int) -> dict[Function, str]:
    """The functions f, g of rods that the table of an example is about, each with the id of its row or column."""
    group = f"{TABLE[name]}.{'even.' if name == 'II' else ''}"
    return {function: id for id, row in right_rows(group, m).items() for function in row}


_LETTERS = ("m", "n", "half", "i", ALPHA, "j", "l", "r", "s")
"""What the value of a cell may depend on."""


_WITHOUT_BRACES = str.maketrans("", "", "{}")
_DEFINED: Mapping[tuple[str, Indices], str] = {
    ("L", (0,)): "(4.10).L_0",
    ("r", (0,)): "(4.11).r_0",
    ("r", (1,)): "(4.11).r_1",
}


def _cell(name: str, m: int, letter: str, symbol: str, indices: Indices, bound: Mapping[str, Any]) -> str:
    """The id of the cell that a letter of a form is, for a function of some rod."""
    if name == "II":
        below = "_".join([symbol, *map(str, indices)])
        half = bound.get("half")
        return f"T3.{half}.{below}" if below in ("d", "w") else f"T3.{half}.{letter}.alpha{bound.get(ALPHA)}.{below}"
    row = functions(name, m).get((letter, bound.get("i", 0)))
    lasts = {1: "1", m - 1: "m-1"} if name == "I" else {1: "1", m: "2" if m == 2 else "m"}
    if symbol == "K" and len(indices) == 1:
        return f"{row}.K_{lasts.get(indices[0])}"
    first = "j" if symbol == "K" else indices[0] if indices else ""
    return f"{row}.{symbol}_{','.join(map(str, (first, *indices[1:])))}"


@cache
def _part(id: str) -> tuple[str, ...]:
    """A cell and those of its part of Table 2, of which all are dashes or none."""
    row, _, name = id.rpartition(".")
    if name.startswith(("j_", "K_j")):
        return tuple(f"{row}.{one}{name[-1]}" for one in ("j_0,", "j_", "K_j,"))
    return (id,)


@cache
def _dependencies(id: str) -> frozenset[str]:
    """The records on which the value of a cell may depend."""
    return frozenset((*_DEFINED.values(), *_part(id)))


def _limit(id: str, scope: Scope, changes: Changes) -> Tree:
    """A cell where its ranges hold; where not, no power. A dash is an empty range."""
    if id in _DEFINED.values():
        left, right = sides(reading_of(id, changes).formula)
        if latex(left).translate(_WITHOUT_BRACES) != id.rpartition(".")[2]:
            raise KeyError(id)
        return right
    cell = reading_of(id, changes)
    formula: Tree = cell.formula
    if len({isinstance(reading_of(one, changes).formula, Blank) for one in _part(id)}) > 1:
        raise MeaninglessError("a part is given whole or not at all")
    if not all(holds(range_, scope) for range_ in cell.ranges if isinstance(range_, Progression)):
        if ".K_" not in id:
            raise MeaninglessError(f"{id} is not given for n = {scope.variables.get('n')}")
        return Minus(Number("1"))
    if isinstance(formula, Blank):
        return Number("1" if ".j_0," in id else "0")
    return formula


@cache
def _right_limit(id: str, m: int, i: int, n: int) -> Tree:
    return _limit(id, Scope({"m": m, "i": i, "n": n}), {})


@cache
def _right_values(name: str, m: int, letter: str) -> dict[tuple[Any, ...], Any]:
    """Of letters of a form for functions f or g: their values as they are right, as far as they are known."""
    return {}


_ALL_LETTERS = ("j", "K", "d", "w", "s", "R", "L", "r")


def _letters(id: str) -> Iterable[str]:
    """The letters that may have other values where a record is changed."""
    if id in _DEFINED.values():
        return _ALL_LETTERS
    return {part.rpartition(".")[2][0] for part in _part(id)}


# forms


Statements = dict[Indices, list[tuple[Tree, Tree, dict[str, Any]]]]
"""What a form says of a rod, by the indices of an F': its argument, what it is, and at which n."""


@dataclass(frozen=True)
class Form:
    """A form as it reads: the step from interval to interval, the start, and the numbers n that it is said for."""

    name: str
    step: Tree
    start: Tree
    numbers: Tree
    statements: dict[tuple[int, int, int], Statements] = field(default_factory=dict, init=False, compare=False)
    """What is known of it, by m, the most n and a rod: with everything else as it is right."""

    @classmethod
    def from_reading(cls, name: str, reading: Reading) -> Form:
        """MeaninglessError where it is none."""
        found = items(reading.formula)
        if len(found) != 2:
            raise MeaninglessError("a form is two equations")
        return cls(name, *found, single_range("n", reading.ranges))


@cache
def right_form(name: str) -> Form:
    """The form of an example's solutions as corrected."""
    return Form.from_reading(name, right_reading(FORMS[name]))


class FormScope(Scope):
    """What the letters of a form mean for the functions f or g of a chain under loads.

    `changed` are cells and definitions that are not taken as they are right.
    """

    def __init__(
        self, form: Form, motion: LoadedChain, letter: str, changes: Changes | None = None, most_n: int | None = None
    ) -> None:
        super().__init__({"m": motion.exact.m})
        self._form, self._motion, self._letter, self._changes = form, motion, letter, changes or {}
        self._most_n = INTERVALS[form.name] if most_n is None else most_n
        self._known_statements: dict[int, Statements] = {}
        self._totals: dict[tuple[int, int, int, int], Any] = {}
        self._limits: dict[tuple[Any, ...], Tree] = {}
        self._values: dict[tuple[Any, ...], Any] = {}
        self._right_values = _right_values(form.name, motion.exact.m, letter)
        self._changed_letters = {letter for id in self._changes for letter in _letters(id)}
        is_drive = form.name == "II"
        rates = motion.exact.rates if is_drive else motion.exact.chain.parameters.kappa
        self._rates = motion.exact.rates
        self.letters = {
            r"\gamma" if is_drive else r"\kappa": lambda i: look_up(rates, i, "a body"),
            r"\barM": lambda s, k: motion.piece(f"M{s}", k).weight,
            r"\tau": motion.start_time,
            "m": lambda number: self.last(f"M{number}" if is_drive else "a" if number == 1 else ""),
        }

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
        if rod not in self._known_statements:
            self._known_statements[rod] = self._statements(rod)
        found = []
        for argument, right, place in self._known_statements[rod].get((rod, number), ()):
            with self.bind({**place, "z": z}):
                if self.value(argument) == z:
                    found.append((right, self.variables))
        if len(found) != 1:
            raise MeaninglessError(f"F'_{{{rod}, {number}}} is given {len(found)} times")
        ((right, bound),) = found
        with self.bind(bound):
            return self.value(right)

    def _statements(self, rod: int) -> Statements:
        known = self._form.statements if "d" not in self._changed_letters else {}
        key = self._motion.exact.m, self._most_n, rod
        if key not in known:
            halves = HALVES if self._form.name == "II" else (None,)
            numbers = places([self._form.numbers], self, self._most_n)
            steps = [(self._form.step, {**place, "half": half}) for place in numbers for half in halves]
            known[key] = {}
            for equation, place in ((self._form.start, self.variables), *steps):
                left, right = sides(equation)
                with self.bind({**place, "i": rod}):
                    function = derivative(left)
                    statement = function.arguments[0], right, self.variables
                    known[key].setdefault(self.indices(function.function), []).append(statement)
        return known[key]

    def call(self, call: Call) -> Any:
        """F' itself: what the form gives for another interval."""
        rod, number = self.indices(derivative(call).function)
        return self.total(rod, number, fmpq(self.value(call.arguments[0])))

    def symbol(self, symbol: Symbol) -> Any:
        """Coefficients, loads, rates, and the cells of the tables."""
        if symbol.superscript and symbol.name == "F":
            return self.coefficient(self.indices(symbol), self.upper(symbol))
        name = symbol.letter
        if symbol.superscript or name != symbol.name or (name in self.letters and symbol.subscript):
            return super().symbol(symbol)
        indices = self.indices(symbol)
        values = self._values if name in self._changed_letters else self._right_values
        place = name, indices, *map(self.variables.get, _LETTERS)
        if place not in values:
            limit = self._limit_of(name, indices)
            if name == "w":  # depends on loads
                return self.value(limit)
            values[place] = self.value(limit)
        return values[place]

    def _limit_of(self, name: str, indices: Indices) -> Tree:
        """The right side of a definition, or a cell, that a letter is at this place; MeaninglessError."""
        bound, m = self.variables, self._motion.exact.m
        key = name, indices, *map(bound.get, ("n", "half", "i", ALPHA))
        if key not in self._limits:
            id = _DEFINED.get((name, indices)) or _cell(self._form.name, m, self._letter, name, indices, bound)
            try:
                if not self._changes.keys().isdisjoint(_dependencies(id)):
                    self._limits[key] = _limit(id, self, self._changes)
                else:
                    self._limits[key] = _right_limit(id, m, bound.get("i", 0), bound.get("n", 0))
            except KeyError:
                raise missing_meaning(Symbol(name), indices) from None
        return self._limits[key]

    def last(self, source: str) -> int:
        """m_s and m_1: the number of the last piece of a load."""
        return len(look_up(self._motion.loads, source, "the load")) - 1

    def coefficient(self, lower: Indices, upper: Indices) -> Any:
        """The coefficient with these indices; MeaninglessError where there is none."""
        known, place = self._motion.memory, ("coefficient", self._letter, lower, upper)
        if place not in known:
            known[place] = self._find_coefficient(lower, upper)
        return known[place]

    def _find_coefficient(self, lower: Indices, upper: Indices) -> fmpq:
        increment = self._motion.gain(self._letter, *self._coefficient_place(upper))
        if len(lower) < 2:  # of the family with rate 0, where 0 is as good as none
            power = look_up({(): 0, (0,): 1}, lower, "F")
            powers = increment.get(fmpq(0), [])
            return powers[power] if power < len(powers) else fmpq(0)
        body, power = lower
        powers = increment.get(look_up(self._rates, body, "the rate"), [])
        if not 0 <= power < len(powers):
            raise MeaninglessError(f"there is no coefficient of power {power} at the rate of body {body}")
        return powers[power]

    def _coefficient_place(self, upper: Indices) -> tuple[int, int, str, int | None]:
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
        case Call(Symbol("F", primes=1, subscript=(_, _)), (_,)):
            return tree
    raise MeaninglessError(f"{latex(tree)} is no derivative of a function")


def look_up(values: Mapping[Any, Any], index: Any, name: str) -> Any:
    """A value by its number; MeaninglessError where there is none."""
    if index not in values:
        raise MeaninglessError(f"{name} has no number {index}")
    return values[index]


def single_range(letters: str, ranges: Sequence[Tree]) -> Progression:
    """The one range that there must be, of one of some letters; MeaninglessError."""
    if len(ranges) == 1 and isinstance(ranges[0], Progression) and latex(ranges[0].variable) in letters:
        return ranges[0]
    raise MeaninglessError(f"the range of {letters} is not given")


def form_cases(
    form: Form, changes: Changes | None = None, scope: type[FormScope] = FormScope, chains: int = 3
) -> Iterator[Case]:
    """All functions of the form's table at the starts of the first intervals and inside, then in the last interval.

    A value there has the increments of all intervals in it, and exponentials of different exponents are independent.
    Of the `chains` of an example the first ones are tried.
    """
    scopes: dict[tuple[int, str], FormScope] = {}
    most = INTERVALS[form.name]
    for m, n in by_size((m, n) for m in SIZES[form.name][:chains] for n in (0, 1, most)):
        motion = form_chain(form.name, m)
        for letter, rod in functions(form.name, m):
            own = scopes.setdefault((m, letter), scope(form, motion, letter, changes))
            for number in numbers(form.name, n)[-1 if n == most else 0 :]:
                for part in WITHIN if n < most else WITHIN[1:]:
                    yield compare_at(own, motion, (letter, rod), number, motion.exact.interval * (number - 1 + part))


@cache
def right_form_cases(name: str) -> tuple[Case, ...]:
    """Those of a form as it is right."""
    return tuple(form_cases(right_form(name)))


def numbers(name: str, n: int) -> tuple[int, ...]:
    """The numbers 1, 2, ... of the intervals that have the number n in a form."""
    return (2 * n + 1, 2 * n + 2) if name == "II" else (n + 1,)


def compare_at(scope: FormScope, motion: LoadedChain, function: Function, number: int, z: fmpq) -> Case:
    """A function at z, by the form of an interval and by the motion."""
    letter, rod = function
    true = motion.wave(letter, rod, z)
    at = {"m": motion.exact.m, "function": f"{letter}'_{rod}", "z": z, "interval": number}
    return case(
        at, lambda: scope.total(rod, number, z), true, true != 0, table_scene(motion.exact, function, number, z)
    )


def table_scene(exact: Exact, function: Function, number: int, z: fmpq | None = None) -> Callable[[], Reproduction]:
    """The scene of a chain under its loads, and where its table has what a function gains in an interval.

    Where z is given also how the value of the function there is made of that.
    """
    letter, rod = function
    outputs = {"velocity": [f"{rod - 1}+" if letter == "f" else f"{rod}-"]}
    look = f"{letter} of rod {rod}, interval {number}: its rates and coefficients"
    if z is not None:
        before = "; so do intervals before, from their own starts" if number > 1 else ""
        look += (
            f"; at z = {z} a step s of a load at the time t adds s c e^(-rate w) w^power for each coefficient c, with "
            f"w = {z - exact.interval * (number - 1)} - t, and nothing where w < 0{before}"
        )
    return example(exact, loads(exact), exact.interval * number + exact.m, outputs, "wavesym tables SCENE", look)
