"""What the letters of the paper mean on a chain that moves under loads, in exact numbers.

Physical quantities and those without dimensions are of one motion, in units that a chain is given.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from flint import fmpq

from wavesym.mechanics.chain import Chain
from wavesym.papers.evaluation import MeaninglessError, Scope
from wavesym.papers.exact_numbers import Jet
from wavesym.papers.pielorz1979.chains import LoadedChain
from wavesym.papers.tree import Derivative, Number, Symbol, Tree, latex
from wavesym.systems.building import BUILDING_FORCE, BUILDING_GROUND
from wavesym.systems.drive import DRIVE

Displacement = Callable[[int, Jet, Jet], Jet]
"""The displacement of a rod at a place and an instant, without dimensions."""

DISPLACEMENTS = {"I": r"\baru", "II": r"\bar\theta", "III": r"\bary"}
"""The U of (2.1) without dimension, Table 1."""
_C_F = Symbol("c", subscript=(Symbol("f"),))
_S_0 = Symbol("S", subscript=(Number("0"),))
_X_I = Symbol("x", subscript=(Symbol("i"),))
_ANY_V_0 = fmpq(7, 5)


@dataclass(frozen=True)
class Units:
    """What a chain has beside its numbers without dimensions.

    The speed of sound, the length of a rod, the unit of displacement, and the unit of moment where it is not that of
    the chain, G J_01 U_0 / l.
    """

    c_f: fmpq
    l: fmpq  # noqa: E741 - the paper's letter
    U_0: fmpq
    S_0: fmpq | None = None


ONES = Units(fmpq(1), fmpq(1), fmpq(1))
_DENSITY = fmpq(11, 6)


_PLAIN: Mapping[str, Mapping[str, fmpq]] = {
    "I": {"F": fmpq(3, 8)},
    "II": {},
    "III": {"k'": fmpq(5, 6), "n": fmpq(4), "A": fmpq(2, 9)},
}
"""What the text gives an example's rods beside density and modulus: sections, columns of a storey, shear."""


class Material:
    """The inertias and stiffnesses of a chain in some units: those with which its nodes have their laws.

    A node's inertia U_tt = beta/2 dU_right/dx - alpha/2 dU_left/dx, in tau and x / l, is that of a body of inertia M
    between rods of stiffness K where M c_f^2 / l^2 = 2 K / (l beta) times the node's inertia.
    """

    def __init__(self, chain: Chain, units: Units) -> None:
        self.chain, self.units = chain, units
        self.example = {DRIVE: "II", BUILDING_FORCE: "III", BUILDING_GROUND: "III"}.get(chain.system, "I")
        self._areas: Mapping[int, Any] = (chain.parameters.inertia or {}) if self.example == "I" else {}
        modulus = _DENSITY * units.c_f**2
        self.plain = {**_PLAIN[self.example], r"\rho": _DENSITY}
        self.plain |= {"I": {"E": modulus, "a": units.c_f}}.get(self.example, {"C": units.c_f})
        if self.example != "I":
            self.plain["G"] = modulus / self.plain.get("k'", fmpq(1))

    def stiffness(self, rod: int) -> fmpq:
        """The force in a rod, or moment, for a unit of strain. LookupError."""
        _check_index(1 <= rod <= self.chain.m)
        if self.example == "II":
            node = self.chain.nodes[rod - 1]
            return self.inertia(rod) * self._per_stiffness(node.beta)
        area = self.plain["F"] * self._areas.get(rod, 1) if self.example == "I" else self.plain["n"] * self.plain["A"]
        return area * _DENSITY * self.units.c_f**2

    def inertia(self, body: int) -> fmpq:
        """The mass of a body, or its moment of inertia, by its number. LookupError."""
        if self.example == "II":
            return fmpq(self.chain.parameters.inertia[body]) * fmpq(3, 7)
        _check_index(0 <= body <= self.chain.m)
        node = self.chain.nodes[body]
        # the inertia of a foundation is in its load
        own = node.inertia or next((-load.coefficients[0] for load in node.loads if load.kind == "a"), fmpq(0))
        _check_index(own != 0)
        rod, coupling = (body + 1, node.beta) if node.right else (body, node.alpha)
        return fmpq(own) * self.stiffness(rod) / self._per_stiffness(coupling)

    def _per_stiffness(self, coupling: fmpq) -> fmpq:
        """K / M of a rod that a node of inertia 1 has with this alpha or beta."""
        return fmpq(coupling) / 2 * self.units.c_f**2 / self.units.l

    @property
    def moment(self) -> fmpq:
        """The unit of moment of a drive, G J_01 U_0 / l."""
        return self.stiffness(1) * self.units.U_0 / self.units.l


def _check_index(known: bool) -> None:
    if not known:
        raise LookupError


def unit_of_moment(chain: Chain, body: int) -> fmpq:
    """What a unit of moment does to a body of a drive, along positive rotation, by its node. KeyError without one."""
    _, unit = chain.unit_loads[f"M{body}"]
    (value,) = unit.coefficients
    return -fmpq(value) if body == len(chain.nodes) else fmpq(value)


