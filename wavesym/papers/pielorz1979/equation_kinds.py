"""The kinds of equations: of nodes and waves, and of what quantities are, inside rods, in other units, in loads.

Nodes: (2.3), (2.4), (4.3)-(4.5). Waves: the delay equations (4.6)-(4.8). Quantities: (2.1), (2.2), (4.1), (3.1), (3.2),
the definitions and constants of section 4, (4.11), and Table 1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property, partial
from typing import Any, ClassVar

from flint import fmpq

from wavesym.mechanics.node import Node
from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds, items, sides, span
from wavesym.papers.pielorz1979.chains import (
    JumpingChain,
    LoadedChain,
    instants,
)
from wavesym.papers.pielorz1979.equation_group import FAST, SLOW, EquationGroup, Key, Place
from wavesym.papers.pielorz1979.letters import DISPLACEMENTS, ONES, body_velocity, rods_at
from wavesym.papers.reader import read_range
from wavesym.papers.record import Case, Reading, Reproduction, case
from wavesym.papers.tree import Call, Cases, Derivative, Relation, Symbol, Tree, latex, parts_of

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
            if not isinstance(part, Call) or part.function.letter not in DISPLACEMENTS.values():
                continue
            if tuple(map(latex, part.arguments)) != (r"\bar{x}", r"\tau"):
                raise MeaninglessError(f"{latex(part)} is not at the node")
        names = ("U", *DISPLACEMENTS.values())
        scope = Scope({"m": self.scope.chain.m} | ({} if i is None else {"i": i}))
        moved = (part for part in parts_of(equation) if isinstance(part, Symbol) and part.letter in names)
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


ROD_NUMBERS = read_range(r"i = 1, 2, \dots, m")


class OfRods(EquationGroup):
    """What is said of each rod."""

    sizes: ClassVar[Mapping[str, Iterable[int]]] = {"I": (4, 6), "II": (1, 2), "III": (2, 3)}
    velocities = "rod"

    def __init__(self, entry: PaperEntry, reading: Reading, motion: LoadedChain) -> None:
        super().__init__(entry, reading, motion)
        late = self.scope.units.l / self.scope.units.c_f  # the t_k are those of (3.2) alone
        self.scope.letters["t"] = lambda zero, rod: self.scope.start(zero, rod) * late

    def numbers(self, equation: Tree) -> Iterable[int]:
        """The rods."""
        if "i" not in self.ranges:
            raise MeaninglessError("i has no range")
        return span(self.ranges["i"], self.scope)

    def places(self, equation: Tree) -> Iterator[Place]:
        return ({"i": i} for i in self.numbers(equation))

    def key(self, equation: Tree, place: Place) -> Key:
        return "rod", place["i"]

    def required_keys(self) -> Iterable[Key]:
        return [("rod", rod) for rod in range(1, self.scope.chain.m + 1)] * len(items(self.reading.formula))

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        """Somewhere in the rod."""
        for part, tau in ((fmpq(2, 3), fmpq(31, 9)), (fmpq(1, 6), fmpq(2, 3))):
            bound = {**self.scope.coordinates(place["i"] - part, tau), "z": tau}
            yield {"x": bound["x"], "t": bound["t"]}, bound


class Interior(OfRods):
    """(2.1), (2.2), (4.1): equations inside the rods, from the start on or at the start."""

    reference = "the exact motion of chains under loads, inside every rod; c_f and l are varied"

    def further_cases(self, equation: Tree, place: Place, at: Place) -> Iterator[Case]:
        """The places that are said to be inside."""
        where = next((r for r in self.reading.ranges if isinstance(r, Relation)), None)
        if where is None:
            raise MeaninglessError("x has no range")
        for x in (fmpq(sixth, 6) for sixth in range(6 * self.scope.chain.m + 1)):
            with self.scope.bind({**self.scope.variables, **self.scope.coordinates(x, fmpq(1))}):
                inside = place["i"] - 1 < x < place["i"]
                yield Case({**at, "x": x, "within": latex(where)}, holds(where, self.scope), inside, is_telling=False)


class Definitions(OfRods):
    """The quantities without dimensions: the same motion in both kinds of units."""

    reference = "the exact motion of chains under loads, with and without dimensions; c_f, l and U_0 are varied"


class Loads(EquationGroup):
    """(3.1), (3.2): the loads of bodies."""

    reference = "what acts on the body by its exact motion, under loads with several pieces, just after any jump"
    sizes: ClassVar[Mapping[str, Iterable[int]]] = {"II": (1, 2, 3), "III": (2,)}
    units = (ONES, ONES)
    is_definition = True

    def key(self, equation: Tree, place: Place) -> Key:
        left = sides(equation)[0]
        function = left.function if isinstance(left, Call) else left
        if not isinstance(function, Symbol):
            raise MeaninglessError(f"{latex(left)} is no load")
        return function.letter, *self.scope.indices(function)

    def required_keys(self) -> Iterable[Key]:
        return [("M", body) for body in range(1, self.scope.chain.m + 2)] if self.scope.is_drive else [(r"\ddoty", 0)]

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        yield from (({"t": fmpq(half, 2)}, {"t": fmpq(half, 2)}) for half in range(6))


class Constants(Loads):
    """kappa, A and loads without dimensions, in terms of materials."""

    reference = "chains of bodies and rods in physical units whose nodes have the laws of the derivation"
    sizes: ClassVar[Mapping[str, Iterable[int]]] = {"I": (4, 6), "II": (1, 2, 3), "III": (2, 3, 4)}
    units = (replace(SLOW, S_0=fmpq(7, 3)), replace(FAST, S_0=fmpq(2, 5)))

    def required_keys(self) -> Iterable[Key]:
        name = self._defined_symbol().letter
        if name == r"\kappa":
            return [(name, i) for i in self.scope.chain.system.indices(self.scope.chain.m)["kappa"]]
        return [(name, body) for body in range(1, self.scope.chain.m + 2)]

    def _defined_symbol(self) -> Symbol:
        left = sides(self.reading.formula)[0]
        function = left.function if isinstance(left, Call) else left
        if not isinstance(function, Symbol) or len(function.subscript) != 1:
            raise MeaninglessError(f"{latex(left)} is not defined")
        return function

    def key(self, equation: Tree, place: Place) -> Key:
        self.scope.indices(self._defined_symbol())
        return super().key(equation, place)

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        yield {}, self.scope.coordinates(0, fmpq(5, 4))


class Rates(Constants):
    """(4.11): gamma, which both its lines together give once."""

    reference = "the rates of the discs by their derived node laws, m = 1 ... 5"
    sizes: ClassVar[Mapping[str, Iterable[int]]] = {"II": range(1, 6)}
    is_alone = False

    def _defined_symbol(self) -> Symbol:
        return Symbol(r"\gamma", subscript=(Symbol("i"),))

    def key(self, equation: Tree, place: Place) -> Key:
        return Loads.key(self, equation, place)

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        yield {}, {}


class Table1(OfRods):
    """The cells of Table 1: where and when the first disturbance reaches a rod, how it moves then, and its loads."""

    _AGAINST: ClassVar[Mapping[str, str]] = {
        "c_f^2": "the stiffness of a rod over its inertia per length",
        "x_0": "the end at which the first disturbance arrives, and the clock with which (4.6)-(4.8) follow",
        "tau_0": "the time at which the first disturbance arrives, and the clock with which (4.6)-(4.8) follow",
        "v": "the velocity of the body to which the rod is fixed",
        "S": "the loads of the rigid bodies, and what acts on them by the exact motion",
    }
    sizes: ClassVar[Mapping[str, Iterable[int]]] = {"I": (4, 6, 8), "II": (1, 2, 3), "III": (2, 3, 4)}
    velocities = "body"
    is_definition = True

    @classmethod
    def reference_note(cls, entry: PaperEntry) -> str:
        return cls._AGAINST[entry.subject["column"]]

    def numbers(self, equation: Tree) -> Iterable[int]:
        if isinstance(equation, Cases):
            return [i for _, where in equation.branches for i in span(where, self.scope)]
        return span(self.ranges.get("i", ROD_NUMBERS), self.scope)

    def required_keys(self) -> Iterable[Key]:
        """The rods; of the loads the bodies that have one, too."""
        numbers = {*range(1, self.scope.chain.m + 1)}
        if self.entry.subject["column"] == "S":
            numbers |= {int(source[1:]) for source in self.scope.chain.sources if source[0] == "M"}
        return [("rod", number) for number in numbers]

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        yield {}, self.scope.coordinates(0, fmpq(place["i"], 2))

    def sides(self, equation: Tree) -> tuple[Callable[[], Any], Callable[[], Any]]:
        scope, i = self.scope, self.scope.variables["i"]
        if self.entry.subject["column"] == "c_f^2":
            value, root = sides(equation)
            return lambda: (scope.units.c_f**2,) * 2, lambda: (scope.value(value), scope.value(root))
        means: Mapping[str, Callable[[], Any]] = {
            "x_0": lambda: scope.first(0, i).x0,
            "tau_0": lambda: scope.first(0, i).tau0,
            "v": lambda: body_velocity(scope.chain, i),
            "S": lambda: scope.functions["S"](i, scope.variables["t"]) if self._is_body(i) else 0,
        }
        return means[self.entry.subject["column"]], partial(scope.value, equation)

    def _is_body(self, i: int) -> bool:
        x = i - 1 if self.scope.is_drive else i
        return 0 <= x <= self.scope.chain.m and bool(self.scope.chain.nodes[x].inertia)

    def further_cases(self, equation: Tree, place: Place, at: Place) -> Iterator[Case]:
        """The first disturbance itself."""
        column, rod = self.entry.subject["column"], place["i"]
        if column in ("x_0", "tau_0") and 1 <= rod <= self.scope.chain.m:
            time, ends = arrival(self.scope.chain, rod)
            value = partial(self.scope.value, equation)
            if column == "tau_0":
                yield case({**at, "front": "time"}, value, time)
            else:
                yield case({**at, "front": "end"}, lambda: value() in ends, True)


def arrival(chain: Any, rod: int, which: Callable[[Iterable[int]], int] = min) -> tuple[int, set[int]]:
    """When the first disturbance reaches a rod (the last one, by max), and at which of its ends.

    Disturbances come from loads, and from contacts that are struck.
    """
    struck = [
        x
        for x, node in enumerate(chain.nodes)
        if node.loads or (node.left and node.right and node.left.velocity != node.right.velocity)
    ]
    times = {end: which(abs(end - x) for x in struck) for end in (rod - 1, rod)}
    first = which(times.values())
    return first, {end for end, time in times.items() if time == first}
