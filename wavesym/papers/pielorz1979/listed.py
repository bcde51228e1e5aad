"""What Tables 2 to 4 list, and what the indices of coefficients mean: by the coefficients that forms ask for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any

from flint import fmpq

from wavesym.derivation.table import Function, Rules
from wavesym.mechanics.node import Parameters
from wavesym.papers.evaluation import MeaninglessError, Scope
from wavesym.papers.exact_tables import building, collision, drive, with_parameters
from wavesym.papers.pielorz1979.forms import (
    INTERVALS,
    SIZES,
    FormScope,
    Indices,
    driven_form,
    functions,
    numbers,
    right_form,
)
from wavesym.papers.pielorz1979.powers import HighestPowers, RequestScope, highest_powers
from wavesym.papers.pielorz1979.rates import chains_of_rates
from wavesym.papers.pielorz1979.truth import DrivenChain
from wavesym.papers.reader import read_formula
from wavesym.papers.record import Case, case
from wavesym.papers.tree import Addition, Symbol, latex, symbols

Words = Mapping[str, str]
"""The words of a sentence, by their places."""
AT = fmpq(43, 3)
"""Some z at which expressions are compared."""


def count(words: Words) -> Iterator[Case]:
    """How many functions Table 2 has."""
    for m in (4, 6, 8, 10):
        yield Case({"m": m}, Scope({"m": m}).value(read_formula(words["count"])), len(functions("I", m)))


def others(words: Words) -> Iterator[Case]:
    """Functions whose derived equation has no derivative and no function that is not found yet."""
    for m in (4, 6, 8):
        found = {Function(*function) for function in functions("I", m)}
        rules, first = Rules(collision(m).chain), len(found)
        left = {Function(letter, rod) for letter in "fg" for rod in range(1, m + 1)} - found
        while new := {f for f in left if _follows(rules, f, found)}:
            found |= new
            left -= new
        yield Case({"m": m}, Scope({"m": m}).value(read_formula(words["count"])), len(found) - first)


def _follows(rules: Rules, function: Function, found: set[Function]) -> bool:
    rule = rules[function]
    own = {Function(term.function, term.rod) for term in rule.terms} - {function}
    return rule.own.same.slope == 0 and own <= found


def table(name: str) -> Callable[[Words], Iterator[Case]]:
    """The highest power at every rate, by the limits of the form and by the exact tables."""

    def cases(words: Words) -> Iterator[Case]:
        for chain in _chains(name, words["hypothesis"]):
            exact = chain.exact
            for letter, rod in functions(name, exact.m):
                at = {"m": exact.m, "kappa": dict(exact.chain.parameters.kappa)}
                if not 1 <= rod <= exact.m:
                    yield Case({**at, "function": f"{letter}_{rod}", "claim": "there is such a rod"}, True, False)
                    continue
                scope = RequestScope(name, chain.driven, letter)
                for number in range(1, numbers(name, INTERVALS[name])[-1] + 1):
                    yield from chain.cases(scope, (letter, rod), number, {**at, "interval": number})
        yield from _of_rates(name, words["hypothesis"])
        if "powers" in words:
            letters = {latex(tree) for tree in symbols(right_form("I").step) if tree.name == "K"}
            yield Case({"claim": "a letter of (4.9)"}, latex(read_formula(words["powers"])) in letters, True)

    return cases


def _of_rates(name: str, hypothesis: str) -> Iterator[Case]:
    """Whether no power is higher than in the table just where the hypothesis holds."""
    for exact, true in chains_of_rates({"I": "T2", "II": "T3", "III": "T4"}[name]):
        kappa, gamma = exact.chain.parameters.kappa, exact.rates
        said = "rates" not in hypothesis or len(set(gamma.values())) == len(gamma)
        said = said and ("2" not in hypothesis or 2 * kappa[1] != kappa[exact.m])
        at = {"m": exact.m, "kappa": dict(kappa), "rates": tuple(gamma.values())}
        yield Case({**at, "claim": "no power is higher than in the table"}, said, true)


def _chains(name: str, hypothesis: str) -> Iterator[HighestPowers]:
    """Those for which a hypothesis holds."""
    yield from (highest_powers(name, m) for m in SIZES[name][: 2 if name == "II" else 3])
    if "different" not in hypothesis:
        yield _like(name)
    if name == "I" and "m is at least 4" not in hypothesis:
        yield highest_powers("I", 2)


@cache
def _like(name: str) -> HighestPowers:
    """A chain in which rates are equal."""
    one = fmpq(1)
    exact, parameters = {
        "I": (collision, Parameters(kappa=dict.fromkeys((1, 3), fmpq(3, 7)), velocity={1: one, 3: -one})),
        "II": (drive, Parameters(kappa=dict.fromkeys((1, 2), one), inertia=dict.fromkeys((1, 2, 3), one))),
        "III": (building, Parameters(kappa={0: fmpq(2, 7), 1: fmpq(3, 5), 2: fmpq(6, 5)})),
    }[name]
    return HighestPowers(name, with_parameters(exact(4 if name == "I" else 2), parameters))


def index_roles(name: str) -> Callable[[Words], Iterator[Case]]:
    """Every coefficient that a form asks for: what the sentence says of it, and what it is."""

    def cases(words: Words) -> Iterator[Case]:
        m = {"I": 6, "II": 3, "III": 3}[name]
        driven = driven_form(name, m)
        for letter, rod in functions(name, m):
            scope, meant = RequestScope(name, driven, letter), FormScope(right_form(name), driven, letter)
            for lower, upper in (pair for number in range(1, 6) for pair in sorted(set(scope.requests(rod, number)))):
                if len(lower) == 2:
                    at = {"m": m, "function": f"{letter}_{rod}", "coefficient": f"F_{lower}^{upper}"}
                    true = _roles(name, driven, lower, upper)
                    yield case(at, lambda: _said_roles(words, meant, lower, upper, driven), true)  # noqa: B023

    return cases


def _roles(name: str, driven: DrivenChain, lower: Indices, upper: Indices) -> dict[str, Any]:
    """What the coefficient with these indices is."""
    begins = driven.exact.interval * (upper[-1] - 1)
    found = {"term": lower[0], "power": lower[1], "function": upper[1 if name == "III" else 0]}
    if name == "II":
        return {**found, "moment": upper[1], "of": AT - begins - driven.loads[f"M{upper[1]}"][-1].time}
    if name == "III":
        return {**found, "part": upper[0], "begins": begins, "of": AT - begins - driven.loads["a"][upper[0]].time}
    return {**found, "begins": begins, "of": AT - begins}


def _said_roles(words: Words, scope: FormScope, lower: Indices, upper: Indices, driven: DrivenChain) -> dict[str, Any]:
    symbol, term = read_formula(words["symbol"]), read_formula(words["term"])
    assert isinstance(symbol, Symbol)
    assert isinstance(term, Symbol)
    if (len(symbol.below), len(symbol.above)) != (len(lower), len(upper)):
        raise MeaninglessError(f"{latex(symbol)} has not as many indices")
    letters: dict[str, int] = {}
    for tree, value in zip((*symbol.below, *symbol.above), (*lower, *upper), strict=True):
        plain = tree.terms[0] if isinstance(tree, Addition) else tree
        name, number = latex(plain), value if plain == tree else value - 1  # n + 1 is the number of an interval
        if letters.setdefault(name, number) != number:
            raise MeaninglessError(f"{name} is both {letters[name]} and {number}")
    last = len(driven.loads[f"M{upper[1]}"]) - 1 if "moment" in words else 0
    with scope.binding({"k": last, **letters, "z": AT}):
        found = {
            role: scope.value(read_formula(word)) for role, word in words.items() if role not in ("symbol", "term")
        }
        return {**found, "term": scope.indices(term)[0]}
