"""What outputs and loads are of a mode: sums of how far points move, or the slope at the end of a bar."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import arb, fmpq

from wavesym.errors import UnservedError
from wavesym.exact.modes.cuts import Cut
from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.statics import Shape, Statics
from wavesym.exact.modes.stiffness import Quantity
from wavesym.mechanics.gauge import ground
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End, Network, Point
from wavesym.mechanics.probe import Probe


@dataclass(frozen=True)
class Seen:
    """What is differentiated in time `order` times: sums of weights times how far points move, or times a slope."""

    order: int
    points: Mapping[int, fmpq]
    slope: tuple[fmpq, End] | None = None

    def of(self, shape: Mode | Shape) -> Quantity:
        """What it is of a shape."""
        if self.slope:
            weight, end = self.slope
            return shape.slope(end) * weight
        return sum((shape.points[point] * weight for point, weight in self.points.items()), arb(0))

    @property
    def power(self) -> int:
        """In how high a power of 1/w^2 its squares are summed up over all modes by `total`."""
        return 2 if self.slope else 0 if self.order == 2 else 1

    def total(self, statics: Statics) -> arb:
        """The sum over all modes with strain of its square over w^(2 power)."""
        if self.slope:
            weight, end = self.slope
            return statics.broken(end) * weight * weight
        if self.order == 2:  # of masses alone
            network, free = statics.stiffness.network, statics.free
            total = sum((arb(b * b / network.points[point].mass) for point, b in self.points.items()), arb(0))
            part = sum((free[point] * b for point, b in self.points.items()), arb(0)) if free else arb(0)
            return total - part * part
        return arb(self.of(statics.under(self.points)))


@dataclass(frozen=True)
class Driver:
    """A load: `gain` times a force on a point, or times the acceleration of one that moves as it is told."""

    point: int
    gain: fmpq
    step: str
    ramp: str


def driven(network: Network) -> list[Driver]:
    """All loads that a network can have: pairs of a step and a ramp. UnservedError for a velocity that is told."""
    found: list[Driver] = []
    for number, point in enumerate(network.points):
        if point.motion == "fixed":
            continue
        for unit in point.loads:
            first, second, *_ = *_felt(point, unit.coefficients), fmpq(0), fmpq(0)
            if first != 0:
                found.append(Driver(number, first, unit.source, ""))
            elif found and found[-1].point == number and not found[-1].ramp and found[-1].gain == second:
                found[-1] = Driver(number, second, found[-1].step, unit.source)
            else:
                found.append(Driver(number, second, "", unit.source))
    return found


def _felt(point: Point, coefficients: Sequence[fmpq]) -> list[fmpq]:
    """A unit load as powers of tau: as a force, or as an acceleration."""
    if point.motion != "velocity":
        return [fmpq(c) for c in coefficients]
    if coefficients[0] != 0:
        raise UnservedError(
            f"system.parts: a motion of told velocity given at {point.name or point.place}, one of told acceleration "
            "expected in modes (pieces and march serve it)"
        )
    return [k * fmpq(c) for k, c in enumerate(coefficients)][1:]


def places(model: Model) -> tuple[tuple[int, fmpq], ...]:
    """Where bars are to be cut so that all outputs are at points. UnservedError where that makes a ring."""
    for probe in model.probes:
        if 0 < probe.place < 1 and probe.rod - 1 in model.network.bridged:
            raise UnservedError(
                f"output: {probe.name} inside a rod with a spring or dashpot beside it given, a place at its ends "
                "expected in modes (pieces and march serve it)"
            )
    return tuple((probe.rod - 1, probe.place) for probe in model.probes if probe.rod)


def seen(network: Network, pieces: Cut, probe: Probe) -> Seen:
    """What an output is, its factor included, on the network that is cut in pieces."""
    factor = probe.factor
    match probe.quantity:
        case "strain" | "force":
            bar = network.bars[probe.rod - 1]
            weight = bar.impedance if probe.quantity == "force" else 1 / bar.speed
            return Seen(0, {}, (factor * weight, pieces.end(probe.rod - 1, probe.place)))
        case "drift":
            ends = End(pieces.firsts[probe.rod - 1], 0), pieces.end(probe.rod - 1, fmpq(1))
            return Seen(0, _sum(_moving(pieces, ends[1], factor), _moving(pieces, ends[0], -factor)))
    if probe.point is not None:
        points = {probe.point: factor}
    elif probe.quantity == "acceleration":
        points = {network.point_at(End(probe.rod - 1, int(probe.place))): factor}
    else:
        points = _moving(pieces, pieces.end(probe.rod - 1, probe.place), factor)
    if probe.quantity == "relative":
        points = _sum(points, {ground(network): -factor})
    return Seen({"velocity": 1, "acceleration": 2}.get(probe.quantity, 0), points)


def _moving(pieces: Cut, end: End, weight: fmpq) -> dict[int, fmpq]:
    return {pieces.network.point_at(end): weight * pieces.network.bars[end.bar].ratios[end.side]}


def _sum(*parts: Mapping[int, fmpq]) -> dict[int, fmpq]:
    total: dict[int, fmpq] = {}
    for part in parts:
        for point, weight in part.items():
            total[point] = total.get(point, fmpq(0)) + weight
    return {point: weight for point, weight in total.items() if weight != 0}
