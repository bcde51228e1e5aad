"""The list III.1 ... III.22 run by itself, from nothing but the parameters, and compared with the exact tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache

from flint import fmpq

from wavesym.papers.exact_tables import Exact, building
from wavesym.papers.pielorz1979.building_lines import CORRECTIONS, PRINTED
from wavesym.papers.pielorz1979.recurrence import At, PrintedLine

Key = tuple[str, str, int, int, int]
"""Letter, family, rod, interval, power."""


class NotGivenError(Exception):
    """The list does not give a coefficient that is asked for."""


class Alone:
    """The coefficients for one source of one building, from a list of lines."""

    def __init__(self, lines: Iterable[PrintedLine], m: int, kappa: Mapping[int, fmpq], source: str) -> None:
        self._targets = [(line, target) for line in lines for target in line.targets]
        self._m, self._kappa, self._source = m, kappa, source
        self._known: dict[Key, fmpq | None] = {}

    def __call__(self, letter: str, family: str, rod: int, interval: int, power: int) -> fmpq:
        """A coefficient; NotGivenError where the list does not give it, or gives it by itself."""
        if interval < 1:
            return fmpq(0)  # F' = 0 before the first interval, by (4.12)
        key = letter, family, rod, interval, power
        if key not in self._known:
            self._known[key] = None
            self._known[key] = self._computed(key)
        value = self._known[key]
        if value is None:
            raise NotGivenError(f"{_named(key)} rests on itself")
        return value

    def _computed(self, key: Key) -> fmpq:
        letter, family, rod, interval, power = key
        at = At(self._m, interval - 1, rod, power, self._kappa)
        for line, target in self._targets:
            if (
                (target.letter, target.family) == (letter, family)
                and target.first(self._m) <= rod <= target.last(self._m)
                and at.n >= target.start
                and not (line.loads and at.n > 0)
                and power in target.powers(at)
            ):
                load = (line.loads or {}).get((self._source, family))
                return sum(
                    (
                        term.factor(at)
                        * self(term.letter, term.family, term.rod(at), interval - term.back, term.power(at))
                        for term in line.terms
                        if term.on(at)
                    ),
                    fmpq(load(at)) if load else fmpq(0),
                )
        raise NotGivenError(f"{_named(key)} is in no line's range")


def corrected(*but: int) -> list[PrintedLine]:
    """The list with all corrections, except those of the lines in `but`."""
    return [
        CORRECTIONS[line.number].line if line.number in CORRECTIONS and line.number not in but else line
        for line in PRINTED
    ]


def compared(lines: Iterable[PrintedLine], m: int, most_n: int) -> Iterator[tuple[str, fmpq, fmpq]]:
    """Every coefficient for n = 0 ... most_n: its name, its value by the list, its true value."""
    exact = building(m)
    kappa = exact.chain.parameters.kappa
    lines = list(lines)
    for source in exact.responses:
        alone = Alone(lines, m, kappa, source)
        for interval in range(1, most_n + 2):
            for key, true in _coefficients(exact, source, interval):
                yield f"{_named(key)}, source {source}, m = {m}", alone(*key), true


def _coefficients(exact: Exact, source: str, interval: int) -> Iterator[tuple[Key, fmpq]]:
    """Those of (4.12) with Table 4: f_1, ..., f_m and g_2, ..., g_m. g_1 is left to (4.8)."""
    kappa = exact.chain.parameters.kappa
    rates = {"c": fmpq(0), "0": fmpq(0), "1": 2 * kappa[1], "m": kappa[exact.m]}
    for letter, first in (("g", 2), ("f", 1)):
        for rod in range(first, exact.m + 1):
            increment = exact.increment(source, letter, rod, interval)
            for family, rate in rates.items():
                powers = increment.get(rate, [])
                if family in "c0":
                    place = "c0".index(family)
                    yield (letter, family, rod, interval, 0), powers[place] if place < len(powers) else fmpq(0)
                else:
                    for power in reversed(range(len(powers))):
                        yield (letter, family, rod, interval, power), powers[power]


@cache
def consequence(number: int) -> str:
    """What becomes of the list where everything but this line is corrected."""
    for m in range(3, 6):
        try:
            for name, value, true in compared(corrected(number), m, 6):
                if value != true:
                    return f"Without it the list by itself goes wrong: {name} becomes {value}, true is {true}."
        except NotGivenError as error:
            return f"Without it the list by itself cannot be run: {error} (m = {m})."
    return "The list by itself gives the right values without it too."


@cache
def whole(largest_m: int, most_n: int) -> str:
    """The corrected list by itself, m = 3 ... largest_m and n = 0 ... most_n, in a sentence."""
    count = 0
    for m in range(3, largest_m + 1):
        for name, value, true in compared(corrected(), m, most_n):
            if value != true:
                return f"fails: {name} becomes {value}, true is {true}"
            count += value != 0
    return f"gives all {count} coefficients that are not 0, m = 3 ... {largest_m}, n = 0 ... {most_n}"


def _named(key: Key) -> str:
    letter, family, rod, interval, power = key
    index = {"c": "", "0": "_0", "1": f"_(1,{power})", "m": f"_(m,{power})"}[family]
    return f"{letter}{index}^(k,{rod},{interval})"
