"""What the modes that are left out can add to an output: proved.

Let f be a load, linear between instants, and e what a mode does from the displacement 1. Without what the load would do
if it did not change, a mode of mass 1 that has the share b of the load moves by b/w^2 times r, r' and r'' follow:

    r(tau) = -integral of f'(s) e(tau - s)

Kinks d_k of the load at t_k each add a swing of d_k/w times exp(-damping w (tau - t_k)), over sqrt(1 - damping^2), and
what does not swing is at most 2 damping/w times the steepest slope of f. With damping of 1 and more e has no more sign
than one, and |r| <= 2 damping/w times the steepest. So r is at most c/w, r' at most c', r'' at most c'' w.

Rayleigh's damping a/w + b w grows: all high modes lag behind the load alike. What they do is one more oscillator for
each load, which is far above them, and the rest is smaller by another 1/w^2: of y + b y' = f differ the higher modes
by at most (2/b + a)/w^2 times the steepest.

The sum over all modes left out of |l_n b_n|/w_n^a is at most that of l_n^2/w_n^(2p) times that of b_n^2/w_n^(2q), under
a root, and the least w to the power p + q - a. These sums are known: over all modes in closed form (statics.py), less
those that are taken.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt
from typing import NamedTuple

from wavesym.programs.modes.damped import Damped
from wavesym.programs.modes.roughness import Roughness


class Decline(NamedTuple):
    """A mode with shares l and b adds at most size |l b|/w^power."""

    size: float
    power: int


@dataclass(frozen=True)
class LeftOut:
    """The modes after the first `count` with strain, none of which has a frequency below w."""

    damped: Damped
    w: float
    count: int

    def declines(self, load: Roughness) -> tuple[Decline, Decline, Decline]:
        """Of what a load does to their displacements (beyond statics, or the lag), velocities and accelerations."""
        steep, least = load.steepest, self.damped.least(self.w, self.count)
        if self.damped.rayleigh:
            a, b = self.damped.rayleigh
            late = steep * (2 / b + a)
            return Decline(late / min(1.0, least) ** 2, 4), Decline(4 * late / b, 4), Decline(4 * steep / b, 2)
        most = self.damped.most(self.count)
        swing = inf
        if most < 1:
            swing = (load.swing(least * self.w) if most else load.in_step) / sqrt(1 - most * most)
        crept = steep / least if least else inf
        return (
            Decline(min(swing + 2 * most * steep, max(2 * crept, 2 * most * steep)), 3),
            Decline(min(steep + swing, crept / least if least < 1 else steep) if least else steep + swing, 2),
            Decline(min(swing, 2 * crept), 1),
        )

    @property
    def lags(self) -> bool:
        """Whether they lag behind a load alike."""
        return self.damped.rayleigh is not None

    @property
    def above(self) -> float:
        """The frequency of the oscillator that stands for all of them where they lag alike."""
        return 8 * self.w
