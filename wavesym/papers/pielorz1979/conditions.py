"""Equations of nodes and waves: the conditions (2.3), (2.4), (4.3)-(4.5), the delay equations (4.6)-(4.8)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property

from flint import fmpq

from wavesym.mechanics.node import Node
from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, letter_name, sides, span
from wavesym.papers.pielorz1979.chains import (
    JumpingChain,
    LoadedChain,
    instants,
)
from wavesym.papers.pielorz1979.equation_group import EquationGroup, Key, Place
from wavesym.papers.pielorz1979.letters import DISPLACEMENTS, rods_at
from wavesym.papers.record import Case, Reading, Reproduction
from wavesym.papers.tree import Call, Derivative, Symbol, Tree, latex, parts_of

NODES: Mapping[str, Callable[[Node], bool]] = {
    "a free end": lambda node: not (node.left and node.right) and not node.inertia and not node.loads,
    "a body between rods": lambda node: bool(node.left and node.right and node.inertia),
    "a contact": lambda node: node.contact,
    "a body at a left end": lambda node: bool(not node.left and node.inertia),
    "a body at a right end": lambda node: bool(not node.right and node.inertia),
}
"""The nodes that the words before (2.4)_1, ..., (2.4)_5 are about."""


class Conditions(EquationGroup):
    """(2.3), (2.4), (4.3)-(4.5): conditions at nodes."""

    letters = frozenset({"i", "x", r"\bar{x}", "x_{i}"})
    is_alone = False

    def places(self, equation: Tree) -> Iterator[Place]:
        """m, i and x; where no i is given, it is the one that makes the rods right."""
        scope, m = self.scope, self.scope.chain.m
        for i in span(self.ranges["i"], scope) if "i" in self.ranges else (None,):
            scope.variables |= {} if i is None else {"i": i}
            for x in self._nodes():
                if not 0 <= x <= m:
                    raise MeaninglessError(f"there is no place x = {x}")
                own = i
                if i is None and Symbol("i") in parts_of(equation):
                    own = next((n for n in (x, x + 1) if self._rods(equation, n) == set(rods_at(scope.chain, x))), x)
                yield {"x": x} if own is None else {"i": own, "x": x}

    def _nodes(self) -> Iterator[int]:
        """The nodes that are meant, or the places that are given, in lengths of rods."""
        if kind := self.entry.subject.get("at"):
            yield from (x for x, node in enumerate(self.scope.chain.nodes) if NODES[kind](node))
            return
        place = self.ranges.get("x") or self.ranges.get(r"\bar{x}")
        if place is None:
            raise MeaninglessError("no place is given")
        for value in place.first_values:
            x = self.scope.value(value) / (self.scope.units.l if place.variable == Symbol("x") else fmpq(1))
            if x.denom() != 1:
                raise MeaninglessError(f"no rod ends at {latex(place)}")
            yield int(x)

    def _rods(self, equation: Tree, i: int | None) -> set[int]:
        """The rods that a condition is about; MeaninglessError where it is about another place than the node."""
        for part in parts_of(equation):
            if not isinstance(part, Call) or letter_name(part.function) not in DISPLACEMENTS.values():
                continue
            if tuple(map(latex, part.arguments)) != (r"\bar{x}", r"\tau"):
                raise MeaninglessError(f"{latex(part)} is not at the node")
        names = ("U", *DISPLACEMENTS.values())
        scope = Scope({"m": self.scope.chain.m} | ({} if i is None else {"i": i}))
        moved = (part for part in parts_of(equation) if isinstance(part, Symbol) and letter_name(part) in names)
        return {rod for symbol in moved for rod in scope.indices(symbol)}

    def key(self, equation: Tree, place: Place) -> Key:
        """It compares velocities, as (2.3) does, or else forces, or how a node moves."""
        found = [part for part in parts_of(equation) if isinstance(part, Derivative)]
        alike = all(latex(part.variable) in ("t", r"\tau") and part.order == 1 for part in found)
        return ("the rods move together" if alike else "forces are balanced"), place["x"]

    def required_keys(self) -> Iterable[Key] | None:
        m, together, balanced = self.scope.chain.m, "the rods move together", "forces are balanced"
        if self.entry.id.startswith("(2."):  # (2.3) is of all nodes between rods, (2.4) of those that it names
            return [(together, x) for x in range(1, m)] if self.entry.id == "(2.3)" else None
        return [(balanced, x) for x in range(m + 1)] + [(together, x) for x in range(1, m)]

    def further_cases(self, equation: Tree, place: Place, at: Place) -> Iterator[Case]:
        rods = tuple(sorted(self._rods(equation, place.get("i"))))
        yield Case({**at, "what": "its rods"}, rods, rods_at(self.scope.chain, place["x"]), is_telling=False)

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        for tau in instants(5, between=[fmpq(5, 6)]):  # every node has moved, and every load has begun
            yield {"left less right side at tau": tau}, self.scope.coordinates(place["x"], tau)


class Delays(EquationGroup):
    """(4.6), (4.7), (4.8): delay equations, also integrated across every front: what jumps in them adds up to 0."""

    is_alone = False

    def key(self, equation: Tree, place: Place) -> Key:
        """The one function on the left, and its rod."""
        calls = [part for part in parts_of(sides(equation)[0]) if isinstance(part, Call)]
        found = {(call.function.name, self.scope.indices(call.function)) for call in calls}
        if len(found) != 1 or any(len(index) != 1 for _, index in found):
            raise MeaninglessError("its left side has not one function of one rod")
        ((name, (rod,)),) = found
        return name, rod

    def required_keys(self) -> Iterable[Key]:
        return [(name, rod) for name in "fg" for rod in range(1, self.scope.chain.m + 1)]

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        for z in instants(6, between=[fmpq(5, 6)]):  # every load has begun
            yield {"left less right side at z": z}, {"z": z}

    def further_cases(self, equation: Tree, place: Place, at: Place) -> Iterator[Case]:
        if any(part.primes == 2 for part in parts_of(equation) if isinstance(part, Symbol)):
            self._jumps.scope.variables |= place
            for front in self._jumps.scope.motion.fronts:  # type: ignore[attr-defined]
                name = "left less right side across a front at z"
                yield self._jumps.balance(equation, {**at, name: front}, {"z": front})

    @cached_property
    def _jumps(self) -> _Jumps:
        return _Jumps(self.entry, self.reading, JumpingChain(self.scope.motion.exact, self.scope.motion.loads))


class _Jumps(Delays):
    """The second derivatives alone, each with the jump of the first one."""

    def __init__(self, entry: PaperEntry, reading: Reading, motion: LoadedChain) -> None:
        super().__init__(entry, reading, motion)
        self.scope.heaviside_at_0 = 0
        self.scope.step = lambda value: 0  # type: ignore[method-assign]

    def scene(self, at: Place, found: Case) -> Callable[[], Reproduction] | None:
        return None
