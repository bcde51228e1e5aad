"""What loads that do not change do to a chain: the sums over all of its modes, in closed form.

A shape here is how far points move; along a bar it is linear, but where the bar itself is accelerated (`bent`), which
bends it so that u'' is the acceleration (along the bar counted in delay). With modes of mass 1, f_n a load's share in
mode n and l_n what an output is of it, sums over all modes n with strain:

    under a load                     sum_n f_n l_n / w_n^2 = l of the shape
    force and motions of points      sum_n l_n^2 / w_n^2   = l of the shape under the forces that l is
    motion of an end with unit       sum_n f_n^2           = mass of the shape that the end imposes
      acceleration
    strain at the end of a bar       sum_n l_n^2 / w_n^4   = mass of the shape with a unit break there

Of a chain that nothing holds, shapes have no part in the motion without strain, and loads what is in balance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from flint import arb

from wavesym.exact.modes.response import HarmonicResponse
from wavesym.exact.modes.shape import rigid, rigid_mode
from wavesym.exact.modes.stiffness import Quantity, Stiffness
from wavesym.mechanics.network import End

Forces = Mapping[int, Quantity]
"""What acts on points."""


@dataclass(frozen=True)
class Shape:
    """How far points move, and their accelerations where bars are bent by them."""

    statics: Statics
    points: Sequence[Quantity]
    bent: Sequence[Quantity] | None = None

    def displacement(self, end: End) -> Quantity:
        """How far the end of a bar moves."""
        return self.statics.displacement(self.points, end)

    def slope(self, end: End) -> Quantity:
        """The strain there times the bar's speed."""
        delay = self.statics.stiffness.network.bars[end.bar].delay
        ends = End(end.bar, 0), End(end.bar, 1)
        slope = (self.displacement(ends[1]) - self.displacement(ends[0])) / delay
        if self.bent is not None:
            here, there = (
                self.statics.displacement(self.bent, End(end.bar, side)) for side in (end.side, 1 - end.side)
            )
            pull = delay * (2 * here + there) / 6
            slope += pull if end.side else -pull
        return slope


@dataclass(frozen=True)
class Statics:
    """The statics of a network whose points are those of a tree, in balls of the precision that is set."""

    stiffness: Stiffness

    def displacement(self, points: Sequence[Quantity], end: End) -> Quantity:
        """How far the end of a bar moves where points move so far."""
        bar = self.stiffness.network.bars[end.bar]
        return points[bar.right if end.side else bar.left] * bar.ratios[end.side]

    @cached_property
    def free(self) -> Sequence[Quantity] | None:
        """The motion without strain, of mass 1; None where something holds the chain."""
        found = rigid(self.stiffness.network)
        return None if found is None else rigid_mode(self.stiffness, found).points

    @cached_property
    def _response(self) -> HarmonicResponse:
        """Where nothing moves a bar is a spring of its impedance over its delay."""
        springs = {bar.delay: 1 / arb(bar.delay) for bar in self.stiffness.network.bars}
        pairs = {delay: (each, each) for delay, each in springs.items()}
        return HarmonicResponse(self.stiffness, arb, arb(0), pairs, is_free=self.free is not None)

    def solve(self, forces: Sequence[Quantity]) -> list[Quantity]:
        """How far the points move under forces on them, those that are not free by nothing.

        Where nothing holds the chain the forces are in balance, and its root does not move.
        """
        return self._response.move(dict(enumerate(forces)))

    def inertia(self, points: Sequence[Quantity]) -> list[Quantity]:
        """The forces on points that accelerate everything as points move, and what is between them linearly."""
        network = self.stiffness.network
        forces = [q * point.mass for q, point in zip(points, network.points, strict=True)]
        for number, bar in enumerate(network.bars):
            share = arb(bar.impedance * bar.delay / 6)
            ends = self.displacement(points, End(number, 0)), self.displacement(points, End(number, 1))
            forces[bar.left] += share * bar.ratios[0] * (2 * ends[0] + ends[1])
            forces[bar.right] += share * bar.ratios[1] * (ends[0] + 2 * ends[1])
        return forces

    def mass(self, points: Sequence[Quantity], broken: Mapping[End, Quantity] | None = None) -> Quantity:
        """The sum of M q^2, and of the integrals of Z u^2; ends that are `broken` move so much further than points."""
        network = self.stiffness.network
        total = sum((q * q * point.mass for q, point in zip(points, network.points, strict=True)), arb(0))
        for number, bar in enumerate(network.bars):
            a, b = (
                self.displacement(points, end) + (broken or {}).get(end, 0) for end in (End(number, 0), End(number, 1))
            )
            total += arb(bar.impedance * bar.delay / 3) * (a * a + a * b + b * b)
        return total

    def imposed_shape(self, point: int) -> Shape:
        """The shape that the unit motion of a point imposes whose motion is prescribed."""
        return Shape(self, self._response.prescribe(point, arb(1))[0])

    def loaded_shape(self, forces: Forces) -> Shape:
        """The shape under forces on points."""
        acting = [arb(0)] * len(self.stiffness.network.points)
        for point, force in forces.items():
            acting[point] = acting[point] + arb(force)
        if self.free is None:
            return Shape(self, self.solve(acting))
        along = self._rigid_component(acting)
        bent = [along * q for q in self.free]
        pull = self.inertia(bent)
        moved = self.solve([force - inertia for force, inertia in zip(acting, pull, strict=True)])
        return Shape(self, self._remove_rigid_part(moved, bent), bent)

    def lagging_shape(self, imposed: Shape) -> Shape:
        """The shape that lags behind an imposed one when that has the acceleration 1."""
        return Shape(self, self.solve([-force for force in self.inertia(imposed.points)]), imposed.points)

    def break_mass(self, end: End) -> Quantity:
        """The mass of the shape with a unit break at the end of a bar: the sum of (slope there)^2 / w^4."""
        bar = self.stiffness.network.bars[end.bar]
        acting = [arb(0)] * len(self.stiffness.network.points)
        acting[bar.left] -= arb(bar.ratios[0] / bar.delay)
        acting[bar.right] += arb(bar.ratios[1] / bar.delay)
        moved = self.solve(acting)
        gap = {end: 1 / arb(bar.impedance) * (-1 if end.side else 1)}
        mass = self.mass(moved, gap)
        if self.free is None:
            return mass
        here = self.displacement(self.free, end)  # the same all along the bar
        part = self._rigid_component(self.inertia(moved)) + here * gap[end] * arb(bar.impedance * bar.delay / 2)
        return mass - part * part

    def _rigid_component(self, forces: Sequence[Quantity]) -> Quantity:
        """What forces do to the motion without strain."""
        assert self.free is not None
        return sum((force * q for force, q in zip(forces, self.free, strict=True)), arb(0))

    def _remove_rigid_part(self, moved: Sequence[Quantity], bent: Sequence[Quantity]) -> list[Quantity]:
        """A shape without its part in the motion without strain."""
        assert self.free is not None
        part = self._rigid_component(self.inertia(moved))
        for number, bar in enumerate(self.stiffness.network.bars):
            end = End(number, 0)  # a bar that is bent by a constant a is a T^2 (x^2 - x)/2 off the line
            bend = self.displacement(bent, end) * arb(bar.impedance * bar.delay**3 / 12)
            part -= self.displacement(self.free, end) * bend
        return [q - part * r for q, r in zip(moved, self.free, strict=True)]
