"""What section 4 says of the highest powers in words: what Tables 2 to 4 list, and how powers run.

A body that is shaken at its own rate answers with one power more, so that powers of bodies with one rate add up. Where
rates differ the powers of the tables are the highest there can be; for special ones some cancel. The tables are tried
on chains with all rates different, with neighbours equal, and with one twice another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from itertools import groupby, pairwise, product
from typing import Any

from flint import fmpq

from wavesym.derivation.walks import units
from wavesym.mechanics.node import Parameters
from wavesym.papers.pielorz1979.chains import EXAMPLES, Exact, building, collision, drive, with_parameters
from wavesym.papers.pielorz1979.chains import INTERVALS as TABULATED
from wavesym.papers.pielorz1979.forms import (
    ALPHA,
    EXACT,
    HALVES,
    INTERVALS,
    SIZES,
    FormScope,
    form_chain,
    functions,
    numbers,
    right_form,
    table_scene,
)
from wavesym.papers.pielorz1979.powers import HighestPowers, RequestScope, highest_powers
from wavesym.papers.pielorz1979.tables import moments
from wavesym.papers.reader import read_formula
from wavesym.papers.record import Case, Reproduction
from wavesym.papers.sentences import Words
from wavesym.papers.tree import latex, symbols


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
        claim = "rates" not in hypothesis or len(set(gamma.values())) == len(gamma)
        claim = claim and ("2" not in hypothesis or 2 * kappa[1] != kappa[exact.m])
        at = {"m": exact.m, "kappa": dict(kappa), "rates": tuple(gamma.values())}
        yield Case({**at, "claim": "no power is higher than in the table"}, claim, true)


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


def meetings(words: Words) -> Iterator[Case]:
    """Highest powers by what waves have met."""
    for at, count, true, scene in _meeting_counts(reflected_only=words["met"] == "reflected"):
        claim = count - {"one less than": 1, "": 0}[words["less"]]
        yield Case(at, max(claim, -1), true, true >= 0, scene)


def connection(words: Words) -> Iterator[Case]:
    """Whether places with the same number have the same highest power, in each example."""
    powers: dict[tuple[object, int], int] = {}
    for at, count, true, scene in _meeting_counts(reflected_only=words["met"] == "reflected from"):
        claim = powers.setdefault((at["example"], max(count, 0)), true)
        yield Case(at, claim, true, true >= 0, scene)


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


def changes_1(words: Words) -> Iterator[Case]:
    """How long the highest powers of example I stay."""
    for m in (4, 6, 8):
        steps = {body: words["ends"] if body in (1, m - 1) else words["others"] for body in range(1, m, 2)}
        yield from _stays("I", collision(m), steps)


def changes_3(words: Words) -> Iterator[Case]:
    """How long the highest powers of example III stay."""
    for m in range(2, 7):
        yield from _stays("III", building(m), dict.fromkeys((1, m), words["step"]))


def _stays(example: str, exact: Exact, steps: Mapping[int, str]) -> Iterator[Case]:
    """How long the power at a body's rate stays, from its first change to its last."""
    for (body, step), (letter, rod) in product(steps.items(), functions(example, exact.m)):
        numbers = range(1, TABULATED[example] + 1)
        degrees = (exact.degree(letter, rod, number, exact.rates[body]) for number in numbers)
        runs = [len(list(run)) for _, run in groupby(degree for degree in degrees if degree >= 0)]
        if lengths := {exact.interval * run for run in runs[1:-1]}:
            at = {"m": exact.m, "function": f"{letter}_{rod}", "body": body}
            yield Case(at, {int(step)}, lengths, True, table_scene(exact, (letter, rod), numbers[-1]))


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
