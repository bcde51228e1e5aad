"""The shape that a chain has when it vibrates with one of its frequencies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

from flint import acb, arb, fmpq

from wavesym.exact.modes.stiffness import HarmonicLaw, Quantity, Stiffness, cot_csc
from wavesym.mechanics.network import End, Network

_I = acb(0, 1)


@dataclass(frozen=True)
class Mode:
    """A frequency, and how far each point moves in the shape whose kinetic energy at velocity 1 is 1/2: balls.

    `points` are by their numbers in the network, and 0 where one does not move. Energies count those of the bars, too.
    Where there are dashpots all is complex, and the mass is that of `Trial`. Bars that swing between ends at rest have
    `amplitudes`: u = a sin w s, s the delay from the left end. Of frequency 0 are rigid motion, whose velocity lasts,
    and a shift that `stays` where it is, as dashpots resist the motion to it.
    """

    stiffness: Stiffness
    frequency: Quantity
    points: Sequence[Quantity]
    amplitudes: Mapping[int, Quantity] = field(default_factory=dict)
    stays: bool = False

    def displacement(self, end: End) -> Quantity:
        """How far the end of a bar moves."""
        bar = self.stiffness.network.bars[end.bar]
        return self.points[bar.right if end.side else bar.left] * bar.ratios[end.side]

    def slope(self, end: End) -> Quantity:
        """The strain there times the bar's speed."""
        if self.frequency == 0:
            return arb(0)
        here, there = self.displacement(end), self.displacement(End(end.bar, 1 - end.side))
        sine, cosine = self.turn(self.stiffness.network.bars[end.bar].delay)
        if self.amplitudes and here == 0 and there == 0:
            slope = self.frequency * self.amplitudes.get(end.bar, arb(0))
            return slope * cosine if end.side else slope
        slope = self.frequency * (there - here * cosine) / sine
        return -slope if end.side else slope

    def pull(self, point: int) -> Quantity:
        """What bars and links pull at a point that is at rest."""
        network, pull = self.stiffness.network, arb(0)
        for number, bar in enumerate(network.bars):
            if bar.left == point:
                pull += self.slope(End(number, 0)) * (bar.impedance * bar.ratios[0])
            if bar.right == point:
                pull -= self.slope(End(number, 1)) * (bar.impedance * bar.ratios[1])
        for link in network.links:
            if point in (link.left, link.right):
                moved = self.points[link.right if link.left == point else link.left]
                pull += moved * (link.ratio * link.stiffness)
                if link.damping != 0:
                    pull += moved * (self.frequency * acb(0, link.ratio * link.damping))
        return pull

    def to_complex(self) -> Mode:
        """The same in complex numbers, as modes with dashpots are."""
        return replace(self, frequency=acb(self.frequency), points=[acb(q) for q in self.points])

    def turn(self, delay: fmpq) -> tuple[Quantity, Quantity]:
        """sin and cos of the frequency times a delay."""
        if delay not in self._turns:
            self._turns[delay] = (self.frequency * delay).sin_cos()
        return self._turns[delay]

    @cached_property
    def _turns(self) -> dict[fmpq, tuple[Quantity, Quantity]]:
        return {}


@dataclass(frozen=True)
class FoundModes:
    """Modes by the absolute values of their frequencies.

    Attributes:
        modes: those at 0 first, rigid motion before shifts; each as often as its frequency is one.
        reach: up to which absolute value none is missed.
        meeting: where two or more frequencies meet that are not told apart, the least such place; None where none are
            known to.
        are_roots: whether they are the roots of a polynomial.
        is_open: whether some that were sought are not proved, and may be where rods are cut once more.
    """

    modes: list[Mode]
    reach: float
    meeting: float | None = None
    are_roots: bool = False
    is_open: bool = False


def rigid(network: Network) -> tuple[fmpq, ...] | None:
    """How far each point moves when all does without strain, exact; None where something holds the chain."""
    groups = unstrained_groups(network)
    if len(groups) != 1 or len(groups[0]) != len(network.points):
        return None
    return tuple(groups[0][number] for number in range(len(network.points)))


def unstrained_groups(network: Network) -> list[dict[int, fmpq]]:
    """Groups of points that rods and springs tie to each other and nothing holds: how far each moves without strain.

    Dashpots hold nothing that is at rest. The first point of each group moves by 1.
    """
    beside: dict[int, list[tuple[int, fmpq]]] = {number: [] for number in range(len(network.points))}
    pairs = [(bar.left, bar.right, bar.ratios[0], bar.ratios[1]) for bar in network.bars]
    pairs += [(link.left, link.right, link.ratio, fmpq(1)) for link in network.links if link.stiffness != 0]
    for left, right, there, here in pairs:
        beside[left].append((right, there / here))
        beside[right].append((left, here / there))
    found: list[dict[int, fmpq]] = []
    met: set[int] = set()
    for first in beside:
        if first in met:
            continue
        group, coming, held = {first: fmpq(1)}, [first], False
        for number in coming:
            point = network.points[number]
            held = held or point.motion is not None or point.stiffness != 0
            for other, ratio in beside[number]:
                if other not in group:
                    coming.append(other)
                held |= group.setdefault(other, group[number] * ratio) != group[number] * ratio
        met.update(group)
        if not held:
            found.append(group)
    return found


