"""III.1 ... III.22 one by one, with the true values of the coefficients on their right, and the list run by itself."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache, partial
from itertools import product

from flint import fmpq

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds
from wavesym.papers.pielorz1979.lines import STEPS, Coefficients, Key, gives, truth, unknowns
from wavesym.papers.pielorz1979.transcript import entry as transcribed
from wavesym.papers.pielorz1979.transcript import ids, settled
from wavesym.papers.record import Case, Reading, Test, by_size, case, reading
from wavesym.papers.tree import Tree

SIZES = tuple(by_size((m, n) for m in range(3, 7) for n in range(10 - m)))
SMALL = 9
"""The m + n below which values are compared first: a wrong one says more than a wrong H or range."""
STEP = 1
"""The step of the load with which the list is run by itself: both a and b change there."""


def coefficient(entry: PaperEntry) -> Test:
    """A line of the list."""
    return Test(
        "the exact tables with equal floors under a load of three steps, m = 3 ... 6, m + n < 10: values, the H of "
        "every coefficient, and every coefficient given once",
        partial(_cases, entry.id),
        conventions={"the functions g of the first interval are 0": partial(_cases, entry.id, rests=True)},
        is_subtracted=True,
        observed=partial(consequence, entry.id) if entry.slip else None,
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
        [one for one in _asked(place, right, opened) if not (rests and one.letter == "g" and one.interval == 1)]
        for opened in (False, True)
    )
    if key in used:
        yield Case({**place, "claim": "does not rest on itself"}, False, True)
    if len(behind) > len(used) or not all(map(exists, used)):
        yield Case({**place, "claim": "H lets in"}, _names(used), _names(filter(exists, behind)))


def _asked(place: dict[str, int], right: Tree, opened: bool = False) -> list[Key]:
    """The coefficients that a right side asks for, in their order."""
    found = []

    def asked(key: Key) -> fmpq:
        found.append(key)
        return truth(place["m"])(key)

    Coefficients(place, asked, opened).value(right)
    return found


def _coverage(id: str, line: Reading, m: int, n: int) -> Iterator[Case]:
    """Every coefficient is given by one line, once."""
    wanted, counts = _wanted(id, m, n), Counter(key for _, key, _ in gives(line, m, n))
    if wanted or counts:
        extra = (counts - Counter(wanted)).elements()
        yield Case({"m": m, "n": n, "claim": "given twice, or no coefficient"}, _names(sorted(extra)), (), bool(counts))
        missing = _names(sorted(wanted - counts.keys()))
        yield Case({"m": m, "n": n, "claim": "given by no line"}, missing, (), bool(wanted))


@cache
def _wanted(id: str, m: int, n: int) -> frozenset[Key]:
    """The coefficients that no other line gives, of the letter and the family that this line is about."""
    about = {_family(key) for key in _given(id, m, n) or _given(id, m, n + 1)}
    others = {key for other in ids("line") if other != id for key in _given(other, m, n)}
    return frozenset(key for key in unknowns(m, n) - others if _family(key) in about)


def _family(key: Key) -> tuple[str, tuple[int, ...]]:
    return key.letter, key.lower[:1] if len(key.lower) == 2 else (-len(key.lower),)


@cache
def _given(id: str, m: int, n: int) -> frozenset[Key]:
    return frozenset(key for _, key, _ in gives(settled(id), m, n))


def _names(keys: Iterable[Key]) -> tuple[str, ...]:
    return tuple(map(str, keys))


# the list run by itself, from nothing but the parameters


class NotGivenError(MeaninglessError):
    """The list does not give a coefficient that is asked for, or gives it by itself."""


class Alone:
    """The coefficients of one building, from a list of lines, up to some n."""

    def __init__(self, lines: Iterable[Reading], m: int, most_n: int) -> None:
        self._lines: dict[Key, tuple[dict[str, int], Tree]] = {}
        for line, n in product(lines, range(most_n + 1)):
            for place, key, right in gives(line, m, n, [STEP]):
                self._lines.setdefault(key, (place, right))
        self._known: dict[Key, fmpq | None] = {}

    def __call__(self, key: Key) -> fmpq:
        """A coefficient; NotGivenError where the list does not give it, or gives it by itself."""
        if key.interval < 1:
            return fmpq(0)  # F' = 0 before the first interval, by (4.12)
        if key not in self._known:
            if key not in self._lines:
                raise NotGivenError(f"{key} is in no line's range")
            place, right = self._lines[key]
            self._known[key] = None
            self._known[key] = Coefficients(place, self).value(right)
        value = self._known[key]
        if value is None:
            raise NotGivenError(f"{key} rests on itself")
        return value


def compared(lines: Iterable[Reading], m: int, most_n: int) -> Iterator[tuple[Key, fmpq, fmpq]]:
    """Every coefficient for n = 0 ... most_n: its value by the list, and its true value; NotGivenError."""
    alone = Alone(lines, m, most_n)
    for n in range(most_n + 1):
        for key in sorted(unknowns(m, n)):
            if key.k == STEP:
                yield key, alone(key), truth(m)(key)


def corrected(but: str = "") -> list[Reading]:
    """The list as it should be, but for a line that is as printed."""
    return [_printed(id) if id == but else settled(id) for id in ids("line")]


def _printed(id: str) -> Reading:
    told = transcribed(id)
    return reading(told.printed, (*told.ranges, *told.inferred))


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


def sizes(entry: PaperEntry) -> Test:
    """The m for which the list is said to give the coefficients."""

    def cases(reading: Reading) -> Iterator[Case]:
        for m in range(2, 7):
            yield Case({"m": m}, holds(reading.formula, Scope({"m": m})), complete(m, 5))

    return Test("whether the list, run by itself, gives every coefficient, m = 2 ... 6, n = 0 ... 5", cases)
