"""On what the solutions depend in time, on loads and on masses, and how the highest powers run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from itertools import groupby, pairwise, product
from typing import Any

from flint import fmpq

from wavesym.exact.table import Function, Rules, unit_response
from wavesym.model.chain import Chain
from wavesym.model.node import Rod
from wavesym.papers.evaluation import Scope, holds
from wavesym.papers.exact_tables import INTERVALS, Exact, building, collision, drive
from wavesym.papers.pielorz1979 import limits
from wavesym.papers.pielorz1979.form_constants import moments
from wavesym.papers.pielorz1979.forms import FORMS, FormScope, Words, form_cases, moved, rates, right_form, shown
from wavesym.papers.pielorz1979.listed import AT
from wavesym.papers.pielorz1979.meetings import most_meetings
from wavesym.papers.pielorz1979.truth import EXAMPLES, Driven
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, case
from wavesym.papers.tree import Call, Number, Series, Tree


def lengths(words: Words) -> Iterator[Case]:
    """Where functions gain anything."""
    steps = {"even": (0, 2), "odd": (1, 2), "whole": (0, 1)}[words["numbers"]]
    for name in words["examples"].removeprefix("examples ").removeprefix("example ").split(" and "):
        for exact in [moved(name, m).exact for m in (4, 6)[: 2 if name == "I" else 1]]:
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
    ways: dict[str, Callable[[fmpq], int]] = {
        "down": lambda x: int(x.floor()),
        "up": lambda x: int(x.ceil()),
        "towards 0": int,
    }
    scope = type("Rounded", (FormScope,), {"entier": lambda self, value: ways[words["way"]](fmpq(value))})
    yield from form_cases(right_form("I"), scope=scope)


def heaviside(words: Words) -> Iterator[Case]:
    """(4.12) with H(0) as said; with 0 and 1 where it is not."""
    known = {" with H(0) = 0": (0,), " with H(0) = 1": (1,)}.get(words["at_0"], (0, 1))
    for at_0 in known:
        scope = type("At0", (FormScope,), {"heaviside_at_0": at_0})
        for tried in form_cases(right_form("III"), scope=scope):
            yield replace(tried, at={"H(0)": at_0, **tried.at})


def acting_moments(words: Words) -> Iterator[Case]:
    """Inside of intervals: at their ends nothing jumps in a drive."""
    where = read_range(rf"z \in {words['interval']}")
    for m, z in ((m, n + fmpq(1, 2)) for m in (1, 2, 3, 4) for n in range(6)):
        exact, number = drive(m), int(z.ceil())
        if not any(_lies(where, Scope({"z": z}), n) for n in range(6)):
            continue
        for letter, i in limits.functions("II", m):
            come = {s for s in range(1, m + 2) if _gained(exact, s, letter, i, range(1, number + 1))}
            gaining = {s for s in come if _gained(exact, s, letter, i, range(number, number + 1))}
            parity = words["odd"] if i % 2 else words["even"]
            said = {s for s in range(1, m + 2) if s % 2 == (parity == "odd")}
            true = come if words["quantity"] == "functions" else gaining
            at = {"m": m, "z": z, "function": f"{letter}'_{i}"}
            told = shown(exact, letter, i, number)
            yield Case(at, said & come if words["arrived"] else said, true, bool(true), told)


def _lies(where: Tree, scope: Scope, n: int) -> bool:
    with scope.binding({"n": n}):
        return holds(where, scope)


def _gained(exact: Exact, s: int, letter: str, rod: int, numbers: range) -> bool:
    return any(exact.increment(f"M{s}", letter, rod, number) for number in numbers)


def unlisted(words: Words) -> Iterator[Case]:
    """The functions without a row in Table 4."""
    call = read_formula(words["function"])
    assert isinstance(call, Call)
    for m in (2, 3, 4):
        missing = [(a, i) for a in "fg" for i in range(1, m + 1) if (a, i) not in limits.functions("III", m)]
        scope = Scope({"m": m, "n": 0})
        yield case({"m": m}, lambda: [(call.function.name, scope.indices(call.function)[0])], missing)  # noqa: B023


# what exponents and powers depend on


def masses(words: Words) -> Iterator[Case]:
    """Whether a heavier body changes exponents."""
    for example, exact in (("I", collision(6)), ("II", drive(2)), ("III", moved("III", 2).exact)):
        p = exact.chain.parameters
        numbers = sorted({*(p.kappa if example != "II" else p.inertia)})
        for body in numbers:
            kappa = {i: value / (2 if i == body else 1) for i, value in p.kappa.items()}
            inertia = p.inertia and {i: value * (2 if i == body else 1) for i, value in p.inertia.items()}
            heavier = Chain(exact.chain.system, exact.m, replace(p, kappa=kappa, inertia=inertia))
            said = {"all rigid bodies": True, "no body": False}.get(words["bodies"], body > 0)
            yield Case(
                {"example": example, "m": exact.m, "mass of body": body, "claim": "exponents change"},
                said,
                _exponents(heavier) != _exponents(exact.chain),
            )


def _exponents(chain: Chain) -> frozenset[fmpq]:
    rules = Rules(chain)
    wanted = {Function(letter, rod): chain.m + 1 for letter in "fg" for rod in range(1, chain.m + 1)}
    found = (unit_response(rules, source, wanted) for source in chain.sources)
    return frozenset(r for response in found for parts in response.values() for part in parts for r in part)


def series(words: Words) -> Iterator[Case]:
    """The time since an interval began and a load came."""
    for example, form in FORMS.items():
        driven = moved(example, 4)
        for n in (0, 1, 2):
            start = 2 * n
            bound: dict[str, Any] = {"n": n, "d": start + 1, "half": "even", "z": AT, "k": 1, "s": 2, "i": 1}
            scope = FormScope(right_form(example), driven, "f")
            time = driven.loads[{"II": "M2", "III": "a"}[example]][1].time if example != "I" else 0
            with scope.binding(bound):
                at = {"form": form, "n": n}
                yield case(at, lambda: scope.value(read_formula(words[example])), AT - start - time)  # noqa: B023


def meetings(words: Words) -> Iterator[Case]:
    """Highest powers by what waves have met."""
    for example, sizes in (("I", (4, 6)), ("II", (1, 2, 3)), ("III", (2, 3))):
        for m in sizes:
            exact = EXAMPLES[example].tables(m)
            for source in exact.responses:
                for number, rate in rates(exact).items():
                    body = number - (exact.interval == 1)
                    count = most_meetings(exact, source, body, reflected_only=words["met"] == "reflected")
                    for letter, rod in limits.functions(example, m):
                        for interval in range(1, 7):
                            true = exact.degree(letter, rod, interval, rate, source)
                            said = count(letter, rod, interval) - {"one less than": 1, "": 0}[words["less"]]
                            at = {"example": example, "m": m, "source": source, "body": number}
                            at |= {"function": f"{letter}_{rod}", "interval": interval}
                            yield Case(at, max(said, -1), true, true >= 0, shown(exact, letter, rod, interval))


def earlier(words: Words) -> Iterator[Case]:
    """A solution put together from the gains that its form gives it in intervals."""
    for example in FORMS:
        m = {"I": 4}.get(example, 2)
        driven = moved(example, m)
        step, number = driven.exact.interval, 4
        for letter, rod in limits.functions(example, m):
            scope = FormScope(right_form(example), driven, letter)
            z = fmpq(step * number) - fmpq(2, 7)
            first = 1 if words["which"] == "all earlier intervals" else number - 1
            total: Any = 0
            for p in range(first, number + 1):
                then = z if words["when"] == "the present z" else min(z, fmpq(step * p))
                total = total + scope.total(rod, p, then) - scope.total(rod, p - 1, then)
            at = {"example": example, "m": m, "function": f"{letter}'_{rod}", "z": z}
            yield Case(at, total, driven.wave(letter, rod, z), True, shown(driven.exact, letter, rod, number))


def _runs(degrees: list[int]) -> set[int]:
    """How many intervals a power stays, from its first change to its last."""
    return set([len(list(run)) for _, run in groupby(d for d in degrees if d >= 0)][1:-1])


def changes_1(words: Words) -> Iterator[Case]:
    """How long the highest powers of example I stay."""
    for m in (4, 6, 8):
        for body, rate in rates(collision(m)).items():
            said = words["ends"] if body in (1, m - 1) else words["others"]
            yield from _stays("I", collision(m), f"body {body}", rate, int(said))


def changes_3(words: Words) -> Iterator[Case]:
    """How long the highest powers of example III stay."""
    for m in range(2, 7):
        known = rates(building(m))
        for name, rate in (("kappa_1", known[1]), ("kappa_m", known[m])):
            yield from _stays("III", building(m), name, rate, int(words["step"]))


def _stays(example: str, exact: Exact, name: str, rate: fmpq, said: int) -> Iterator[Case]:
    for letter, rod in limits.functions(example, exact.m):
        degrees = [exact.degree(letter, rod, n, rate) for n in range(1, INTERVALS[example] + 1)]
        if lengths := {exact.interval * length for length in _runs(degrees)}:
            at = {"m": exact.m, "function": f"{letter}_{rod}", "rate": name}
            yield Case(at, {said}, lengths, True, shown(exact, letter, rod, INTERVALS[example]))


def parts(words: Words) -> Iterator[Case]:
    """(4.10) with as many terms in its sums over alpha and beta as said."""
    form = right_form("II")
    counts = {limits.ALPHA: words["parts"], r"\beta": words["terms"]}
    yield from form_cases(replace(form, step=_relimited(form.step, counts)))


def _relimited(tree: Any, counts: Mapping[str, str]) -> Any:
    """The tree with other upper limits of its sums."""
    if isinstance(tree, tuple):
        return tuple(_relimited(part, counts) for part in tree)
    if not is_dataclass(tree):
        return tree
    changed = replace(tree, **{f.name: _relimited(getattr(tree, f.name), counts) for f in fields(tree)})  # type: ignore[type-var]
    if isinstance(changed, Series) and changed.variable.name in counts:
        return replace(changed, last=Number(counts[changed.variable.name]))
    return changed


def slopes(words: Words) -> Iterator[Case]:
    """Differences of neighbouring powers inside the three ranges of l."""
    alpha = {"first": 1, "second": 2}[words["group"]]
    slopes = {"rise": 1, "are equal": 0, "fall": -1}
    for m in range(1, 6):
        exact, known = drive(m), rates(drive(m))
        for half, (letter, i) in ((h, f) for h in limits.HALVES for f in limits.functions("II", m)):
            scope = FormScope(right_form("II"), moved("II", m), letter)
            for r, s in moments(scope, half, i, (alpha,)):
                with scope.binding({"n": 0, "half": half, "i": i, "r": r, limits.ALPHA: alpha}):
                    ends = [0, *(scope.whole(read_formula(f"L_{beta}")) for beta in (1, 2, 3))]
                for n in range(4):
                    d = 2 * n + 1 + limits.HALVES.index(half)
                    for part, (low, high) in zip(("one", "two", "three"), pairwise(ends), strict=True):
                        powers = [exact.degree(letter, i, d, known[b], f"M{s}") for b in range(low + 1, high + 1)]
                        for body, (one, other) in enumerate(pairwise(powers), low + 1):
                            if min(one, other) >= 0:
                                at = {"m": m, "n": n, "half": half, "function": f"{letter}_{i}", "s": s, "l": body}
                                yield Case(at, slopes[words[part]], other - one, True, shown(exact, letter, i, d))


def by_4_2(words: Words) -> Iterator[Case]:
    """What (4.2) gives on both sides of every node, by the conditions that hold there."""
    order = {"derivatives": 1, "integrals of the derivatives": 0}[words["orders"]]
    for example, m in (("I", 4), ("II", 2), ("III", 3)):
        driven = moved(example, m)
        for x, tau in product(range(m + 1), (fmpq(k) + fmpq(3, 7) for k in range(5))):
            node, at = driven.exact.chain.nodes[x], {"example": example, "m": m, "x": x, "tau": tau}
            sides = [rod for rod in (x, x + 1) if 1 <= rod <= m]
            if words["quantities"] == "velocities and strains":
                strains = {rod: _field(driven, rod, x, tau, order, -1) for rod in sides}
                forces = sum(
                    (node.alpha * -strains[rod] if rod == x else node.beta * strains[rod]) / 2 for rod in sides
                )
                for load in node.loads:
                    forces += sum(c * driven.load(load.source, tau, k) for k, c in enumerate(load.coefficients) if c)
                yield Case({**at, "claim": "forces"}, forces, node.inertia * _field(driven, sides[0], x, tau, 2, 1))
                found = [_field(driven, rod, x, tau, order, 1) + _rod(driven, rod).velocity for rod in sides]
            else:
                found = [_field(driven, rod, x, tau, order, 1) + _rod(driven, rod).velocity * tau for rod in sides]
            yield Case({**at, "claim": "both sides"}, found[0], found[-1], len(sides) > 1)


def _rod(driven: Driven, rod: int) -> Rod:
    return driven.exact.chain.rod(rod)


def _field(driven: Driven, rod: int, x: int, tau: fmpq, order: int, sign: int) -> Any:
    """g with f added or taken away, on the clocks of Table 1."""
    clock = _rod(driven, rod)
    since, along = tau - clock.tau0, x - clock.x0
    return driven.wave("g", rod, since + along, order) + sign * driven.wave("f", rod, since - along, order)
