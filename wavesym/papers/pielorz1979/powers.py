"""The highest powers in the solutions: by the coefficients that a form requests, and by the exact tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from functools import cache, partial
from itertools import product
from typing import Any

from flint import fmpq

from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.pielorz1979.chains import INTERVALS as TABULATED
from wavesym.papers.pielorz1979.chains import Exact, LoadedChain, LoadStep, example
from wavesym.papers.pielorz1979.forms import (
    ALPHA,
    EXACT,
    HALVES,
    TABLE,
    Changes,
    FormScope,
    Function,
    Indices,
    numbers,
    right_form,
    right_rows,
)
from wavesym.papers.record import Case, NoValue, Reproduction, by_size, case
from wavesym.papers.tree import Call, Power, Series

PAIRS = {
    "I": tuple(by_size(product((4, 6, 10), range(5)))),
    "II": tuple(by_size(product((1, 2, 3, 5), range(3)))),
    "III": tuple(by_size(product((2, 3, 4, 5), range(6)))),
}
"""The m and n that tables are tried with."""


class RequestScope(FormScope):
    """A form that keeps which coefficients it requests in one interval; all else is a factor 1.

    `part` is the one part of the moments, alpha, that is looked at.
    """

    def __init__(
        self, name: str, motion: LoadedChain, letter: str, changes: Changes | None = None, part: int | None = None
    ) -> None:
        super().__init__(right_form(name), motion, letter, changes, max(n for _, n in PAIRS[name]))
        self.letters |= dict.fromkeys((r"\barM", r"\tau"), lambda *index: 1)
        self._part = part
        self._requests: list[tuple[Indices, Indices]] = []

    def requests(self, rod: int, number: int) -> list[tuple[Indices, Indices]]:
        """The lower and upper indices of the coefficients for a rod in interval 1, 2, ..., in their order."""
        self._requests = []
        self._total(rod, number, fmpq(0))
        return self._requests

    def coefficient(self, lower: Indices, upper: Indices) -> Any:
        self._coefficient_place(upper)  # as many as the form's coefficients have
        self._requests.append((lower, upper))
        return 0

    def series(self, series: Series) -> Any:
        if series.variable.name != ALPHA or self._part is None:
            return super().series(series)
        with self.bind({ALPHA: self._part}):
            return self.value(series.body)

    def call(self, call: Call) -> Any:
        return 0

    def step(self, value: Any) -> Any:
        return 1

    def power(self, power: Power) -> Any:
        return 1

    def last(self, source: str) -> int:
        """Moments that do not exist are requested, too."""
        return len(self._motion.loads.get(source, (None,))) - 1


Powers = dict[tuple[str, str], Any]
"""The highest powers, by source (in example II, where each has its own) and rate."""


class HighestPowers:
    """The highest powers of a chain's functions, as a form has them and as they are."""

    def __init__(self, name: str, exact: Exact) -> None:
        self.name, self.exact = name, exact
        self.motion = LoadedChain(exact, {source: (LoadStep(fmpq(0), fmpq(1)),) for source in exact.responses})
        self._rates = {body: str(rate) for body, rate in exact.rates.items()}
        self._true: dict[tuple[str, int, int], Powers] = {}

    def powers_requested(self, requests: Iterable[tuple[Indices, Indices]]) -> Powers:
        """Those of the coefficients requested; all powers of a rate where any is requested more than once."""
        found: dict[tuple[str, str], list[int]] = {}
        twice = set()
        for (lower, upper), times in Counter(requests).items():
            if len(lower) == 2:
                rate = self._rates.get(lower[0], f"of no body: number {lower[0]}")
                key = (f"M{upper[1]}" if self.name == "II" else "", rate)
                found.setdefault(key, []).extend([lower[1]] * times)
                if times > 1:
                    twice.add(key)
        return {key: tuple(sorted(powers)) if key in twice else max(powers) for key, powers in found.items()}

    def true(self, letter: str, rod: int, number: int) -> Powers:
        """Those of the exact tables."""
        key = letter, rod, number
        if key not in self._true:
            found: Powers = {}
            for source in self.exact.responses:
                for rate, powers in self.exact.increment(source, letter, rod, number).items():
                    if rate != 0:
                        of = (source if self.name == "II" else "", str(rate))
                        found[of] = max(found.get(of, 0), len(powers) - 1)
            self._true[key] = found
        return self._true[key]

    def moments(self, half: str, letter: str, rod: int) -> tuple[int, ...]:
        """The moments that change a function in some interval of a half."""
        later = range(1 + HALVES.index(half), TABULATED["II"] + 1, 2)
        return tuple(
            s for s in range(1, self.exact.m + 2) if any(self.exact.increment(f"M{s}", letter, rod, n) for n in later)
        )

    def cases(self, scope: RequestScope, function: Function, number: int, at: Mapping[str, object]) -> Iterator[Case]:
        """One for every rate that a function has, or is said to have, in an interval."""
        letter, rod = function
        true, at = self.true(letter, rod, number), {**at, "function": f"{letter}_{rod}"}
        try:
            requests = scope.requests(rod, number)
        except MeaninglessError as error:
            yield Case(at, NoValue(str(error)), {" ".join(key).strip(): power for key, power in true.items()})
            return
        stated, sources = (
            self.powers_requested(requests),
            {f"M{upper[1]}" if self.name == "II" else "" for _, upper in requests},
        )
        for key in {**{key: power for key, power in true.items() if key[0] in sources}, **stated}:
            where = {**at, "moment": key[0], "rate": key[1]} if key[0] else {**at, "rate": key[1]}
            highest = true.get(key, -1)
            scene = partial(self._scene, letter, rod, number, *key, highest)
            yield Case(where, stated.get(key, -1), highest, key in true, scene)

    def _scene(self, letter: str, rod: int, number: int, source: str, rate: str, highest: int) -> Reproduction:
        """The table of the exact increments, where the highest power is read off."""
        gains = {s: self.exact.increment(s, letter, rod, number) for s in self.exact.responses}
        lengths = {s: {str(r): len(powers) for r, powers in gain.items()} for s, gain in gains.items()}
        source = source or max(lengths, key=lambda s: lengths[s].get(rate, 0))
        what = f"its highest power is {highest}" if highest >= 0 else "there is none"
        look = f"{letter} of rod {rod}, source {source}, interval {number}, rate {rate}: {what}"
        unit = {source: (LoadStep(fmpq(0), fmpq(1)),)}
        until = self.exact.interval * number
        return example(self.exact, unit, until, {"strain": ["1-"]}, "wavesym tables SCENE", look)()


