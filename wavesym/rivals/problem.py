"""(2.1)-(2.4) of a scene in doubles: where every rival starts."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Generic, TypeVar

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest

Array = NDArray[np.float64]
Evaluate = Callable[[Array], Array]
"""Ascending tau in [0, until], shape (n,), to the outputs, shape (outputs, n)."""

FORCE_TERMS = 3
"""Loads are polynomials in tau of at most this many terms: a ramp of acceleration is a parabola of ground velocity."""


@dataclass(frozen=True)
class Event:
    """From `time` on, the load at a node has sum_k coefficients[k] (tau - time)**k more."""

    time: Fraction
    node: int
    coefficients: tuple[float, float, float]


@dataclass(frozen=True)
class Watch:
    """An output: a quantity in rod 1 ... m, `offset` in [0, 1] from its left end."""

    quantity: str
    rod: int
    offset: float


@dataclass(frozen=True)
class Problem:
    """m rods of length 1 with waves of speed 1, and at node x = 0 ... m, with U_t the same on both sides,

        inertia U_tt + damping U_t = (beta/2) dU_right/dx - (alpha/2) dU_left/dx + loads.

    At tau = 0 nothing is displaced and the rods move at `rods` (m,). All else has shape (m + 1,).
    """

    inertia: Array
    alpha: Array
    beta: Array
    damping: Array
    rods: Array
    events: tuple[Event, ...]
    watches: tuple[Watch, ...]
    until: float

    @property
    def nodes(self) -> int:
        """m + 1."""
        return len(self.inertia)

    @property
    def gamma(self) -> Array:
        """What stands before the velocity once the waves are told apart: damping + (alpha + beta)/2."""
        return np.asarray(self.damping + (self.alpha + self.beta) / 2)

    @cached_property
    def velocity(self) -> Array:
        """The nodes' velocities at tau = 0: a body's are those of its rods, a contact's what balances two rods."""
        left, right = self.beside(self.rods)
        balanced = (self.alpha * left + self.beta * right) / (2 * self.gamma)
        return np.where(self.inertia > 0, np.where(np.arange(self.nodes) > 0, left, right), balanced)

    def beside(self, rods: Array) -> tuple[Array, Array]:
        """A quantity of rods (m,) seen from the nodes: of the rod on the left, on the right; 0 if there is none."""
        return np.append(0.0, rods), np.append(rods, 0.0)

    @cached_property
    def cuts(self) -> tuple[Fraction, ...]:
        """0, the fractional parts of the load times, 1: inside a unit of tau waves jump or bend nowhere else."""
        return tuple(sorted({Fraction(0), Fraction(1)} | {event.time % 1 for event in self.events}))

    def place(self, event: Event) -> tuple[int, int]:
        """The unit of tau, and in it the panel between two cuts, that an event starts."""
        window = event.time // 1
        return window, bisect_right(self.cuts, event.time - window) - 1

    def load_mean(self, low: Array, high: Array) -> Array:
        """The loads' means over intervals [low, high], each (n,): shape (n, nodes)."""
        return means(self.events, self.nodes, low, high)


P = TypeVar("P")


@dataclass(frozen=True)
class Rival(Generic[P]):
    """A method: `prepare` does what a new parameter set needs, and gives what is called for values.

    `states` says a model as the method takes it: UnservedError for one that it does not take. `resolutions`, from
    coarse to fine, are what its accuracy is bought with; `unit` says of what.
    """

    name: str
    language: str
    unit: str
    resolutions: tuple[float, ...]
    states: Callable[[Model], P]
    prepare: Callable[[P, float], Evaluate]


def means(events: Sequence[Event], nodes: int, low: Array, high: Array) -> Array:
    """The means of loads over intervals [low, high], each (n,): shape (n, nodes)."""
    total = np.zeros((len(low), nodes))
    for event in events:
        start = float(event.time)
        first, last = np.maximum(low - start, 0.0), np.maximum(high - start, 0.0)
        for k, c in enumerate(event.coefficients):
            total[:, event.node] += c / (k + 1) * (last ** (k + 1) - first ** (k + 1)) / (high - low)
    return total


def terms(exact: Sequence[fmpq]) -> tuple[float, float, float]:
    """A load's coefficients, as many as every load has."""
    a, b, c = map(nearest, (*exact, *[fmpq(0)] * (FORCE_TERMS - len(exact))))
    return a, b, c
