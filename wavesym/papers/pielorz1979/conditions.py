"""(2.3), (2.4), (4.3)-(4.5): the conditions at the nodes, on chains under loads and against the nodes in symbols."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any

from flint import fmpq
from sympy import Expr, IndexedBase, Rational, expand

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS
from wavesym.derivation.delay_terms import exact
from wavesym.mechanics.node import Node, Parameters
from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, sides, span
from wavesym.papers.exact_tables import UNEQUAL_COLLISION, grounded_building, unequal_collision
from wavesym.papers.pielorz1979.equations import left_over, once, ranges_of, within
from wavesym.papers.pielorz1979.forms import moved
from wavesym.papers.pielorz1979.letters import IndexedLetters, Moving, letter, rods_at
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.symbols import ACCELERATION, DISPLACEMENTS, Symbols, moment, strain, told
from wavesym.papers.pielorz1979.transcript import others
from wavesym.papers.pielorz1979.truth import EXAMPLES, DrivenChain, driven, instants, loads
from wavesym.papers.reader import UnreadableError, read_range
from wavesym.papers.record import Case, Reading, Reproduction, Test, reading, shown
from wavesym.papers.tree import Call, Derivative, Progression, Symbol, Tree, latex

UNTIL = 6
"""How far in tau conditions are tried: every node has moved, and every load has begun."""
_SIZE = 8
"""An m at which every range has more than one member."""
_LENGTH = fmpq(7)
"""The l of section 2: x = i is no place, x = il is."""
_RANGES = ("i", "x", r"\bar{x}", "x_{i}")
"""Letters that a range may be of; x_i is where body i is."""
_CONTINUOUS, _FORCES = "the rods move together", "forces are balanced"

KINDS: Mapping[str, Callable[[Node], bool]] = {
    "a free end": lambda node: not (node.left and node.right) and not node.inertia and not node.loads,
    "a body between rods": lambda node: bool(node.left and node.right and node.inertia),
    "a contact": lambda node: node.contact,
    "a body at a left end": lambda node: bool(not node.left and node.inertia),
    "a body at a right end": lambda node: bool(not node.right and node.inertia),
}
"""The nodes that the words before (2.4)_1, ..., (2.4)_5 are about."""


def test(entry: PaperEntry) -> Test:
    """How a condition is tried: at its nodes, where it is about all the rods and nothing is said twice."""
    names = (str(entry.about["example"]),) if "example" in entry.about else tuple(EXAMPLES)
    kind, base = entry.about.get("at"), entry.about.get("base")

    def cases(read: Reading, base: str | None = base) -> Iterator[Case]:
        for name in names:
            for m in EXAMPLES[name].sizes:
                yield from _tried(entry.id, name, _moved(name, m, kind, base), read, kind)

    def where_equal(read: Reading) -> Iterator[Case]:
        for m in EXAMPLES["III"].sizes:
            yield from _tried(entry.id, "III", moved("III", m), read, kind)

    def numbered(numbering: str) -> Callable[[Reading], Iterator[Case]]:
        place = read_range(f"x_i = {numbering}")
        return lambda read: cases(Reading(read.formula, (*read.ranges, place)))

    in_symbols = not base and _balances(entry)
    conventions = {f"body i stands at x = {place}": numbered(place) for place in ("(i-1)l", "il") if kind}
    if names == ("III",) and not base:
        conventions["all floors are equal"] = where_equal
    return Test(
        "the exact motion of chains with all parameters different under loads of several steps"
        + (", on a foundation that moves with the ground" if base else "")
        + ("; the node for symbolic i and m" if in_symbols else ""),
        cases,
        difference=partial(_difference, names, kind) if in_symbols else None,
        mathematics=(lambda read: cases(read, None)) if base else None,
        conventions=conventions,
    )


def _balances(entry: PaperEntry) -> bool:
    """Whether what is right balances forces, which the nodes have in symbols."""
    try:
        return _said(reading(*entry.settled).formula) == _FORCES
    except UnreadableError:
        return False


@cache
def _moved(name: str, m: int, kind: str | None, base: str | None) -> DrivenChain:
    """A chain of an example under its loads; for (2.4), which has an A_i for each rod, with unequal rods."""
    if base == "ground":
        return DrivenChain(grounded_building(m), loads(grounded_building(m)))
    if name == "I" and kind:
        return DrivenChain(unequal_collision(m), loads(unequal_collision(m)))
    return driven(name, m)


def _add_section_2(scope: IndexedLetters, name: str, read: Reading) -> None:
    """Give a scope the A, B and S of (2.4)."""
    kappa, inertia = scope.letters[r"\kappa"], scope.letters["J"]
    numbering = ranges_of(read, _RANGES).get("x_{i}")

    def own(number: Any) -> Any:
        """A body's number in its example; the condition may number bodies by their places."""
        if numbering is None:
            return number
        with scope.binding({**scope.bound, "i": number}):
            return scope.value(numbering.shown[0]) / scope.bound["l"] + (1 if name == "II" else 0)

    if name == "II":  # in units in which the B_i of (2.4) is J_i
        moments = scope.functions[r"\barM"]
        scope.letters["A"] = lambda rod: kappa(rod) * inertia(rod)
        scope.letters["B"] = lambda number: inertia(own(number))
        scope.functions["S"] = lambda number, t: kappa(1) * inertia(1) * moments(own(number), t)
    else:
        scope.letters["A"] = inertia if name == "I" else lambda _: 1
        scope.letters["B"] = lambda number: 1 / kappa(own(number))
        scope.functions["S"] = lambda number, t: 0  # Table 1