@cache
def highest_powers(name: str, m: int) -> HighestPowers:
    """Those of an example with all rates different."""
    return HighestPowers(name, EXACT[name](m))


def power_cases(
    name: str, changes: Changes, heads: Iterable[str], most_n: int | None = None, part: int | None = None
) -> Iterator[Case]:
    """The functions of some rows or columns: in example II their moments, and in all their highest powers.

    Of a `part` of the moments only the powers, as these do not say which moments there are.
    """
    scopes: dict[tuple[int, str], RequestScope] = {}
    for m, n in (pair for pair in PAIRS[name] if most_n is None or pair[1] <= most_n):
        powers, table = highest_powers(name, m), right_rows(f"{TABLE[name]}.", m)
        for head, function in ((id, function) for id, row in table.items() for function in row if id in heads):
            letter, rod = function
            scope = scopes.setdefault((m, letter), RequestScope(name, powers.motion, letter, changes, part))
            half = head.split(".")[1]
            number = numbers(name, n)[half == "odd"]
            if name == "II" and n == 0 and part is None:
                at = {"m": m, "function": f"{letter}_{rod}", "claim": "moments s"}
                yield case(at, partial(_moments, scope, rod, number), powers.moments(half, letter, rod))
            yield from powers.cases(scope, function, number, {"m": m, "n": n})


@cache
def right_power_cases(name: str, heads: tuple[str, ...], part: int | None) -> tuple[Case, ...]:
    """The cases of rows or columns in which all is right."""
    return tuple(power_cases(name, {}, heads, part=part))


def _moments(scope: RequestScope, rod: int, number: int) -> tuple[int, ...]:
    return tuple(sorted(upper[1] for lower, upper in scope.requests(rod, number) if not lower))
