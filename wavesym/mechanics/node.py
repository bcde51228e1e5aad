"""What a chain is made of: rods, and the conditions (2.4) at the nodes between them.

A system describes its nodes once, as functions of the place i, the number of rods m and the parameters. With exact
numbers in their place the description is the chain of a scene; with symbols it is the start of the derivation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

# An exact rational in a chain, a rational function in a chain of symbols, a symbolic expression in a derivation.
Quantity = Any


@dataclass(frozen=True)
class Rod:
    """An elastic rod's clock and start: the constants of (4.2) and Table 1 (all dimensionless).

    Its waves are f(tau - tau0 - x + x0) and g(tau - tau0 + x - x0); `velocity` is the v of (2.2).
    """

    tau0: Quantity
    x0: Quantity
    velocity: Quantity = 0


RAMPS = frozenset("bR")
"""The kinds of unit loads that are ramps of others."""


@dataclass(frozen=True)
class UnitLoad:
    """A unit load at a node: `coefficients[k]` multiplies tau**k from tau = 0 on.

    `kind` is "M" or "R" (a unit step or ramp of moment `number`), "a" or "b" (of the base acceleration).
    """

    kind: str
    number: Quantity | None
    coefficients: tuple[Quantity, ...]

    @property
    def source(self) -> str:
        """Its name in tables and loads: M1, M2, ... R1, R2, ... a, b."""
        return self.kind if self.number is None else f"{self.kind}{self.number}"

    @property
    def is_ramp(self) -> bool:
        """Whether it is the ramp of another one: "b", "R1", ..., of the node of a general chain "NODE:ramp"."""
        return self.kind in RAMPS or self.kind.endswith(":ramp")


@dataclass(frozen=True)
class Node:
    """The condition between rod x (on the left) and rod x + 1 (on the right), in dimensionless form:

        inertia U_tt + damping U_t = (beta/2) dU_right/dx - (alpha/2) dU_left/dx + loads,

    with U_t the same on both sides. Every line of (4.3)-(4.5) is of this form: a rigid body has inertia 1, a contact,
    a free end or a prescribed force inertia 0; a prescribed velocity is damping 1 alone. At a `contact` rods
    only touch.
    """

    left: Rod | None
    right: Rod | None
    inertia: Quantity
    alpha: Quantity
    beta: Quantity
    damping: Quantity = 0
    loads: tuple[UnitLoad, ...] = ()
    contact: bool = False

    @property
    def radiation(self) -> Quantity:
        """What stands before the velocity once the waves are told apart: damping + (alpha + beta)/2."""
        return self.damping + (self.alpha + self.beta) / 2

    @property
    def rate(self) -> Quantity:
        """The g of exp(-g tau), with which a body left to itself comes to rest. ZeroDivisionError without inertia."""
        return self.radiation / self.inertia

    @property
    def velocity(self) -> Quantity:
        """How fast a body is at tau = 0: as its rods."""
        rod = self.left or self.right
        assert rod is not None  # a node has a rod
        return rod.velocity


@dataclass(frozen=True)
class Family:
    """Nodes of one kind, at x = first, first + step, ... last. `at` takes no more parameters than its node has."""

    first: Quantity
    last: Quantity
    step: int
    node_at: Callable[[Quantity], Node]


def single(x: Quantity, node: Callable[[], Node]) -> Family:
    """A family of one, at `x`."""
    return Family(x, x, 1, lambda _: node())


@dataclass(frozen=True)
class Parameters:
    """The numbers (or symbols) of a system, each indexed as in the paper; `dashpot` by the node it is at."""

    kappa: Any
    inertia: Any = None
    velocity: Any = None
    dashpot: Any = None


@dataclass(frozen=True)
class System:
    """One system: its nodes, for any m, as families from left to right.

    It is made for m = smallest, smallest + step, ... `indices(m)` says which parameters it has, by name.
    """

    name: str
    families: Callable[[Quantity, Parameters], tuple[Family, ...]]
    indices: Callable[[int], Mapping[str, range]]
    smallest: int
    step: int = 1
