"""The list III.1 ... III.22: what its letters mean, its lines among true values, and the list run by itself.

A coefficient has the letter of its function, upper indices k (the step of the load), rod and interval, and lower ones:
none where it is constant, 0 where it is linear in the time since the interval began, (1, i) and (m, i) before power i
of that time and an exponential of rate 2 kappa_1 or kappa_m.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, partial
from itertools import product
from typing import Any, NamedTuple

from flint import fmpq

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds, items, places, sides
from wavesym.papers.pielorz1979.chains import example
from wavesym.papers.pielorz1979.forms import form_chain
from wavesym.papers.pielorz1979.transcript import entry as transcribed
from wavesym.papers.pielorz1979.transcript import ids, right_reading
from wavesym.papers.record import Case, Reading, Reproduction, Test, by_size, case, reading
from wavesym.papers.tree import Symbol, Tree, latex, symbols

STEPS = range(3)
"""The k of the steps of the load that the list is tried with."""


class Key(NamedTuple):
    """A coefficient, by its letter, its lower indices and its upper ones."""

    letter: str
    lower: tuple[int, ...]
    k: int
    rod: int
    interval: int

    @property
    def power(self) -> int:
        """Of the time since the interval began, before which it stands."""
        return self.lower[-1] if len(self.lower) > 1 else len(self.lower)

    def __str__(self) -> str:
        below = {0: "", 1: "_0"}.get(len(self.lower)) or (f"_({self.lower[0]},{self.lower[1]})" if self.lower else "")
        return f"{self.letter}{below}^({self.k},{self.rod},{self.interval})"


def key(symbol: Symbol, scope: Scope) -> Key:
    """The coefficient that a symbol means; MeaninglessError."""
    upper, lower = scope.upper(symbol), scope.indices(symbol)
    if symbol.name not in "fg" or symbol.accent or symbol.primes or len(upper) != 3:
        raise MeaninglessError(f"{latex(symbol)} is no coefficient")
    if lower not in ((), (0,)) and (len(lower) != 2 or lower[0] not in (1, scope.variables["m"])):
        raise MeaninglessError(f"{latex(symbol)} has no such lower indices")
    return Key(symbol.name, lower, *upper)


class TrueCoefficients:
    """The coefficients of (4.12) for a building of m - 1 equal floors under a load, by the exact tables."""

    def __init__(self, m: int) -> None:
        self.motion, self.m = form_chain("III", m), m
        self.exact, self.loads = self.motion.exact, self.motion.loads
        self.kappa = {i: fmpq(kappa) for i, kappa in self.exact.chain.parameters.kappa.items()}
        self._powers: dict[Key, list[fmpq]] = {}

    def __call__(self, key: Key) -> fmpq:
        """A coefficient: 0 before the first interval and where it does not exist; MeaninglessError."""
        if key.power < 0:
            raise MeaninglessError(f"there is no {key}")
        powers = self.family(key)
        return powers[key.power] if key.power < len(powers) else fmpq(0)

    def family(self, key: Key) -> list[fmpq]:
        """The coefficients of all powers at the rate of one."""
        one = key._replace(lower=key.lower[:1] if len(key.lower) > 1 else ())
        if one not in self._powers:
            increment = self.motion.gain(key.letter, key.rod, key.interval, "ab", key.k)
            self._powers[one] = increment.get(self._rate(key.lower), [])
        return self._powers[one]

    def _rate(self, lower: tuple[int, ...]) -> fmpq:
        return fmpq(0) if len(lower) < 2 else self.kappa[self.m] if lower[0] == self.m else 2 * self.kappa[1]

    def exists(self, key: Key) -> bool:
        """Whether (4.12) has such a term there: the function has begun to move, and the power is not too high."""
        if key.interval < 1 or not 1 <= key.rod <= self.m:
            return False
        if len(key.lower) < 2:
            return bool(self.motion.gain(key.letter, key.rod, key.interval, "ab", key.k))
        return 0 <= key.lower[1] < len(self.family(key))

    def example(self, key: Key) -> Reproduction:
        """The tables of increments for units of both sources, of which a coefficient is made."""
        parts = " and ".join(f"{steps[key.k].weight} times source {name}" for name, steps in self.loads.items())
        look = (
            f"{key.letter} of rod {key.rod}, interval {key.interval}, rate {self._rate(key.lower)}, power {key.power}: "
            f"{parts} is {self(key)}"
        )
        until = self.exact.interval * key.interval
        return example(self.exact, self.loads, until, {"strain": ["1-"]}, "wavesym tables SCENE", look)()


@cache
def truth(m: int) -> TrueCoefficients:
    """The coefficients of a building of m - 1 floors."""
    return TrueCoefficients(m)


@cache
def unknowns(m: int, n: int) -> frozenset[Key]:
    """The coefficients of interval n + 1, for all steps: those of f_1, ..., f_m and g_2, ..., g_m."""
    functions = [("f", rod) for rod in range(1, m + 1)] + [("g", rod) for rod in range(2, m + 1)]
    found = []
    for (letter, rod), k in product(functions, STEPS):
        powers = {body: truth(m).family(Key(letter, (body, 0), k, rod, n + 1)) for body in (1, m)}
        lower = [(), (0,), *((body, power) for body in powers for power in range(len(powers[body])))]
        found += [Key(letter, indices, k, rod, n + 1) for indices in lower]
    return frozenset(found)


class Coefficients(Scope):
    """The letters of the list: coefficients as they are `given`, kappa, and the steps of the load.

    `opened`: every H is 1, so that all coefficients behind one are asked for.
    """

    def __init__(self, bound: Mapping[str, int], given: Callable[[Key], Any], opened: bool = False) -> None:
        super().__init__(bound)
        known = truth(bound["m"])
        self._coefficient, self._is_open = given, opened
        self.letters = {
            r"\kappa": known.kappa.__getitem__,
            r"\bara": lambda k: known.motion.piece("a", k).weight,
            r"\barb": lambda k: known.motion.piece("b", k).weight,
        }

    def symbol(self, symbol: Symbol) -> Any:
        return self._coefficient(key(symbol, self)) if symbol.superscript else super().symbol(symbol)

    def step(self, value: Any) -> Any:
        return 1 if self._is_open else super().step(value)


def gives(line: Reading, m: int, n: int, steps: Iterable[int] = STEPS) -> Iterator[tuple[dict[str, int], Key, Tree]]:
    """Indices, the coefficient, and what it is, for all that a line gives for an n; MeaninglessError.

    A line in which no n stands gives its coefficients once.
    """
    for equation in items(line.formula):
        left, right = sides(equation)
        if not isinstance(left, Symbol):
            raise MeaninglessError(f"{latex(left)} is no coefficient")
        for k in steps:
            yield from ((place, key, right) for place, key in _keys(left, line.ranges, m, n, k))


@cache
def _keys(left: Symbol, ranges: tuple[Tree, ...], m: int, n: int, k: int) -> list[tuple[dict[str, int], Key]]:
    if n > 0 and Symbol("n") not in symbols(left):
        return []
    return [(place, key(left, Scope(place))) for place in places(ranges, Scope({"m": m, "n": n, "k": k}))]


SIZES = tuple(by_size((m, n) for m in range(3, 6) for n in range(10 - m)))
SMALL = 9
"""The m + n below which values are compared first: a wrong one says more than a wrong H or range."""
STEP = 1
"""The step of the load with which the list is run by itself: both a and b change there."""


def coefficient(entry: PaperEntry) -> Test:
    """A line of the list."""
    return Test(
        "the exact tables with equal floors under a load of three steps, m = 3 ... 5, m + n < 10: values, the H of "
        "every coefficient, and every coefficient given once",
        partial(_cases, entry.id),
        conventions={"the functions g of the first interval are 0": partial(_cases, entry.id, rests=True)},
        is_subtracted=True,
        observation=partial(consequence, entry.id) if entry.slip else None,
    )


def _cases(id: str, line: Reading, rests: bool = False) -> Iterator[Case]:
    """`rests`: a coefficient of g in the first interval, text.8, may be let in."""
    for small, (m, n) in product((True, False), SIZES):
        for place, key, right in gives(line, m, n, [(m + n) % len(STEPS)]):
            if small is (m + n < SMALL):
                value = partial(Coefficients(place, truth(m)).value, right)
                true = truth(m)(key)
                yield case(place, value, true, true != 0, partial(truth(m).example, key))
            if not small:
                yield from _lets_in(place, key, right, rests)
        if not small:
            yield from _coverage(id, line, m, n)


def _lets_in(place: dict[str, int], key: Key, right: Tree, rests: bool) -> Iterator[Case]:
    """H lets in the coefficients that exist, and no others; none rests on itself."""
    exists = truth(place["m"]).exists
    used, behind = (
        [
            one
            for one in _requested_keys(place, right, opened)
            if not (rests and one.letter == "g" and one.interval == 1)
        ]
        for opened in (False, True)
    )
    if key in used:
        yield Case({**place, "claim": "does not rest on itself"}, False, True)
    if len(behind) > len(used) or not all(map(exists, used)):
        yield Case({**place, "claim": "H lets in"}, _names(used), _names(filter(exists, behind)))


def _requested_keys(place: dict[str, int], right: Tree, opened: bool = False) -> list[Key]:
    """The coefficients that a right side asks for, in their order."""
    found = []

    def request(key: Key) -> fmpq:
        found.append(key)
        return truth(place["m"])(key)

    Coefficients(place, request, opened).value(right)
    return found


def _coverage(id: str, line: Reading, m: int, n: int) -> Iterator[Case]:
    """Every coefficient is given by one line, once."""
    wanted, counts = _required_keys(id, m, n), Counter(key for _, key, _ in gives(line, m, n))
    if wanted or counts:
        extra = (counts - Counter(wanted)).elements()
        yield Case({"m": m, "n": n, "claim": "given twice, or no coefficient"}, _names(sorted(extra)), (), bool(counts))
        missing = _names(sorted(wanted - counts.keys()))
        yield Case({"m": m, "n": n, "claim": "given by no line"}, missing, (), bool(wanted))


@cache
def _required_keys(id: str, m: int, n: int) -> frozenset[Key]:
    """The coefficients that no other line gives, of the letter and the family that this line is about."""
    about = {_family(key) for key in _line_keys(id, m, n) or _line_keys(id, m, n + 1)}
    others = {key for other in ids("line") if other != id for key in _line_keys(other, m, n)}
    return frozenset(key for key in unknowns(m, n) - others if _family(key) in about)


def _family(key: Key) -> tuple[str, tuple[int, ...]]:
    return key.letter, key.lower[:1] if len(key.lower) == 2 else (-len(key.lower),)


@cache
def _line_keys(id: str, m: int, n: int) -> frozenset[Key]:
    return frozenset(key for _, key, _ in gives(right_reading(id), m, n))


def _names(keys: Iterable[Key]) -> tuple[str, ...]:
    return tuple(map(str, keys))


# the list run by itself, from nothing but the parameters


class NotGivenError(MeaninglessError):
    """The list does not give a coefficient that is asked for, or gives it by itself."""


class ListRun:
    """The coefficients of one building, from a list of lines, up to some n."""

    def __init__(self, lines: Iterable[Reading], m: int, most_n: int) -> None:
        self._lines: dict[Key, tuple[dict[str, int], Tree]] = {}
        for line, n in product(lines, range(most_n + 1)):
            for place, key, right in gives(line, m, n, [STEP]):
                self._lines.setdefault(key, (place, right))
        self._values: dict[Key, fmpq | None] = {}

    def __call__(self, key: Key) -> fmpq:
        """A coefficient; NotGivenError where the list does not give it, or gives it by itself."""
        if key.interval < 1:
            return fmpq(0)  # F' = 0 before the first interval, by (4.12)
        if key not in self._values:
            if key not in self._lines:
                raise NotGivenError(f"{key} is in no line's range")
            place, right = self._lines[key]
            self._values[key] = None
            self._values[key] = Coefficients(place, self).value(right)
        value = self._values[key]
        if value is None:
            raise NotGivenError(f"{key} rests on itself")
        return value


def listed_values(lines: Iterable[Reading], m: int, most_n: int) -> Iterator[tuple[Key, fmpq, fmpq]]:
    """Every coefficient for n = 0 ... most_n: its value by the list, and its true value; NotGivenError."""
    alone = ListRun(lines, m, most_n)
    for n in range(most_n + 1):
        for key in sorted(unknowns(m, n)):
            if key.k == STEP:
                yield key, alone(key), truth(m)(key)


def right_lines(but: str = "") -> list[Reading]:
    """The list as it should be, but for a line that is as printed."""
    return [reading(*transcribed(id).printed_strings) if id == but else right_reading(id) for id in ids("line")]


@cache
def gives_all(m: int, most_n: int) -> bool:
    """Whether the corrected list gives every coefficient for an m."""
    try:
        return all(value == true for _, value, true in listed_values(right_lines(), m, most_n))
    except MeaninglessError:
        return False


@cache
def consequence(id: str) -> str:
    """What becomes of the list where everything but this line is corrected."""
    for m in range(3, 6):
        try:
            for key, value, true in listed_values(right_lines(id), m, 6):
                if value != true:
                    return f"Without it the list by itself goes wrong: {key} becomes {value}, true is {true} (m = {m})."
        except MeaninglessError as error:
            return f"Without it the list by itself cannot be run: {error} (m = {m})."
    return "The list by itself gives the right values without it too."


def sizes(entry: PaperEntry) -> Test:
    """The m for which the list is said to give the coefficients."""

    def cases(reading: Reading) -> Iterator[Case]:
        for m in range(2, 7):
            yield Case({"m": m}, holds(reading.formula, Scope({"m": m})), gives_all(m, 5))

    return Test("whether the list, run by itself, gives every coefficient, m = 2 ... 6, n = 0 ... 5", cases)