def rigid_mass(network: Network, free: tuple[fmpq, ...]) -> fmpq:
    """Twice the energy of the motion without strain, by how fast each point moves in it."""
    masses = (point.mass * q * q for point, q in zip(network.points, free, strict=True))
    bars = (bar.impedance * bar.delay * (bar.ratios[0] * free[bar.left]) ** 2 for bar in network.bars)
    return sum((*masses, *bars), fmpq(0))


def rigid_mode(stiffness: Stiffness, free: tuple[fmpq, ...]) -> Mode:
    """The motion without strain, by how far each point moves in it; of mass 1."""
    scale = arb(rigid_mass(stiffness.network, free)).rsqrt()
    return Mode(stiffness, arb(0), [scale * q for q in free])


class Trial(NamedTuple):
    """How far each row moves; all of them are in balance but row `root`, on which the `rest` acts; and the mass.

    Where there are dashpots all is complex, and part of the mass is what they resist over 2 i w: that, too, is the
    w^2-derivative of -K.
    """

    rows: list[Quantity]
    root: int
    rest: Quantity
    mass: Quantity

    def better(self, w: Quantity) -> Quantity:
        """A better frequency than w: Newton's method, as the w^2-derivative of -K, seen by a shape, is its mass."""
        return (w * w + self.rest * self.rows[self.root] / self.mass).sqrt().mid()


def trial(stiffness: Stiffness, law: HarmonicLaw, w: Quantity, root: int, rate: Quantity = None) -> Trial:
    """How the chain moves at a frequency where only row `root` is held. Where nothing acts on it that is a mode.

    Where there are dashpots `rate` is i w.

    Determinants of branches instead of pivots: a part of the chain may have the same frequency as the whole.
    """
    cot, csc = cot_csc(law, w)
    diagonal, up = law.matrix(w, cot, csc, rate)
    order = stiffness.orders(root)
    # of each branch its determinant, and that without the row it hangs by: the product of those of its branches
    whole, inner = list(diagonal), [arb(1)] * len(diagonal)
    for row, parent, edge in reversed(order[1:]):
        whole[parent] = whole[parent] * whole[row] - up[edge] * up[edge] * inner[row] * inner[parent]
        inner[parent] = inner[parent] * whole[row]
    scale = [arb(1)] * len(diagonal)
    hanging: dict[int, list[int]] = {}
    for row, parent, _ in order[1:]:
        hanging.setdefault(parent, []).append(row)
    for row, parent, edge in order[1:]:
        scale[row] = -up[edge] * scale[parent]
        for other in hanging[parent]:
            if other != row:
                scale[row] *= whole[other]
    rows = [a * b for a, b in zip(scale, inner, strict=True)]
    mass = moved_mass(law, w, rows, stiffness.parents, cot, csc)
    if rate is not None:
        mass += _resistance(law, rows, stiffness.parents) / (2 * rate)
    return Trial(rows, root, whole[root], mass)


def complex_mode(stiffness: Stiffness, law: HarmonicLaw, w: Quantity, root: int, sharp: arb) -> Mode | None:
    """The mode of mass 1 at a complex frequency, a ball, in which row `root` moves; None where it is not `sharp`."""
    made = trial(stiffness, law, w, root, _I * w)
    # a square root away from where it jumps
    scale = (-made.mass).rsqrt() * _I if made.mass.real.mid() < 0 else made.mass.rsqrt()
    points = stiffness.point_motions([row * scale for row in made.rows])
    is_sharp = all(q.real.rad() < sharp and q.imag.rad() < sharp for q in points)
    return Mode(stiffness, w, points) if is_sharp else None


def _resistance(law: HarmonicLaw, found: Sequence[Quantity], parents: Sequence[int | None]) -> Quantity:
    """What dashpots resist at velocities q, seen by q."""
    total = sum((c * q * q for c, q in zip(law.damping, found, strict=True)), arb(0))
    for c, q, parent in zip(law.coupling_damping, found, parents, strict=True):
        total += 2 * c * q * found[parent or 0]
    return total


def moved_mass(
    law: HarmonicLaw,
    w: Quantity,
    found: Sequence[Quantity],
    parents: Sequence[int | None],
    cot: Sequence[Quantity],
    csc: Sequence[Quantity],
) -> Quantity:
    """The generalised mass of a shape: the sum of M q^2, and of the integrals of Z u^2 over the delays of the bars.

    Args:
        law: masses, and the impedances of bars by rows.
        w: the frequency, in rad per tau.
        found: the displacement q of each row.
        parents: the row that each row hangs on; None for the root.
        cot, csc: cot and 1/sin of w times each delay of the law.
    """
    # u = (left sin w(T - s) + right sin w s)/sin w T, so that its square has the integral
    # (left^2 + right^2) same + 2 left right other
    same = [(t * s * s - c / w) / 2 for t, c, s in zip(law.delays, cot, csc, strict=True)]
    other = [s / w - t * c * s for t, c, s in zip(law.delays, cot, csc, strict=True)]
    total: Quantity = 0
    for q, mass, weights in zip(found, law.mass, law.ends, strict=True):
        for delay, weight in weights:
            mass = mass + weight * same[delay]
        total = total + mass * q * q
    for q, parent, weights in zip(found, parents, law.bars, strict=True):
        for delay, weight in weights:
            total = total + weight * other[delay] * q * found[parent or 0]
    return total
