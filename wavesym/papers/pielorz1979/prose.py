"""What section 4 says of the solutions in words: sentences, each with what its words are evaluated to.

The patterns of the sentences (sentences.py) are in sayings.toml; here are the cases that their words give.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from itertools import groupby, pairwise, product
from pathlib import Path
from typing import Any

from flint import fmpq

from wavesym.exact.table import Function, Rules, unit_response
from wavesym.model.chain import Chain
from wavesym.model.node import Parameters, Rod
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds
from wavesym.papers.exact_tables import INTERVALS, Exact, building, collision, drive
from wavesym.papers.pielorz1979 import limits
from wavesym.papers.pielorz1979.forms import INTERVALS as TRIED
from wavesym.papers.pielorz1979.forms import Form, FormScope, corrected, form_cases, moments, moved, rates
from wavesym.papers.pielorz1979.meetings import most_meetings
from wavesym.papers.pielorz1979.transcription import entry as transcribed
from wavesym.papers.pielorz1979.truth import EXAMPLES, Driven, loads
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Reading, Test, case
from wavesym.papers.sentences import Pattern, sentence_reader
from wavesym.papers.tree import Call, Number, Series, Symbol, Tree, latex, symbols
from wavesym.systems.building import BUILDING_FORCE
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

Words = Mapping[str, str]
FORMS = {"I": "(4.9)", "II": "(4.10)", "III": "(4.12)"}
MOST_N = 5


@cache
def sayings() -> Mapping[str, tuple[Pattern, str]]:
    """The patterns of sentences, each with what it is compared with, by name."""
    told = tomllib.loads(Path(__file__).with_name("sayings.toml").read_text(encoding="utf-8"))
    return {name: (Pattern(name, said["text"], said["words"]), said["against"]) for name, said in told.items()}


def solution(entry: Entry) -> Test:
    """Adapter: a sentence about the solutions."""
    reader = sentence_reader(pattern for pattern, _ in sayings().values())
    right = reader.read(entry.slip.corrected if entry.slip else entry.printed, ()).formula.pattern

    def cases(reading: Reading) -> Iterator[Case]:
        return CASES[reading.formula.pattern](reading.formula.words)

    return Test(sayings()[right][1], cases, reader.read, reader.faults)


@cache
def right_form(example: str) -> Form:
    """The form of an example's solutions as corrected."""
    return Form.of(example, corrected(transcribed(FORMS[example])))


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


# where formulas change


def _lengths(words: Words) -> Iterator[Case]:
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


def _entier(words: Words) -> Iterator[Case]:
    ways: dict[str, Callable[[fmpq], int]] = {
        "down": lambda x: int(x.floor()),
        "up": lambda x: int(x.ceil()),
        "towards 0": int,
    }
    scope = type("Rounded", (FormScope,), {"entier": lambda self, value: ways[words["way"]](fmpq(value))})
    yield from form_cases(right_form("I"), scope=scope)


def _heaviside(words: Words) -> Iterator[Case]:
    known = {" with H(0) = 0": (0,), " with H(0) = 1": (1,)}.get(words["at_0"], (0, 1))
    for at_0 in known:
        scope = type("At0", (FormScope,), {"heaviside_at_0": at_0})
        for tried in form_cases(right_form("III"), scope=scope):
            yield replace(tried, at={"H(0)": at_0, **tried.at})


# what stands in the tables


