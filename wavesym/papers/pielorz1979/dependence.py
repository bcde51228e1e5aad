"""On what the solutions depend in time, on loads and on masses, and how the highest powers run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import groupby, pairwise, product
from typing import Any

from flint import fmpq

from wavesym.derivation.table import Function, Rules, unit_response
from wavesym.mechanics.chain import Chain
from wavesym.papers.evaluation import Scope, holds
from wavesym.papers.exact_tables import INTERVALS, Exact, building, collision, drive
from wavesym.papers.pielorz1979.forms import (
    ALPHA,
    FORMS,
    HALVES,
    FormScope,
    driven_form,
    form_cases,
    functions,
    right_form,
    shown,
)
from wavesym.papers.pielorz1979.listed import AT, Words
from wavesym.papers.pielorz1979.meetings import most_meetings
from wavesym.papers.pielorz1979.tables import moments
from wavesym.papers.pielorz1979.truth import EXAMPLES
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Reproduction, case
from wavesym.papers.tree import Call, Number, Series


def lengths(words: Words) -> Iterator[Case]:
    """Where functions gain anything."""
    steps = {"even": (0, 2), "odd": (1, 2), "whole": (0, 1)}[words["numbers"]]
    for name in words["examples"].removeprefix("examples ").removeprefix("example ").split(" and "):
        for exact in [driven_form(name, m).exact for m in (4, 6)[: 2 if name == "I" else 1]]:
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
            said = {s for s in moments if s % 2 == ((words["odd"] if i % 2 else words["even"]) == "odd")}
            true = come if words["quantity"] == "functions" else {s for s in moments if gains[s][-1]}
            at = {"m": m, "z": z, "function": f"{letter}'_{i}"}
            told = shown(exact, (letter, i), number)
            yield Case(at, said & come if words["arrived"] else said, true, bool(true), told)


def unlisted(words: Words) -> Iterator[Case]:
    """The functions without a row in Table 4."""
    call = read_formula(words["function"])
    assert isinstance(call, Call)
    for m in (2, 3, 4):
        missing = [(a, i) for a in "fg" for i in range(1, m + 1) if (a, i) not in functions("III", m)]
        scope = Scope({"m": m, "n": 0})
        yield case({"m": m}, lambda: [(call.function.name, scope.indices(call.function)[0])], missing)  # noqa: B023


# what exponents and powers depend on


def masses(words: Words) -> Iterator[Case]:
    """Whether a heavier body changes exponents."""
    for example, exact in (("I", collision(6)), ("II", drive(2)), ("III", driven_form("III", 2).exact)):
        p = exact.chain.parameters
        for body in sorted(p.inertia if example == "II" else p.kappa):
            kappa = {i: value / (2 if i == body else 1) for i, value in p.kappa.items()}
            inertia = p.inertia and {i: value * (2 if i == body else 1) for i, value in p.inertia.items()}
            heavier = Chain(exact.chain.system, exact.m, replace(p, kappa=kappa, inertia=inertia))
            said = {"all rigid bodies": True, "no body": False}.get(words["bodies"], body > 0)
            at = {"example": example, "m": exact.m, "mass of body": body, "claim": "exponents change"}
            yield Case(at, said, _exponents(heavier) != _exponents(exact.chain))


def _exponents(chain: Chain) -> frozenset[fmpq]:
    rules = Rules(chain)
    wanted = {Function(letter, rod): chain.m + 1 for letter in "fg" for rod in range(1, chain.m + 1)}
    found = (unit_response(rules, source, wanted) for source in chain.sources)
    return frozenset(r for response in found for parts in response.values() for part in parts for r in part)


def series(words: Words) -> Iterator[Case]:
    """The time since an interval began and a load came."""
    for example, form in FORMS.items():
        driven = driven_form(example, 4)
        for n in (0, 1, 2):
            scope = FormScope(right_form(example), driven, "f")
            time = driven.loads[{"II": "M2", "III": "a"}[example]][1].time if example != "I" else 0
            with scope.binding({"n": n, "d": 2 * n + 1, "half": "even", "z": AT, "k": 1, "s": 2, "i": 1}):
                said, at = read_formula(words[example]), {"form": form, "n": n}
                yield case(at, lambda: scope.value(said), AT - 2 * n - time)  # noqa: B023


def meetings(words: Words) -> Iterator[Case]:
    """Highest powers by what waves have met."""
    for at, count, true, told in _counted(reflected_only=words["met"] == "reflected"):
        said = count - {"one less than": 1, "": 0}[words["less"]]
        yield Case(at, max(said, -1), true, true >= 0, told)


def connected(words: Words) -> Iterator[Case]:
    """Whether places with the same number have the same highest power, in each example."""
    powers: dict[tuple[object, int], int] = {}
    for at, count, true, told in _counted(reflected_only=words["met"] == "reflected from"):
        said = powers.setdefault((at["example"], max(count, 0)), true)
        yield Case(at, said, true, true >= 0, told)


def _counted(*, reflected_only: bool) -> Iterator[tuple[dict[str, object], int, int, Callable[[], Reproduction]]]:
    """Where, the most times that a wave has met the body, and the highest power at its rate."""
    for example, sizes in (("I", (4, 6)), ("II", (1, 2, 3)), ("III", (2, 3))):
        for m in sizes:
            exact = EXAMPLES[example].tables(m)
            for source, (body, rate) in product(exact.responses, exact.rates.items()):
                node = body - (exact.interval == 1)
                count = most_meetings(exact, source, node, reflected_only=reflected_only)
                for (letter, rod), interval in product(functions(example, m), range(1, 7)):
                    true = exact.degree(letter, rod, interval, rate, source)
                    at = {"example": example, "m": m, "source": source, "body": body}
                    at |= {"function": f"{letter}_{rod}", "interval": interval}
                    yield at, count(letter, rod, interval), true, shown(exact, (letter, rod), interval)


def earlier(words: Words) -> Iterator[Case]:
    """A solution put together from the gains that its form gives it in intervals."""
    for example in FORMS:
        m = {"I": 4}.get(example, 2)
        driven = driven_form(example, m)
        step, number = driven.exact.interval, 4
        for letter, rod in functions(example, m):
            scope = FormScope(right_form(example), driven, letter)
            z = fmpq(step * number) - fmpq(2, 7)
            first = 1 if words["which"] == "all earlier intervals" else number - 1
            total: Any = 0
            for p in range(first, number + 1):
                then = z if words["when"] == "the present z" else min(z, fmpq(step * p))
                total = total + scope.total(rod, p, then) - scope.total(rod, p - 1, then)
            at = {"example": example, "m": m, "function": f"{letter}'_{rod}", "z": z}
            yield Case(at, total, driven.wave(letter, rod, z), True, shown(driven.exact, (letter, rod), number))


def changes_1(words: Words) -> Iterator[Case]:
    """How long the highest powers of example I stay."""
    for m in (4, 6, 8):
        said = {body: words["ends"] if body in (1, m - 1) else words["others"] for body in range(1, m, 2)}
        yield from _stays("I", collision(m), said)


def changes_3(words: Words) -> Iterator[Case]:
    """How long the highest powers of example III stay."""
    for m in range(2, 7):
        yield from _stays("III", building(m), dict.fromkeys((1, m), words["step"]))


def _stays(example: str, exact: Exact, said: Mapping[int, str]) -> Iterator[Case]:
    """How long the power at a body's rate stays, from its first change to its last."""
    for (body, step), (letter, rod) in product(said.items(), functions(example, exact.m)):
        numbers = range(1, INTERVALS[example] + 1)
        degrees = (exact.degree(letter, rod, number, exact.rates[body]) for number in numbers)
        runs = [len(list(run)) for _, run in groupby(degree for degree in degrees if degree >= 0)]
        if lengths := {exact.interval * run for run in runs[1:-1]}:
            at = {"m": exact.m, "function": f"{letter}_{rod}", "body": body}
            yield Case(at, {int(step)}, lengths, True, shown(exact, (letter, rod), numbers[-1]))


