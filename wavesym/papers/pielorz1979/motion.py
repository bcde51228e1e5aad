"""(2.1), (2.2), (2.5), (4.1), (4.2), on the motion of chains in physical units and without dimensions.

What is said of the motion inside the rods is evaluated on the exact motion. What is said to be the motion is put into
the laws of the nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any

from flint import fmpq

from wavesym.model.chain import Chain
from wavesym.papers.entries import Entry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds, items, range_of, sides, span
from wavesym.papers.jets import Jet
from wavesym.papers.pielorz1979.displacements import displacement, force, wave
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.truth import Driven, Step, driven
from wavesym.papers.record import Case, Example, Reading, Test, case
from wavesym.papers.tree import Call, Derivative, Number, Relation, Symbol, Tree, latex

INSTANTS = (fmpq(2, 3), fmpq(31, 9))


@dataclass(frozen=True)
class Units:
    """The speed of sound, the length of a rod, the unit of displacement."""

    c_f: fmpq
    l: fmpq  # noqa: E741 - the paper's letter
    U_0: fmpq


_SLOW, _FAST = Units(fmpq(2), fmpq(3), fmpq(5, 7)), Units(fmpq(5, 2), fmpq(1, 7), fmpq(3))
CHAINS = (("II", 1, _SLOW), ("II", 2, _FAST), ("III", 2, _SLOW), ("III", 3, _FAST), ("I", 4, _SLOW), ("I", 6, _FAST))
_ANY_V_0 = fmpq(7, 5)


def body_velocity(chain: Chain, rod: int) -> fmpq:
    """How fast the body is at the start that a rod is fixed to."""
    given = chain.parameters.velocity or {}
    return next((fmpq(given[x]) for x in (rod - 1, rod) if x in given), fmpq(0))


class Moving(Scope):
    """The letters of section 2, and of section 4 with bars, on the motion of a chain."""

    def __init__(self, motion: Driven, units: Units, constants: Mapping[Tree, Tree] | None = None) -> None:
        super().__init__({"m": motion.exact.m, "l": units.l}, constants)
        self.motion, self.units = motion, units

    def at(self, x: Any, tau: Any) -> Mapping[str, Any]:
        """A place and an instant, in both units."""
        units = self.units
        return {"x": x * units.l, "t": tau * (units.l / units.c_f), r"\bar{x}": x, r"\tau": tau}

    def symbol(self, symbol: Symbol) -> Any:
        units = self.units
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


def scopes(constants: Mapping[Tree, Tree] | None = None) -> Iterator[tuple[dict[str, object], Moving]]:
    """Chains under loads, the smallest first, with what to call them."""
    for name, m, units in CHAINS:
        at = {"example": name, "m": m, "c_f": units.c_f, "l": units.l}
        yield at, Moving(driven(name, m), units, constants)


def _rods(reading: Reading, scope: Moving, at: Mapping[str, object]) -> tuple[Case, Sequence[int]]:
    """Whether every rod is named once, and those that are."""
    named = range_of("i", reading.ranges)
    rods = span(named, scope)
    return Case({**at, "rods": latex(named)}, rods, tuple(range(1, scope.motion.exact.m + 1)), telling=False), rods


def inside(entry: Entry) -> Test:
    """Equations that are said to hold inside the rods, from the start on or at the start."""
    return Test("the exact motion of chains under loads, inside every rod; c_f and l are varied", _inside_cases)


def _inside_cases(reading: Reading) -> Iterator[Case]:
    where = next((r for r in reading.ranges if isinstance(r, Relation)), None)
    if where is None:
        raise MeaninglessError("x has no range")
    for at, scope in scopes():
        whole, rods = _rods(reading, scope, at)
        yield whole
        for rod, sixth in product(rods, range(6 * scope.motion.exact.m + 1)):
            x = fmpq(sixth, 6)
            scope.bound |= {"i": rod, **scope.at(x, INSTANTS[sixth % 2])}
            here = {**at, "i": rod, "x": scope.bound["x"], "t": scope.bound["t"]}
            said = holds(where, scope)
            yield Case({**here, "within": latex(where)}, said, rod - 1 < x < rod, telling=False)
            if said and sixth % 6 in (1, 4):
                for number, equation in enumerate(items(reading.formula), 1):
                    value = f"left less right side, equation {number}"
                    difference = partial(_difference, scope, equation)
                    yield case({**here, "value": value}, difference, 0, "U" in latex(equation), example=_front)


def _difference(scope: Moving, equation: Tree) -> Any:
    left, right = sides(equation)
    return Jet.of(scope.value(left) - scope.value(right)).value


def _front() -> Example:
    look = "velocity@1 stays 0 until tau = 1: a front crosses a rod in t = l / c_f, its speed is c_f"
    step = {"M1": (Step(fmpq(0), fmpq(1)),)}
    return example(driven("II", 1).exact, step, 2, {"velocity": ["1"]}, "wavesym run SCENE --samples 9", look)()


def solution(entry: Entry) -> Test:
    """A displacement in f and g, (2.5) or (4.2)."""
    return Test(NODES, lambda reading: solution_cases(reading, reading.formula, scopes(), _clocks))


def _clocks() -> Example:
    look = "velocity@3/2 changes from tau = 1/2 on, velocity@1/2 from tau = 3/2: every rod has a t_0 of its own"
    places = {"velocity": ["1/2", "3/2"]}
    return example(driven("I", 4).exact, {}, 2, places, "wavesym run SCENE --samples 9", look)()


NODES = "continuity and the balance of forces at every node, as derived, on exact f and g; c_f and l are varied"


def solution_cases(
    reading: Reading,
    formula: Tree,
    moving: Iterator[tuple[dict[str, object], Moving]],
    shown: Callable[[], Example] | None = None,
) -> Iterator[Case]:
    """A displacement in the laws of all nodes; `reading` has the range of its rods."""
    for at, scope in moving:
        whole, rods = _rods(reading, scope, at)
        yield whole
        if not whole.agrees:
            return
        for tau, x in product(INSTANTS, range(scope.motion.exact.m + 1)):
            here = {**at, "t": scope.at(0, tau)["t"], "node": x, "value": "step of velocity, force left over"}
            yield case(here, partial(_left_over, scope, formula, x, tau, rods), (0, 0), example=shown)


def _left_over(scope: Moving, formula: Tree, x: int, tau: fmpq, rods: Sequence[int]) -> tuple[Any, Any]:
    """What the printed displacements leave of the law of a node: a step of velocity, and a force."""
    node = scope.motion.exact.chain.nodes[x]
    ends = [
        (
            _printed(scope, formula, rod, scope.at(fmpq(x), Jet(tau, 1))),
            _printed(scope, formula, rod, scope.at(Jet(fmpq(x), 1), tau)),
        )
        for rod in (x, x + 1)
        if rod in rods  # the first and the last node have one
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
