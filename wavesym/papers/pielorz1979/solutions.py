"""What section 4 says of the solutions in words: their functions and coefficients, and on what they depend."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Any

from flint import fmpq

from wavesym.derivation.table import Function, Rules, unit_response
from wavesym.mechanics.chain import Chain
from wavesym.papers.evaluation import MeaninglessError, Scope, holds
from wavesym.papers.pielorz1979.chains import LoadedChain, collision, drive
from wavesym.papers.pielorz1979.forms import (
    ALPHA,
    FORMS,
    FormScope,
    Indices,
    form_cases,
    form_chain,
    functions,
    right_form,
    table_scene,
)
from wavesym.papers.pielorz1979.powers import RequestScope
from wavesym.papers.pielorz1979.solution_powers import changes_1, changes_3, connection, meetings, slopes, table
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, case
from wavesym.papers.sentences import Words
from wavesym.papers.tree import Addition, Call, Number, Series, Symbol, latex

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


def index_roles(name: str, words: Words) -> Iterator[Case]:
    """Every coefficient that a form asks for: what the sentence says of it, and what it is."""
    m = {"I": 6, "II": 3, "III": 3}[name]
    motion = form_chain(name, m)
    for letter, rod in functions(name, m):
        scope, meant = RequestScope(name, motion, letter), FormScope(right_form(name), motion, letter)
        for lower, upper in (pair for number in range(1, 6) for pair in sorted(set(scope.requests(rod, number)))):
            if len(lower) == 2:
                at = {"m": m, "function": f"{letter}_{rod}", "coefficient": f"F_{lower}^{upper}"}
                true = _roles(name, motion, lower, upper)
                yield case(at, lambda: _stated_roles(words, meant, lower, upper, motion), true)  # noqa: B023


def _roles(name: str, motion: LoadedChain, lower: Indices, upper: Indices) -> dict[str, Any]:
    """What the coefficient with these indices is."""
    begins = motion.exact.interval * (upper[-1] - 1)
    found = {"term": lower[0], "power": lower[1], "function": upper[1 if name == "III" else 0]}
    if name == "II":
        return {**found, "moment": upper[1], "of": AT - begins - motion.loads[f"M{upper[1]}"][-1].time}
    if name == "III":
        return {**found, "part": upper[0], "begins": begins, "of": AT - begins - motion.loads["a"][upper[0]].time}
    return {**found, "begins": begins, "of": AT - begins}


def _stated_roles(
    words: Words, scope: FormScope, lower: Indices, upper: Indices, motion: LoadedChain
) -> dict[str, Any]:
    symbol, term = read_formula(words["symbol"]), read_formula(words["term"])
    assert isinstance(symbol, Symbol)
    assert isinstance(term, Symbol)
    if (len(symbol.subscript), len(symbol.superscript)) != (len(lower), len(upper)):
        raise MeaninglessError(f"{latex(symbol)} has not as many indices")
    letters: dict[str, int] = {}
    for tree, value in zip((*symbol.subscript, *symbol.superscript), (*lower, *upper), strict=True):
        plain = tree.terms[0] if isinstance(tree, Addition) else tree
        name, number = latex(plain), value if plain == tree else value - 1  # n + 1 is the number of an interval
        if letters.setdefault(name, number) != number:
            raise MeaninglessError(f"{name} is both {letters[name]} and {number}")
    last = len(motion.loads[f"M{upper[1]}"]) - 1 if "moment" in words else 0
    with scope.bind({"k": last, **letters, "z": AT}):
        found = {
            role: scope.value(read_formula(word)) for role, word in words.items() if role not in ("symbol", "term")
        }
        return {**found, "term": scope.indices(term)[0]}


# on what the solutions depend


def lengths(words: Words) -> Iterator[Case]:
    """Where functions gain anything."""
    steps = {"even": (0, 2), "odd": (1, 2), "whole": (0, 1)}[words["numbers"]]
    for name in words["examples"].removeprefix("examples ").removeprefix("example ").split(" and "):
        for exact in [form_chain(name, m).exact for m in (4, 6)[: 2 if name == "I" else 1]]:
            gains = {
                exact.interval * (number - 1)
                for response in exact.responses.values()
                for increments in response.values()
                for number, increment in enumerate(increments, 1)
                if increment
            }
            until = max(gains) + 1
            yield Case({"example": name, "m": exact.m}, list(range(steps[0], until, steps[1])), sorted(gains))


def entier(words: Words) -> Iterator[Case]:
    """(4.9) with E as said."""
    ways: dict[str, Callable[[fmpq], Any]] = {"down": fmpq.floor, "up": fmpq.ceil, "towards 0": int}
    way = ways[words["way"]]
    rounded = type("Rounded", (FormScope,), {"entier": lambda self, value: int(way(fmpq(value)))})
    yield from form_cases(right_form("I"), scope=rounded)


def acting_moments(words: Words) -> Iterator[Case]:
    """Inside of intervals: at their ends nothing jumps in a drive."""
    where = read_range(rf"z \in {words['interval']}")
    for m, half in product((1, 2, 3, 4), range(6)):
        exact, number, z = drive(m), half + 1, half + fmpq(1, 2)
        if not any(holds(where, Scope({"n": n, "z": z})) for n in range(6)):
            continue
        for letter, i in functions("II", m):
            moments = range(1, m + 2)
            gains = {s: [exact.increment(f"M{s}", letter, i, n) for n in range(1, number + 1)] for s in moments}
            come = {s for s in moments if any(gains[s])}
            claim = {s for s in moments if s % 2 == ((words["odd"] if i % 2 else words["even"]) == "odd")}
            true = come if words["quantity"] == "functions" else {s for s in moments if gains[s][-1]}
            at = {"m": m, "z": z, "function": f"{letter}'_{i}"}
            scene = table_scene(exact, (letter, i), number)
            yield Case(at, claim & come if words["arrived"] else claim, true, bool(true), scene)


def missing_function(words: Words) -> Iterator[Case]:
    """The functions without a row in Table 4, for each m that is tried, against those that a sentence names."""
    call = read_formula(words["function"])
    assert isinstance(call, Call)
    for m in (2, 3, 4):
        missing = [(a, i) for a in "fg" for i in range(1, m + 1) if (a, i) not in functions("III", m)]
        scope = Scope({"m": m, "n": 0})
        yield case({"m": m}, lambda: [(call.function.name, scope.indices(call.function)[0])], missing)  # noqa: B023


# what exponents and powers depend on


def masses(words: Words) -> Iterator[Case]:
    """Whether a heavier body changes exponents."""
    for example, exact in (("I", collision(6)), ("II", drive(2)), ("III", form_chain("III", 2).exact)):
        p = exact.chain.parameters
        for body in sorted(p.inertia if example == "II" else p.kappa):
            kappa = {i: value / (2 if i == body else 1) for i, value in p.kappa.items()}
            inertia = p.inertia and {i: value * (2 if i == body else 1) for i, value in p.inertia.items()}
            heavier = Chain(exact.chain.system, exact.m, replace(p, kappa=kappa, inertia=inertia))
            claim = {"all rigid bodies": True, "no body": False}.get(words["bodies"], body > 0)
            at = {"example": example, "m": exact.m, "mass of body": body, "claim": "exponents change"}
            yield Case(at, claim, _exponents(heavier) != _exponents(exact.chain))


def _exponents(chain: Chain) -> frozenset[fmpq]:
    rules = Rules(chain)
    wanted = {Function(letter, rod): chain.m + 1 for letter in "fg" for rod in range(1, chain.m + 1)}
    found = (unit_response(rules, source, wanted) for source in chain.sources)
    return frozenset(r for response in found for parts in response.values() for part in parts for r in part)


def series(words: Words) -> Iterator[Case]:
    """The time since an interval began and a load came."""
    for example, form in FORMS.items():
        motion = form_chain(example, 4)
        for n in (0, 1, 2):
            scope = FormScope(right_form(example), motion, "f")
            time = motion.loads[{"II": "M2", "III": "a"}[example]][1].time if example != "I" else 0
            with scope.bind({"n": n, "d": 2 * n + 1, "half": "even", "z": AT, "k": 1, "s": 2, "i": 1}):
                claim, at = read_formula(words[example]), {"form": form, "n": n}
                yield case(at, lambda: scope.value(claim), AT - 2 * n - time)  # noqa: B023


def earlier_intervals(words: Words) -> Iterator[Case]:
    """A solution put together from the gains that its form gives it in intervals."""
    for example in FORMS:
        m = {"I": 4}.get(example, 2)
        motion = form_chain(example, m)
        step, number = motion.exact.interval, 4
        for letter, rod in functions(example, m):
            scope = FormScope(right_form(example), motion, letter)
            z = fmpq(step * number) - fmpq(2, 7)
            first = 1 if words["which"] == "all earlier intervals" else number - 1
            total: Any = 0
            for p in range(first, number + 1):
                then = z if words["when"] == "the present z" else min(z, fmpq(step * p))
                total = total + scope.total(rod, p, then) - scope.total(rod, p - 1, then)
            at = {"example": example, "m": m, "function": f"{letter}'_{rod}", "z": z}
            shown = table_scene(motion.exact, (letter, rod), number, z)
            yield Case(at, total, motion.wave(letter, rod, z), True, shown)


def parts(words: Words) -> Iterator[Case]:
    """(4.10) with as many terms in its sums over alpha and beta as said."""
    counts = {ALPHA: Number(words["parts"]), r"\beta": Number(words["terms"])}

    class LimitedScope(FormScope):
        def series(self, series: Series) -> Any:
            return super().series(replace(series, last=counts.get(series.variable.name, series.last)))

    yield from form_cases(right_form("II"), scope=LimitedScope)


def by_4_2(words: Words) -> Iterator[Case]:
    """What (4.2) gives on both sides of every node, by the conditions that hold there."""
    order = {"derivatives": 1, "integrals of the derivatives": 0}[words["orders"]]
    strained = words["quantities"] == "velocities and strains"
    for example, m in (("I", 4), ("II", 2), ("III", 3)):
        motion = form_chain(example, m)
        for x, tau in product(range(m + 1), (fmpq(k) + fmpq(3, 7) for k in range(5))):
            node, at = motion.exact.chain.nodes[x], {"example": example, "m": m, "x": x, "tau": tau}
            found: list[Any] = []
            forces: Any = 0
            acceleration: Any = 0
            for rod in (rod for rod in (x, x + 1) if 1 <= rod <= m):
                f, g = motion.waves_at(rod, x, tau, order)
                found.append(f + g + motion.exact.chain.rod(rod).velocity * (1 if strained else tau))
                forces += (-node.alpha if rod == x else node.beta) * (g - f) / 2
                acceleration = sum(motion.waves_at(rod, x, tau, 2))
            if strained:
                for load in node.loads:
                    forces += sum(c * motion.load(load.source, tau, k) for k, c in enumerate(load.coefficients) if c)
                yield Case({**at, "claim": "forces"}, forces, node.inertia * acceleration)
            yield Case({**at, "claim": "both sides"}, found[0], found[-1], len(found) > 1)


SOLUTIONS: Mapping[str, Callable[[Words], Iterator[Case]]] = {
    "lengths": lengths,
    "entier": entier,
    "table_2": partial(table, "I"),
    "table_3": partial(table, "II"),
    "table_4": partial(table, "III"),
    "functions": count,
    "others": others,
    "indices_4_9": partial(index_roles, "I"),
    "indices_4_10": partial(index_roles, "II"),
    "indices_4_12": partial(index_roles, "III"),
    "moments": acting_moments,
    "unlisted": missing_function,
    "exponents": masses,
    "series": series,
    "connected": connection,
    "meetings": meetings,
    "earlier": earlier_intervals,
    "changes_1": changes_1,
    "changes_3": changes_3,
    "terms": parts,
    "fields": by_4_2,
    "slopes": slopes,
}
"""What is tried for the words of a sentence, by its pattern."""
