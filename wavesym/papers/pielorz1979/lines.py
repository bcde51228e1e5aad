"""The language of the list III.1 ... III.22: what its letters mean, what a line gives, and what there is to give.

A coefficient has the letter of its function, upper indices k (the step of the load), rod and interval, and lower ones:
none where it is constant, 0 where it is linear in the time since the interval began, (1, i) and (m, i) before power i
of that time and an exponential of rate 2 kappa_1 or kappa_m.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from itertools import product
from typing import Any, NamedTuple

from flint import fmpq

from wavesym.papers.evaluation import MeaninglessError, Scope, items, places, sides
from wavesym.papers.pielorz1979.forms import driven_form, known
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.record import Reading, Reproduction
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

    def __str__(self) -> str:
        below = {0: "", 1: "_0"}.get(len(self.lower)) or (f"_({self.lower[0]},{self.lower[1]})" if self.lower else "")
        return f"{self.letter}{below}^({self.k},{self.rod},{self.interval})"


def key(symbol: Symbol, scope: Scope) -> Key:
    """The coefficient that a symbol means; MeaninglessError."""
    upper, lower = scope.upper(symbol), scope.indices(symbol)
    if symbol.name not in "fg" or symbol.accent or symbol.primes or len(upper) != 3:
        raise MeaninglessError(f"{latex(symbol)} is no coefficient")
    if lower not in ((), (0,)) and (len(lower) != 2 or lower[0] not in (1, scope.bound["m"])):
        raise MeaninglessError(f"{latex(symbol)} has no such lower indices")
    return Key(symbol.name, lower, *upper)


class TrueCoefficients:
    """The coefficients of (4.12) for a building of m - 1 equal floors under a load, by the exact tables."""

    def __init__(self, m: int) -> None:
        self.driven, self.m = driven_form("III", m), m
        self.exact, self.loads = self.driven.exact, self.driven.loads
        self.kappa = {i: fmpq(kappa) for i, kappa in self.exact.chain.parameters.kappa.items()}
        self._powers: dict[Key, list[fmpq]] = {}

    def __call__(self, key: Key) -> fmpq:
        """A coefficient: 0 before the first interval and where it does not exist; MeaninglessError."""
        powers, power = self.family(key), key.lower[-1] if len(key.lower) > 1 else len(key.lower)
        if power < 0:
            raise MeaninglessError(f"there is no {key}")
        return powers[power] if power < len(powers) else fmpq(0)

    def family(self, key: Key) -> list[fmpq]:
        """The coefficients of all powers at the rate of one."""
        one = key._replace(lower=key.lower[:1] if len(key.lower) > 1 else ())
        if one not in self._powers:
            increment = self.driven.gain(key.letter, key.rod, key.interval, "ab", key.k)
            self._powers[one] = increment.get(self._rate(key.lower), [])
        return self._powers[one]

    def _rate(self, lower: tuple[int, ...]) -> fmpq:
        return fmpq(0) if len(lower) < 2 else self.kappa[self.m] if lower[0] == self.m else 2 * self.kappa[1]

    def exists(self, key: Key) -> bool:
        """Whether (4.12) has such a term there: the function has begun to move, and the power is not too high."""
        if key.interval < 1 or not 1 <= key.rod <= self.m:
            return False
        if len(key.lower) < 2:
            return bool(self.driven.gain(key.letter, key.rod, key.interval, "ab", key.k))
        return 0 <= key.lower[1] < len(self.family(key))

    def example(self, key: Key) -> Reproduction:
        """The tables of increments for units of both sources, of which a coefficient is made."""
        parts = " and ".join(f"{steps[key.k].weight} times source {name}" for name, steps in self.loads.items())
        power = key.lower[-1] if len(key.lower) > 1 else len(key.lower)
        look = (
            f"{key.letter} of rod {key.rod}, interval {key.interval}, rate {self._rate(key.lower)}, power {power}: "
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
        self._truth, self._given, self._opened = truth(bound["m"]), given, opened

    def symbol(self, symbol: Symbol) -> Any:
        match symbol:
            case Symbol("f" | "g", above=(_, *_)):
                return self._given(key(symbol, self))
            case Symbol(r"\kappa", accent="", below=(_,)):
                return known(self._truth.kappa, self.indices(symbol)[0], symbol.name)
            case Symbol("a" | "b" as source, accent=r"\bar", below=(_,)):
                return self._truth.driven.piece(source, self.indices(symbol)[0]).weight
        return super().symbol(symbol)

    def step(self, value: Any) -> Any:
        return 1 if self._opened else super().step(value)


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