# on chains


def _tried(id: str, name: str, driven: DrivenChain, read: Reading, kind: str | None) -> Iterator[Case]:
    """A condition at all its places of a chain."""
    chain, m = driven.exact.chain, driven.exact.m
    said: Counter[tuple[str, int]] = Counter()
    scope = Moving(driven)
    scope.functions[DISPLACEMENTS[name]] = scope.functions[r"\barU"]
    scope.letters["U"] = lambda rod: scope.functions["U"](rod, scope.bound["x"], scope.bound["t"])
    _add_section_2(scope, name, read)
    nodes = [x for x, node in enumerate(chain.nodes) if KINDS[kind](node)] if kind else None
    for bound in _places(read, m, nodes):
        at: dict[str, object] = {"example": name, **bound}
        mentioned = tuple(sorted(_mentioned(read.formula, Scope(bound))))
        yield Case({**at, "what": "its rods"}, mentioned, rods_at(chain, bound["x"]), telling=False)
        said[_said(read.formula), bound["x"]] += 1
        scope.bound |= {**bound, "l": _LENGTH}
        yield from _balanced(scope, read, bound["x"], at)
    if not kind:
        beside = _others(id, m)
        stated = {what for what, _ in said + beside}  # (2.3) alone is of continuity
        needed = [(_FORCES, x) for x in range(m + 1)] + [(_CONTINUOUS, x) for x in range(1, m)]
        yield from once({"m": m}, said, beside, [(what, x) for what, x in needed if what in stated])


def _places(read: Reading, m: int, nodes: list[int] | None = None) -> Iterator[dict[str, int]]:
    """Where a condition is said to hold: m, i and x. Where no i is given, it is the one that makes the rods right."""
    ranges = ranges_of(read, _RANGES)
    for i in span(ranges["i"], Scope({"m": m})) if "i" in ranges else (None,):
        given = {"m": m} if i is None else {"m": m, "i": i}
        for x in _where(read, given) if nodes is None else nodes:
            if not 0 <= x <= m:
                raise MeaninglessError(f"there is no place x = {x}")
            if i is None and Symbol("i") in within(read.formula):
                rods = {rod for rod in (x, x + 1) if 1 <= rod <= m}
                fitting = (n for n in (x, x + 1) if _mentioned(read.formula, Scope({"m": m, "i": n})) == rods)
                yield {**given, "i": next(fitting, x), "x": x}
            else:
                yield {**given, "x": x}


def _place(read: Reading) -> Progression:
    """The place that is given, x or without dimension."""
    ranges = ranges_of(read, _RANGES)
    if not ranges.keys() & {"x", r"\bar{x}"}:
        raise MeaninglessError("no place is given")
    return ranges["x"] if "x" in ranges else ranges[r"\bar{x}"]


def _where(read: Reading, bound: Mapping[str, int]) -> Iterator[int]:
    """The places that are given, in lengths of rods."""
    place = _place(read)
    for x in span(place, Scope({**bound, "l": _LENGTH})):
        count = x / (_LENGTH if place.variable == Symbol("x") else fmpq(1))
        if count.q != 1:
            raise MeaninglessError(f"no rod ends at x = {x}")
        yield int(count)


def _mentioned(formula: Tree, scope: Scope) -> set[Any]:
    """The rods that a condition is about; MeaninglessError where it is about another place than the node."""
    for part in within(formula):
        displaced = isinstance(part, Call) and letter(part.function) in DISPLACEMENTS.values()
        if displaced and tuple(map(latex, part.arguments)) != (r"\bar{x}", r"\tau"):
            raise MeaninglessError(f"{latex(part)} is not at the node")
    symbols = (part for part in within(formula) if isinstance(part, Symbol))
    moved = (symbol for symbol in symbols if letter(symbol) in ("U", *DISPLACEMENTS.values()))
    return {rod for symbol in moved for rod in scope.indices(symbol)}


