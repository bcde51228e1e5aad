"""What the letters of conditions mean at a node: strain, velocity and acceleration there, moments, A, B, S of (2.4)."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any

from flint import fmpq
from sympy import Expr, expand, latex
from sympy import Symbol as Letter

from wavesym.model.node import Parameters
from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.pielorz1979.letters import Letters, Numbers, Symbols
from wavesym.papers.pielorz1979.truth import Driven
from wavesym.papers.tree import Call, Derivative, Progression, Symbol

DISPLACEMENTS = {"I": r"\baru", "II": r"\bar\theta", "III": r"\bary"}
"""The U of (2.1) without dimension, Table 1."""
COORDINATES = {"x": "x", r"\barx": "x", "t": "t", r"\tau": "t"}
LENGTH = fmpq(7)
"""The l of section 2: x = i is no place, x = il is."""


class AtNode(Letters):
    """Derivatives at a place; A, B and S of (2.4); moments along positive rotation. `name` is the example's."""

    name: str
    numbering: Progression | None
    _by: tuple[str, int] | None = None

    def derivative(self, derivative: Derivative) -> Any:
        by = COORDINATES.get(letter(derivative.by))
        if by is None or derivative.by.below or (by == "x" and derivative.order > 1):
            return super().derivative(derivative)
        self._by = by, derivative.order
        try:
            return self.value(derivative.of)
        finally:
            self._by = None

    def symbol(self, symbol: Symbol) -> Any:
        match letter(symbol), self.indices(symbol):
            case displaced, (rod,) if displaced in ("U", DISPLACEMENTS[self.name]) and self._by:
                return self.slope(rod, *self._by)
            case "A", (rod,) if self.name == "II":  # in units in which the B_i of (2.4) is J_i
                return self.parameter("kappa", rod) * self.parameter("inertia", rod)
            case "A", (rod,):
                return self.parameter("inertia", rod) if self.name == "I" else 1
            case "B", (number,):
                body = self._own(number)
                return self.parameter("inertia", body) if self.name == "II" else 1 / self.parameter("kappa", body)
        return super().symbol(symbol)

    def call(self, call: Call) -> Any:
        name, index = letter(call.function), self.indices(call.function)
        variables = [COORDINATES.get(letter(a)) for a in call.arguments if isinstance(a, Symbol) and not a.below]
        if name == DISPLACEMENTS[self.name] and variables == ["x", "t"] and len(call.arguments) == 2:
            return self.symbol(call.function)
        if name == r"\barM" and variables == ["t"]:
            return self.moment(index)
        if name == "S" and variables == ["t"] and len(index) == 1:
            if self.name != "II":  # Table 1
                return 0
            unit = self.parameter("kappa", 1) * self.parameter("inertia", 1)
            return unit * self.moment((self._own(index[0]),))
        return super().call(call)

    def _own(self, number: Any) -> Any:
        """A body's number in its example; the condition may number bodies by their places."""
        if self.numbering is None:
            return number
        with self.binding({"i": number}):
            place = self.value(self.numbering.shown[0]) / self.bound["l"]
        return place + (1 if self.name == "II" else 0)

    def slope(self, rod: Any, by: str, order: int) -> Any:
        """A derivative of a rod's displacement; MeaninglessError."""
        raise MeaninglessError("velocities are no part of a balance")

    @abstractmethod
    def moment(self, index: tuple[Any, ...]) -> Any:
        """The moment on a body, along positive rotation; the tables count that on the last one against it."""


class MotionAtNode(AtNode, Numbers):
    """The motion at a place x and an instant tau."""

    def __init__(
        self, name: str, driven: Driven, bound: Mapping[str, int], tau: fmpq, numbering: Progression | None
    ) -> None:
        super().__init__(driven, {**bound, r"\tau": tau, "l": LENGTH})
        self.name, self.x, self.tau, self.numbering = name, bound["x"], tau, numbering

    def slope(self, rod: int, by: str, order: int) -> Any:
        f, g = self.driven.waves_at(rod, self.x, self.tau, order)
        self.seen = self.seen or f != 0 or g != 0
        if by == "x":
            return g - f
        return f + g + (self.driven.exact.chain.rod(rod).velocity if order == 1 else 0)

    def moment(self, index: tuple[Any, ...]) -> Any:
        if len(index) != 1 or not 1 <= index[0] <= self.driven.exact.m + 1:
            raise MeaninglessError(f"there is no moment {index[0]}" if index else "the moment has no index")
        sign = -1 if index[0] == self.driven.exact.m + 1 else 1
        return sign * self.driven.load(f"M{index[0]}", self.tau)


class SymbolsAtNode(AtNode, Symbols):
    """Strain, velocity, acceleration as they are, the acceleration of either rod as that of the node."""

    def __init__(self, name: str, parameters: Parameters, index: Any, numbering: Progression | None) -> None:
        super().__init__({"i": index, "l": Letter("l")})
        self.name, self.parameters, self.numbering = name, parameters, numbering

    def slope(self, rod: Any, by: str, order: int) -> Expr:
        return strain(rod) if by == "x" else ACCELERATION if order == 2 else super().slope(rod, by, order)

    def moment(self, index: tuple[Any, ...]) -> Expr:
        return moment_on(*map(expand, index))


ACCELERATION = Letter(r"\frac{\partial^2 U(x, \tau)}{\partial \tau^2}")


def strain(rod: Any) -> Expr:
    return Letter(rf"\frac{{\partial U_{{{latex(rod)}}}(x, \tau)}}{{\partial x}}")


def moment_on(number: Any = None) -> Expr:
    return Letter(rf"M_{{{latex(number)}}}(\tau)" if number is not None else r"M(\tau)")


def letter(symbol: Symbol) -> str:
    """A letter with its marks, but its indices."""
    return symbol.accent + symbol.name + "'" * symbol.primes
