"""How a network moves under forces and motions that go as exp(s tau), in any arithmetic, by its dynamic stiffness."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from flint import fmpq

from wavesym.exact.modes.stiffness import Quantity, Stiffness
from wavesym.mechanics.network import Bar, End, Link


@dataclass(frozen=True)
class HarmonicResponse:
    """`number` takes exact numbers to the arithmetic; of each delay T `bars` has s coth(s T) and s/sinh(s T).

    With `is_free` nothing holds the network: forces balance then, and the root rests.
    """

    stiffness: Stiffness
    number: Callable[[fmpq], Quantity]
    s: Quantity
    bars: Mapping[fmpq, tuple[Quantity, Quantity]]
    is_free: bool = False

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
        zero = self.s * 0
        acting = [forces.get(point, zero) for point in self.stiffness.points]
        moved = self.stiffness.substitute(*self.eliminated, acting, free=self.is_free)
        return self.stiffness.point_motions(moved) if moved else [zero] * len(self.stiffness.network.points)

    def prescribe(self, point: int, motion: Quantity) -> tuple[list[Quantity], Quantity]:
        """How far points move when one is moved so far, and the work of what moves it."""
        network, held, forces = self.stiffness.network, self.s * 0, dict[int, Quantity]()
        parts: list[Bar | Link] = [*network.bars, *network.links]
        for part in parts:
            if isinstance(part, Bar):
                ratios = part.ratios
                near, far = (each * self.number(part.impedance) for each in self.bars[part.delay])
            else:
                ratios = part.ratio, fmpq(1)
                near = far = self.number(part.stiffness) + self.s * self.number(part.damping)
            ends = (part.left, part.right), (part.right, part.left)
            for (here, there), ratio, other in zip(ends, ratios, reversed(ratios), strict=True):
                if here == point:
                    held = held + near * self.number(ratio) ** 2
                    forces[there] = forces.get(there, self.s * 0) + far * self.number(ratio) * self.number(other)
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
