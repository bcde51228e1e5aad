"""Time as users of a physical scene read it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction

from flint import fmpq

from wavesym.numbers.doubles import nearest, not_below, rational

_TAU = re.compile(r"(?<!w)tau = ([0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]+)?)|([0-9][0-9.e+-]*) units of tau")


@dataclass(frozen=True)
class Clock:
    """One tau is `seconds` long, and `per_tau` of the `unit` that results are told in."""

    seconds: fmpq
    per_tau: fmpq
    unit: str = "s"

    def time(self, tau: fmpq) -> float:
        """The double nearest to a tau in the unit."""
        return nearest(tau * self.per_tau)

    def format(self, tau: fmpq) -> str:
        """A tau in the unit, for people."""
        return f"{self.time(tau):.9g} {self.unit}"

    def append_times(self, text: str) -> str:
        """A message that speaks of tau, with what that is in the unit behind each."""
        per_tau = nearest(self.per_tau)
        return _TAU.sub(lambda found: f"{found[0]} ({float(found[1] or found[2]) * per_tau:.5g} {self.unit})", text)

    def tau(self, time: float, until: fmpq) -> float:
        """The smallest double of tau not below a time, which stands for the shortest decimal that reads back to it.

        So what begins at that decimal has begun. A time that is rounded from the horizon's, `until`, is within it.
        """
        if not math.isfinite(time):
            return math.nan
        last = not_below(until)
        tau = not_below(rational(Fraction(repr(time))) / self.per_tau)
        return min(tau, last) if time <= self.time(until) else tau
