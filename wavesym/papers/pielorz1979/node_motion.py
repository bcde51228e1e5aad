"""The language of (2.3), (2.4), (4.3)-(4.5): a condition is a function of the motion at a node and of its place i.

`y.x(r)`, `y.t(r)`, `y.tt(r)` are strain, velocity and acceleration of rod r there.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from flint import fmpq
from sympy import Integer

from wavesym.derivation.delay_terms import Line, Operator, Wave, exact
from wavesym.model.node import Rod
from wavesym.papers.exact_tables import Exact
from wavesym.papers.pielorz1979.delays import Example
from wavesym.papers.pielorz1979.signals import Formal, Numbers, Place, PrintedSignal, Waves, residual_case
from wavesym.papers.record import Case, Slip


class NodeMotion(ABC):
    """The motion at a node, and the loads and parameters of its system."""

    def __init__(self, waves: Waves) -> None:
        self.waves = waves
        self.m, self.k, self.J, self.M, self.A = waves.m, waves.k, waves.J, waves.M, waves.A

    @abstractmethod
    def x(self, rod: Place) -> Any:
        """dU/dx."""

    @abstractmethod
    def t(self, rod: Place) -> Any:
        """dU/dtau."""

    def tt(self, rod: Place) -> Any:
        """d2U/dtau2."""
        return self.t(rod).d

    @property
    def base(self) -> Any:
        """The acceleration of the foundation, (3.2)."""
        return self.waves.base


Ansatz = Callable[[Rod, int], tuple[int, int]]
"""How late f and g of a rod are at x."""


def lags(rod: Rod, x: int) -> tuple[int, int]:
    """(4.2)."""
    return rod.tau0 + x - rod.x0, rod.tau0 - x + rod.x0


class Tabulated(NodeMotion):
    """Exact increments in the clock tau, by (4.2) and Table 1; accelerations between jumps."""

    def __init__(self, waves: Waves, table: Exact, place: int, ansatz: Ansatz = lags) -> None:
        super().__init__(waves)
        self._table, self._place, self._ansatz = table, place, ansatz

    def _waves(self, rod: int) -> tuple[PrintedSignal, PrintedSignal]:
        if not 1 <= rod <= self.m:
            raise LookupError(f"rod {rod}")
        late_f, late_g = self._ansatz(self._table.chain.rod(rod), self._place)
        return self.waves.f(rod, late_f), self.waves.g(rod, late_g)

    def x(self, rod: int) -> PrintedSignal:
        f, g = self._waves(rod)
        return g - f

    def t(self, rod: int) -> PrintedSignal:
        f, g = self._waves(rod)
        return f + g + PrintedSignal({0: {fmpq(0): [fmpq(self._table.chain.rod(rod).velocity)]}})


class Formally(NodeMotion):
    """Strain and velocity as they are, for symbolic i and m."""

    def x(self, rod: Place) -> Formal:
        return self._wave("U_x", rod)

    def t(self, rod: Place) -> Formal:
        return self._wave("U_t", rod)

    @staticmethod
    def _wave(name: str, rod: Place) -> Formal:
        return Formal(Line({Wave(name, exact(rod), Integer(0)): Operator(Integer(0), Integer(1))}))


Condition = Callable[[Any, Place], Any]


@dataclass(frozen=True)
class Stated:
    """A condition and the places x = i where it is said to hold, for a given m."""

    condition: Condition
    span: Callable[[int], Iterable[int]]


@dataclass(frozen=True)
class PrintedCondition:
    """A printed condition; `place` is its x for symbolic i and m, `step` that of its range, 0 for a single place.

    `examples` are those that have such nodes.
    """

    id: str
    text: str
    examples: tuple[Example, ...]
    stated: Stated
    place: Place | None
    step: int = 0
    ranges: str = ""
    slip: Slip[Stated] | None = None


def case(table: Exact, source: str, condition: Condition, i: int, ansatz: Ansatz = lags) -> Case:
    """What is left of a condition at x = i."""

    def formula(waves: Waves, i: int) -> PrintedSignal:
        result: PrintedSignal = condition(Tabulated(waves, table, i, ansatz), i)
        return result

    # rods of example I may be read up to two units early
    return residual_case(Numbers(table, source), formula, i, short=2)
