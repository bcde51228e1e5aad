"""How a network moves when what drives it goes as exp(s tau), in any arithmetic: power series in s, or a prime's."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from flint import fmpq

from wavesym.exact.modes.stiffness import Quantity, Stiffness
from wavesym.mechanics.network import End
from wavesym.programs.modes.projection import ModalOutput


@dataclass(frozen=True)
class HarmonicResponse:
    """`number` takes exact numbers to the arithmetic; of each delay T `bars` has s coth(s T) and s/sinh(s T)."""

    stiffness: Stiffness
    number: Callable[[fmpq], Quantity]
    s: Quantity
    bars: Mapping[fmpq, tuple[Quantity, Quantity]]

    @cached_property
    def eliminated(self) -> tuple[list[Quantity], list[Quantity]]:
        """The pivots of the dynamic stiffness, and what couples each row to its parent."""
        pulled, shared = zip(*(self.bars[delay] for delay in sorted(self.bars)), strict=True) if self.bars else ((), ())
        law, zero = self.stiffness.law(self.number), self.s * 0
        diagonal, up = law.assemble(-self.s * self.s, pulled, [-each for each in shared], self.s)
        coupled = [each + zero for each in up]
        return self.stiffness.pivots([each + zero for each in diagonal], coupled), coupled

    def move(self, forces: Mapping[int, Quantity]) -> list[Quantity]:
        """How far points move under forces on them."""
        zero, points = self.s * 0, self.stiffness.points
        moved = [zero] * len(self.stiffness.network.points)
        found = self.stiffness.substitute(*self.eliminated, [forces.get(point, zero) for point in points])
        for point, q in zip(points, found, strict=True):
            moved[point] = q
        return moved

    def prescribe(self, point: int, motion: Quantity) -> tuple[list[Quantity], Quantity]:
        """How far points move when one is moved so far, and the work of what moves it."""
        held, forces = self.stiffness.prescribed_column(
            point, self.number, lambda bar: self.bars[bar.delay][0], lambda bar: self.bars[bar.delay][1], self.s
        )
        moved = [q * motion for q in self.move(forces)]
        free = (p for p in forces if self.stiffness.network.points[p].motion is None)
        pull = sum((forces[p] * moved[p] for p in free), self.s * 0)
        moved[point] = motion + self.s * 0
        return moved, (held * motion - pull) * motion

    def slope(self, moved: Sequence[Quantity], end: End) -> Quantity:
        """The strain times the bar's speed at its end."""
        bar = self.stiffness.network.bars[end.bar]
        ends = [moved[point] * self.number(n) for point, n in zip((bar.left, bar.right), bar.ratios, strict=True)]
        pulled, shared = self.bars[bar.delay]
        slope = shared * ends[1 - end.side] - pulled * ends[end.side]
        return -slope if end.side else slope

    def read(self, output: ModalOutput, moved: Sequence[Quantity]) -> Quantity:
        """An output of how far points move, but for its derivatives."""
        if output.slope:
            weight, end = output.slope
            return self.slope(moved, end) * self.number(weight)
        parts = (moved[point] * self.number(weight) for point, weight in output.points.items())
        return sum(parts, self.s * 0)
