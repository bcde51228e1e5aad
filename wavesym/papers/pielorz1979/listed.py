"""What Tables 2 to 4 list, and what the indices of coefficients mean: by the coefficients that forms ask for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from flint import fmpq

from wavesym.exact.table import Function, Rules, unit_response
from wavesym.model.chain import Chain
from wavesym.model.node import Parameters
from wavesym.papers.evaluation import MeaninglessError, Scope
from wavesym.papers.exact_tables import Exact, building, collision, drive
from wavesym.papers.pielorz1979 import limits
from wavesym.papers.pielorz1979.forms import INTERVALS, Form, FormScope, Words, moved, rates, right_form, shown
from wavesym.papers.pielorz1979.truth import Driven, loads
from wavesym.papers.reader import read_formula
from wavesym.papers.record import Case, case
from wavesym.papers.tree import Symbol, latex, symbols
from wavesym.systems.building import BUILDING_FORCE
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

MOST_N = 5
"""Intervals that are tabulated for chains in which rates are equal."""
AT = fmpq(43, 3)
"""Some z at which expressions are compared."""


class Asked(FormScope):
    """A form that keeps which coefficients it asks for, all of them 0."""

    def __init__(self, form: Form, driven: Driven, letter: str) -> None:
        super().__init__(form, driven, letter)
        self.asked: set[tuple[tuple[int, ...], tuple[int, ...]]] = set()

    def coefficient(self, lower: tuple[int, ...], upper: tuple[int, ...]) -> Any:
        """0, where a coefficient is asked for."""
        self.asked.add((lower, upper))
        return 0


def asked(example: str, driven: Driven, letter: str, rod: int, number: int) -> Asked:
    """What a form asks for until the interval 1, 2, ... when all loads have come."""
    scope = Asked(right_form(example), driven, letter)
    scope.total(rod, number, fmpq(100))
    return scope


def count(words: Words) -> Iterator[Case]:
    """How many functions Table 2 has."""
    for m in (4, 6, 8, 10):
        yield Case({"m": m}, Scope({"m": m}).value(read_formula(words["count"])), len(limits.functions("I", m)))


def others(words: Words) -> Iterator[Case]:
    """Functions whose derived equation has no derivative and no function that is not found yet."""
    for m in (4, 6, 8):
        exact, found = collision(m), {Function(*function) for function in limits.functions("I", m)}
        rules, first = Rules(exact.chain), len(found)
        left = {Function(letter, rod) for letter in "fg" for rod in range(1, m + 1)} - found
        while new := {f for f in left if _follows(rules, f, found)}:
            found |= new
            left -= new
        yield Case({"m": m}, Scope({"m": m}).value(read_formula(words["count"])), len(found) - first)


def _follows(rules: Rules, function: Function, found: set[Function]) -> bool:
    rule = rules[function]
    own = {Function(term.function, term.rod) for term in rule.terms} - {function}
    return rule.own.same.slope == 0 and own <= found


def listed(example: str, chains: Callable[[str], Iterator[Exact]]) -> Callable[[Words], Iterator[Case]]:
    """The highest power at every rate, by the limits of the form and by the exact tables."""

    def cases(words: Words) -> Iterator[Case]:
        for exact in chains(words["hypothesis"]):
            driven = Driven(exact, loads(exact))
            last = (INTERVALS[example] + 1) * (2 if example == "II" else 1)
            for letter, rod in limits.functions(example, exact.m):
                at = {"m": exact.m, "kappa": dict(exact.chain.parameters.kappa), "function": f"{letter}_{rod}"}
                if not 1 <= rod <= exact.m:
                    yield Case({**at, "claim": "there is such a rod"}, True, False)
                    continue
                said = [(lower, upper) for lower, upper in asked(example, driven, letter, rod, last).asked if lower[1:]]
                for number in range(1, last + 1):
                    true = _true_powers(exact, letter, rod, number)
                    powers = _said_powers(exact, [pair for pair in said if pair[1][-1] == number])
                    told = shown(exact, letter, rod, number) if exact.m >= exact.chain.system.smallest else None
                    yield Case({**at, "interval": number}, powers, true, bool(true), told)
        if "powers" in words:
            letters = {latex(tree) for tree in symbols(right_form("I").step) if tree.name == "K"}
            yield Case({"claim": "a letter of (4.9)"}, latex(read_formula(words["powers"])) in letters, True)

    return cases


def _said_powers(exact: Exact, said: list[tuple[tuple[int, ...], tuple[int, ...]]]) -> dict[str, int]:
    found: dict[str, int] = {}
    for (body, power), upper in said:
        key = _named(rates(exact)[body], f"M{upper[1]}" if exact.interval == 1 else "")
        found[key] = max(found.get(key, 0), power)
    return found


def _true_powers(exact: Exact, letter: str, rod: int, number: int) -> dict[str, int]:
    found: dict[str, int] = {}
    for source in exact.responses:
        for rate, powers in exact.increment(source, letter, rod, number).items():
            if rate != 0:
                key = _named(rate, source if exact.interval == 1 else "")
                found[key] = max(found.get(key, 0), len(powers) - 1)
    return found


def _named(rate: fmpq, source: str) -> str:
    return " ".join(filter(None, (f"rate {rate}", source)))


def _chain(system: Any, m: int, **parameters: Any) -> Exact:
    chain = Chain(system, m, Parameters(**parameters))
    rules = Rules(chain)
    wanted = {Function(letter, rod): MOST_N + 1 for letter in "fg" for rod in range(1, m + 1)}
    return Exact(chain, rules.interval, {source: unit_response(rules, source, wanted) for source in chain.sources})


@cache
def _like(name: str) -> Exact:
    """Chains in which rates are equal, and the collision of two bars."""
    one = fmpq(1)
    if name == "I":
        kappa = {1: fmpq(3, 7), 3: fmpq(3, 7)}
        return _chain(COLLISION, 4, kappa=kappa, velocity={1: one, 3: -one})
    if name == "II":
        discs = dict.fromkeys(range(1, 4), one)
        return _chain(DRIVE, 2, kappa={1: one, 2: one}, inertia=discs)
    return _chain(BUILDING_FORCE, 2, kappa={0: fmpq(2, 7), 1: fmpq(3, 5), 2: fmpq(6, 5)})


def collisions(hypothesis: str) -> Iterator[Exact]:
    """Collisions for which a hypothesis holds."""
    yield from (collision(m) for m in (4, 6, 8))
    if "different" not in hypothesis:
        yield _like("I")
    if "m is at least 4" not in hypothesis:
        yield collision(2)


def drives(hypothesis: str) -> Iterator[Exact]:
    """Drives for which a hypothesis holds."""
    yield from (drive(m) for m in (1, 2))
    if "different" not in hypothesis:
        yield _like("II")


def buildings(hypothesis: str) -> Iterator[Exact]:
    """Buildings for which a hypothesis holds."""
    yield from (building(m) for m in (2, 3, 4))
    if "different" not in hypothesis:
        yield _like("III")


def index_roles(example: str) -> Callable[[Words], Iterator[Case]]:
    """Every coefficient that a form asks for: what the sentence says of it, and what it is."""

    def cases(words: Words) -> Iterator[Case]:
        m = {"I": 6, "II": 3, "III": 3}[example]
        driven = moved(example, m)
        for letter, rod in limits.functions(example, m):
            scope = asked(example, driven, letter, rod, 5)
            for lower, upper in sorted(scope.asked, key=lambda pair: (pair[1][-1], pair)):
                if len(lower) == 2:
                    at = {"m": m, "function": f"{letter}_{rod}", "coefficient": f"F_{lower}^{upper}"}
                    true = _roles(example, driven, lower, upper)
                    yield case(at, lambda: _said_roles(words, scope, lower, upper, driven), true)  # noqa: B023

    return cases


def _roles(example: str, driven: Driven, lower: tuple[int, ...], upper: tuple[int, ...]) -> dict[str, Any]:
    """What the coefficient with these indices is."""
    begins = driven.exact.interval * (upper[-1] - 1)
    found = {"term": lower[0], "power": lower[1]}
    if example == "I":
        return {**found, "function": upper[0], "begins": begins, "of": AT - begins}
    if example == "II":
        since = AT - begins - driven.loads[f"M{upper[1]}"][-1].time
        return {**found, "function": upper[0], "moment": upper[1], "of": since}
    since = AT - begins - driven.loads["a"][upper[0]].time
    return {**found, "function": upper[1], "part": upper[0], "begins": begins, "of": since}


def _said_roles(
    words: Words, scope: FormScope, lower: tuple[int, ...], upper: tuple[int, ...], driven: Driven
) -> dict[str, Any]:
    symbol = read_formula(words["symbol"])
    assert isinstance(symbol, Symbol)
    if (len(symbol.below), len(symbol.above)) != (len(lower), len(upper)):
        raise MeaninglessError(f"{latex(symbol)} has not as many indices")
    letters: dict[str, int] = {}
    for tree, value in (*zip(symbol.below, lower, strict=True), *zip(symbol.above, upper, strict=True)):
        name, number = (tree.name, value) if isinstance(tree, Symbol) else (tree.terms[0].name, value - 1)  # type: ignore[union-attr]
        if letters.setdefault(name, number) != number:
            raise MeaninglessError(f"{name} is both {letters[name]} and {number}")
    term = read_formula(words["term"])
    assert isinstance(term, Symbol)
    last = len(driven.loads[f"M{upper[1]}"]) - 1 if "moment" in words else 0
    with scope.binding({"k": last, **letters, "z": AT}):
        found = {
            role: scope.value(read_formula(word)) for role, word in words.items() if role not in ("symbol", "term")
        }
        return {**found, "term": scope.indices(term)[0]}
