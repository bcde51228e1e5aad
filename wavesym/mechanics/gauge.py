"""What outputs are sums of: strains, velocities and displacements at places, and the loads on points.

    force                 impedance * speed * strain
    drift of a rod        displacement of its far end less that of its near one
    relative              displacement less that of the foundation, or of the prescribed end
    acceleration          all that acts on a mass, over the mass: rods, spring and dashpot to the ground, links, loads;
                          where nothing has mass the derivative of the velocity

What touches a mass pushes it with all that acts on what touches, as that has no mass; where it is open that is nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.network import End, Network
from wavesym.mechanics.probe import Probe
from wavesym.mechanics.quantities import order_of

_ZERO, _ONE = fmpq(0), fmpq(1)


class WaveTerm(NamedTuple):
    """So many times the wave, as a velocity, that an end has sent, `delay` (in tau) later."""

    end: End
    weight: fmpq
    delay: fmpq


@dataclass(frozen=True)
class Gauge:
    """`quantity` (strain, velocity, displacement, acceleration) `place` rod lengths from the left end of a rod.

    Or that of a `point`.
    The right-going wave has come so far from that end, the left-going one 1 - place from the other. A "load" is what
    acts on a point, a "constant" is 1. `rod` is 0 where a point is read, or nothing.
    """

    quantity: str
    rod: int
    place: fmpq
    point: int | None = None

    @property
    def x(self) -> fmpq:
        """How far it is from the left end of the chain, in rod lengths, where the rods follow one another."""
        return self.rod - 1 + self.place

    @property
    def weights(self) -> tuple[int, int]:
        """What the right-going and the left-going wave, each as a velocity, count in dU/dx or dU/dtau."""
        return (-1, 1) if self.quantity == "strain" else (1, 1)

    def waves(self, network: Network) -> tuple[WaveTerm, WaveTerm]:
        """On a rod: the right-going and the left-going wave, each from the end that sends it."""
        bar = network.bars[self.rod - 1]
        over = 1 / bar.speed if self.quantity == "strain" else _ONE
        right, left = self.weights
        return (
            WaveTerm(End(self.rod - 1, 0), right * over, self.place * bar.delay),
            WaveTerm(End(self.rod - 1, 1), left * over, (1 - self.place) * bar.delay),
        )

    @property
    def moves(self) -> bool:
        """Whether it is read from what moves."""
        return self.quantity not in ("load", "constant")

    @property
    def order(self) -> int:
        """How often the waves are differentiated: -1 for an integral, a displacement; 1 for an acceleration."""
        return order_of(self.quantity)


class ReadingTerm(NamedTuple):
    """So many times a reading."""

    weight: fmpq
    reading: Gauge


Sum = tuple[ReadingTerm, ...]
"""A sum of readings, none of them twice or with weight 0; empty for what is 0 whatever moves."""


def readings(network: Network, probe: Probe) -> Sum:
    """What an output is the sum of, its factor included."""
    if probe.quantity == "acceleration" and (probe.point is not None or probe.place in (0, 1)):
        point, ratio = probe.point, _ONE
        if point is None:
            end = End(probe.rod - 1, int(probe.place))
            point, ratio = network.point_at(end), network.bars[end.bar].ratios[end.side]
        if network.points[point].mass != 0:
            return _merge_terms(probe, _times(ratio / network.points[point].mass, _forces_on(network, point)))
    return motion_readings(network, probe)


def motion_readings(network: Network, probe: Probe) -> Sum:
    """The same of motion alone: an acceleration is what it is, not the forces that cause it."""
    return _merge_terms(probe, _parts(network, probe))


def _merge_terms(probe: Probe, parts: Iterable[ReadingTerm]) -> Sum:
    weights: dict[Gauge, fmpq] = {}
    for weight, reading in parts:
        weights[reading] = weights.get(reading, _ZERO) + probe.factor * weight
    return tuple(ReadingTerm(weight, reading) for reading, weight in weights.items() if weight != 0)


def _parts(network: Network, probe: Probe) -> Iterator[ReadingTerm]:
    match probe.computed_quantity:
        case "strain" | "force":
            bar = network.bars[probe.rod - 1]
            stiffness = bar.impedance * bar.speed if probe.computed_quantity == "force" else _ONE
            yield ReadingTerm(stiffness, Gauge("strain", probe.rod, probe.place))
            yield ReadingTerm(stiffness * bar.weight_strain(probe.place), Gauge("constant", 0, _ZERO))
        case "drift":
            yield ReadingTerm(_ONE, Gauge("displacement", probe.rod, _ONE))
            yield ReadingTerm(-_ONE, Gauge("displacement", probe.rod, _ZERO))
        case "relative":
            yield ReadingTerm(_ONE, Gauge("displacement", probe.rod, probe.place, probe.point))
            yield ReadingTerm(-_ONE, gauge_at("displacement", network, ground(network)))
        case _:
            yield ReadingTerm(_ONE, Gauge(probe.quantity, probe.rod, probe.place, probe.point))


def positions(reads: Sequence[Gauge]) -> tuple[list[tuple[int, fmpq]], list[int]]:
    """Where they are: places of bars, and points, as `Network.distances` takes them."""
    return (
        [(each.rod - 1, each.place) for each in reads if each.rod],
        [each.point for each in reads if each.point is not None],
    )


def ground(network: Network) -> int:
    """The point that relative displacements count from: the only one whose motion is prescribed, or the first one."""
    prescribed = [number for number, point in enumerate(network.points) if point.motion in ("velocity", "acceleration")]
    return prescribed[0] if len(prescribed) == 1 else 0


def _forces_on(network: Network, point: int, before: int | None = None) -> Iterator[ReadingTerm]:
    """All that acts on a point, and on what touches it; contacts `before` are followed already."""
    for number, side in network.ends_at.get(point, ()):
        bar = network.bars[number]
        pull = (1, -1)[side] * bar.ratios[side] * bar.impedance * bar.speed
        yield ReadingTerm(pull, Gauge("strain", number + 1, fmpq(side)))
    body = network.points[point]
    yield ReadingTerm(-body.damping, gauge_at("velocity", network, point))
    yield ReadingTerm(-body.stiffness, gauge_at("displacement", network, point))
    for number, link in enumerate(network.links):
        if point not in (link.left, link.right) or number == before:
            continue
        if link.has_corner and not link.contact:
            raise UnservedError(
                f"output.acceleration: {link.changes}, and its force is no sum of readings; take velocity"
            )
        if link.contact:
            other, share = (link.right, link.ratio) if point == link.left else (link.left, 1 / link.ratio)
            yield from _times(share, _forces_on(network, other, number))
            continue
        pull = link.ratio if point == link.left else -_ONE
        for factor, quantity in ((link.damping, "velocity"), (link.stiffness, "displacement")):
            yield ReadingTerm(pull * factor, gauge_at(quantity, network, link.right))
            yield ReadingTerm(-pull * factor * link.ratio, gauge_at(quantity, network, link.left))
    if body.loads:
        yield ReadingTerm(_ONE, Gauge("load", 0, _ZERO, point))


def gauge_at(quantity: str, network: Network, point: int) -> Gauge:
    """That of a point, at the end of a rod that moves as it does where there is one."""
    for number, side in network.ends_at.get(point, ()):
        if network.bars[number].ratios[side] == 1:
            return Gauge(quantity, number + 1, fmpq(side))
    return Gauge(quantity, 0, _ZERO, point)


def _times(factor: fmpq, parts: Iterable[ReadingTerm]) -> Iterator[ReadingTerm]:
    return (ReadingTerm(factor * weight, reading) for weight, reading in parts)
