"""Any network of rods in doubles: where the rivals start that take unequal rods, springs, dashpots and branches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.damping import Damping
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Bar, Network
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import fraction, nearest
from wavesym.rivals.problem import Array, Event, means, terms


@dataclass(frozen=True)
class NetworkProblem:
    """Bars in which waves travel with a delay, between points; a bar's end moves `ratio` times as fast as its point,

        mass u'' + damping u' + stiffness u = sum over ends of ratio * force of the bar + loads.

    At tau = 0 nothing is displaced: what a bar is strained then is counted besides. `velocity`, `mass` have shape
    (points,), `damping`, `stiffness` (points, points). The velocity of a point that is `told` its motion is its load,
    at tau = 0, too.
    `ends` has the points of each bar's left and right end, `ratios` their ratios, both (bars, 2). `modal` is how
    modes are damped besides.
    """

    mass: Array
    damping: Array
    stiffness: Array
    velocity: Array
    told: tuple[int, ...]
    ends: tuple[tuple[int, int], ...]
    ratios: Array
    delay: Array
    speed: Array
    impedance: Array
    moving: Array
    strain: Array
    events: tuple[Event, ...]
    probes: tuple[Probe, ...]
    until: float
    modal: Damping | None = None

    @property
    def points(self) -> int:
        """How many points."""
        return len(self.mass)

    @cached_property
    def held(self) -> Array:
        """The waves in each bar at tau = 0 that were sent from its left and its right end: (bars, 2)."""
        turned = self.speed * self.strain
        return np.stack([self.moving - turned, self.moving + turned], axis=1) / 2

    def at_ends(self) -> Iterator[tuple[int, int, int, float, float]]:
        """Each end of a bar: bar, side (0 left, 1 right), point, ratio, impedance."""
        for bar, (ends, ratios) in enumerate(zip(self.ends, self.ratios.tolist(), strict=True)):
            for side in (0, 1):
                yield bar, side, ends[side], ratios[side], float(self.impedance[bar])

    def load_mean(self, low: Array, high: Array) -> Array:
        """The loads' means over intervals [low, high], each (n,): shape (n, points)."""
        return means(self.events, self.points, low, high)


def network_problem(model: Model) -> NetworkProblem:
    """The network of a model with its loads. UnservedError where contacts open and close, and for modal damping."""
    model.refuse_damping()
    return damped_problem(model)


def damped_problem(model: Model) -> NetworkProblem:
    """The network of a model with its loads and its modal damping. UnservedError where contacts open and close."""
    network = model.network
    if network.contacts:
        raise UnservedError("system: a contact that opens and closes given, none expected")
    points, bars = network.points, network.bars
    damping, stiffness = (np.diag([nearest(getattr(p, name)) for p in points]) for name in ("damping", "stiffness"))
    for link in network.links:
        pair = np.zeros(len(points))
        pair[link.left], pair[link.right] = nearest(link.ratio), -1.0
        damping = damping + nearest(link.damping) * np.outer(pair, pair)
        stiffness = stiffness + nearest(link.stiffness) * np.outer(pair, pair)
    events = tuple(_events(model))
    velocity = np.array([nearest(_velocity(network, number)) for number in range(len(points))])
    for number in (told := tuple(number for number, point in enumerate(points) if point.motion)):
        velocity[number] = sum(event.coefficients[0] for event in events if event.node == number and event.time == 0)
    return NetworkProblem(
        mass=np.array([nearest(point.mass) for point in points]),
        damping=damping,
        stiffness=stiffness,
        velocity=velocity,
        told=told,
        ends=tuple((bar.left, bar.right) for bar in bars),
        ratios=np.array([[nearest(ratio) for ratio in bar.ratios] for bar in bars]),
        delay=_column(bars, "delay"),
        speed=_column(bars, "speed"),
        impedance=_column(bars, "impedance"),
        moving=_column(bars, "velocity"),
        strain=_column(bars, "strain"),
        events=events,
        probes=model.probes,
        until=nearest(model.until),
        modal=model.damping,
    )


def _velocity(network: Network, number: int) -> fmpq:
    """How fast a point is at tau = 0; one without mass as the momentum of its bars says."""
    point = network.points[number]
    if point.mass != 0:
        return point.velocity
    carried = weight = fmpq(0)
    for bar in network.bars:
        for end, ratio in zip((bar.left, bar.right), bar.ratios, strict=True):
            if end == number:
                carried += ratio * bar.impedance * bar.velocity
                weight += ratio**2 * bar.impedance
    return carried / weight if weight != 0 else point.velocity


def _events(model: Model) -> Iterator[Event]:
    """The loads; of a prescribed motion its velocity, which begins as the point's own."""
    units = {}
    for number, point in enumerate(model.network.points):
        if point.motion and point.velocity != 0:
            yield Event(fraction(fmpq(0)), number, terms([point.velocity]))
        for unit in point.loads:
            integrated = [fmpq(0), *(fmpq(c) / (k + 1) for k, c in enumerate(unit.coefficients))]
            units[unit.source] = number, integrated if point.motion == "acceleration" else unit.coefficients
    for load in model.loads:
        if load.source in units:  # an impact is in the velocities
            number, coefficients = units[load.source]
            yield Event(fraction(load.time), number, terms([load.weight * c for c in coefficients]))


def _column(bars: tuple[Bar, ...], name: str) -> Array:
    return np.array([nearest(getattr(bar, name)) for bar in bars])
