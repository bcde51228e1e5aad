"""The damping ratios of all modes, and what is known of those of higher ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, sqrt

import numpy as np

from wavesym.errors import UnservedError
from wavesym.mechanics.damping import Damping
from wavesym.numbers.doubles import nearest
from wavesym.programs.modes.modal import Numbers


@dataclass(frozen=True)
class Damped:
    """`ratios` of the first modes with strain, and for all higher ones the last; or a/w + b w, halved, for all."""

    ratios: tuple[float, ...] = (0.0,)
    rayleigh: tuple[float, float] | None = None

    def of(self, w: Numbers) -> Numbers:
        """The ratios at ascending frequencies from the first on; 0 for a motion without strain."""
        strained = w > 0
        made = np.zeros(len(w))
        if self.rayleigh:
            a, b = self.rayleigh
            made[strained] = (a / w[strained] + b * w[strained]) / 2
        else:
            number = np.minimum(np.arange(np.count_nonzero(strained)), len(self.ratios) - 1)
            made[strained] = np.array(self.ratios)[number]
        return made

    def least(self, w: float, count: int) -> float:
        """The least ratio of all modes with a frequency of at least w, which follow after `count` with strain."""
        if not self.rayleigh:
            return min(self.ratios[min(count, len(self.ratios) - 1) :])
        a, b = self.rayleigh
        return sqrt(a * b) if b * w * w < a else (a / w + b * w) / 2

    def most(self, count: int) -> float:
        """The largest ratio of these modes."""
        return inf if self.rayleigh else max(self.ratios[min(count, len(self.ratios) - 1) :])


def damped(damping: Damping | None, w: Sequence[float]) -> Damped:
    """What a scene says of damping, for modes whose first frequencies with strain are w.

    UnservedError where two modes with one frequency have ratios of their own, as then it is open which modes they are.
    """
    if damping is None:
        return Damped()
    ratio = nearest(damping.ratios[0])
    if damping.modes is None or ratio == 0:
        ratios = tuple(map(nearest, damping.ratios))
        for number, (one, other) in enumerate(pairwise(ratios[: len(w)]), 1):
            if one != other and w[number - 1] == w[number]:
                raise UnservedError(
                    f"system.damping: {one:g} and {other:g} given for modes {number} and {number + 1}, which have one "
                    f"frequency, {w[number]:g}; the same ratio expected for both"
                )
        return Damped(ratios)
    first, second = (w[number - 1] for number in damping.modes)
    return Damped(rayleigh=(2 * ratio * first * second / (first + second), 2 * ratio / (first + second)))
