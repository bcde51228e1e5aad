"""What section 4 says of the solutions in words: sentences, each with what its words are evaluated to.

A `Saying` is a pattern (sentences.py), what it is compared with, and its cases for some words.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache
from itertools import groupby, pairwise, product
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
from wavesym.papers.pielorz1979.forms import Form, FormScope, corrected, form_cases, moved, moments, rates
from wavesym.papers.pielorz1979.meetings import most_meetings
from wavesym.papers.pielorz1979.transcription import entry as transcribed
from wavesym.papers.pielorz1979.truth import Driven, loads
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Reading, Test, case
from wavesym.papers.sentences import Pattern, sentence_reader
from wavesym.papers.tree import Call, Number, Relation, Series, Symbol, Tree, latex, symbols
from wavesym.systems.building import BUILDING_FORCE
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE

Words = Mapping[str, str]
FORMS = {"I": "(4.9)", "II": "(4.10)", "III": "(4.12)"}
MOST_N = 5


@dataclass(frozen=True)
class Saying:
    """A pattern of sentences, what they are compared with, and the cases that their words give."""

    pattern: Pattern
    against: str
    cases: Callable[[Words], Iterator[Case]]


def solution(entry: Entry) -> Test:
    """Adapter: a sentence about the solutions."""
    reader = sentence_reader(saying.pattern for saying in SAYINGS)
    known = {saying.pattern.name: saying for saying in SAYINGS}
    right = reader.read(entry.slip.corrected if entry.slip else entry.printed, ()).formula.pattern

    def cases(reading: Reading) -> Iterator[Case]:
        return known[reading.formula.pattern].cases(reading.formula.words)

    return Test(known[right].against, cases, reader.read, reader.faults)


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
    numbers = {"even": lambda z: z % 2 == 0, "odd": lambda z: z % 2 == 1, "whole": lambda z: True}[words["numbers"]]
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
            yield Case({"example": name, "m": exact.m}, [z for z in range(until) if numbers(z)], sorted(gains))


def _entier(words: Words) -> Iterator[Case]:
    ways = {"down": lambda x: int(x.floor()), "up": lambda x: int(x.ceil()), "towards 0": int}
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
            kappa = {"kappa": dict(exact.chain.parameters.kappa)}
            for number in range(1, (TRIED[example] + 1) * (2 if example == "II" else 1) + 1):
                for letter, rod in limits.functions(example, exact.m):
                    at = {"m": exact.m, **kappa, "function": f"{letter}_{rod}", "interval": number}
                    if not 1 <= rod <= exact.m:
                        yield Case({**at, "claim": "there is such a rod"}, True, False)
                        continue
                    true = _true_powers(exact, letter, rod, number)
                    yield case(at, lambda: _said_powers(example, driven, letter, rod, number), true, bool(true))  # noqa: B023

    return cases


def _said_powers(example: str, driven: Driven, letter: str, rod: int, number: int) -> dict[str, int]:
    known = rates(driven.exact)
    found: dict[str, int] = {}
    for lower, upper in asked(example, driven, letter, rod, number).asked:
        if len(lower) == 2 and upper[-1] == number:
            key = _named(known[lower[0]], f"M{upper[1]}" if example == "II" else "")
            found[key] = max(found.get(key, 0), lower[1])
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


def _chain(exact: Exact, system: Any, m: int, **parameters: Any) -> Exact:
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
        return _chain(collision(4), COLLISION, 4, kappa=kappa, velocity={1: one, 3: -one})
    if name == "II":
        discs = {i: one for i in range(1, 4)}
        return _chain(drive(2), DRIVE, 2, kappa={1: one, 2: one}, inertia=discs)
    return _chain(building(2), BUILDING_FORCE, 2, kappa={0: fmpq(2, 7), 1: fmpq(3, 5), 2: fmpq(6, 5)})


def _collisions(hypothesis: str) -> Iterator[Exact]:
    if "m is at least 4" not in hypothesis:
        yield collision(2)
    yield from (collision(m) for m in (4, 6, 8))
    if "different" not in hypothesis:
        yield _like("I")


def _drives(hypothesis: str) -> Iterator[Exact]:
    yield from (drive(m) for m in (1, 2, 3))
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
    body, power = lower
    begins = driven.exact.interval * (upper[-1] - 1)
    found = {"function": upper[0], "term": body, "power": power, "of": _AT - begins}
    if example == "I":
        return {**found, "begins": begins}
    if example == "II":
        return {**found, "moment": upper[1], "of": found["of"] - driven.loads[f"M{upper[1]}"][-1].time}
    time = driven.loads["a"][upper[0]].time
    return {**found, "function": upper[1], "part": upper[0], "begins": begins, "of": found["of"] - time}


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
    said = {"function": "function", "power": "power", "begins": "begins", "moment": "moment", "part": "part"}
    last = len(driven.loads[f"M{upper[1]}"]) - 1 if "moment" in words else 0
    with scope.binding({"k": last, **letters, "z": _AT}):
        found = {key: scope.value(read_formula(words[place])) for key, place in said.items() if place in words}
        return {**found, "term": scope.indices(term)[0], "of": scope.value(read_formula(words["of"]))}


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


def _not_listed(words: Words) -> Iterator[Case]:
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
            exact = {"I": collision, "II": drive}.get(example, lambda m: _uneven(m))(m)
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


def _uneven(m: int) -> Exact:
    from wavesym.papers.exact_tables import uneven_building

    return uneven_building(m)


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


def _changes_i(words: Words) -> Iterator[Case]:
    for m in (4, 6, 8):
        for body, rate in rates(collision(m)).items():
            said = words["ends"] if body in (1, m - 1) else words["others"]
            yield from _stays("I", collision(m), f"body {body}", rate, int(said))


def _changes_iii(words: Words) -> Iterator[Case]:
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


def _by_4_2(words: Words) -> Iterator[Case]:
    """What (4.2) gives on both sides of every node, by the conditions that hold there."""
    order = {"derivatives": 1, "integrals of the derivatives": 0}[words["orders"]]
    for example, m in (("I", 4), ("II", 2), ("III", 3)):
        driven = moved(example, m)
        for x, tau in product(range(m + 1), (fmpq(k) + fmpq(3, 7) for k in range(5))):
            node, at = driven.exact.chain.nodes[x], {"example": example, "m": m, "x": x, "tau": tau}
            sides = [rod for rod in (x, x + 1) if 1 <= rod <= m]
            if words["quantities"] == "velocities and strains":
                strains = {rod: _field(driven, rod, x, tau, order, -1) for rod in sides}
                forces = sum((node.alpha * -strains[rod] if rod == x else node.beta * strains[rod]) / 2 for rod in sides)
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


HYPOTHESES = ("", ", if all rates are different")
_NUMBERS = ("1", "2", "3", "4")
_SLOPES = ("rise", "are equal", "fall")
_INDICES = ("i", "j", "k", "l", "s")

SAYINGS = (
    Saying(
        Pattern(
            "H",
            "H is the function of Heaviside{at_0}.",
            {"at_0": (", whose value at 0 is not given", " with H(0) = 0", " with H(0) = 1")},
        ),
        "the motion, by (4.12)",
        _heaviside,
    ),
    Saying(
        Pattern(
            "lengths",
            "In {examples} the formulas keep their form between successive {numbers} numbers z.",
            {"examples": ("examples I and III", "example II"), "numbers": ("even", "odd", "whole")},
        ),
        "where functions gain anything in the exact tables",
        _lengths,
    ),
    Saying(
        Pattern("entier", "E(n) is n rounded {way}.", {"way": ("down", "up", "towards 0")}),
        "the motion, by (4.9)",
        _entier,
    ),
    Saying(
        Pattern(
            "Table 2",
            "Table 2 has the functions F_i and their constants K_1, {powers} and K_{m-1}{hypothesis}.",
            {
                "powers": ("K_{j_s}", "K_{j,s}"),
                "hypothesis": (
                    *HYPOTHESES,
                    ", if m is at least 4",
                    ", if m is at least 4 and all rates are different",
                ),
            },
        ),
        "highest powers of the exact tables, m = 2 ... 8, with different rates and with equal ones",
        _listed("I", _collisions),
    ),
    Saying(
        Pattern(
            "Table 3",
            "Table 3 has the constants s_alpha, R_alpha, L_beta and K_beta of the functions in the intervals that begin "
            "at even and odd numbers{hypothesis}.",
            {"hypothesis": HYPOTHESES},
        ),
        "highest powers of the exact tables, m = 1, 2, 3, with different rates and with equal ones",
        _listed("II", _drives),
    ),
    Saying(
        Pattern(
            "Table 4",
            "Table 4 has the functions and their constants K_1 and K_m for a building of one storey (m = 2) and more"
            "{hypothesis}.",
            {"hypothesis": HYPOTHESES},
        ),
        "highest powers of the exact tables, m = 2, 3, 4, with different rates and with equal ones",
        _listed("III", _buildings),
    ),
    Saying(
        Pattern(
            "count",
            "(4.9) and Table 2 give the derivatives of {count} functions.",
            {"count": ("m", "m-1", "m+1", "2m")},
        ),
        "the functions in the rows of Table 2",
        _count,
    ),
    Saying(
        Pattern(
            "others",
            "Those of the other {count} functions follow from (4.6) and the functions found above.",
            {"count": ("m", "m-1", "m+1", "2m")},
        ),
        "the derived delay equations: which functions they give without integration, from those of Table 2 on",
        _others,
    ),
    Saying(
        Pattern(
            "indices of (4.9)",
            "In (4.9) the coefficient {symbol} is that of function number {function} in the interval that begins at "
            "{begins}, at the term with {term}, times power {power} of {of}.",
            {
                "symbol": ("F_{i,k}^{i,n+1}", "F_{l,k}^{i,n+1}", "F_{l,k}^{i,n}"),
                "function": _INDICES,
                "begins": ("2n", "2n+2", "n"),
                "term": (r"\kappa_i", r"\kappa_l", r"\kappa_1"),
                "power": _INDICES,
                "of": ("z-2n", "z-2n-2", "z"),
            },
        ),
        "every coefficient that (4.9) asks for, m = 6",
        _indices("I"),
    ),
    Saying(
        Pattern(
            "indices of (4.10)",
            "In (4.10) the coefficient {symbol} is that of function number {function} and moment number {moment}, at "
            "the term with {term}, times power {power} of {of}.",
            {
                "symbol": ("F_{i,j}^{i,s,d}", "F_{l,j}^{i,s,d}", "F_{l,j}^{i,s,d-1}"),
                "function": _INDICES,
                "moment": _INDICES,
                "term": (r"\gamma_i", r"\gamma_l", r"\gamma_s"),
                "power": _INDICES,
                "of": (r"z-d+1-\tau_{s,k}", r"z-d-\tau_{s,k}", "z-d+1"),
            },
        ),
        "every coefficient that (4.10) asks for, m = 3",
        _indices("II"),
    ),
    Saying(
        Pattern(
            "indices of (4.12)",
            "In (4.12) the coefficient {symbol} is that of function number {function} in the interval that begins at "
            "{begins}, at the term with {term}, times power {power} of {of}, and of part number {part} of (3.2).",
            {
                "symbol": ("F_{i,j}^{k,i,n+1}", "F_{l,j}^{k,i,n+1}", "F_{l,j}^{i,k,n+1}"),
                "function": _INDICES,
                "begins": ("2n", "2n+2", "n"),
                "term": (r"\kappa_1", r"\kappa_i", r"\kappa_l"),
                "power": _INDICES,
                "of": (r"z-2n-\tau_k", "z-2n", r"z-2n-2-\tau_k"),
                "part": _INDICES,
            },
        ),
        "every coefficient that (4.12) asks for, m = 3",
        _indices("III"),
    ),
    Saying(
        Pattern(
            "moments",
            "For z in {interval} the {quantity} of odd i depend on all {odd} moments, those of even i on the {even} ones"
            "{arrived}.",
            {
                "interval": ("(2n, 2n+1)", r"\langle 2n+1, 2n+2 \rangle", "(2n, 2n+2)"),
                "quantity": ("functions", "increments"),
                "odd": ("odd", "even"),
                "even": ("even", "odd"),
                "arrived": ("", ", once they have arrived"),
            },
        ),
        "exact tables, m = 1 ... 4: on which moments a function, or what it gains in an interval, depends",
        _moments,
    ),
    Saying(
        Pattern(
            "first equation of (4.8)",
            "The function {function} is found from the first equation of (4.8).",
            {"function": ("g'_{i,j}(z)", "g'_{1,n+1}(z)", "g'_{2,n+1}(z)", "f'_{1,n+1}(z)")},
        ),
        "the functions without a row in Table 4",
        _not_listed,
    ),
    Saying(
        Pattern(
            "masses",
            "The solutions depend exponentially on the masses of {bodies}, by kappa_i or gamma_i.",
            {"bodies": ("all rigid bodies", "all rigid bodies but the foundation", "no body")},
        ),
        "the exponents of exact tables where one mass is doubled, of every body of every example",
        _masses,
    ),
    Saying(
        Pattern(
            "series",
            "The factors of the exponentials are power series in {I} (I), {III} (III) or {II} (II).",
            {
                "I": ("z-2n", "z-2n-1", "z"),
                "III": (r"z-2n-\tau_k", r"z-2n+\tau_k", r"z-2n-1-\tau_k"),
                "II": (r"z-d+1-\tau_{s,k}", r"z-d-\tau_{s,k}", "z-d+1"),
            },
        ),
        "the time since the interval began and the load came",
        _series,
    ),
    Saying(
        Pattern(
            "meetings",
            "The highest power is {less} the most times that a wave that has arrived was {met} by the body.",
            {"less": ("one less than", ""), "met": ("reflected", "reflected, let through or sent")},
        ),
        "highest powers of the exact tables, and the ways of waves counted from body to body",
        _meetings,
    ),
    Saying(
        Pattern(
            "earlier intervals",
            "In an interval the solutions are made of their forms in {which}, taken at {when}.",
            {
                "which": ("all earlier intervals", "the interval before"),
                "when": ("the present z", "the end of those intervals"),
            },
        ),
        "the motion",
        _earlier,
    ),
    Saying(
        Pattern(
            "changes of powers (I)",
            "In example I the highest powers change every {ends} at kappa_1 and kappa_{m-1}, and every {others} at the "
            "others.",
            {"ends": _NUMBERS, "others": _NUMBERS},
        ),
        "highest powers of the exact tables, functions of Table 2: the length in z between changes",
        _changes_i,
    ),
    Saying(
        Pattern(
            "changes of powers (III)",
            "In example III the highest powers change every {step}.",
            {"step": _NUMBERS},
        ),
        "highest powers of the exact tables: the length in z between changes",
        _changes_iii,
    ),
    Saying(
        Pattern(
            "parts",
            "A solution of example II has by its moments {parts} parts, each of which has by gamma {terms} terms.",
            {"parts": _NUMBERS, "terms": _NUMBERS},
        ),
        "the motion, by (4.10) with so many terms in the sums over alpha and beta",
        _parts,
    ),
    Saying(
        Pattern(
            "fields",
            "By (4.2) and Table 1 {quantities} follow from the {orders} that the forms give.",
            {
                "quantities": ("velocities and strains", "displacements"),
                "orders": ("derivatives", "integrals of the derivatives"),
            },
        ),
        "the conditions at nodes: one velocity, one displacement, and what strains and loads do to a body",
        _by_4_2,
    ),
    Saying(
        Pattern(
            "slopes",
            "For moments of the {group} group the highest powers {one} with l, then {two}, then {three}.",
            {"group": ("first", "second"), "one": _SLOPES, "two": _SLOPES, "three": _SLOPES},
        ),
        "highest powers of the exact tables, both halves, differences inside a range of l",
        _slopes,
    ),
)
