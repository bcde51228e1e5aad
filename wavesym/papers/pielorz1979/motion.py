"""(2.1), (2.2), (2.5), (3.1), (3.2), (4.1), (4.2), and what is without dimensions, on the motion of chains.

What is said of the motion inside the rods is evaluated on the exact motion. What is said to be the motion is put into
the laws of the nodes. A load is what acts on a node, which its exact motion tells.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Any

from flint import fmpq

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, given, holds, items, range_of, sides, span
from wavesym.papers.jets import Jet
from wavesym.papers.pielorz1979.equations import covers
from wavesym.papers.pielorz1979.letters import Moving, Units
from wavesym.papers.pielorz1979.scenes import example
from wavesym.papers.pielorz1979.transcript import entry as entry_of
from wavesym.papers.pielorz1979.transcript import settled
from wavesym.papers.pielorz1979.truth import DrivenChain, LoadStep, driven
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.record import Case, Reading, Reproduction, Test, case
from wavesym.papers.tree import Call, Relation, Symbol, Tree, latex

_INSTANTS = (fmpq(2, 3), fmpq(31, 9))
_SLOW, _FAST = Units(fmpq(2), fmpq(3), fmpq(5, 7)), Units(fmpq(5, 2), fmpq(1, 7), fmpq(3))
_CHAINS = (("II", 1, _SLOW), ("II", 2, _FAST), ("III", 2, _SLOW), ("III", 3, _FAST), ("I", 4, _SLOW), ("I", 6, _FAST))
_NODES = "continuity and the balance of forces at every node, as derived, on exact f and g; c_f and l are varied"
_RODS = read_range(r"i = 1, 2, \dots, m")
"""What the rows of Table 1 are of, where nothing else is said."""

Scopes = Iterable[tuple[dict[str, object], Moving]]


def _scopes(kind: Callable[..., Moving] = Moving, **known: Any) -> Scopes:
    """Chains under loads, the smallest first, with what to call them; all velocities are of rods."""
    for name, m, units in _CHAINS:
        scope = kind(driven(name, m), units, **known)
        scope.letters |= {r"\barv": scope.velocity, "t": partial(_arrives, scope)}
        yield {"example": name, "m": m, "c_f": units.c_f, "l": units.l}, scope


def _arrives(scope: Moving, zero: int, rod: int) -> Any:
    """t_(0,i); the instants t_k are those of (3.2) alone."""
    return scope.value(read_formula(rf"\tau_{{{zero},{rod}}}")) * scope.units.l / scope.units.c_f


def _rods(reading: Reading, scope: Moving, at: Mapping[str, object]) -> Case:
    """Whether every rod is named once."""
    return covers(at, "rods", [range_of("i", reading.ranges)], scope, range(1, scope.chain.m + 1))


def inside(entry: PaperEntry) -> Test:
    """Equations that are said to hold inside the rods, from the start on or at the start."""
    return Test("the exact motion of chains under loads, inside every rod; c_f and l are varied", _inside_cases)


def _inside_cases(reading: Reading) -> Iterator[Case]:
    where = next((r for r in reading.ranges if isinstance(r, Relation)), None)
    if where is None:
        raise MeaninglessError("x has no range")
    for at, scope in _scopes():
        yield _rods(reading, scope, at)
        rods = span(range_of("i", reading.ranges), scope)
        for rod, sixth in product(rods, range(6 * scope.chain.m + 1)):
            x = fmpq(sixth, 6)
            scope.bound |= {"i": rod, **scope.at(x, _INSTANTS[sixth % 2])}
            here = {**at, "i": rod, "x": scope.bound["x"], "t": scope.bound["t"]}
            said = holds(where, scope)
            yield Case({**here, "within": latex(where)}, said, rod - 1 < x < rod, telling=False)
            if said and sixth % 6 in (1, 4):
                for number, equation in enumerate(items(reading.formula), 1):
                    value = f"left less right side, equation {number}"
                    yield case(
                        {**here, "value": value}, partial(_less, scope, equation), 0, "U" in latex(equation), _front
                    )


def _less(scope: Moving, equation: Tree) -> Any:
    left, right = sides(equation)
    return Jet.of(scope.value(left) - scope.value(right)).value


def _shown(name: str, m: int, until: int, places: list[str], look: str) -> Reproduction:
    """A chain at rest that its first moment moves, or bodies that meet; and what is seen there."""
    step = {"M1": (LoadStep(fmpq(0), fmpq(1)),)} if name == "II" else {}
    return example(driven(name, m).exact, step, until, {"velocity": places}, "wavesym run SCENE --samples 9", look)()


_FRONT = "velocity@1 stays 0 until tau = 1: a front crosses a rod in t = l / c_f, its speed is c_f"
_front = partial(_shown, "II", 1, 2, ["1"], _FRONT)
_CLOCKS = "velocity@3/2 changes from tau = 1/2 on, velocity@1/2 from tau = 3/2: every rod has a t_0 of its own"
_clocks = partial(_shown, "I", 4, 2, ["1/2", "3/2"], _CLOCKS)


def solution(entry: PaperEntry) -> Test:
    """A displacement in f and g, (2.5) or (4.2)."""
    return Test(_NODES, lambda reading: _solution_cases(reading, reading.formula, _scopes(), _clocks))


def _solution_cases(
    reading: Reading, formula: Tree, scopes: Scopes, shown: Callable[[], Reproduction] | None = None
) -> Iterator[Case]:
    """A displacement in the laws of all nodes; `reading` has the range of its rods."""
    for at, scope in scopes:
        whole = _rods(reading, scope, at)
        yield whole
        if not whole.agrees:
            return
        for tau, x in product(_INSTANTS, range(scope.chain.m + 1)):
            here = {**at, "t": scope.at(0, tau)["t"], "node": x, "value": "step of velocity, force left over"}
            yield case(here, partial(_left_over, scope, formula, x, tau), (0, 0), example=shown)


def _left_over(scope: Moving, formula: Tree, x: int, tau: fmpq) -> tuple[Any, Any]:
    """What the printed displacements leave of the law of a node: a step of velocity, and a force."""
    step, force = scope.law(x, tau, partial(_printed, scope, formula))
    for load in scope.chain.nodes[x].loads:
        for power, coefficient in enumerate(load.coefficients):
            force = force - coefficient * scope.motion.load(load.source, tau, power)
    return step, force


def _printed(scope: Moving, formula: Tree, rod: int, x: Jet, tau: Jet) -> Jet:
    """The displacement of a rod as printed, in units of U_0."""
    left, right = sides(formula)
    with scope.binding({**scope.bound, "i": rod, **scope.at(x, tau)}):
        match left:
            case Call(Symbol("U", accent, 0, (index,)), (place, time)) if scope.whole(index) == rod:
                if (latex(place), latex(time)) == ((r"\bar{x}", r"\tau") if accent else ("x", "t")):
                    moved: Jet = Jet.of(scope.value(right)) / scope.unit(left.function)
                    return moved
    raise MeaninglessError(f"{latex(left)} is not the displacement of rod {rod}")


def definition(entry: PaperEntry) -> Test:
    """A quantity without dimensions: put into (4.2), which no other of its name then has a place in."""

    def cases(reading: Reading) -> Iterator[Case]:
        letter, means = sides(reading.formula)
        defining = _scopes(partial(_Defining, letter, means), constants=given(reading.ranges))
        return _solution_cases(reading, read_formula(entry_of("(4.2)").printed), defining)

    def unbarred(reading: Reading) -> Iterator[Case]:
        letter, means = sides(reading.formula)
        plain = replace(letter, accent="") if isinstance(letter, Symbol) else letter
        return cases(Reading(Relation((plain, means), ("=",)), reading.ranges))

    return Test(f"(4.2) with it: {_NODES}", cases, conventions={"a letter means the same with a bar": unbarred})


class _Defining(Moving):
    """(4.2) where one letter is what its definition makes of the motion in physical units."""

    def __init__(
        self, letter: Tree, means: Tree, motion: DrivenChain, units: Units, constants: Mapping[Tree, Tree]
    ) -> None:
        super().__init__(motion, units, constants)
        if not isinstance(letter, Symbol):
            raise MeaninglessError(f"{latex(letter)} is no letter to define")
        self.letter, self.means = letter, means

    def at(self, x: Any, tau: Any) -> Mapping[str, Any]:
        return {name: value for name, value in super().at(x, tau).items() if name != latex(self.letter)}

    def meaning(self, known: Mapping[str, Callable[..., Any]], symbol: Symbol, *arguments: Any) -> Any:
        if self._is_defined(symbol):
            return self._defined(dict(zip("z", arguments, strict=False)))
        return super().meaning(known, symbol, *arguments)

    def unit(self, displacement: Symbol) -> Any:
        if not self._is_defined(displacement):
            return super().unit(displacement)
        U_0 = self.units.U_0
        return self._defined({}, {"U": {0: U_0, self.bound["i"]: U_0}.__getitem__})

    def _is_defined(self, symbol: Symbol) -> bool:
        """Whether it is the letter; MeaninglessError where it is one of its name that stays undefined."""
        if symbol.name == self.letter.name and len(symbol.below) == len(self.letter.below) and symbol != self.letter:
            raise MeaninglessError(f"(4.2) has {latex(symbol)}, and {latex(self.letter)} is defined")
        return symbol == self.letter

    def _defined(self, bound: Mapping[str, Any], letters: Mapping[str, Callable[..., Any]] | None = None) -> Any:
        """What the letter is by its definition."""
        physical = Moving(self.motion, self.units, self.constants)
        physical.bound = {**self.bound, **bound}
        physical.letters |= {r"\barv": self.velocity, **(letters or {})}
        return physical.value(self.means)


# loads


def moments(entry: PaperEntry) -> Test:
    """(3.1)."""
    return Test(_ACTING, _moment_cases)


def base(entry: PaperEntry) -> Test:
    """(3.2)."""
    return Test(_ACTING, lambda reading: _load_cases(reading, Moving(driven("III", 2)), {"m": 2}, "a"))


_ACTING = "what acts on the body by its exact motion, under loads with several pieces, just after any jump"


def _moment_cases(reading: Reading) -> Iterator[Case]:
    bodies = range_of("i", reading.ranges)
    for m in (1, 2, 3):
        scope = Moving(driven("II", m))
        whole = covers({"m": m}, "bodies", [bodies], scope, range(1, m + 2))
        yield whole
        for body in span(bodies, scope) if whole.agrees else ():
            scope.bound["i"] = body
            yield from _load_cases(reading, scope, {"m": m, "i": body}, f"M{body}")


def _load_cases(reading: Reading, scope: Moving, at: Mapping[str, object], source: str) -> Iterator[Case]:
    """It is called what the left side says, and is the right one."""
    left, right = sides(reading.formula)
    for half in range(6):
        scope.bound["t"] = t = fmpq(half, 2)
        true = _load(scope, source, t)
        yield case({**at, "t": t, "side": latex(left)}, partial(scope.value, left), true, telling=False)
        yield case({**at, "t": t}, partial(scope.value, right), true)


def _load(scope: Moving, source: str, t: fmpq) -> Any:
    """What acts at the node of a source, in what its unit gives at first."""
    x, unit = scope.chain.loaded[source]
    return scope.acting(x, t) / unit.coefficients[0]


def bodies(entry: PaperEntry) -> Test:
    """The loads S_i of Table 1, of the body at the left end of rod i: (4.4) counts bodies so."""

    def cases(reading: Reading) -> Iterator[Case]:
        named = reading.ranges[0] if reading.ranges else _RODS
        for m in {"I": (4, 6), "II": (1, 2, 3), "III": (2, 3)}[entry.about["row"]]:
            scope = Moving(driven(entry.about["row"], m))
            rigid = {x + 1: bool(node.loads) for x, node in enumerate(scope.chain.nodes) if node.inertia}
            for i in span(named, scope):
                t = fmpq(i, 2)
                scope.bound |= {"i": i, "t": t}
                true = _load(scope, f"M{i}", t) if rigid.get(i) else scope.acting(i - 1, t) if i in rigid else 0
                yield case({"m": m, "i": i, "t": t}, partial(scope.value, reading.formula), true)
            wanted = {*range(1, m + 1), *(body for body, loaded in rigid.items() if loaded)}
            look = f"velocity@{m} is not 0: M_{m + 1} moves the drive, and no cell has it for i = 1, ..., {m}"
            moment = {f"M{m + 1}": (LoadStep(fmpq(0), fmpq(1)),)}
            shown = example(
                driven("II", m).exact, moment, 3, {"velocity": [str(m)]}, "wavesym run SCENE --samples 7", look
            )
            yield covers({"m": m}, "rods and loaded bodies", [named], scope, wanted, telling=True, example=shown)

    def counted_as_in_3_1(reading: Reading) -> Iterator[Case]:
        return cases(Reading(reading.formula, (range_of("i", settled("(3.1)").ranges),)))

    return Test(
        "what acts on the rigid bodies by the exact motion",
        cases,
        conventions={"i is the number of a body, as in (3.1)": counted_as_in_3_1},
    )
