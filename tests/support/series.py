"""Functions of time piece by piece, each a power series with some 50 digits: their values, signs and zeros.

Nothing of the package is used. Any two numbers are the same where they differ by less than `SAME`: nothing is proved.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

from flint import arb, arb_poly, fmpq

BITS = 400
SAME = fmpq(1, 10**40)

# where what crosses 0 is as flat as this, it may only touch it
_FLAT = arb(2) ** -50


class Unclear(AssertionError):
    """A guard touches 0 for an instant, or no choice of branches would do."""


class Piece(NamedTuple):
    """A series from `start` on, for one step."""

    start: fmpq
    series: arb_poly

    def at(self, tau: fmpq) -> arb:
        return self.series(arb(tau - self.start))

    def moved(self, start: fmpq) -> arb_poly:
        """The series about a later instant."""
        return self.series if start == self.start else self.series(arb_poly([arb(start - self.start), 1]))


@dataclass
class History:
    """A function of time, piece by piece; before tau = 0 it is constant."""

    before: fmpq
    pieces: list[Piece] = field(default_factory=list)
    sums: list[arb] = field(default_factory=list)
    """The integral from 0 to the start of each piece."""

    def add(self, piece: Piece) -> None:
        last = self.pieces[-1] if self.pieces else None
        gained = last.series.integral()(arb(piece.start - last.start)) if last else arb(0)
        self.sums.append(((self.sums[-1] if self.sums else arb(0)) + gained).mid())
        self.pieces.append(piece)

    def index(self, tau: fmpq) -> int:
        """The piece that begins last of those that begin by then; -1 before all."""
        low, high = 0, len(self.pieces)
        while low < high:
            middle = (low + high) // 2
            if self.pieces[middle].start <= tau + SAME:
                low = middle + 1
            else:
                high = middle
        return low - 1

    def about(self, tau: fmpq, step: fmpq) -> arb_poly:
        """The series from tau on, which holds for a step."""
        found = self.index(tau + step / 2)
        return arb_poly([arb(self.before)]) if found < 0 else self.pieces[found].moved(tau)

    def value(self, tau: fmpq) -> arb:
        found = self.index(tau)
        return arb(self.before) if found < 0 else self.pieces[found].at(tau)

    def integral(self, tau: fmpq) -> arb:
        """From 0 to tau, which may be negative."""
        found = self.index(tau)
        if found < 0:
            return arb(self.before * tau)
        piece = self.pieces[found]
        return self.sums[found] + piece.series.integral()(arb(tau - piece.start))

    def square(self, start: fmpq, end: fmpq) -> arb:
        """The integral of its square from one instant to another."""
        cuts = [start, *(piece.start for piece in self.pieces if start < piece.start < end), end]
        total = arb(0)
        for low, high in pairwise(cuts):
            if high - low > SAME:
                series = self.about(low, high - low)
                total += (series * series).integral()(arb(high - low))
        return total


def is_zero(number: arb, size: arb | int = 1) -> bool:
    """Whether it differs from 0 by less than two numbers that are the same."""
    return bool(abs(number.mid()) <= arb(SAME) * (1 + abs(size)))


def middle(series: arb_poly) -> arb_poly:
    """Without its radii, which grow as no error does."""
    return arb_poly([coefficient.mid() for coefficient in series.coeffs()])


def sign_after(series: arb_poly, step: fmpq) -> int:
    """The sign of a series just after its start: 0 if it stays 0."""
    scale = arb(1)
    for coefficient in series.coeffs():
        if not is_zero(coefficient * scale):
            return 1 if coefficient > 0 else -1
        scale *= arb(step)
    return 0


def first_fall(series: arb_poly, step: fmpq) -> fmpq | None:
    """When a series that begins positive, or is 0 for long, first becomes negative; None if not within the step.

    Raises Unclear where it touches 0.
    """
    coefficients = series.coeffs()
    scale = arb(1)
    while coefficients and is_zero(coefficients[0] * scale):
        coefficients = coefficients[1:]
        scale *= arb(step)
    if not coefficients:
        return None
    rest = arb_poly(coefficients)
    slope = rest.derivative()
    waiting = [(fmpq(0), step)]
    while waiting:
        low, high = waiting.pop()
        half = (low + high) / 2
        there = arb(half, (high - low) / 2)
        bent = slope(there)
        value = rest(arb(half)) + bent * arb(0, (high - low) / 2)
        if value > 0:
            continue
        if not bent.contains(0) or high - low < SAME:
            last = rest(arb(high))
            if high - low < SAME:
                if last < 0:
                    return high
                raise Unclear("touches 0")
            if last > 0 and not is_zero(last):
                continue
            if bent > 0:
                raise Unclear("negative at first")
            found = _crossing(rest, low, high)
            if abs(slope(arb(found))) < _FLAT:
                raise Unclear("touches 0")
            return found
        waiting += [(half, high), (low, half)]
    return None


def _crossing(series: arb_poly, low: fmpq, high: fmpq) -> fmpq:
    """By bisection."""
    if is_zero(series(arb(high))):
        return high
    while high - low > SAME / 2**40:
        half = (low + high) / 2
        if series(arb(half)) > 0:
            low = half
        else:
            high = half
    return high