def _listed(example: str, chains: Callable[[str], Iterator[Exact]]) -> Callable[[Words], Iterator[Case]]:
    """The highest power at every rate, by the limits of the form and by the exact tables."""

    def cases(words: Words) -> Iterator[Case]:
        if "powers" in words:
            columns = {latex(read_formula(words["powers"]))}
            found = {latex(tree) for tree in symbols(right_form("I").step) if tree.name == "K" and len(tree.below) == 2}
            yield Case({"claim": "the letter of (4.9)"}, columns, found)
        for exact in chains(words["hypothesis"]):
            driven = Driven(exact, loads(exact))
            last = (TRIED[example] + 1) * (2 if example == "II" else 1)
            for letter, rod in limits.functions(example, exact.m):
                at = {"m": exact.m, "kappa": dict(exact.chain.parameters.kappa), "function": f"{letter}_{rod}"}
                if not 1 <= rod <= exact.m:
                    yield Case({**at, "claim": "there is such a rod"}, True, False)
                    continue
                said = [(lower, upper) for lower, upper in asked(example, driven, letter, rod, last).asked if lower[1:]]
                for number in range(1, last + 1):
                    true = _true_powers(exact, letter, rod, number)
                    found = _said_powers(exact, [pair for pair in said if pair[1][-1] == number])
                    yield Case({**at, "interval": number}, found, true, bool(true))

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


def _collisions(hypothesis: str) -> Iterator[Exact]:
    if "m is at least 4" not in hypothesis:
        yield collision(2)
    yield from (collision(m) for m in (4, 6, 8))
    if "different" not in hypothesis:
        yield _like("I")


def _drives(hypothesis: str) -> Iterator[Exact]:
    yield from (drive(m) for m in (1, 2))
    if "different" not in hypothesis:
        yield _like("II")


def _buildings(hypothesis: str) -> Iterator[Exact]:
    yield from (building(m) for m in (2, 3, 4))
    if "different" not in hypothesis:
        yield _like("III")


def _count(words: Words) -> Iterator[Case]:
    for m in (4, 6, 8, 10):
        yield Case({"m": m}, Scope({"m": m}).value(read_formula(words["count"])), len(limits.functions("I", m)))


def _others(words: Words) -> Iterator[Case]:
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


# what indices mean


def _indices(example: str) -> Callable[[Words], Iterator[Case]]:
    """Every coefficient that a form asks for: what the sentence says of it, and what it is."""

    def cases(words: Words) -> Iterator[Case]:
        m = {"I": 6, "II": 3, "III": 3}[example]
        driven = moved(example, m)
        own = {f"{letter}{rod}": (letter, rod) for letter, rod in limits.functions(example, m)}
        for letter, rod in own.values():
            scope = asked(example, driven, letter, rod, 5)
            for lower, upper in sorted(scope.asked, key=lambda pair: (pair[1][-1], pair)):
                if len(lower) == 2:
                    at = {"m": m, "function": f"{letter}_{rod}", "coefficient": f"F_{lower}^{upper}"}
                    true = _roles(example, driven, lower, upper)
                    yield case(at, lambda: _said_roles(words, scope, lower, upper, driven), true)  # noqa: B023

    return cases


_AT = fmpq(43, 3)
"""Some z at which expressions are compared."""


def _roles(example: str, driven: Driven, lower: tuple[int, ...], upper: tuple[int, ...]) -> dict[str, Any]:
    """What the coefficient with these indices is."""
    begins = driven.exact.interval * (upper[-1] - 1)
    found = {"term": lower[0], "power": lower[1]}
    if example == "I":
        return {**found, "function": upper[0], "begins": begins, "of": _AT - begins}
    if example == "II":
        since = _AT - begins - driven.loads[f"M{upper[1]}"][-1].time
        return {**found, "function": upper[0], "moment": upper[1], "of": since}
    since = _AT - begins - driven.loads["a"][upper[0]].time
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
    with scope.binding({"k": last, **letters, "z": _AT}):
        found = {
            role: scope.value(read_formula(word)) for role, word in words.items() if role not in ("symbol", "term")
        }
        return {**found, "term": scope.indices(term)[0]}


# which moments act


def _moments(words: Words) -> Iterator[Case]:
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
            yield Case(at, said & come if words["arrived"] else said, true, bool(true))


def _lies(where: Tree, scope: Scope, n: int) -> bool:
    with scope.binding({"n": n}):
        return holds(where, scope)


