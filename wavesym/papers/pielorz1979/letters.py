"""What the letters of sections 2 to 4 mean on a chain that moves under loads, in exact numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from flint import fmpq
from sympy.tensor.indexed import IndexException

from wavesym.mechanics.chain import Chain
from wavesym.papers.evaluation import MeaninglessError, Scope
from wavesym.papers.jets import Jet
from wavesym.papers.pielorz1979.truth import DrivenChain
from wavesym.papers.record import shown
from wavesym.papers.tree import Call, Derivative, Symbol, Tree, latex

Displaced = Callable[[int, Jet, Jet], Jet]
"""The displacement of a rod at a place and an instant, without dimensions."""

_C_F = Symbol("c", below=(Symbol("f"),))
_ANY_V_0 = fmpq(7, 5)


def letter(symbol: Symbol) -> str:
    """A letter with its marks, but without its indices."""
    return symbol.accent + symbol.name + "'" * symbol.primes


class IndexedLetters(Scope):
    """Letters as functions of their indices, functions as those of their indices and arguments; each by `letter`."""

    def __init__(self, bound: Mapping[str, Any], constants: Mapping[Tree, Tree] | None = None) -> None:
        super().__init__(bound, constants)
        self.letters: dict[str, Callable[..., Any]] = {}
        self.functions: dict[str, Callable[..., Any]] = {}

    def symbol(self, symbol: Symbol) -> Any:
        return self.meaning(self.letters, symbol)

    def call(self, call: Call) -> Any:
        return self.meaning(self.functions, call.function, *map(self.value, call.arguments))

    def meaning(self, known: Mapping[str, Callable[..., Any]], symbol: Symbol, *arguments: Any) -> Any:
        """What a letter or function is there; MeaninglessError where it is not known, or has not these indices."""
        if (means := known.get(letter(symbol))) is None or symbol.above:
            raise MeaninglessError(f"{latex(symbol)} is not defined")
        index = self.indices(symbol)
        try:
            return means(*index, *arguments)
        except (LookupError, TypeError, IndexException):
            told = f"with indices {shown(index)}" if index else "without an index"
            raise MeaninglessError(f"{latex(symbol)} is not defined {told}") from None


@dataclass(frozen=True)
class Units:
    """The speed of sound, the length of a rod, the unit of displacement."""

    c_f: fmpq
    l: fmpq  # noqa: E741 - the paper's letter
    U_0: fmpq


_ONES = Units(fmpq(1), fmpq(1), fmpq(1))


def unit_of_moment(chain: Chain, body: int) -> fmpq:
    """What a unit of moment does to a body of a drive, along positive rotation, by its node. KeyError without one."""
    _, unit = chain.loaded[f"M{body}"]
    (value,) = unit.coefficients
    return -fmpq(value) if body == len(chain.nodes) else fmpq(value)


class Moving(IndexedLetters):
    """The letters on the motion of a chain; `seen` tells whether anything moved where it was looked at.

    A velocity with a bar is that of a body. `most` is the highest derivative that is asked for.
    """

    def __init__(self, motion: DrivenChain, units: Units = _ONES, constants: Mapping[Tree, Tree] | None = None) -> None:
        self.units = units
        super().__init__({"m": motion.exact.m, "l": units.l}, constants)
        self.motion, self.chain, self.seen, self.most = motion, motion.exact.chain, False, 2
        parameters, late = self.chain.parameters, units.l / units.c_f
        self.letters = {
            r"\kappa": parameters.kappa.__getitem__,
            "J": (parameters.inertia or {}).__getitem__,
            r"\barA": lambda i: unit_of_moment(self.chain, i),
            r"\barv": (parameters.velocity or {}).__getitem__,
            "v": lambda i: self.velocity(i) * units.U_0 / late if i else _ANY_V_0,
            "m": lambda i: len(motion.loads[self._source(i)]) - 1,
            r"\tau": self._start,
            "t": lambda *index: self._start(*index) * late,
            r"\barx": lambda *index: self._first(*index).x0 if index else self.bound[r"\bar{x}"],
            "x": lambda *index: self._first(*index).x0 * units.l,
            "U": {0: units.U_0}.__getitem__,
            r"\ddoty": self._ground,
            **dict.fromkeys(("M", r"\barM"), lambda i, k: self._weight(f"M{i}", k)),
        }
        self.functions = {
            **dict.fromkeys(("M", r"\barM"), lambda i, t: motion.load(self._source(i), t)),
            "U": self._displaced,
            r"\barU": lambda i, x, tau: self.displacement(i, Jet.of(x), Jet.of(tau)),
        }
        for source in "ab":
            self.letters |= dict.fromkeys((source, rf"\bar{source}"), partial(self._weight, source))
        for wave in "fg":
            physical = rf"\mathcal{wave.upper()}"
            self.letters[physical] = partial(self._in_physical_units, wave)
            self.functions |= {wave: partial(self._along, wave), physical: partial(self._in_physical_units, wave)}
            self.functions |= {wave + "'" * order: partial(self.wave, wave, order) for order in (1, 2, 3)}

    def symbol(self, symbol: Symbol) -> Any:
        return self.units.c_f if symbol == _C_F else super().symbol(symbol)

    def derivative(self, derivative: Derivative) -> Any:
        by = latex(derivative.by)
        if by not in self.bound or derivative.order > 2:
            raise MeaninglessError(f"{latex(derivative)} is not defined")
        self.most = derivative.order
        try:
            with self.binding({by: Jet(self.bound[by], 1)}):
                found = Jet.of(self.value(derivative.of))
        finally:
            self.most = 2
        return found.first if derivative.order == 1 else found.second

    def at(self, x: Any, tau: Any) -> Mapping[str, Any]:
        """A place and an instant, in both units."""
        units = self.units
        return {"x": x * units.l, "t": tau * (units.l / units.c_f), r"\bar{x}": x, r"\tau": tau}

    def wave(self, name: str, order: int, rod: int, z: Any) -> Any:
        """f or g, or a derivative; MeaninglessError."""
        value = self.motion.wave(name, rod, z, order)
        self.seen = self.seen or (order > 0 and value != 0)
        return value

    def _along(self, name: str, rod: int, z: Any) -> Jet:
        at = Jet.of(z)
        return at.of_function(lambda order: self.wave(name, order, rod, at.value), self.most)

    def _in_physical_units(self, name: str, rod: int, z: Any = None) -> Jet:
        """F or G; where no argument is printed, of z."""
        return self._along(name, rod, self.bound["z"] if z is None else Jet.of(z) / self.units.l) * self.units.U_0

    def displacement(self, rod: int, x: Jet, tau: Jet) -> Jet:
        """The motion of a rod, without dimensions; MeaninglessError outside the rod and before the start."""
        if not rod - 1 <= x.value <= rod or not 1 <= rod <= self.chain.m:
            raise MeaninglessError(f"rod {rod} does not reach to {x.value} l")
        if tau.value < 0:
            raise MeaninglessError("the motion begins at t = 0")
        numbers = (fmpq(n) for at in (x, tau) for n in (at.value, at.first, at.second))
        key = ("displacement", rod, self.most, *((int(n.p), int(n.q)) for n in numbers))
        if key not in self.motion.known:
            clock = self.chain.rod(rod)
            f = self._along("f", rod, tau - x + (clock.x0 - clock.tau0))
            g = self._along("g", rod, tau + x - (clock.x0 + clock.tau0))
            changes = any(part != 0 for part in (f.first, f.second, g.first, g.second))
            self.motion.known[key] = f + g + tau * clock.velocity, changes
        moved: Jet
        moved, changes = self.motion.known[key]
        self.seen = self.seen or changes
        return moved

    def _displaced(self, *at: Any) -> Jet:
        """In physical units; without a number, of the rod that is there."""
        *rod, x, t = at
        place, tau = Jet.of(x) / self.units.l, Jet.of(t) * (self.units.c_f / self.units.l)
        number = rod[0] if rod else -int((-place.value).floor())
        return self.displacement(number, place, tau) * self.units.U_0

    def unit(self, displacement: Symbol) -> Any:
        """In which a displacement is counted that is called so."""
        return 1 if displacement.accent else self.units.U_0

    def velocity(self, rod: int) -> fmpq:
        """How fast the body is at the start that a rod is fixed to; MeaninglessError."""
        self._first(0, rod)
        return body_velocity(self.chain, rod)

    def law(self, x: int, tau: fmpq, displaced: Displaced) -> tuple[Any, Any]:
        """What displacements mean for a node: a step of velocity, and what has to act there."""
        node, place, time = self.chain.nodes[x], Jet(fmpq(x), 1), Jet(tau, 1)
        moving = [displaced(rod, Jet(fmpq(x)), time) for rod in rods_at(self.chain, x)]
        force = node.inertia * moving[0].second + node.damping * moving[0].first
        if node.left:
            force = force + node.alpha / 2 * displaced(x, place, Jet(tau)).first
        if node.right:
            force = force - node.beta / 2 * displaced(x + 1, place, Jet(tau)).first
        return moving[-1].first - moving[0].first, force

    def acting(self, x: int, tau: fmpq) -> Any:
        """What acts on a node, by the exact motion."""
        return self.law(x, tau, self.displacement)[1]

    def _source(self, number: int) -> str:
        """Of a drive its moment with a number; a building has load number 1 alone. LookupError."""
        name = "a" if number == 1 and "a" in self.motion.loads else f"M{number}"
        if name not in self.motion.loads:
            raise LookupError(name)
        return name

    def _ground(self, zero: int) -> Any:
        """The acceleration of the ground, y_0 with two dots. LookupError."""
        if zero != 0:
            raise LookupError(zero)
        return self.motion.load("a", self.bound["t"]) + self.motion.load("b", self.bound["t"], 1)

    def _weight(self, source: str, k: int) -> fmpq:
        return self.motion.piece(source, k).weight

    def _start(self, *index: int) -> fmpq:
        """tau_(s,k) and tau_k of a piece of a load, tau_(0,i) of a rod."""
        *number, k = index
        if number == [0]:
            return fmpq(self._first(0, k).tau0)
        source = f"M{number[0]}" if number else "a"
        if source not in self.motion.loads:
            raise LookupError(source)
        return self.motion.piece(source, k).time

    def _first(self, zero: int, rod: int) -> Any:
        """Where and when the first disturbance reaches a rod."""
        if zero != 0 or not 1 <= rod <= self.chain.m:
            raise MeaninglessError(f"there is no rod {rod}")
        return self.chain.rod(rod)


def rods_at(chain: Chain, x: int) -> tuple[int, ...]:
    """The numbers of the rods at a node."""
    return tuple(rod for rod in (x, x + 1) if 1 <= rod <= chain.m)


def body_velocity(chain: Chain, rod: int) -> fmpq:
    """How fast the body is at the start that a rod is fixed to."""
    given = chain.parameters.velocity or {}
    return next((fmpq(given[x]) for x in (rod - 1, rod) if x in given), fmpq(0))
