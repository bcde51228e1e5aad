"""The test of equations: both sides at all places and instants that their ranges say, on chains that move under loads.

Equations that belong together say each of some things once: a condition at each node, an equation for each function, a
constant for each body. A cell of Table 1 is an equation, too: what its column is for is on the left.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache, cached_property, lru_cache, partial
from typing import Any, ClassVar

from flint import fmpq

from wavesym.mechanics.node import Node
from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, constants_in, holds, items, sides, span
from wavesym.papers.exact_numbers import Jet
from wavesym.papers.pielorz1979.chains import (
    EXAMPLES,
    UNEQUAL_COLLISION,
    JumpingChain,
    LoadedChain,
    building,
    example,
    grounded_building,
    instants,
    loaded_chain,
    loads,
    unequal_collision,
)
from wavesym.papers.pielorz1979.letters import DISPLACEMENTS, ONES, Motion, Units, body_velocity, letter, rods_at
from wavesym.papers.pielorz1979.transcript import others, settled
from wavesym.papers.reader import read_range
from wavesym.papers.record import Case, Reading, Reproduction, Test, case, format_value
from wavesym.papers.tree import Call, Cases, Derivative, Progression, Relation, Symbol, Tree, latex

Place = Mapping[str, Any]
"""Values of running letters."""
Key = tuple[Any, ...]
"""What an equation says: a letter or a word, and a number."""

NODES: Mapping[str, Callable[[Node], bool]] = {
    "a free end": lambda node: not (node.left and node.right) and not node.inertia and not node.loads,
    "a body between rods": lambda node: bool(node.left and node.right and node.inertia),
    "a contact": lambda node: node.contact,
    "a body at a left end": lambda node: bool(not node.left and node.inertia),
    "a body at a right end": lambda node: bool(not node.right and node.inertia),
}
"""The nodes that the words before (2.4)_1, ..., (2.4)_5 are about."""
EQUAL_FLOORS = "equal floors"
_SLOW, _FAST = Units(fmpq(2), fmpq(3), fmpq(5, 7)), Units(fmpq(5, 2), fmpq(1, 7), fmpq(3))
_MOVING = "the exact motion of chains with all parameters different under loads of several steps"
_RODS = read_range(r"i = 1, 2, \dots, m")


@lru_cache(maxsize=1000)
def within(tree: Any) -> tuple[Any, ...]:
    """A tree and all its parts."""
    values = (getattr(tree, field.name) for field in fields(tree))
    parts = (part for value in values for part in (value if isinstance(value, tuple) else (value,)))
    return (tree, *(inner for part in parts if is_dataclass(part) for inner in within(part)))  # type: ignore[arg-type]


class EquationGroup:
    """Equations of a kind, tried on one chain: a record's, and which others there are.

    Attributes:
        against: what they are compared with.
        letters: what a range may be of.
        sizes: the m of each example.
        units: of the chains, those of every other m.
        velocities: whether a v is that of a "body" or of a "rod".
        is_definition: whether the left side is known by the exact motion, and the right side is to be its value.
        is_alone: whether the record says by itself all that is required, or beside others of its group.
    """

    against: ClassVar[str] = _MOVING
    letters: ClassVar[frozenset[str]] = frozenset({"i", "x_{i}", "v_{0}", "S_{0}"})
    sizes: ClassVar[Mapping[str, Iterable[int]]] = {name: example.sizes for name, example in EXAMPLES.items()}
    units: ClassVar[tuple[Units, Units]] = (_SLOW, _FAST)
    velocities: ClassVar[str] = "body"
    is_definition: ClassVar[bool] = False
    is_alone: ClassVar[bool] = True

    def __init__(self, entry: PaperEntry, reading: Reading, motion: LoadedChain) -> None:
        self.entry, self.reading = entry, reading
        progressions = [r for r in reading.ranges if isinstance(r, Progression)]
        self.ranges = {latex(r.variable): r for r in progressions}
        if len(self.ranges) < len(progressions) or not self.ranges.keys() <= self.letters:
            raise MeaninglessError("a range of something else")
        constants = {name: value for name, value in constants_in(reading.ranges).items() if "_" in latex(name)}
        self.scope = Motion(motion, self.units[motion.exact.m % 2], constants, self.velocities)

    # what a kind has of its own

    def places(self, equation: Tree) -> Iterator[Place]:
        """Where an equation is said to hold."""
        if "i" in self.ranges and Symbol("i") in within(equation):
            yield from ({"i": i} for i in span(self.ranges["i"], self.scope))
        else:
            yield {}

    def key(self, equation: Tree, place: Place) -> Key:
        """What an equation says at a place."""
        raise NotImplementedError

    def required(self) -> Iterable[Key] | None:
        """All that is to be said of the chain, once; None where that is not asked."""
        raise NotImplementedError

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        """How an instant is called, and what is bound then."""
        yield {}, {}

    def sides(self, equation: Tree) -> tuple[Callable[[], Any], Callable[[], Any]]:
        """The values of both sides."""
        left, right = sides(equation)
        return partial(self.scope.value, left), partial(self.scope.value, right)

    def more(self, equation: Tree, place: Place, at: Place) -> Iterator[Case]:
        """What else is said at a place."""
        yield from ()

    # the test

    def cases(self, at: Place) -> Iterator[Case]:
        """Both sides of each equation wherever it is said to hold, and what is said how often."""
        said: Counter[Key] = Counter()
        for equation in items(self.reading.formula):
            for place in self.places(equation):
                self.scope.bound |= place
                said[self.key(equation, place)] += 1
                here = {**at, **{name: place[name] for name in ("i", "x") if name in place}}
                yield from self.more(equation, place, here)
                for name, bound in self.instants(place):
                    yield self.balance(equation, {**here, **name}, bound)
        if (needed := self.required()) is None:
            return
        beside = Counter[Key]() if self.is_alone else self.beside()
        total, required = said + beside, Counter(needed)
        for key in sorted(total.keys() | required.keys(), key=str):
            found = Case(
                {**at, "how often it is given": "_".join(map(str, key))}, total[key], required[key], key in said
            )
            yield found if found.agrees else replace(found, example=self.scene(at, found))

    def balance(self, equation: Tree, at: Place, bound: Place) -> Case:
        """An equation at an instant: what is left of it, or its right side where it is a definition."""
        left, right = self.sides(equation)
        self.scope.seen = self.is_definition
        with self.scope.binding({**self.scope.bound, **bound}):
            if self.is_definition:
                found = case(at, lambda: Jet.of(right()).value, Jet.of(left()).value)
            else:
                found = case(at, lambda: Jet.of(left() - right()).value, 0)
        return replace(found, telling=self.scope.seen, example=None if found.agrees else self.scene(at, found))

    def beside(self) -> Counter[Key]:
        """What the other equations of the group say."""
        return _said_beside(self.entry.id, self.entry.kind, self.scope.motion)

    def scene(self, at: Place, found: Case) -> Callable[[], Reproduction] | None:
        """How a case is seen: what a scene says at its place, to be put into the equation."""
        if self.scope.chain.system is UNEQUAL_COLLISION:  # no scene has it
            return None
        where = ", ".join(f"{name} = {format_value(value)}" for name, value in at.items())
        x = min(max(fmpq(at.get("x", at.get("i", 1))), fmpq(0)), fmpq(self.scope.chain.m))
        look = f"velocity@{x} and what stands beside it in the equation; with {where}, {found.printed} comes of it"
        motion, outputs = self.scope.motion, {"velocity": [str(x)]}
        return example(motion.exact, motion.loads, 8, outputs, "wavesym run SCENE --samples 1001", look)


@cache
def _said_beside(id: str, kind: str, motion: LoadedChain) -> Counter[Key]:
    found: Counter[Key] = Counter()
    for reading in others(id, kind):
        beside = GROUPS[kind](PaperEntry(id=id, kind=kind, printed=""), reading, motion)
        for equation in items(reading.formula):
            for place in beside.places(equation):
                beside.scope.bound |= place
                found[beside.key(equation, place)] += 1
    return found


class Conditions(EquationGroup):
    """(2.3), (2.4), (4.3)-(4.5): conditions at nodes."""

    letters = frozenset({"i", "x", r"\bar{x}", "x_{i}"})
    is_alone = False

    def places(self, equation: Tree) -> Iterator[Place]:
        """m, i and x; where no i is given, it is the one that makes the rods right."""
        scope, m = self.scope, self.scope.chain.m
        for i in span(self.ranges["i"], scope) if "i" in self.ranges else (None,):
            scope.bound |= {} if i is None else {"i": i}
            for x in self._nodes():
                if not 0 <= x <= m:
                    raise MeaninglessError(f"there is no place x = {x}")
                own = i
                if i is None and Symbol("i") in within(equation):
                    own = next((n for n in (x, x + 1) if self._rods(equation, n) == set(rods_at(scope.chain, x))), x)
                yield {"x": x} if own is None else {"i": own, "x": x}

    def _nodes(self) -> Iterator[int]:
        """The nodes that are meant, or the places that are given, in lengths of rods."""
        if kind := self.entry.about.get("at"):
            yield from (x for x, node in enumerate(self.scope.chain.nodes) if NODES[kind](node))
            return
        place = self.ranges.get("x") or self.ranges.get(r"\bar{x}")
        if place is None:
            raise MeaninglessError("no place is given")
        for value in place.shown:
            x = self.scope.value(value) / (self.scope.units.l if place.variable == Symbol("x") else fmpq(1))
            if x.denom() != 1:
                raise MeaninglessError(f"no rod ends at {latex(place)}")
            yield int(x)

    def _rods(self, equation: Tree, i: int | None) -> set[int]:
        """The rods that a condition is about; MeaninglessError where it is about another place than the node."""
        for part in within(equation):
            is_moved = isinstance(part, Call) and letter(part.function) in DISPLACEMENTS.values()
            if is_moved and tuple(map(latex, part.arguments)) != (r"\bar{x}", r"\tau"):
                raise MeaninglessError(f"{latex(part)} is not at the node")
        names = ("U", *DISPLACEMENTS.values())
        scope = Scope({"m": self.scope.chain.m} | ({} if i is None else {"i": i}))
        moved = (part for part in within(equation) if isinstance(part, Symbol) and letter(part) in names)
        return {rod for symbol in moved for rod in scope.indices(symbol)}

    def key(self, equation: Tree, place: Place) -> Key:
        """It compares velocities, as (2.3) does, or else forces, or how a node moves."""
        found = [part for part in within(equation) if isinstance(part, Derivative)]
        alike = all(latex(part.by) in ("t", r"\tau") and part.order == 1 for part in found)
        return ("the rods move together" if alike else "forces are balanced"), place["x"]

    def required(self) -> Iterable[Key] | None:
        m, together, balanced = self.scope.chain.m, "the rods move together", "forces are balanced"
        if self.entry.id.startswith("(2."):  # (2.3) is of all nodes between rods, (2.4) of those that it names
            return [(together, x) for x in range(1, m)] if self.entry.id == "(2.3)" else None
        return [(balanced, x) for x in range(m + 1)] + [(together, x) for x in range(1, m)]

    def more(self, equation: Tree, place: Place, at: Place) -> Iterator[Case]:
        rods = tuple(sorted(self._rods(equation, place.get("i"))))
        yield Case({**at, "what": "its rods"}, rods, rods_at(self.scope.chain, place["x"]), telling=False)

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        for tau in instants(6, between=[fmpq(5, 6)]):  # every node has moved, and every load has begun
            yield {"left less right side at tau": tau}, self.scope.at(place["x"], tau)


class Delays(EquationGroup):
    """(4.6), (4.7), (4.8): delay equations, also integrated across every front: what jumps in them adds up to 0."""

    is_alone = False

    def key(self, equation: Tree, place: Place) -> Key:
        """The one function on the left, and its rod."""
        calls = [part for part in within(sides(equation)[0]) if isinstance(part, Call)]
        found = {(call.function.name, self.scope.indices(call.function)) for call in calls}
        if len(found) != 1 or any(len(index) != 1 for _, index in found):
            raise MeaninglessError("its left side has not one function of one rod")
        ((name, (rod,)),) = found
        return name, rod

    def required(self) -> Iterable[Key]:
        return [(name, rod) for name in "fg" for rod in range(1, self.scope.chain.m + 1)]

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        for z in instants(8, between=[fmpq(5, 6)]):  # waves have crossed the longest chain
            yield {"left less right side at z": z}, {"z": z}

    def more(self, equation: Tree, place: Place, at: Place) -> Iterator[Case]:
        if any(part.primes == 2 for part in within(equation) if isinstance(part, Symbol)):
            self._across.scope.bound |= place
            for front in self._across.scope.motion.fronts:  # type: ignore[attr-defined]
                name = "left less right side across a front at z"
                yield self._across.balance(equation, {**at, name: front}, {"z": front})

    @cached_property
    def _across(self) -> _Jumps:
        return _Jumps(self.entry, self.reading, JumpingChain(self.scope.motion.exact, self.scope.motion.loads))


class _Jumps(Delays):
    """The second derivatives alone, each with the jump of the first one."""

    def __init__(self, entry: PaperEntry, reading: Reading, motion: LoadedChain) -> None:
        super().__init__(entry, reading, motion)
        self.scope.heaviside_at_0 = 0
        self.scope.step = lambda value: 0  # type: ignore[method-assign]

    def scene(self, at: Place, found: Case) -> Callable[[], Reproduction] | None:
        return None


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

    def required(self) -> Iterable[Key]:
        return [("rod", rod) for rod in range(1, self.scope.chain.m + 1)] * len(items(self.reading.formula))

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        """Somewhere in the rod."""
        for part, tau in ((fmpq(2, 3), fmpq(31, 9)), (fmpq(1, 6), fmpq(2, 3))):
            bound = {**self.scope.at(place["i"] - part, tau), "z": tau}
            yield {"x": bound["x"], "t": bound["t"]}, bound


class Interior(OfRods):
    """(2.1), (2.2), (4.1): equations inside the rods, from the start on or at the start."""

    against = "the exact motion of chains under loads, inside every rod; c_f and l are varied"

    def more(self, equation: Tree, place: Place, at: Place) -> Iterator[Case]:
        """The places that are said to be inside."""
        where = next((r for r in self.reading.ranges if isinstance(r, Relation)), None)
        if where is None:
            raise MeaninglessError("x has no range")
        for x in (fmpq(sixth, 6) for sixth in range(6 * self.scope.chain.m + 1)):
            with self.scope.binding({**self.scope.bound, **self.scope.at(x, fmpq(1))}):
                inside = place["i"] - 1 < x < place["i"]
                yield Case({**at, "x": x, "within": latex(where)}, holds(where, self.scope), inside, telling=False)


class Definitions(OfRods):
    """The quantities without dimensions: the same motion in both kinds of units."""

    against = "the exact motion of chains under loads, with and without dimensions; c_f, l and U_0 are varied"


class Loads(EquationGroup):
    """(3.1), (3.2): the loads of bodies."""

    against = "what acts on the body by its exact motion, under loads with several pieces, just after any jump"
    sizes: ClassVar[Mapping[str, Iterable[int]]] = {"II": (1, 2, 3), "III": (2,)}
    units = (ONES, ONES)
    is_definition = True

    def key(self, equation: Tree, place: Place) -> Key:
        left = sides(equation)[0]
        function = left.function if isinstance(left, Call) else left
        if not isinstance(function, Symbol):
            raise MeaninglessError(f"{latex(left)} is no load")
        return letter(function), *self.scope.indices(function)

    def required(self) -> Iterable[Key]:
        return [("M", body) for body in range(1, self.scope.chain.m + 2)] if self.scope.is_drive else [(r"\ddoty", 0)]

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        yield from (({"t": fmpq(half, 2)}, {"t": fmpq(half, 2)}) for half in range(6))


class Constants(Loads):
    """kappa, A and loads without dimensions, in terms of materials."""

    against = "chains of bodies and rods in physical units whose nodes have the laws of the derivation"
    sizes: ClassVar[Mapping[str, Iterable[int]]] = {"I": (4, 6), "II": (1, 2, 3), "III": (2, 3, 4)}
    units = (replace(_SLOW, S_0=fmpq(7, 3)), replace(_FAST, S_0=fmpq(2, 5)))

    def required(self) -> Iterable[Key]:
        name = letter(self._defined())
        if name == r"\kappa":
            return [(name, i) for i in self.scope.chain.system.indices(self.scope.chain.m)["kappa"]]
        return [(name, body) for body in range(1, self.scope.chain.m + 2)]

    def _defined(self) -> Symbol:
        left = sides(self.reading.formula)[0]
        function = left.function if isinstance(left, Call) else left
        if not isinstance(function, Symbol) or len(function.below) != 1:
            raise MeaninglessError(f"{latex(left)} is not defined")
        return function

    def key(self, equation: Tree, place: Place) -> Key:
        self.scope.indices(self._defined())
        return super().key(equation, place)

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        yield {}, self.scope.at(0, fmpq(5, 4))


class Rates(Constants):
    """(4.11): gamma, which both its lines together give once."""

    against = "the rates of the discs by their derived node laws, m = 1 ... 5"
    sizes: ClassVar[Mapping[str, Iterable[int]]] = {"II": range(1, 6)}
    is_alone = False

    def _defined(self) -> Symbol:
        return Symbol(r"\gamma", below=(Symbol("i"),))

    def key(self, equation: Tree, place: Place) -> Key:
        return Loads.key(self, equation, place)

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        yield {}, {}


class Table1(OfRods):
    """The cells of Table 1: where and when the first disturbance reaches a rod, how it moves then, and its loads."""

    against = "when and where the first disturbance arrives, and the clock with which (4.6)-(4.8) follow"
    sizes: ClassVar[Mapping[str, Iterable[int]]] = {"I": (4, 6, 8), "II": (1, 2, 3), "III": (2, 3, 4)}
    velocities = "body"
    is_definition = True

    def numbers(self, equation: Tree) -> Iterable[int]:
        if isinstance(equation, Cases):
            return [i for _, where in equation.branches for i in span(where, self.scope)]
        return span(self.ranges.get("i", _RODS), self.scope)

    def required(self) -> Iterable[Key]:
        """The rods; of the loads the bodies that have one, too."""
        numbers = {*range(1, self.scope.chain.m + 1)}
        if self.entry.about["column"] == "S":
            numbers |= {int(source[1:]) for source in self.scope.chain.sources if source[0] == "M"}
        return [("rod", number) for number in numbers]

    def instants(self, place: Place) -> Iterator[tuple[Place, Place]]:
        yield {}, self.scope.at(0, fmpq(place["i"], 2))

    def sides(self, equation: Tree) -> tuple[Callable[[], Any], Callable[[], Any]]:
        scope, i = self.scope, self.scope.bound["i"]
        if self.entry.about["column"] == "c_f^2":
            value, root = sides(equation)
            return lambda: (scope.units.c_f**2,) * 2, lambda: (scope.value(value), scope.value(root))
        means: Mapping[str, Callable[[], Any]] = {
            "x_0": lambda: scope.first(0, i).x0,
            "tau_0": lambda: scope.first(0, i).tau0,
            "v": lambda: body_velocity(scope.chain, i),
            "S": lambda: scope.functions["S"](i, scope.bound["t"]) if self._is_body(i) else 0,
        }
        return means[self.entry.about["column"]], partial(scope.value, equation)

    def _is_body(self, i: int) -> bool:
        x = i - 1 if self.scope.is_drive else i
        return 0 <= x <= self.scope.chain.m and bool(self.scope.chain.nodes[x].inertia)

    def more(self, equation: Tree, place: Place, at: Place) -> Iterator[Case]:
        """The first disturbance itself."""
        column, rod = self.entry.about["column"], place["i"]
        if column in ("x_0", "tau_0") and 1 <= rod <= self.scope.chain.m:
            time, ends = arrival(self.scope.chain, rod)
            value = partial(self.scope.value, equation)
            if column == "tau_0":
                yield case({**at, "front": "time"}, value, time)
            else:
                yield case({**at, "front": "end"}, lambda: value() in ends, True)


GROUPS: Mapping[str, type[EquationGroup]] = {
    "condition": Conditions,
    "delay": Delays,
    "inside": Interior,
    "definition": Definitions,
    "load": Loads,
    "constant": Constants,
    "rate": Rates,
    "cell": Table1,
}


def equation(entry: PaperEntry) -> Test:
    """How an equation is tried, and under what the text may mean beside what it says."""
    group, base = GROUPS[entry.kind], entry.about.get("base")
    own = entry.about.get("row" if entry.kind == "cell" else "example")
    names = (str(own),) if own else tuple(group.sizes)

    def cases(reading: Reading, variant: str | None = base) -> Iterator[Case]:
        for name in names:
            for m in group.sizes[name]:
                motion = _chain(name, m, variant, "at" in entry.about)
                yield from group(entry, reading, motion).cases({"m": m} if own else {"example": name, "m": m})

    def with_range(more: Tree) -> Callable[[Reading], Iterable[Case]]:
        return lambda reading: cases(_with_range(reading, more))

    conventions: dict[str, Callable[[Reading], Iterable[Case]]] = {}
    if "at" in entry.about:
        for place in ("(i-1)l", "il"):
            conventions[f"body i stands at x = {place}"] = with_range(read_range(f"x_i = {place}"))
    if own == "III" and entry.kind in ("condition", "delay") and not base:
        conventions["all floors are equal"] = lambda reading: cases(reading, EQUAL_FLOORS)
    if entry.kind == "definition":
        conventions["a letter means the same with a bar"] = lambda reading: cases(_without_bar(reading))
    if entry.kind == "cell":
        bodies = next(r for r in settled("(3.1)").ranges if isinstance(r, Progression))
        conventions["i is the number of a body, as in (3.1)"] = with_range(bodies)
    return Test(
        group.against + (", on a foundation that moves with the ground" if base else ""),
        cases,
        is_subtracted=not base,
        mathematics=(lambda reading: cases(reading, None)) if base else None,
        conventions=conventions,
    )


def _with_range(reading: Reading, more: Tree) -> Reading:
    """A formula with one more range, in the place of one of the same letter."""
    assert isinstance(more, Progression)
    kept = (r for r in reading.ranges if not isinstance(r, Progression) or r.variable != more.variable)
    return Reading(reading.formula, (*kept, more))


def _without_bar(reading: Reading) -> Reading:
    name, means = sides(reading.formula)
    plain = replace(name, accent="") if isinstance(name, Symbol) else name
    return Reading(Relation((plain, means), ("=",)), reading.ranges)


@cache
def _chain(name: str, m: int, variant: str | None, is_general: bool) -> LoadedChain:
    """A chain of an example under its loads; for (2.4), which has an A_i for each rod, with unequal rods."""
    if variant == "ground":
        exact = grounded_building(m)
    elif variant == EQUAL_FLOORS:
        exact = building(m)
    elif name == "I" and is_general:
        exact = unequal_collision(m)
    else:
        return loaded_chain(name, m)
    return LoadedChain(exact, loads(exact))


def is_complete(number: str, m: int) -> bool:
    """Whether the equations of a group, as they are right, give each of f_1, ..., f_m, g_1, ..., g_m once."""
    known = EXAMPLES[{"(4.6)": "I", "(4.7)": "II", "(4.8)": "III"}[number]]
    if (m - known.system.smallest) % known.system.step:
        return False
    said = _said_beside(number, "delay", loaded_chain(known.name, m))
    return said == Counter((name, rod) for name in "fg" for rod in range(1, m + 1))


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


# solutions


def solution(entry: PaperEntry) -> Test:
    """A displacement in f and g, (2.5) or (4.2), put into the law of every node: a step of velocity, and a force."""
    return Test(
        "continuity and the balance of forces at every node, as derived, on exact f and g; c_f and l are varied",
        partial(_solution_cases, entry),
    )


def _solution_cases(entry: PaperEntry, reading: Reading) -> Iterator[Case]:
    for name, sizes in OfRods.sizes.items():
        for m in sizes:
            group = Definitions(entry, reading, loaded_chain(name, m))
            scope, at = group.scope, {"example": name, "m": m}
            said = Counter(group.key(reading.formula, place) for place in group.places(reading.formula))
            required = Counter(group.required())
            for key in sorted(said.keys() | required.keys()):
                yield Case({**at, "how often it is given": f"rod_{key[1]}"}, said[key], required[key], telling=False)
            for tau in (fmpq(2, 3), fmpq(31, 9)):
                for x in range(m + 1):
                    where = {**at, "t": tau * scope.units.l / scope.units.c_f, "node": x}
                    value = "step of velocity, force left over"
                    found = case({**where, "value": value}, partial(_left_over, scope, reading.formula, x, tau), (0, 0))
                    yield replace(found, example=None if found.agrees else group.scene({**where, "x": x}, found))


def _left_over(scope: Motion, formula: Tree, x: int, tau: fmpq) -> tuple[Any, Any]:
    """What the printed displacements leave of the law of a node."""
    step, force = scope.law(x, tau, partial(_printed, scope, formula))
    for load in scope.chain.nodes[x].loads:
        for power, coefficient in enumerate(load.coefficients):
            force = force - coefficient * scope.motion.load(load.source, tau, power)
    return step, force


def _printed(scope: Motion, formula: Tree, rod: int, x: Jet, tau: Jet) -> Jet:
    """The displacement of a rod as printed, in units of U_0."""
    left, right = sides(formula)
    with scope.binding({**scope.bound, "i": rod, **scope.at(x, tau)}):
        match left:
            case Call(Symbol("U", accent, 0, (index,)), (place, time)) if scope.whole(index) == rod:
                if (latex(place), latex(time)) == ((r"\bar{x}", r"\tau") if accent else ("x", "t")):
                    return Jet.of(scope.value(right)) / (1 if accent else scope.units.U_0)
    raise MeaninglessError(f"{latex(left)} is not the displacement of rod {rod}")