def _gained(exact: Exact, s: int, letter: str, rod: int, numbers: range) -> bool:
    return any(exact.increment(f"M{s}", letter, rod, number) for number in numbers)


def _unlisted(words: Words) -> Iterator[Case]:
    call = read_formula(words["function"])
    assert isinstance(call, Call)
    for m in (2, 3, 4):
        missing = [(a, i) for a in "fg" for i in range(1, m + 1) if (a, i) not in limits.functions("III", m)]
        scope = Scope({"m": m, "n": 0})
        yield case({"m": m}, lambda: [(call.function.name, scope.indices(call.function)[0])], missing)  # noqa: B023


# what exponents and powers depend on


def _masses(words: Words) -> Iterator[Case]:
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


def _series(words: Words) -> Iterator[Case]:
    for example, form in FORMS.items():
        driven = moved(example, 4)
        for n in (0, 1, 2):
            start = 2 * n
            bound: dict[str, Any] = {"n": n, "d": start + 1, "half": "even", "z": _AT, "k": 1, "s": 2, "i": 1}
            scope = FormScope(right_form(example), driven, "f")
            time = driven.loads[{"II": "M2", "III": "a"}[example]][1].time if example != "I" else 0
            with scope.binding(bound):
                at = {"form": form, "n": n}
                yield case(at, lambda: scope.value(read_formula(words[example])), _AT - start - time)  # noqa: B023


def _meetings(words: Words) -> Iterator[Case]:
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
                            yield Case(at, max(said, -1), true, true >= 0)


def _earlier(words: Words) -> Iterator[Case]:
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
            yield Case(at, total, driven.wave(letter, rod, z))


def _runs(degrees: list[int]) -> set[int]:
    """How many intervals a power stays, from its first change to its last."""
    return set([len(list(run)) for _, run in groupby(d for d in degrees if d >= 0)][1:-1])


def _changes_1(words: Words) -> Iterator[Case]:
    for m in (4, 6, 8):
        for body, rate in rates(collision(m)).items():
            said = words["ends"] if body in (1, m - 1) else words["others"]
            yield from _stays("I", collision(m), f"body {body}", rate, int(said))


def _changes_3(words: Words) -> Iterator[Case]:
    for m in range(2, 7):
        known = rates(building(m))
        for name, rate in (("kappa_1", known[1]), ("kappa_m", known[m])):
            yield from _stays("III", building(m), name, rate, int(words["step"]))


def _stays(example: str, exact: Exact, name: str, rate: fmpq, said: int) -> Iterator[Case]:
    for letter, rod in limits.functions(example, exact.m):
        degrees = [exact.degree(letter, rod, n, rate) for n in range(1, INTERVALS[example] + 1)]
        if lengths := {exact.interval * length for length in _runs(degrees)}:
            yield Case({"m": exact.m, "function": f"{letter}_{rod}", "rate": name}, {said}, lengths)


def _parts(words: Words) -> Iterator[Case]:
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


def _slopes(words: Words) -> Iterator[Case]:
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
                                yield Case(at, slopes[words[part]], other - one)


def _fields(words: Words) -> Iterator[Case]:
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


CASES: Mapping[str, Callable[[Words], Iterator[Case]]] = {
    "heaviside": _heaviside,
    "lengths": _lengths,
    "entier": _entier,
    "table_2": _listed("I", _collisions),
    "table_3": _listed("II", _drives),
    "table_4": _listed("III", _buildings),
    "count": _count,
    "others": _others,
    "indices_4_9": _indices("I"),
    "indices_4_10": _indices("II"),
    "indices_4_12": _indices("III"),
    "moments": _moments,
    "unlisted": _unlisted,
    "masses": _masses,
    "series": _series,
    "meetings": _meetings,
    "earlier": _earlier,
    "changes_1": _changes_1,
    "changes_3": _changes_3,
    "parts": _parts,
    "fields": _fields,
    "slopes": _slopes,
}
"""What is tried for the words of a saying, by its name."""