def parts(words: Words) -> Iterator[Case]:
    """(4.10) with as many terms in its sums over alpha and beta as said."""
    counts = {ALPHA: Number(words["parts"]), r"\beta": Number(words["terms"])}

    class Limited(FormScope):
        def series(self, series: Series) -> Any:
            return super().series(replace(series, last=counts.get(series.variable.name, series.last)))

    yield from form_cases(right_form("II"), scope=Limited)


def slopes(words: Words) -> Iterator[Case]:
    """Differences of neighbouring powers inside the three ranges of l."""
    alpha = {"first": 1, "second": 2}[words["group"]]
    slopes = {"rise": 1, "are equal": 0, "fall": -1}
    for m in range(1, 6):
        exact, known = drive(m), drive(m).rates
        for half, (letter, i) in ((h, f) for h in HALVES for f in functions("II", m)):
            scope = FormScope(right_form("II"), driven_form("II", m), letter)
            for r, s in moments(scope, half, i, alpha):
                with scope.binding({"n": 0, "half": half, "i": i, "r": r, ALPHA: alpha}):
                    ends = [0, *(scope.whole(read_formula(f"L_{beta}")) for beta in (1, 2, 3))]
                for n in range(4):
                    d = 2 * n + 1 + HALVES.index(half)
                    for part, (low, high) in zip(("one", "two", "three"), pairwise(ends), strict=True):
                        powers = [exact.degree(letter, i, d, known[b], f"M{s}") for b in range(low + 1, high + 1)]
                        for body, (one, other) in enumerate(pairwise(powers), low + 1):
                            if min(one, other) >= 0:
                                at = {"m": m, "n": n, "half": half, "function": f"{letter}_{i}", "s": s, "l": body}
                                yield Case(at, slopes[words[part]], other - one, True, shown(exact, (letter, i), d))


def by_4_2(words: Words) -> Iterator[Case]:
    """What (4.2) gives on both sides of every node, by the conditions that hold there."""
    order = {"derivatives": 1, "integrals of the derivatives": 0}[words["orders"]]
    strained = words["quantities"] == "velocities and strains"
    for example, m in (("I", 4), ("II", 2), ("III", 3)):
        driven = driven_form(example, m)
        for x, tau in product(range(m + 1), (fmpq(k) + fmpq(3, 7) for k in range(5))):
            node, at = driven.exact.chain.nodes[x], {"example": example, "m": m, "x": x, "tau": tau}
            found: list[Any] = []
            forces: Any = 0
            acceleration: Any = 0
            for rod in (rod for rod in (x, x + 1) if 1 <= rod <= m):
                f, g = driven.waves_at(rod, x, tau, order)
                found.append(f + g + driven.exact.chain.rod(rod).velocity * (1 if strained else tau))
                forces += (-node.alpha if rod == x else node.beta) * (g - f) / 2
                acceleration = sum(driven.waves_at(rod, x, tau, 2))
            if strained:
                for load in node.loads:
                    forces += sum(c * driven.load(load.source, tau, k) for k, c in enumerate(load.coefficients) if c)
                yield Case({**at, "claim": "forces"}, forces, node.inertia * acceleration)
            yield Case({**at, "claim": "both sides"}, found[0], found[-1], len(found) > 1)
