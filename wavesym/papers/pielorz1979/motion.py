"""(2.1), (2.2), (2.5), (4.1), (4.2) and the quantities without dimensions, on the motion of chains.

What is said of the motion inside the rods is evaluated on the exact motion. What is said to be the motion is put into
the laws of the nodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any

from flint import fmpq

from wavesym.model.chain import Chain
from wavesym.model.node import Node
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, given, holds, items, sides, span
from wavesym.papers.jets import Jet
from wavesym.papers.pielorz1979.truth import Driven, driven
from wavesym.papers.reader import read_formula
from wavesym.papers.record import Case, Reading, Test, case
from wavesym.papers.tree import Call, Derivative, Number, Progression, Symbol, Tree, latex

INSTANTS = (fmpq(2, 3), fmpq(9, 5), fmpq(31, 9))


@dataclass(frozen=True)
class Units:
    """The speed of sound, the length of a rod, the unit of displacement."""

    c_f: fmpq
    l: fmpq  # noqa: E741 - the paper's letter
    U_0: fmpq


_SLOW, _FAST = Units(fmpq(2), fmpq(3), fmpq(5, 7)), Units(fmpq(5, 2), fmpq(1, 7), fmpq(3))
CHAINS = (("II", 1, _SLOW), ("II", 2, _FAST), ("III", 2, _SLOW), ("III", 3, _FAST), ("I", 4, _SLOW), ("I", 6, _FAST))
_ANY_V_0 = fmpq(7, 5)


def displacement(motion: Driven, rod: int, x: Jet, tau: Jet) -> Jet:
    """The exact motion of a rod, without dimensions; MeaninglessError outside the rod and before the start."""
    if not rod - 1 <= x.value <= rod or not 1 <= rod <= motion.exact.m:
        raise MeaninglessError(f"rod {rod} does not reach to {x.value} l")
    if tau.value < 0:
        raise MeaninglessError("the motion begins at t = 0")
    clock = motion.exact.chain.rod(rod)
    f = wave(motion, "f", rod, tau - x + (clock.x0 - clock.tau0))
    g = wave(motion, "g", rod, tau + x - (clock.x0 + clock.tau0))
    moved: Jet = f + g + tau * clock.velocity
    return moved


def wave(motion: Driven, letter: str, rod: int, z: Jet) -> Jet:
    """f or g of a rod."""
    return z.of_function(lambda order: motion.wave(letter, rod, z.value, order))


def force(node: Node, left: tuple[Jet, Jet] | None, right: tuple[Jet, Jet] | None) -> Any:
    """What has to act on a node, where its rods move so: displacements there, along time and along place."""
    moving, _ = left or right or (Jet(0), Jet(0))
    total = node.inertia * moving.second + node.damping * moving.first
    if left:
        total = total + node.alpha / 2 * left[1].first
    if right:
        total = total - node.beta / 2 * right[1].first
    return total


def acting(motion: Driven, x: int, tau: fmpq) -> Any:
    """What acts on the node at x, by the exact motion."""
    place, time = Jet(fmpq(x), 1), Jet(tau, 1)

    def end(rod: int) -> tuple[Jet, Jet]:
        return displacement(motion, rod, Jet(place.value), time), displacement(motion, rod, place, Jet(tau))

    m = motion.exact.m
    return force(motion.exact.chain.nodes[x], end(x) if x > 0 else None, end(x + 1) if x < m else None)


def body_velocity(chain: Chain, rod: int) -> fmpq:
    """How fast the body is at the start that a rod is fixed to."""
    given = chain.parameters.velocity or {}
    return next((fmpq(given[x]) for x in (rod - 1, rod) if x in given), fmpq(0))


class Moving(Scope):
    """The letters of section 2, and of section 4 with bars, on the motion of a chain.

    `constants` are those whose value the formula's ranges say.
    """

    def __init__(self, motion: Driven, units: Units, constants: Mapping[Tree, Tree] | None = None) -> None:
        super().__init__({"m": motion.exact.m, "l": units.l})
        self.motion, self.units, self.constants = motion, units, constants or {}

    def at(self, x: Any, tau: Any) -> Mapping[str, Any]:
        """A place and an instant, in both units."""
        units = self.units
        return {"x": x * units.l, "t": tau * (units.l / units.c_f), r"\bar{x}": x, r"\tau": tau}

    def symbol(self, symbol: Symbol) -> Any:
        units = self.units
        if symbol in self.constants:
            return self.value(self.constants[symbol])
        match symbol:
            case Symbol("x", r"\bar", 0, ()) if r"\bar{x}" in self.bound:
                return self.bound[r"\bar{x}"]
            case Symbol("c", "", 0, (Symbol("f"),)):
                return units.c_f
            case Symbol("U", "", 0, (Number("0"),)):
                return units.U_0
            case Symbol("U", "", 0, (index,)) if "U" in self.bound and self.whole(index) == self.bound["i"]:
                return self.bound["U"]
            case Symbol("v", "", 0, (Number("0"),)):
                return _ANY_V_0
            case Symbol("v", "", 0, (index,)):
                return self._velocity(index) * units.c_f * units.U_0 / units.l
            case Symbol("v", r"\bar", 0, (index,)):
                return self._velocity(index)
            case Symbol("t", "", 0, (Number("0"), index)):
                return self._clock(index).tau0 * units.l / units.c_f
            case Symbol("x", "", 0, (Number("0"), index)):
                return self._clock(index).x0 * units.l
            case Symbol(r"\tau", "", 0, (Number("0"), index)):
                return self._clock(index).tau0
            case Symbol("x", r"\bar", 0, (Number("0"), index)):
                return self._clock(index).x0
            case Symbol("F" | "G", r"\mathcal", 0, (_,)) if "z" in self.bound:
                return self._wave(symbol, self.bound["z"] * units.l)
        return super().symbol(symbol)

    def call(self, call: Call) -> Any:
        function, arguments = call.function, [Jet.of(self.value(argument)) for argument in call.arguments]
        match function, arguments:
            case Symbol("U", "", 0, ()), (x, t):  # of the rod that is there
                rod = -int((-x.value / self.units.l).floor())
                return self._displacement(rod, x / self.units.l, t)
            case Symbol("U", "", 0, (index,)), (x, t):
                return self._displacement(self.whole(index), x / self.units.l, t)
            case Symbol("U", r"\bar", 0, (index,)), (x, tau):
                return displacement(self.motion, self.whole(index), x, tau)
            case ((Symbol("F" | "G", r"\mathcal", 0, (_,)) | Symbol("f" | "g", "", 0, (_,))), (z,)):
                return self._wave(function, z)
        return super().call(call)

    def derivative(self, derivative: Derivative) -> Any:
        by = latex(derivative.by)
        if by not in self.bound or derivative.order > 2:
            raise MeaninglessError(f"{latex(derivative)} is not defined")
        with self.binding({by: Jet(self.bound[by], 1)}):
            found = Jet.of(self.value(derivative.of))
        return found.first if derivative.order == 1 else found.second

    def unit(self, function: Symbol) -> Any:
        """In which a displacement is counted that is called so."""
        return 1 if function.accent else self.units.U_0

    def _displacement(self, rod: int, x: Jet, t: Jet) -> Jet:
        return displacement(self.motion, rod, x, t * (self.units.c_f / self.units.l)) * self.units.U_0

    def _wave(self, function: Symbol, z: Jet) -> Jet:
        (rod,) = self.indices(function)
        if not function.accent:
            return wave(self.motion, function.name, rod, z)
        return wave(self.motion, function.name.lower(), rod, z / self.units.l) * self.units.U_0

    def _velocity(self, index: Tree) -> fmpq:
        self._clock(index)
        return body_velocity(self.motion.exact.chain, self.whole(index))

    def _clock(self, index: Tree) -> Any:
        rod = self.whole(index)
        if not 1 <= rod <= self.motion.exact.m:
            raise MeaninglessError(f"there is no rod {rod}")
        return self.motion.exact.chain.rod(rod)


def _scopes(constants: Mapping[Tree, Tree] | None = None) -> Iterator[tuple[dict[str, object], Moving]]:
    for example, m, units in CHAINS:
        at = {"example": example, "m": m, "c_f": units.c_f, "l": units.l}
        yield at, Moving(driven(example, m), units, constants)


def _rods(reading: Reading, scope: Moving, at: Mapping[str, object]) -> tuple[Case, Sequence[int]]:
    """Whether every rod is named once, and those that are."""
    named = next((r for r in reading.ranges if isinstance(r, Progression) and r.variable == Symbol("i")), None)
    if named is None:
        raise MeaninglessError("no range of i")
    rods = span(named, scope)
    return Case({**at, "rods": latex(named)}, rods, tuple(range(1, scope.motion.exact.m + 1)), telling=False), rods


def inside(entry: Entry) -> Test:
    """Equations that are said to hold inside the rods, from the start on or at the start."""
    return Test("the exact motion of chains under loads, inside every rod; c_f and l are varied", _inside_cases)


def _inside_cases(reading: Reading) -> Iterator[Case]:
    (where,) = (r for r in reading.ranges if not isinstance(r, Progression))
    for at, scope in _scopes():
        whole, rods = _rods(reading, scope, at)
        yield whole
        for rod, sixth in product(rods, range(6 * scope.motion.exact.m + 1)):
            x = fmpq(sixth, 6)
            scope.bound |= {"i": rod, **scope.at(x, INSTANTS[sixth % 3])}
            here = {**at, "i": rod, "x": scope.bound["x"], "t": scope.bound["t"]}
            said = holds(where, scope)
            yield Case({**here, "within": latex(where)}, said, rod - 1 < x < rod, telling=False)
            if said and sixth % 6 in (1, 4):
                for number, equation in enumerate(items(reading.formula), 1):
                    value = f"left less right side, equation {number}"
                    yield case({**here, "value": value}, partial(_difference, scope, equation), 0)


def _difference(scope: Moving, equation: Tree) -> Any:
    left, right = sides(equation)
    return Jet.of(scope.value(left) - scope.value(right)).value


def solution(entry: Entry) -> Test:
    """A displacement in f and g, (2.5) or (4.2)."""
    return Test(_NODES, lambda reading: _solution_cases(reading, reading.formula, _scopes()))


_NODES = "continuity and the balance of forces at every node, as derived, on exact f and g; c_f and l are varied"


def _solution_cases(
    reading: Reading, formula: Tree, scopes: Iterator[tuple[dict[str, object], Moving]]
) -> Iterator[Case]:
    for at, scope in scopes:
        whole, rods = _rods(reading, scope, at)
        yield whole
        for tau, x in product(INSTANTS, range(scope.motion.exact.m + 1)):
            here = {**at, "t": scope.at(0, tau)["t"], "node": x, "value": "step of velocity, force left over"}
            yield case(here, partial(_left_over, scope, formula, x, tau, rods), (0, 0))


def _left_over(scope: Moving, formula: Tree, x: int, tau: fmpq, rods: Sequence[int]) -> tuple[Any, Any]:
    """What the printed displacements leave of the law of a node: a step of velocity, and a force."""
    node = scope.motion.exact.chain.nodes[x]
    ends = [
        (
            _printed(scope, formula, rod, scope.at(fmpq(x), Jet(tau, 1))),
            _printed(scope, formula, rod, scope.at(Jet(fmpq(x), 1), tau)),
        )
        for rod in (x, x + 1)
        if rod in rods
    ]
    left_over = force(node, ends[0] if node.left else None, ends[-1] if node.right else None)
    for load in node.loads:
        for power, coefficient in enumerate(load.coefficients):
            left_over = left_over - coefficient * scope.motion.load(load.source, tau, power)
    return ends[-1][0].first - ends[0][0].first, left_over


def _printed(scope: Moving, formula: Tree, rod: int, at: Mapping[str, Any]) -> Jet:
    """The displacement of a rod as printed, in units of U_0."""
    left, right = sides(formula)
    with scope.binding({**scope.bound, "i": rod, **at}):
        match left:
            case Call(Symbol("U", accent, 0, (index,)), (x, t)) if scope.whole(index) == rod:
                if (latex(x), latex(t)) == ((r"\bar{x}", r"\tau") if accent else ("x", "t")):
                    moved: Jet = Jet.of(scope.value(right)) / scope.unit(left.function)
                    return moved
    raise MeaninglessError(f"{latex(left)} is not the displacement of rod {rod}")


def definition(entry: Entry) -> Test:
    """A quantity without dimensions: put into (4.2), which no other of its name then has a place in."""

    def cases(reading: Reading) -> Iterator[Case]:
        letter, means = sides(reading.formula)
        scopes = ((at, _Defining(scope, letter, means)) for at, scope in _scopes(given(reading.ranges)))
        yield from _solution_cases(reading, _printed_formula("(4.2)"), scopes)

    return Test(f"(4.2) with it: {_NODES}", cases)


class _Defining(Moving):
    """(4.2) where one letter is what its definition makes of the motion in physical units."""

    def __init__(self, scope: Moving, letter: Tree, means: Tree) -> None:
        super().__init__(scope.motion, scope.units, scope.constants)
        if not isinstance(letter, Symbol):
            raise MeaninglessError(f"{latex(letter)} is no letter to define")
        self.letter, self.means = letter, means

    def at(self, x: Any, tau: Any) -> Mapping[str, Any]:
        known = super().at(x, tau)
        return {name: known[name] for name in known if name != latex(self.letter)}

    def symbol(self, symbol: Symbol) -> Any:
        return self._meaning() if self._defined(symbol) else super().symbol(symbol)

    def call(self, call: Call) -> Any:
        if not self._defined(call.function):
            return super().call(call)
        (z,) = call.arguments
        return self._meaning(z=self.value(z))

    def unit(self, function: Symbol) -> Any:
        if not self._defined(function):
            return super().unit(function)
        return self._meaning(U=self.units.U_0)

    def _defined(self, symbol: Symbol) -> bool:
        """Whether it is the letter; MeaninglessError where it is one of its name that stays undefined."""
        if symbol.name == self.letter.name and len(symbol.below) == len(self.letter.below) and symbol != self.letter:
            raise MeaninglessError(f"(4.2) has {latex(symbol)}, and {latex(self.letter)} is defined")
        return symbol == self.letter

    def _meaning(self, **more: Any) -> Any:
        physical = Moving(self.motion, self.units, self.constants)
        physical.bound = {**self.bound, **more}
        return physical.value(self.means)


def _printed_formula(id: str) -> Tree:
    """What another record has as printed."""
    from wavesym.papers.pielorz1979.paper import paper  # which has the adapters

    (found,) = (entry for entry in paper().entries() if entry.id == id)
    return read_formula(found.printed)
