"""What section 4 says of the solutions in words: what the tables list, on what the solutions depend, how powers run.

A body that is shaken at its own rate answers with one power more, so that powers of bodies with one rate add up. Where
rates differ the powers of the tables are the highest there can be; for special ones some cancel. The tables are tried
on chains with all rates different, with neighbours equal, and with one twice another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cache, partial
from itertools import groupby, pairwise, product
from typing import Any

from flint import fmpq

from wavesym.derivation.table import Function, Rules, unit_response
from wavesym.derivation.walks import units
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters
from wavesym.papers.evaluation import MeaninglessError, Scope, holds
from wavesym.papers.pielorz1979.chains import EXAMPLES, Exact, LoadedChain, building, collision, drive, with_parameters
from wavesym.papers.pielorz1979.chains import INTERVALS as TABULATED
from wavesym.papers.pielorz1979.forms import (
    ALPHA,
    EXACT,
    FORMS,
    HALVES,
    INTERVALS,
    SIZES,
    FormScope,
    Indices,
    form_cases,
    form_chain,
    functions,
    numbers,
    right_form,
    table_scene,
)
from wavesym.papers.pielorz1979.powers import HighestPowers, RequestScope, highest_powers
from wavesym.papers.pielorz1979.tables import moments
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Reproduction, case
from wavesym.papers.sentences import Words
from wavesym.papers.tree import Addition, Call, Number, Series, Symbol, latex, symbols

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


def table(name: str, words: Words) -> Iterator[Case]:
    """The highest power at every rate, by the limits of the form and by the exact tables."""
    for chain in _chains(name, words["hypothesis"]):
        exact = chain.exact
        for letter, rod in functions(name, exact.m):
            at = {"m": exact.m, "kappa": dict(exact.chain.parameters.kappa)}
            if not 1 <= rod <= exact.m:
                yield Case({**at, "function": f"{letter}_{rod}", "claim": "there is such a rod"}, True, False)
                continue
            scope = RequestScope(name, chain.motion, letter)
            for number in range(1, numbers(name, INTERVALS[name])[-1] + 1):
                yield from chain.cases(scope, (letter, rod), number, {**at, "interval": number})
    yield from _of_rates(name, words["hypothesis"])
    if "powers" in words:
        letters = {latex(tree) for tree in symbols(right_form("I").step) if tree.name == "K"}
        yield Case({"claim": "a letter of (4.9)"}, latex(read_formula(words["powers"])) in letters, True)


def _of_rates(name: str, hypothesis: str) -> Iterator[Case]:
    """Whether no power is higher than in the table just where the hypothesis holds."""
    for exact, true in chains_of_rates(name):
        kappa, gamma = exact.chain.parameters.kappa, exact.rates
        said = "rates" not in hypothesis or len(set(gamma.values())) == len(gamma)
        said = said and ("2" not in hypothesis or 2 * kappa[1] != kappa[exact.m])
        at = {"m": exact.m, "kappa": dict(kappa), "rates": tuple(gamma.values())}
        yield Case({**at, "claim": "no power is higher than in the table"}, said, true)


def _chains(name: str, hypothesis: str) -> Iterator[HighestPowers]:
    """Those for which a hypothesis holds."""
    yield from (highest_powers(name, m) for m in SIZES[name][: 2 if name == "II" else 3])
    if "different" not in hypothesis:
        yield _equal_rates(name)
    if name == "I" and "m is at least 4" not in hypothesis:
        yield highest_powers("I", 2)


@cache
def _equal_rates(name: str) -> HighestPowers:
    """A chain in which rates are equal."""
    one = fmpq(1)
    exact, parameters = {
        "I": (collision, Parameters(kappa=dict.fromkeys((1, 3), fmpq(3, 7)), velocity={1: one, 3: -one})),
        "II": (drive, Parameters(kappa=dict.fromkeys((1, 2), one), inertia=dict.fromkeys((1, 2, 3), one))),
        "III": (building, Parameters(kappa={0: fmpq(2, 7), 1: fmpq(3, 5), 2: fmpq(6, 5)})),
    }[name]
    return HighestPowers(name, with_parameters(exact(4 if name == "I" else 2), parameters))


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
                yield case(at, lambda: _said_roles(words, meant, lower, upper, motion), true)  # noqa: B023


def _roles(name: str, motion: LoadedChain, lower: Indices, upper: Indices) -> dict[str, Any]:
    """What the coefficient with these indices is."""
    begins = motion.exact.interval * (upper[-1] - 1)
    found = {"term": lower[0], "power": lower[1], "function": upper[1 if name == "III" else 0]}
    if name == "II":
        return {**found, "moment": upper[1], "of": AT - begins - motion.loads[f"M{upper[1]}"][-1].time}
    if name == "III":
        return {**found, "part": upper[0], "begins": begins, "of": AT - begins - motion.loads["a"][upper[0]].time}
    return {**found, "begins": begins, "of": AT - begins}


def _said_roles(words: Words, scope: FormScope, lower: Indices, upper: Indices, motion: LoadedChain) -> dict[str, Any]:
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


# chains whose rates are equal, or not

_ONE, _A, _B, _C = fmpq(1), fmpq(2, 3), fmpq(3, 5), fmpq(5, 7)
_COLLISIONS = (
    (_A, _B),
    (_A, 2 * _A),
    (2 * _A, _A),
    (_A, _B, _B),
    (_A, _A, _B),
    (_A, _B, _C),
    (_ONE, 2 * _ONE, 3 * _ONE),
)
_DRIVES = (  # kappa, J
    ((_A,), (1, 3)),
    ((_A,), (1, 1)),
    ((_A,), (2, 1)),
    ((_A,), (1, 2)),
    ((_A, _B), (1, 2, 3)),
    ((_A, _A / 2), (1, 2, 3)),
    ((_A, _B), (1, 2, 2 * _B / _A)),
    ((_A, _A), (1, 2, fmpq(4, 3))),
)
_BUILDINGS = ((2, _A, _B), (2, _A, 2 * _A), (3, _A, _B), (3, _A, 2 * _A))  # m, kappa of floors, of the roof
_TABULATED = 9


def _variants(name: str) -> Iterator[tuple[int, Parameters]]:
    """m and parameters."""
    if name == "I":
        for kappas in _COLLISIONS:
            m = 2 * len(kappas)
            velocity = collision(m).chain.parameters.velocity
            yield m, Parameters(kappa={2 * i + 1: kappa for i, kappa in enumerate(kappas)}, velocity=velocity)
    elif name == "II":
        for shafts, discs in _DRIVES:
            yield len(shafts), Parameters(kappa=_each(shafts), inertia=_each(discs))
    else:
        for m, floor, roof in _BUILDINGS:
            yield m, Parameters(kappa={0: _C, **dict.fromkeys(range(1, m), floor), m: roof})


def _each(values: Iterable[Any]) -> dict[int, fmpq]:
    return {i: fmpq(value) for i, value in enumerate(values, 1)}


@cache
def chains_of_rates(name: str) -> tuple[tuple[Exact, bool], ...]:
    """Chains with different and with equal rates, and whether no power is higher than where nothing cancels.

    There all rates are different.

    Lower ones there are: of bodies with kappa 1, 2, 3 those of the middle one cancel.
    """
    found = []
    for m, parameters in _variants(name):
        usual = EXACT[name](m)
        exact = with_parameters(usual, parameters)
        bodies: dict[fmpq, set[fmpq]] = {}
        for (_, rate), (_, other) in zip(exact.rates.items(), usual.rates.items(), strict=True):
            bodies.setdefault(rate, set()).add(other)
        functions = product("fg", range(1, m + 1), range(1, _TABULATED + 1))
        same = all(
            exact.degree(*place, rate, source) <= max(usual.degree(*place, other, source) for other in others)
            for place, source, (rate, others) in product(functions, exact.responses, bodies.items())
        )
        found.append((exact, same))
    return tuple(found)


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
            said = {s for s in moments if s % 2 == ((words["odd"] if i % 2 else words["even"]) == "odd")}
            true = come if words["quantity"] == "functions" else {s for s in moments if gains[s][-1]}
            at = {"m": m, "z": z, "function": f"{letter}'_{i}"}
            told = table_scene(exact, (letter, i), number)
            yield Case(at, said & come if words["arrived"] else said, true, bool(true), told)


def missing_function(words: Words) -> Iterator[Case]:
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
    for example, exact in (("I", collision(6)), ("II", drive(2)), ("III", form_chain("III", 2).exact)):
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
        motion = form_chain(example, 4)
        for n in (0, 1, 2):
            scope = FormScope(right_form(example), motion, "f")
            time = motion.loads[{"II": "M2", "III": "a"}[example]][1].time if example != "I" else 0
            with scope.bind({"n": n, "d": 2 * n + 1, "half": "even", "z": AT, "k": 1, "s": 2, "i": 1}):
                said, at = read_formula(words[example]), {"form": form, "n": n}
                yield case(at, lambda: scope.value(said), AT - 2 * n - time)  # noqa: B023


def meetings(words: Words) -> Iterator[Case]:
    """Highest powers by what waves have met."""
    for at, count, true, told in _meeting_counts(reflected_only=words["met"] == "reflected"):
        said = count - {"one less than": 1, "": 0}[words["less"]]
        yield Case(at, max(said, -1), true, true >= 0, told)


def connection(words: Words) -> Iterator[Case]:
    """Whether places with the same number have the same highest power, in each example."""
    powers: dict[tuple[object, int], int] = {}
    for at, count, true, told in _meeting_counts(reflected_only=words["met"] == "reflected from"):
        said = powers.setdefault((at["example"], max(count, 0)), true)
        yield Case(at, said, true, true >= 0, told)


def _meeting_counts(
    *, reflected_only: bool
) -> Iterator[tuple[dict[str, object], int, int, Callable[[], Reproduction]]]:
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
                    yield at, count(letter, rod, interval), true, table_scene(exact, (letter, rod), interval)


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
            yield Case(at, total, motion.wave(letter, rod, z), True, table_scene(motion.exact, (letter, rod), number))


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
        numbers = range(1, TABULATED[example] + 1)
        degrees = (exact.degree(letter, rod, number, exact.rates[body]) for number in numbers)
        runs = [len(list(run)) for _, run in groupby(degree for degree in degrees if degree >= 0)]
        if lengths := {exact.interval * run for run in runs[1:-1]}:
            at = {"m": exact.m, "function": f"{letter}_{rod}", "body": body}
            yield Case(at, {int(step)}, lengths, True, table_scene(exact, (letter, rod), numbers[-1]))


def parts(words: Words) -> Iterator[Case]:
    """(4.10) with as many terms in its sums over alpha and beta as said."""
    counts = {ALPHA: Number(words["parts"]), r"\beta": Number(words["terms"])}

    class LimitedScope(FormScope):
        def series(self, series: Series) -> Any:
            return super().series(replace(series, last=counts.get(series.variable.name, series.last)))

    yield from form_cases(right_form("II"), scope=LimitedScope)


def slopes(words: Words) -> Iterator[Case]:
    """Differences of neighbouring powers inside the three ranges of l."""
    alpha = {"first": 1, "second": 2}[words["group"]]
    slopes = {"rise": 1, "are equal": 0, "fall": -1}
    for m in range(1, 6):
        exact, known = drive(m), drive(m).rates
        for half, (letter, i) in ((h, f) for h in HALVES for f in functions("II", m)):
            scope = FormScope(right_form("II"), form_chain("II", m), letter)
            for r, s in moments(scope, half, i, alpha):
                with scope.bind({"n": 0, "half": half, "i": i, "r": r, ALPHA: alpha}):
                    ends = [0, *(scope.whole(read_formula(f"L_{beta}")) for beta in (1, 2, 3))]
                for n in range(4):
                    d = 2 * n + 1 + HALVES.index(half)
                    for part, (low, high) in zip(("one", "two", "three"), pairwise(ends), strict=True):
                        powers = [exact.degree(letter, i, d, known[b], f"M{s}") for b in range(low + 1, high + 1)]
                        for body, (one, other) in enumerate(pairwise(powers), low + 1):
                            if min(one, other) >= 0:
                                at = {"m": m, "n": n, "half": half, "function": f"{letter}_{i}", "s": s, "l": body}
                                yield Case(
                                    at, slopes[words[part]], other - one, True, table_scene(exact, (letter, i), d)
                                )


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


# how often waves meet a body: ways counted, without any law of motion

NEVER = -(10**6)
"""The count of a wave that does not come."""


def most_meetings(exact: Exact, source: str, body: int, *, reflected_only: bool) -> Callable[[str, int, int], int]:
    """The most times that a wave of a source has met the body at a node, by function, rod and interval.

    With `reflected_only` only where it was thrown back; otherwise where it passed or started, too.
    """
    nodes = exact.chain.nodes
    starts = [unit for unit in units(exact.chain) if source in (unit.name, "impact")]

    @cache
    def largest_sent(x: int, right: bool, tau: int) -> int:
        """The most of those that leave a node to one side at tau."""
        node = nodes[x]
        if tau < 0 or (node.right if right else node.left) is None:
            return NEVER
        here = int(x == body)
        found = [
            here * (not reflected_only)
            for unit in starts
            if unit.x == x and tau == 0 and (unit.right if right else unit.left)
        ]
        for from_left in (True, False):
            if (node.left if from_left else node.right) is None:
                continue
            thrown_back = from_left != right
            if not node.inertia and thrown_back == bool(node.left and node.right):
                continue  # without a body a wave passes between rods, and is thrown back from an end
            before = largest_sent(x - 1, True, tau - 1) if from_left else largest_sent(x + 1, False, tau - 1)
            found.append(before + here * (thrown_back or not reflected_only))
        return max(found, default=NEVER)

    def count(letter: str, rod: int, interval: int) -> int:
        tau = exact.chain.leaves(letter, rod, exact.interval * (interval - 1))
        return largest_sent(rod - 1, True, tau) if letter == "f" else largest_sent(rod, False, tau)

    return count


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
