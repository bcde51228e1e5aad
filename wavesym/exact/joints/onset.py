"""The first powers of a function that begins at a knot, exact, though it is no polynomial.

Balls cannot tell how a function leaves 0. But what is at rest, or moves as is known exactly, begins with powers that
are rational, whatever comes later: f(w) = c_0 + c_1 w + ... + c_(n-1) w^(n-1) + r, |r| <= beyond w^n. For small w the
first of these that is not 0 has the last word, and coarse bounds of derivatives tell how small (see `joint_onset`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import perm

from flint import arb, fmpq, fmpq_poly

ORDER = 6


@dataclass(frozen=True)
class Onset:
    """Up to ORDER powers; the rest is at most `beyond` times the next one."""

    powers: fmpq_poly
    beyond: arb

    @classmethod
    def of(cls, exact: fmpq_poly) -> Onset | None:
        """Of a polynomial; None where it has more powers."""
        return cls(exact, arb(0)) if exact.length() <= ORDER else None

    def sign(self) -> int:
        """Just after the start; 0 where these powers do not tell."""
        first = next((c for c in self.powers.coeffs() if c != 0), fmpq(0))
        return (first > 0) - (first < 0)

    def positive_until(self, length: fmpq) -> fmpq:
        """How long it is certainly positive, about; 0 where it does not begin so."""
        if self.sign() <= 0:
            return fmpq(0)
        c = self.powers.coeffs()
        first = next(n for n, value in enumerate(c) if value != 0)
        w = length
        while True:
            rest = sum((abs(arb(value)) * arb(w) ** (n - first) for n, value in enumerate(c) if n > first), arb(0))
            if arb(c[first]) > rest + self.beyond * arb(w) ** (ORDER - first):
                return w
            w /= 2

    def derivatives(self, length: fmpq) -> list[arb]:
        """Bounds of the function and its derivatives, up to that of ORDER."""
        h, c = arb(length), [*map(abs, self.powers.coeffs())]
        return [
            sum((arb(value * perm(n, j)) * h ** (n - j) for n, value in enumerate(c) if n >= j), arb(0)).upper()
            + (self.beyond * perm(ORDER, j) * h ** (ORDER - j)).upper()
            for j in range(ORDER + 1)
        ]


def combined(terms: Sequence[tuple[fmpq, Onset]]) -> Onset:
    """A sum with exact factors."""
    total, beyond = fmpq_poly(), arb(0)
    for factor, onset in terms:
        total += factor * onset.powers
        beyond += abs(arb(factor)) * onset.beyond
    return Onset(total, beyond.upper())
