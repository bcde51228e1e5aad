"""The list III.1 ... III.22 run by itself, from nothing but the parameters, and compared with the exact tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from itertools import product

from flint import fmpq

from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.pielorz1979.lines import Coefficients, Key, Line, ids, line, truth
from wavesym.papers.tree import Tree

STEP = 1
"""The step of the load whose coefficients are computed: both a and b change there."""


class NotGivenError(MeaninglessError):
    """The list does not give a coefficient that is asked for, or gives it by itself."""


class Alone:
    """The coefficients of one building, from a list of lines, up to some n."""

    def __init__(self, lines: Iterable[Line], m: int, most_n: int) -> None:
        self._m = m
        self._lines: dict[Key, tuple[dict[str, int], Tree]] = {}
        for one, n in product(lines, range(most_n + 1)):
            for bound, key, right in one.places(m, n, STEP):
                self._lines.setdefault(key, (bound, right))
        self._known: dict[Key, fmpq | None] = {}

    def __call__(self, key: Key) -> fmpq:
        """A coefficient; NotGivenError where the list does not give it, or gives it by itself."""
        if key.interval < 1:
            return fmpq(0)  # F' = 0 before the first interval, by (4.12)
        if key not in self._known:
            if key not in self._lines:
                raise NotGivenError(f"{key} is in no line's range")
            bound, right = self._lines[key]
            self._known[key] = None
            self._known[key] = Coefficients(bound, self._m, self).value(right)
        value = self._known[key]
        if value is None:
            raise NotGivenError(f"{key} rests on itself")
        return value


def compared(lines: Iterable[Line], m: int, most_n: int) -> Iterator[tuple[Key, fmpq, fmpq]]:
    """Every coefficient for n = 0 ... most_n: its value by the list, and its true value; NotGivenError."""
    alone = Alone(lines, m, most_n)
    for n in range(most_n + 1):
        for key in sorted(truth(m).unknowns(n)):
            if key.k == STEP:
                yield key, alone(key), truth(m)(key)


def corrected(*but: str) -> list[Line]:
    """The list as it should be, but for the lines in `but`, which are as printed."""
    return [line(id, printed=id in but) for id in ids()]


@cache
def complete(m: int, most_n: int) -> bool:
    """Whether the corrected list gives every coefficient for an m."""
    try:
        return all(value == true for _, value, true in compared(corrected(), m, most_n))
    except MeaninglessError:
        return False


@cache
def consequence(id: str) -> str:
    """What becomes of the list where everything but this line is corrected."""
    for m in range(3, 6):
        try:
            for key, value, true in compared(corrected(id), m, 6):
                if value != true:
                    return f"Without it the list by itself goes wrong: {key} becomes {value}, true is {true} (m = {m})."
        except MeaninglessError as error:
            return f"Without it the list by itself cannot be run: {error} (m = {m})."
    return "The list by itself gives the right values without it too."


@cache
def whole(largest_m: int, most_n: int) -> str:
    """The corrected list by itself, m = 3 ... largest_m and n = 0 ... most_n, in a sentence."""
    count = 0
    for m in range(3, largest_m + 1):
        try:
            for key, value, true in compared(corrected(), m, most_n):
                if value != true:
                    return f"fails: {key} becomes {value}, true is {true} (m = {m})"
                count += value != 0
        except MeaninglessError as error:
            return f"cannot be run: {error} (m = {m})"
    return f"gives all {count} coefficients that are not 0, m = 3 ... {largest_m}, n = 0 ... {most_n}"