class Motion(Scope):
    """The letters on the motion of a chain; `seen` tells whether anything moved where it was looked at.

    `constants` are those that ranges say the value of; `velocities` whether a v is that of a "body" or of a "rod".
    """

    def __init__(
        self,
        motion: LoadedChain,
        units: Units | None = None,
        constants: Mapping[Tree, Tree] | None = None,
        velocities: str = "body",
    ) -> None:
        self.units = units = units or ONES
        self.motion, self.chain, self.is_seen, self._most = motion, motion.exact.chain, False, 2
        self.material = material = Material(self.chain, units)
        super().__init__({"m": motion.exact.m, "l": units.l, **material.plain}, constants)
        parameters, late = self.chain.parameters, units.l / units.c_f
        bodies = (parameters.velocity or {}).__getitem__
        self.letters = {
            r"\kappa": parameters.kappa.__getitem__,
            r"\gamma": motion.exact.rates.__getitem__,
            "J": self._inertia_or_section,
            "A": material.stiffness,
            "B": lambda number: material.inertia(self.own_number(number)),
            r"\barA": lambda i: unit_of_moment(self.chain, i) * self.value(_S_0) / material.moment,
            r"\barv": bodies if velocities == "body" else self.velocity,
            "v": lambda i: self.velocity(i) * units.U_0 / late if i else _ANY_V_0,
            "m": lambda i: len(motion.loads[self._source(i)]) - 1,
            r"\tau": self.start,
            "t": lambda *index: self.start(*index) * late,
            r"\barx": lambda *index: self.first(*index).x0 if index else self.variables[r"\bar{x}"],
            "x": lambda *index: self.first(*index).x0 * units.l,
            "S": {0: material.moment if units.S_0 is None and self.is_drive else units.S_0}.__getitem__,
            "U": lambda i: self._physical_displacement(i, self.variables["x"], self.variables["t"]) if i else units.U_0,
            r"\barU": lambda i: self._plain_displacement(i, self.variables[r"\bar{x}"], self.variables[r"\tau"]),
            r"\ddoty": self._ground,
            r"\barM": lambda i, k: self._weight(f"M{i}", k),
        }
        self.functions = {
            **dict.fromkeys((r"\barM", r"\barS"), self._applied_load),
            "S": lambda i, t: self._applied_load(self.own_number(i), t / late) * self.unit_of_load,
            "U": self._physical_displacement,
            **dict.fromkeys((r"\barU", DISPLACEMENTS[material.example]), self._plain_displacement),
        }
        if self.is_drive:
            self.letters["M"] = lambda i, k: self._weight(f"M{i}", k) * material.moment
            self.functions["M"] = lambda i, t: self.load(i - 1, t / late) * material.moment
        else:
            self.letters["M"] = material.inertia
        if "k'" in material.plain:
            self.letters["k'"] = lambda: material.plain["k'"]
        for source in "ab":
            self.letters |= dict.fromkeys((source, rf"\bar{source}"), partial(self._weight, source))
        for wave in "fg":
            physical = rf"\mathcal{wave.upper()}"
            self.letters[physical] = partial(self._in_physical_units, wave)
            self.letters[wave] = lambda rod, wave=wave: self._wave_jet(wave, rod, self.variables["z"])
            self.functions |= {wave: partial(self._wave_jet, wave), physical: partial(self._in_physical_units, wave)}
            self.functions |= {wave + "'" * order: partial(self.wave, wave, order) for order in (1, 2, 3)}

    @property
    def is_drive(self) -> bool:
        """Whether the chain is one of example II."""
        return self.chain.system is DRIVE

    def symbol(self, symbol: Symbol) -> Any:
        return self.units.c_f if symbol == _C_F else super().symbol(symbol)

    def derivative(self, derivative: Derivative) -> Any:
        by = latex(derivative.variable)
        if by not in self.variables or derivative.order > 2:
            raise MeaninglessError(f"{latex(derivative)} is not defined")
        self._most = derivative.order
        try:
            with self.bind({by: Jet(self.variables[by], 1)}):
                found = Jet.from_number(self.value(derivative.function))
        finally:
            self._most = 2
        return found.first if derivative.order == 1 else found.second

    def coordinates(self, x: Any, tau: Any) -> Mapping[str, Any]:
        """A place and an instant, in both units."""
        units = self.units
        return {"x": x * units.l, "t": tau * (units.l / units.c_f), r"\bar{x}": x, r"\tau": tau}

    def wave(self, name: str, order: int, rod: int, z: Any) -> Any:
        """f or g, or a derivative; MeaninglessError."""
        value = self.motion.wave(name, rod, z, order)
        self.is_seen = self.is_seen or (order > 0 and value != 0)
        return value

    def _wave_jet(self, name: str, rod: int, z: Any) -> Jet:
        at = Jet.from_number(z)
        return at.apply(lambda order: self.wave(name, order, rod, at.value), self._most)

    def _in_physical_units(self, name: str, rod: int, z: Any = None) -> Jet:
        """F or G; where no argument is printed, of z."""
        return (
            self._wave_jet(name, rod, self.variables["z"] if z is None else Jet.from_number(z) / self.units.l)
            * self.units.U_0
        )

    def displacement(self, rod: int, x: Jet, tau: Jet) -> Jet:
        """The motion of a rod, without dimensions; MeaninglessError outside the rod and before the start."""
        if not rod - 1 <= x.value <= rod or not 1 <= rod <= self.chain.m:
            raise MeaninglessError(f"rod {rod} does not reach to {x.value} l")
        if tau.value < 0:
            raise MeaninglessError("the motion begins at t = 0")
        numbers = (fmpq(n) for at in (x, tau) for n in (at.value, at.first, at.second))
        key = ("displacement", rod, self._most, *((int(n.p), int(n.q)) for n in numbers))
        if key not in self.motion.memory:
            clock = self.chain.rod(rod)
            f = self._wave_jet("f", rod, tau - x + (clock.x0 - clock.tau0))
            g = self._wave_jet("g", rod, tau + x - (clock.x0 + clock.tau0))
            changes = any(part != 0 for part in (f.first, f.second, g.first, g.second))
            self.motion.memory[key] = f + g + tau * clock.velocity, changes
        moved: Jet
        moved, changes = self.motion.memory[key]
        self.is_seen = self.is_seen or changes
        return moved

    def _plain_displacement(self, rod: int, x: Any, tau: Any) -> Jet:
        return self.displacement(rod, Jet.from_number(x), Jet.from_number(tau))

    def _physical_displacement(self, *at: Any) -> Jet:
        """In physical units; without a number, of the rod that is there."""
        *rod, x, t = at
        place, tau = Jet.from_number(x) / self.units.l, Jet.from_number(t) * (self.units.c_f / self.units.l)
        number = rod[0] if rod else -int((-place.value).floor())
        return self.displacement(number, place, tau) * self.units.U_0

    def velocity(self, rod: int) -> fmpq:
        """How fast the body is at the start that a rod is fixed to; MeaninglessError."""
        self.first(0, rod)
        return body_velocity(self.chain, rod)

    def law(self, x: int, tau: fmpq, displacement: Displacement) -> tuple[Any, Any]:
        """What displacements mean for a node: a step of velocity, and what has to act there."""
        node, place, time = self.chain.nodes[x], Jet(fmpq(x), 1), Jet(tau, 1)
        moving = [displacement(rod, Jet(fmpq(x)), time) for rod in rods_at(self.chain, x)]
        force = node.inertia * moving[0].second + node.damping * moving[0].first
        if node.left:
            force = force + node.alpha / 2 * displacement(x, place, Jet(tau)).first
        if node.right:
            force = force - node.beta / 2 * displacement(x + 1, place, Jet(tau)).first
        return moving[-1].first - moving[0].first, force

    def load(self, x: int, tau: fmpq) -> Any:
        """What acts on a node by the exact motion, in what the unit of its load gives at first. LookupError."""
        _check_index(0 <= x <= self.chain.m and bool(self.chain.nodes[x].loads))
        _, force = self.law(x, tau, self.displacement)
        return force / self.chain.nodes[x].loads[0].coefficients[0]

    def _applied_load(self, body: int, tau: Any) -> Any:
        """The load that is put on a body, without dimension; 0 where there is none. LookupError."""
        x = body - 1 if self.is_drive else body
        _check_index(0 <= x <= self.chain.m and bool(self.chain.nodes[x].inertia or self.chain.nodes[x].loads))
        return self.motion.load(f"M{body}", tau)

    @property
    def unit_of_load(self) -> fmpq:
        """The unit of moment of a drive; the other examples have no loads of bodies."""
        return self.material.moment if self.is_drive else fmpq(1)

    def own_number(self, number: Any) -> Any:
        """The number in its example of a body of (2.4), which may number bodies by their places: x_i."""
        place = self.constants.get(_X_I)
        if place is None:
            return number
        with self.bind({"i": number}):
            x = self.value(place) / self.units.l
        if x.denom() != 1:
            raise MeaninglessError(f"no body stands at {x} l")
        return int(x) + (1 if self.is_drive else 0)

    def _inertia_or_section(self, *index: int) -> fmpq:
        """J_i of a body, J_(0,i) of a shaft. LookupError."""
        if len(index) == 1:
            return self.material.inertia(*index) if self.is_drive else self.chain.parameters.inertia[index[0]]
        zero, rod = index
        _check_index(zero == 0 and self.is_drive)
        return self.material.stiffness(rod) / self.material.plain["G"]

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
        return self.load(0, self.variables["t"])

    def _weight(self, source: str, k: int) -> fmpq:
        return self.motion.piece(source, k).weight

    def start(self, *index: int) -> fmpq:
        """tau_(s,k) and tau_k of a piece of a load, tau_(0,i) of a rod."""
        *number, k = index
        if number == [0]:
            return fmpq(self.first(0, k).tau0)
        if (f"M{number[0]}" if number else "a") not in self.motion.loads:
            raise LookupError(number)
        return self.motion.start_time(*index)

    def first(self, zero: int, rod: int) -> Any:
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
