"""The shape that a chain has when it vibrates with one of its frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, fmpq

from wavesym.exact.modes.stiffness import Law, Stiffness, circular
from wavesym.model.network import End, Network


@dataclass(frozen=True)
class Mode:
    """A frequency, and how far each point moves in the shape whose kinetic energy at velocity 1 is 1/2: balls.

    `points` are by their numbers in the network, and 0 where one does not move. Energies count those of the bars, too.
    """

    stiffness: Stiffness
    frequency: arb
    points: Sequence[arb]

    def at(self, end: End) -> arb:
        """How far the end of a bar moves."""
        bar = self.stiffness.network.bars[end.bar]
        return arb(bar.ratios[end.side]) * self.points[bar.right if end.side else bar.left]

    def slope(self, end: End) -> arb:
        """The strain there times the bar's speed."""
        w, here, there = self.frequency, self.at(end), self.at(End(end.bar, 1 - end.side))
        if w == 0:
            return arb(0)
        sine, cosine = (w * self.stiffness.network.bars[end.bar].delay).sin_cos()
        slope = w * (there - here * cosine) / sine
        return -slope if end.side else slope


def rigid(network: Network) -> tuple[fmpq, ...] | None:
    """How far each point moves when all does without strain, exact; None where something holds the chain."""
    if any(point.motion or point.stiffness != 0 for point in network.points):
        return None
    pairs = [(bar.left, bar.right, bar.ratios[0], bar.ratios[1]) for bar in network.bars]
    pairs += [(link.left, link.right, link.ratio, fmpq(1)) for link in network.links if link.stiffness != 0]
    found: dict[int, fmpq] = {0: fmpq(1)}
    for _ in network.points:
        for left, right, there, here in pairs:
            if left in found:
                found.setdefault(right, found[left] * there / here)
            elif right in found:
                found[left] = found[right] * here / there
    if any(found[left] * there != found[right] * here for left, right, there, here in pairs):
        return None
    return tuple(found[number] for number in range(len(network.points)))


def shape(stiffness: Stiffness, law: Law, w: arb) -> tuple[Sequence[arb], arb, arb]:
    """What moves how far at a frequency w (rows of K), with the largest as 1; its K(w) there; and its mass.

    All other rows are in balance: K(w) times the shape is 0 but in the row of the largest. Where that is 0, too, w is a
    frequency, and else w^2 + K/mass is a better one, squared (Newton's method, as -dK/dw^2 of a shape is its mass).
    """
    cot, csc = circular(law, w)
    diagonal, up = law.matrix(w, cot, csc)
    d = stiffness.pivots(diagonal, up)
    parents, count = stiffness.parents, len(d)
    push = [up[row] * up[row] / d[row] for row in range(count)]
    # what is left of a row once all others are eliminated; `without` is a parent's without the branch of the row
    left, without = list(d), list(d)
    for row in reversed(range(count)):
        parent = parents[row]
        if parent is not None:
            without[row] = left[parent] + push[row]
            left[row] = d[row] * left[parent] / without[row]
    largest = min(range(count), key=lambda row: abs(float(left[row].mid())))
    found: list[arb | None] = [None] * count
    found[largest] = arb(1)
    row, parent = largest, parents[largest]
    while parent is not None:
        found[parent] = -up[row] * found[row] / without[row]
        row, parent = parent, parents[parent]
    for row in reversed(range(count)):
        if found[row] is None:
            parent = parents[row]
            found[row] = arb(0) if parent is None else -up[row] * found[parent] / d[row]
    return found, left[largest], _mass(law, w, found, cot, csc)  # type: ignore[return-value]


def _mass(law: Law, w: arb, found: Sequence[arb], cot: Sequence[arb], csc: Sequence[arb]) -> arb:
    """The sum of M q^2, and of the integrals of Z u^2 over the delays of the bars."""
    total = sum((mass * q * q for mass, q in zip(law.mass, found, strict=True) if mass != 0), arb(0))
    # u = (left sin w(T - s) + right sin w s)/sin w T, so that its square has the integral
    # (left^2 + right^2) same + 2 left right other
    same = [(t * s * s - c / w) / 2 for t, c, s in zip(law.delays, cot, csc, strict=True)]
    other = [(s / w - t * c * s) / 2 for t, c, s in zip(law.delays, cot, csc, strict=True)]
    for bar in law.bars:
        if bar.left is not None:
            total += bar.at_left * found[bar.left] ** 2 * same[bar.delay]
        if bar.right is not None:
            total += bar.at_right * found[bar.right] ** 2 * same[bar.delay]
            if bar.left is not None:
                total += 2 * bar.across * found[bar.left] * found[bar.right] * other[bar.delay]
    return total
