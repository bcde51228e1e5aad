"""Numbers that count how wrong floating-point arithmetic can make them at worst, however it rounds.

A kernel that is run with them, written down once more, says what a proof of its bound has to allow for.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import arb, fmpq

Number = int | float | Fraction | fmpq | arb
_ZERO = arb(0)


def ball(number: Number) -> arb:
    return number if isinstance(number, arb) else arb(fmpq(*_ratio(number)))


def _ratio(number: int | float | Fraction | fmpq) -> tuple[int, int]:
    return (int(number.p), int(number.q)) if isinstance(number, fmpq) else number.as_integer_ratio()


@dataclass(frozen=True)
class Counted:
    """A number of at most `size`, computed with an error of at most `rounding` u + `underflow` smallest numbers.

    With u = 0 rounding is counted to first order, as most proofs do. What is no `Counted` is exact.
    """

    size: arb
    rounding: arb = _ZERO
    underflow: arb = _ZERO
    u: arb = _ZERO

    @classmethod
    def exact(cls, number: Number, u: Number = 0) -> Counted:
        return cls(abs(ball(number)), u=ball(u))

    @classmethod
    def nearest(cls, number: Number, u: Number = 0) -> Counted:
        """A number of a table: rounded once, and perhaps below the normal numbers."""
        return cls.exact(number, u)._rounded(arb(0.5))

    def __add__(self, other: Counted | Number) -> Counted:
        # where a sum is below the normal numbers it is exact
        other = self._like(other)
        return Counted(
            self.size + other.size, self.rounding + other.rounding, self.underflow + other.underflow, self.u
        )._rounded()

    def __mul__(self, other: Counted | Number) -> Counted:
        other = self._like(other)
        return Counted(
            self.size * other.size,
            self._reach * other.rounding + self.rounding * other.size,
            self._reach * other.underflow + self.underflow * other._reach,
            self.u,
        )._rounded(arb(0.5))

    def __truediv__(self, other: Number) -> Counted:
        """By an exact number: how small a counted one may be is not known."""
        size = abs(ball(other))
        return Counted(self.size / size, self.rounding / size, self.underflow / size, self.u)._rounded(arb(0.5))

    def __neg__(self) -> Counted:
        return self

    __radd__ = __sub__ = __rsub__ = __add__
    __rmul__ = __mul__

    def through(self, size: Number, slope: Number, ulps: int) -> Counted:
        """A function of at most such a size and slope, computed within so many units in the last place (2 u each)."""
        size, slope = abs(ball(size)), abs(ball(slope))
        moved = slope * self.rounding
        rounding = moved + 2 * ulps * (size + self.u * moved)
        return Counted(size, rounding, slope * self.underflow + ulps, self.u)

    def error(self, u: Number, smallest: Number) -> arb:
        """The largest error, absolute, in a format with such a unit roundoff and such a smallest number."""
        return self.rounding * ball(u) + self.underflow * ball(smallest)

    @property
    def _reach(self) -> arb:
        """The largest that it may have become by rounding."""
        return self.size + self.u * self.rounding

    def _rounded(self, lost: arb = _ZERO) -> Counted:
        return Counted(self.size, self.rounding + self._reach, self.underflow * (1 + self.u) + lost, self.u)

    def _like(self, other: Counted | Number) -> Counted:
        return other if isinstance(other, Counted) else Counted.exact(other, self.u)
