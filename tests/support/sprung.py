"""Masses, dashpots and springs that act on one side or yield, from event to event in 50 digits.

Nothing of the package is used. Between events the state, displacements and velocities, obeys y' = A y + b, whose Taylor
series is summed; a guard that changes its sign in a small step is located by bisection.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import mpmath as mp

DIGITS, ORDER, STEP, FINE = 50, 40, 0.125, 32


@dataclass
class LawSpring:
    """A spring from a point to another one, or to the ground (None); pulls where `right` is farther."""

    left: int | None
    right: int | None
    stiffness: mp.mpf
    side: int = 0
    gap: mp.mpf = field(default_factory=mp.mpf)
    limits: tuple[mp.mpf, mp.mpf] | None = None
    mode: int = 0  # on one side 1 acting, 0 idle; of what yields 0 holding, 1 or -1 yielding
    plastic: mp.mpf = field(default_factory=mp.mpf)
    name: str = ""

    def lengthening(self, values: Sequence[mp.mpf]) -> mp.mpf:
        right = mp.mpf(0) if self.right is None else values[self.right]
        return right - (mp.mpf(0) if self.left is None else values[self.left])

    def pull(self) -> tuple[mp.mpf, mp.mpf]:
        """The factor of its lengthening in its force, and the rest."""
        if self.limits is None:
            if self.side == 0:
                return self.stiffness, mp.mpf(0)
            return (self.stiffness, -self.stiffness * self.side * self.gap) if self.mode else (mp.mpf(0), mp.mpf(0))
        if self.mode:
            return mp.mpf(0), self.limits[0] if self.mode > 0 else -self.limits[1]
        return self.stiffness, -self.stiffness * self.plastic

    def guards(self, x: Sequence[mp.mpf], v: Sequence[mp.mpf]) -> list[tuple[mp.mpf, int]]:
        """What may not become negative, and the branch that follows."""
        e = self.lengthening(x)
        if self.limits is None:
            over = self.side * e - self.gap
            return [] if self.side == 0 else [(over, 0)] if self.mode else [(-over, 1)]
        if self.mode:
            return [(self.mode * self.lengthening(v), 0)]
        force = self.stiffness * (e - self.plastic)
        return [(self.limits[0] - force, 1), (force + self.limits[1], -1)]

    def go(self, mode: int, x: Sequence[mp.mpf]) -> str:
        """To another branch; what happens."""
        if self.limits is not None and mode == 0:
            pull = self.limits[0] if self.mode > 0 else -self.limits[1]
            self.plastic = self.lengthening(x) - pull / self.stiffness
        self.mode = mode
        if self.limits is None:
            return "engages" if mode else "lets go"
        return "yields" if mode else "holds"


@dataclass
class Sprung:
    """Masses with dashpots to the ground, springs, and forces that jump: (time, point, by how much)."""

    masses: list[mp.mpf]
    dashpots: list[mp.mpf]
    springs: list[LawSpring]
    velocities: list[mp.mpf]
    jumps: list[tuple[mp.mpf, int, mp.mpf]]

    def run(self, taus: Sequence[mp.mpf]) -> tuple[list[tuple[str, str, mp.mpf]], list[list[mp.mpf]]]:
        """What happens until the last of some instants, and displacements, then velocities, at each of them."""
        with mp.workdps(DIGITS):
            n = len(self.masses)
            x, v, force = [mp.mpf(0)] * n, list(self.velocities), [mp.mpf(0)] * n
            happened: list[tuple[str, str, mp.mpf]] = []
            found: list[list[mp.mpf]] = []
            stops = sorted({*taus, *(time for time, _, _ in self.jumps)})
            now = mp.mpf(0)
            for stop in stops:
                while now < stop:
                    length = min(mp.mpf(STEP), stop - now)
                    series = self._series(x, v, force)
                    event = self._first(series, length)
                    if event is None:
                        x, v = self._at(series, length)
                        now = stop if length == stop - now else now + length
                        continue
                    length, spring, mode = event
                    x, v = self._at(series, length)
                    now += length
                    happened.append((spring.go(mode, x), spring.name, now))
                for time, point, size in self.jumps:
                    force[point] += size if time == stop else 0
                if stop in taus:
                    found.append([*x, *v])
            return happened, found

    def _series(self, x: list[mp.mpf], v: list[mp.mpf], force: list[mp.mpf]) -> list[list[mp.mpf]]:
        """Taylor coefficients of displacements."""
        n, pulls = len(self.masses), [spring.pull() for spring in self.springs]
        series = [list(x), list(v)]
        for k in range(ORDER):
            acting = [(force[i] if k == 0 else 0) - self.dashpots[i] * (k + 1) * series[k + 1][i] for i in range(n)]
            for spring, (factor, rest) in zip(self.springs, pulls, strict=True):
                pull = factor * spring.lengthening(series[k]) + (rest if k == 0 else 0)
                if spring.right is not None:
                    acting[spring.right] -= pull
                if spring.left is not None:
                    acting[spring.left] += pull
            series.append([acting[i] / self.masses[i] / ((k + 1) * (k + 2)) for i in range(n)])
        return series

    @staticmethod
    def _at(series: list[list[mp.mpf]], t: mp.mpf) -> tuple[list[mp.mpf], list[mp.mpf]]:
        n = len(series[0])
        powers = [t**k for k in range(len(series))]
        x = [mp.fsum(powers[k] * series[k][i] for k in range(len(series))) for i in range(n)]
        v = [mp.fsum(k * powers[k - 1] * series[k][i] for k in range(1, len(series))) for i in range(n)]
        return x, v

    def _first(self, series: list[list[mp.mpf]], length: mp.mpf) -> tuple[mp.mpf, LawSpring, int] | None:
        """The first guard that becomes negative, and when."""

        def negative(t: mp.mpf) -> tuple[LawSpring, int] | None:
            x, v = self._at(series, t)
            for spring in self.springs:
                for value, mode in spring.guards(x, v):
                    if value < -(mp.mpf(10) ** (-DIGITS + 8)):
                        return spring, mode
            return None

        for k in range(1, FINE + 1):
            high = length * k / FINE
            if (found := negative(high)) is not None:
                low = length * (k - 1) / FINE
                for _ in range(4 * DIGITS):
                    half = (low + high) / 2
                    if (there := negative(half)) is not None:
                        high, found = half, there
                    else:
                        low = half
                return high, *found
        return None