def _balanced(scope: Moving, read: Reading, x: int, at: Mapping[str, object]) -> Iterator[Case]:
    """The condition at instants."""
    driven, node = scope.motion, scope.chain.nodes[x]
    outputs = {"strain": [f"{x}{s}" for s, rod in (("-", node.left), ("+", node.right)) if rod], "velocity": [str(x)]}

    def seen(tau: fmpq, left: str) -> Callable[[], Reproduction] | None:
        if scope.chain.system is UNEQUAL_COLLISION:  # no scene has it
            return None
        f, g = driven.waves_at(x if node.left else x + 1, x, tau, order=2)
        look = (
            f"put strain and velocity of tau = {tau}, and its slope there, {shown(f + g)}, into the condition: {left}"
        )
        until = tau if tau > 0 else 1
        return example(driven.exact, driven.loads, until, outputs, "wavesym run SCENE --samples 1001", look)

    taus = instants(UNTIL, between=[fmpq(5, 6)])
    return left_over(read.formula, at, scope, ("tau", taus), partial(scope.at, x), seen)


def _said(formula: Tree) -> str:
    """What a condition says: it compares velocities, as (2.3) does, or else forces, or how a node moves."""
    found = [part for part in within(formula) if isinstance(part, Derivative)]
    alike = all(latex(part.by) in ("t", r"\tau") and part.order == 1 for part in found)
    return _CONTINUOUS if alike else _FORCES


@cache
def _others(id: str, m: int) -> Counter[tuple[str, int]]:
    """What the other conditions of a group say."""
    beside = others(id, "condition")
    return Counter((_said(read.formula), bound["x"]) for read in beside for bound in _places(read, m))


# in symbols


def _difference(names: tuple[str, ...], kind: str | None, read: Reading) -> str:
    """Printed less derived for symbolic i and m, both scaled to the same strain."""
    lines = []
    for name in names:
        system, letters = EXAMPLES[name].system, SYMBOLS
        if name == "I" and kind:
            system, letters = UNEQUAL_COLLISION, replace(SYMBOLS, inertia=IndexedBase("A"))
        for family in system.families(COUNT, letters):
            first, last = (exact(end) for end in (family.first, family.last))
            x = INDEX if first != last else first
            members = range(int(first.subs(COUNT, _SIZE)), int(last.subs(COUNT, _SIZE)) + 1, family.step)
            if kind is None and {bound["x"] for bound in _places(read, _SIZE)} <= set(members):
                x = expand(Symbols(bound={"l": 1}).value(_place(read).shown[0]))
            elif kind is None or not KINDS[kind](family.at(x)):
                continue
            over = _less_derived(name, letters, family.at(x), x, read)
            if over != "0":
                lines.append(f"{name}: {over}" if len(names) > 1 else over)
    return "; ".join(dict.fromkeys(lines)) or "0"


def _less_derived(name: str, letters: Parameters, node: Node, place: Expr, read: Reading) -> str:
    """What is left of a condition at one kind of node."""
    rods = [expand(rod) for rod, there in ((place, node.left), (place + 1, node.right)) if there]
    indices = [INDEX] if "i" in ranges_of(read, _RANGES) else [place, expand(place + 1)]
    scopes = [Symbols(letters, {"i": index}) for index in indices]
    scope = next((s for s in scopes if _mentioned(read.formula, s) == set(rods)), scopes[0])
    _add_section_2(scope, name, read)
    left, right = sides(read.formula)
    unit = strain(rods[-1])
    printed, derived = expand(scope.value(left) - scope.value(right)), expand(_balance(node, place))
    scaled = [expand(side / side.coeff(unit)) for side in (printed, derived) if side.coeff(unit) != 0]
    if len(scaled) < 2:
        raise MeaninglessError(f"it has no {unit}")
    return told(scaled[0] - scaled[1])


def _balance(node: Node, x: Expr) -> Expr:
    """The node's own condition, as `Node` has it."""
    total = -node.inertia * ACCELERATION
    if node.right:
        total += Rational(1, 2) * node.beta * strain(expand(x + 1))
    if node.left:
        total -= Rational(1, 2) * node.alpha * strain(expand(x))
    for unit in node.loads:
        total += unit.coefficients[0] * moment(unit.number)
    return total
