"""Bars in a line that strike each other: an exact solver of its own, which steps from instant to instant.

Bars carry waves that are constant between fronts, nothing has mass, nothing acts: then all velocities are constant
between one arrival of a front, or one closing of a gap, and the next. Fractions, no law of the package.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field
from fractions import Fraction
from operator import itemgetter


@dataclass
class Rod:
    """Its travel time, impedance and velocity; and the waves under way: when they come to the right and left end."""

    delay: Fraction
    impedance: Fraction
    velocity: Fraction
    coming: tuple[list[tuple[Fraction, Fraction]], list[tuple[Fraction, Fraction]]] = field(
        default_factory=lambda: ([], [])
    )
    arrived: list[Fraction] = field(default_factory=list)
    sent: list[Fraction] = field(default_factory=list)
    history: tuple[list[tuple[Fraction, Fraction]], list[tuple[Fraction, Fraction]]] = field(
        default_factory=lambda: ([], [])
    )
    """What was sent from the left and from the right end, and from when on."""

    def __post_init__(self) -> None:
        self.arrived = [self.velocity / 2, self.velocity / 2]
        self.sent = [self.velocity / 2, self.velocity / 2]

    def waves(self, place: Fraction, tau: Fraction) -> tuple[Fraction, Fraction]:
        """What goes to the right and to the left, as velocities, at a part of its length."""
        found = []
        for history, way in zip(self.history, (place, 1 - place), strict=True):
            before = bisect_right(history, tau - way * self.delay, key=itemgetter(0))
            found.append(history[before - 1][1] if before else self.velocity / 2)
        return found[0], found[1]


@dataclass
class Struck:
    """`between[k]` is left of rod k: "joint", "free", "fixed", "absorbing" (at the ends), or the gap of a contact.

    At the ends of the line a gap is that to a wall.
    """

    rods: list[Rod]
    between: list[str | Fraction]

    def events(self, until: Fraction) -> list[tuple[int, str, Fraction]]:
        """What contacts do, up to `until`: the number of the place, what, and when."""
        gaps = {k: gap for k, gap in enumerate(self.between) if isinstance(gap, Fraction)}
        closed = {k for k, gap in gaps.items() if gap == 0}
        found, now = [], Fraction(0)
        while True:
            rates = {}
            for k in range(len(self.between)):
                ends = self._ends(k)
                free = [self.rods[rod].arrived[side] * 2 for rod, side in ends]
                if k in gaps:
                    left, right = self._sides(k, free)
                    if gaps[k] == 0:
                        shut = right <= left  # at rest beside each other they touch
                        if shut != (k in closed):
                            found.append((k, "closes" if shut else "opens", now))
                        closed = closed | {k} if shut else closed - {k}
                    if k in closed:
                        free = [self._common(ends, walls=k in (0, len(self.rods)))] * len(ends)
                    else:
                        rates[k] = right - left
                elif self.between[k] == "fixed":
                    free = [Fraction(0)]
                elif self.between[k] == "absorbing":
                    free = [self.rods[rod].arrived[side] for rod, side in ends]
                elif self.between[k] == "joint":
                    free = [self._common(ends, walls=False)] * 2
                for (rod, side), velocity in zip(ends, free, strict=True):
                    self._send(rod, side, velocity - self.rods[rod].arrived[side], now)
            times = [each[0][0] for rod in self.rods for each in rod.coming if each]
            times += [now + gaps[k] / -rate for k, rate in rates.items() if rate < 0]
            then = min(times, default=until + 1)
            if then > until:
                return found
            for k, rate in rates.items():
                gaps[k] += rate * (then - now)
            now = then
            for rod in self.rods:
                for side in (0, 1):
                    while rod.coming[side] and rod.coming[side][0][0] == now:
                        rod.arrived[side] = rod.coming[side].pop(0)[1]

    def _ends(self, k: int) -> list[tuple[int, int]]:
        return [(k - 1, 1)] * (k > 0) + [(k, 0)] * (k < len(self.rods))

    def _sides(self, k: int, free: list[Fraction]) -> tuple[Fraction, Fraction]:
        if k == 0:
            return Fraction(0), free[0]
        return (free[0], Fraction(0)) if k == len(self.rods) else (free[0], free[1])

    def _common(self, ends: list[tuple[int, int]], walls: bool) -> Fraction:
        if walls:
            return Fraction(0)
        weight = sum((self.rods[rod].impedance for rod, _ in ends), Fraction(0))
        pushed = sum((2 * self.rods[rod].impedance * self.rods[rod].arrived[side] for rod, side in ends), Fraction(0))
        return pushed / weight

    def _send(self, rod: int, side: int, wave: Fraction, now: Fraction) -> None:
        if wave != self.rods[rod].sent[side]:
            self.rods[rod].sent[side] = wave
            self.rods[rod].history[side].append((now, wave))
            self.rods[rod].coming[1 - side].append((now + self.rods[rod].delay, wave))
