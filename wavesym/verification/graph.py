"""A network in doubles, as the wave equation in its bars and the balance of forces at its points say it.

In a bar U_tt = speed^2 U_xx, and its force is impedance * speed * U_x. Its end moves `ratio` times as fast as its
point, which feels `ratio` times its force. At the points, all at once,

    mass u'' + damping u' + stiffness u = sum over ends of ratio * force of the bar + loads.

A contact between two points keeps its gap from being negative; while that is 0 it pushes, and never pulls.

At tau = 0 nothing is displaced: what a bar is strained then is counted besides. Nothing here knows of joints, waves or
their laws.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, reduce
from math import gcd

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import fraction, nearest

Array = NDArray[np.float64]


@dataclass(frozen=True)
class GraphEvent:
    """From `time` on, the load on a point (or what its motion is) has sum_k coefficients[k] (tau - time)**k more."""

    time: Fraction
    point: int
    coefficients: tuple[float, ...]


@dataclass(frozen=True)
class Change:
    """The contact with this number opens or closes at tau."""

    contact: int
    kind: str
    tau: float


Struck = list[tuple[Change, float]]
"""What happens at contacts in the order of time, and how well it is known when."""


def alike(finer: Sequence[Change], coarser: Sequence[Change]) -> Struck | None:
    """What happens in two solutions, and how far apart in time; None where it is not the same."""
    found: Struck = []
    for contact in {change.contact for change in (*finer, *coarser)}:
        both = [[change for change in changes if change.contact == contact] for changes in (finer, coarser)]
        if [change.kind for change in both[0]] != [change.kind for change in both[1]]:
            return None
        found += [(one, abs(one.tau - other.tau)) for one, other in zip(*both, strict=True)]
    return sorted(found, key=lambda each: (each[0].tau, each[0].contact))


@dataclass(frozen=True)
class Graph:
    """Points, and bars with two ends each: end 2 b is the left one of bar b, end 2 b + 1 the right one.

    `mass`, `damping` and `stiffness` have no part of the bars in them; the last two are square. `given` are the points
    whose motion is prescribed, with how many integrals their displacements are away from the loads. The gaps of
    contacts are `gaps` + `parting` @ displacements, and their pushes act on points by the transpose of `parting`.
    """

    network: Network
    mass: Array
    damping: Array
    stiffness: Array
    velocity: Array
    given: dict[int, int]
    ends: NDArray[np.int_]
    ratios: Array
    impedance: Array
    speed: Array
    start_velocity: Array
    start_strain: Array
    contacts: tuple[str, ...]
    gaps: Array
    parting: Array
    events: tuple[GraphEvent, ...]

    @cached_property
    def delays(self) -> tuple[Fraction, ...]:
        """How long a wave takes through each bar."""
        return tuple(fraction(bar.length) / fraction(bar.speed) for bar in self.network.bars)

    @property
    def measure(self) -> Fraction:
        """The largest time that all delays are multiples of."""
        return reduce(_common, self.delays)

    @cached_property
    def pull(self) -> Array:
        """The forces of the bars on their points while nothing but their start has come to the ends, without ratios.

        A bar's end feels impedance * (velocity and, towards the bar, speed * strain) less impedance * its velocity.
        """
        strain = self.speed * self.start_strain
        ends = np.stack([self.start_velocity + strain, self.start_velocity - strain], axis=1)
        return np.asarray((self.impedance[:, np.newaxis] * ends).ravel())

    def load_integral(self, times: Array, order: int) -> Array:
        """The loads integrated `order` times from tau = 0 on: shape (times, points)."""
        total = np.zeros((len(times), len(self.mass)))
        for event in self.events:
            since = np.maximum(times - float(event.time), 0.0)
            began = times >= float(event.time)
            for k, c in enumerate(event.coefficients):
                power = k + order
                divided = np.prod(np.arange(k + 1, power + 1, dtype=float))
                total[:, event.point] += np.where(began, c / divided * since**power, 0.0)
        return total

    def prescribed(self, times: Array) -> Array:
        """The displacements of the points whose motion is given; 0 for the others."""
        result = np.zeros((len(times), len(self.mass)))
        for point, integrals in self.given.items():
            result[:, point] = self.load_integral(times, integrals)[:, point] + times * self.velocity[point]
        return result

    @cached_property
    def pace(self) -> float:
        """A velocity that the start and the loads are worth: what is far smaller is noise. 1 where nothing moves."""
        longest = float(max(self.delays))
        found = [*self.velocity, *self.start_velocity, *(self.speed * self.start_strain)]
        for event in self.events:
            size = sum(abs(c) * longest**k for k, c in enumerate(event.coefficients))
            held = {0: 1 / float(np.min(self.impedance)), 1: 1.0, 2: longest}
            found.append(size * held[self.given.get(event.point, 0)])
        return float(np.max(np.abs(found))) or 1.0

    @cached_property
    def worth(self) -> tuple[float, float]:
        """A displacement and a force that this is worth."""
        return self.pace * float(max(self.delays)), self.pace * float(np.max(self.impedance))

    @cached_property
    def swings(self) -> float:
        """How fast masses swing on their springs, at most, roughly; radians per unit of tau."""
        heavy = self.mass > 0
        stiff = np.sum(np.abs(self.stiffness), axis=1)
        return float(np.sqrt(np.max(stiff[heavy] / self.mass[heavy], initial=0.0)))

    @cached_property
    def groups(self) -> tuple[tuple[int, ...], ...]:
        """The points that springs, dashpots and contacts join, as they move together."""
        size = len(self.mass)
        pairs = np.eye(size) + (self.damping != 0) + (self.stiffness != 0)
        for row in self.parting:
            pairs += np.outer(row != 0, row != 0)
        reached = np.linalg.matrix_power(pairs > 0, size) if size else pairs > 0
        return tuple(dict.fromkeys(tuple(np.flatnonzero(row).tolist()) for row in reached))

    @cached_property
    def free(self) -> NDArray[np.int_]:
        """The points that are free to move."""
        return np.array([point for point in range(len(self.mass)) if point not in self.given], dtype=int)


def graph(model: Model) -> Graph:
    """The network of a model with its loads. UnservedError where modes are damped."""
    model.refuse_damping()
    network = model.network
    points, bars = network.points, network.bars
    damping, stiffness = (np.diag(_numbers(points, name)) for name in ("damping", "stiffness"))
    parting = []
    for link in network.links:
        pair = np.zeros(len(points))
        pair[link.left], pair[link.right] = -nearest(link.ratio), 1.0
        if link.contact:
            parting.append(pair)
            continue
        damping = damping + nearest(link.damping) * np.outer(pair, pair)
        stiffness = stiffness + nearest(link.stiffness) * np.outer(pair, pair)
    return Graph(
        network,
        mass=_numbers(points, "mass"),
        damping=damping,
        stiffness=stiffness,
        velocity=_numbers(points, "velocity"),
        given={
            number: 2 if point.motion == "acceleration" else 1 for number, point in enumerate(points) if point.motion
        },
        ends=np.array([(bar.left, bar.right) for bar in bars]).ravel(),
        ratios=np.array([nearest(ratio) for bar in bars for ratio in bar.ratios]),
        impedance=_numbers(bars, "impedance"),
        speed=_numbers(bars, "speed"),
        start_velocity=_numbers(bars, "velocity"),
        start_strain=_numbers(bars, "strain"),
        contacts=tuple(link.place for link in network.links if link.contact),
        gaps=np.array([nearest(link.gap) for link in network.links if link.contact]),
        parting=np.array(parting).reshape(-1, len(points)),
        events=tuple(_events(model)),
    )


def _events(model: Model) -> list[GraphEvent]:
    units = {
        unit.source: (number, unit.coefficients)
        for number, point in enumerate(model.network.points)
        for unit in point.loads
    }
    found = []
    for load in model.loads:
        if load.source != "impact":  # that is in the velocities
            point, coefficients = units[load.source]
            found.append(
                GraphEvent(fraction(load.time), point, tuple(nearest(load.weight * fmpq(c)) for c in coefficients))
            )
    return found


def _numbers(parts: tuple[object, ...], name: str) -> Array:
    return np.array([nearest(getattr(part, name)) for part in parts])


def _common(one: Fraction, other: Fraction) -> Fraction:
    return Fraction(
        gcd(one.numerator * other.denominator, other.numerator * one.denominator), one.denominator * other.denominator
    )
