"""The language of the list III.1 ... III.22: what its letters mean, what a line gives, and what there is to give.

A coefficient has the letter of its function, upper indices k (the step of the load), rod and interval, and lower ones:
none where it is constant, 0 where it is linear in the time since the interval began, (1, i) and (m, i) before power i
of that time and an exponential of rate 2 kappa_1 or kappa_m.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from flint import fmpq

from wavesym.exact.increments import Increment
from wavesym.papers.evaluation import MeaninglessError, Scope, holds, items, sides, span
from wavesym.papers.exact_tables import Exact, building
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.transcript import entries, entry
from wavesym.papers.pielorz1979.truth import Step, loads
from wavesym.papers.reader import UnreadableError
from wavesym.papers.record import Example, Reading, reading
from wavesym.papers.tree import Progression, Symbol, Tree, latex

STEPS = range(3)
"""The k of the steps of the load that the list is tried with."""


class Key(NamedTuple):
    """A coefficient; `family` is "" (constant), "0" (linear), "1" or "m"."""

    letter: str
    family: str
    rod: int
    interval: int
    power: int
    k: int

    def __str__(self) -> str:
        lower = {"": "", "0": "_0"}.get(self.family, f"_({self.family},{self.power})")
        return f"{self.letter}{lower}^({self.k},{self.rod},{self.interval})"


def key(symbol: Symbol, scope: Scope) -> Key:
    """The coefficient that a symbol means; MeaninglessError."""
    upper, lower = scope.upper(symbol), scope.indices(symbol)
    if symbol.name not in "fg" or symbol.accent or symbol.primes or len(upper) != 3:
        raise MeaninglessError(f"{latex(symbol)} is no coefficient")
    k, rod, interval = upper
    match lower:
        case ():
            return Key(symbol.name, "", rod, interval, 0, k)
        case (0,):
            return Key(symbol.name, "0", rod, interval, 0, k)
        case (body, power) if body in (1, scope.bound["m"]):
            return Key(symbol.name, "1" if body == 1 else "m", rod, interval, power, k)
    raise MeaninglessError(f"{latex(symbol)} has no such lower indices")


class Truth:
    """The coefficients of (4.12) for a building of m - 1 equal floors under a load, by the exact tables."""

    def __init__(self, m: int) -> None:
        self.exact: Exact = building(m)
        self.m = m
        self.kappa = {i: fmpq(kappa) for i, kappa in self.exact.chain.parameters.kappa.items()}
        self.loads: Mapping[str, tuple[Step, ...]] = {name: tuple(steps) for name, steps in loads(self.exact).items()}
        self._known: dict[Key, fmpq] = {}
        self._found: dict[Key, bool] = {}

    def __call__(self, key: Key) -> fmpq:
        """A coefficient: 0 before the first interval and where it does not exist; MeaninglessError."""
        if key not in self._known:
            self._known[key] = self._computed(key)
        return self._known[key]

    def _computed(self, key: Key) -> fmpq:
        if key.k not in STEPS or not 1 <= key.rod <= self.m or key.power < 0:
            raise MeaninglessError(f"there is no {key}")
        place = int(key.family == "0") or key.power
        total = fmpq(0)
        for source, steps in self.loads.items():
            powers = self._increment(source, key).get(self._rate(key.family), [])
            total += steps[key.k].weight * powers[place] if place < len(powers) else 0
        return total

    def _increment(self, source: str, key: Key) -> Increment:
        try:
            return self.exact.increment(source, key.letter, key.rod, key.interval)
        except IndexError:
            raise MeaninglessError(f"{key} is beyond the tables") from None

    def _rate(self, family: str) -> fmpq:
        return {"": fmpq(0), "0": fmpq(0), "1": 2 * self.kappa[1], "m": self.kappa[self.m]}[family]

    def exists(self, key: Key) -> bool:
        """Whether (4.12) has such a term there: the function has begun to move, and the power is not too high."""
        if key not in self._found:
            self._found[key] = self._exists(key)
        return self._found[key]

    def _exists(self, key: Key) -> bool:
        if key.interval < 1 or not 1 <= key.rod <= self.m:
            return False
        if key.family in ("", "0"):
            return self.exact.alive(key.letter, key.rod, key.interval)
        return 0 <= key.power <= self.exact.degree(key.letter, key.rod, key.interval, self._rate(key.family))

    def example(self, key: Key) -> Example:
        """The tables of increments for units of both sources, of which a coefficient is made."""
        place = int(key.family == "0") or key.power
        parts = " and ".join(f"{steps[key.k].weight} times source {name}" for name, steps in self.loads.items())
        look = (
            f"{key.letter} of rod {key.rod}, interval {key.interval}, rate {self._rate(key.family)}, power {place}: "
            f"{parts} is {self(key)}"
        )
        until = self.exact.interval * key.interval
        return example(self.exact, self.loads, until, {"strain": ["1-"]}, "wavesym tables SCENE", look)()

    def unknowns(self, n: int) -> frozenset[Key]:
        """The coefficients of interval n + 1, for all steps: those of f_1, ..., f_m and g_2, ..., g_m."""
        found = []
        for letter, rod in [("f", rod) for rod in range(1, self.m + 1)] + [("g", rod) for rod in range(2, self.m + 1)]:
            found += [(letter, family, rod, n + 1, 0) for family in ("", "0")]
            for family in "1m":
                degree = self.exact.degree(letter, rod, n + 1, self._rate(family))
                found += [(letter, family, rod, n + 1, power) for power in range(degree + 1)]
        return frozenset(Key(*parts, k) for parts in found for k in STEPS)


@cache
def truth(m: int) -> Truth:
    """The coefficients of a building of m - 1 floors."""
    return Truth(m)


class Coefficients(Scope):
    """The letters of the list: coefficients as they are `given`, kappa, and the steps of the load.

    `opened`: every H is 1, so that all coefficients behind one are asked for.
    """

    def __init__(self, bound: Mapping[str, int], m: int, given: Callable[[Key], fmpq], opened: bool = False) -> None:
        super().__init__(bound)
        self._truth, self._given, self._opened = truth(m), given, opened

    def symbol(self, symbol: Symbol) -> Any:
        match symbol:
            case Symbol(r"\kappa", accent="", below=(_,)):
                (body,) = self.indices(symbol)
                if body in self._truth.kappa:
                    return self._truth.kappa[body]
            case Symbol("a" | "b" as source, accent=r"\bar", below=(_,)):
                (k,) = self.indices(symbol)
                if k in STEPS:
                    return self._truth.loads[source][k].weight
            case Symbol("f" | "g", above=(_, *_)):
                return self._given(key(symbol, self))
        return super().symbol(symbol)

    def step(self, value: Any) -> Any:
        return 1 if self._opened else super().step(value)


@dataclass(frozen=True)
class Line:
    """A line of the list: coefficients, what they are, and the ranges of j, i and n for which that is said."""

    equations: tuple[tuple[Tree, Tree], ...]
    ranges: tuple[Tree, ...]

    @classmethod
    def of(cls, read: Reading) -> Line:
        """The line that a reading is; MeaninglessError."""
        pairs = []
        for item in items(read.formula):
            left, *right = sides(item)
            if len(right) != 1 or not isinstance(left, Symbol):
                raise MeaninglessError(f"{latex(item)} gives no coefficient")
            pairs.append((left, right[0]))
        return cls(tuple(pairs), read.ranges)

    def places(self, m: int, n: int, k: int) -> Iterator[tuple[dict[str, int], Key, Tree]]:
        """Indices, the coefficient, and what it is, for all coefficients that the line gives for an n.

        A line in which no n stands gives its coefficients once.
        """
        for left, right in self.equations:
            assert isinstance(left, Symbol)
            if n == 0 or "n" in latex(left):
                for bound in _bindings(self.ranges, {"m": m, "n": n, "k": k}):
                    yield bound, key(left, Scope(bound)), right


def _bindings(ranges: tuple[Tree, ...], bound: dict[str, int]) -> Iterator[dict[str, int]]:
    """The values of j and i, one range after another, where the conditions hold."""
    if not ranges:
        yield bound
        return
    first, *rest = ranges
    if isinstance(first, Progression) and isinstance(first.variable, Symbol) and first.variable.name not in bound:
        for value in span(first, Scope(bound)):
            yield from _bindings(tuple(rest), {**bound, first.variable.name: value})
    elif holds(first, Scope(bound)):
        yield from _bindings(tuple(rest), bound)


@cache
def line(id: str, printed: bool = False) -> Line:
    """A line of the list as it should be, or as it is printed; MeaninglessError."""
    record = entry(id)
    slip = None if printed else record.slip
    ranges = record.ranges if slip is None or slip.ranges is None else slip.ranges
    try:
        return Line.of(reading(slip.corrected if slip else record.printed, (*ranges, *record.inferred)))
    except UnreadableError as error:
        raise MeaninglessError(str(error)) from None


@cache
def ids() -> tuple[str, ...]:
    """The lines of the list."""
    return tuple(id for id, record in entries().items() if record.kind == "line")


def given(lines: Iterable[Line], m: int, n: int) -> Iterator[Key]:
    """The coefficients that lines give for an n, for all steps."""
    for line in lines:
        for k in STEPS:
            for _, key, _ in line.places(m, n, k):
                yield key
