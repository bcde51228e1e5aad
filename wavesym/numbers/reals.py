"""The two kinds of floating-point numbers that programs are generated in. Every value is kept as a Python float."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from flint import arb, fmpq

from wavesym.numbers.doubles import middle, midpoint, nearest, rational


@dataclass(frozen=True)
class Real:
    """An IEEE format: unit roundoff, smallest positive number, and the number next to another, up or down.

    `largest` is the largest power of 2.
    """

    name: str
    bytes: int
    roundoff: fmpq
    smallest: fmpq
    largest: fmpq
    next_after: Callable[[float, float], float]

    @property
    def least(self) -> fmpq:
        """From here on a number, and its rounding error too, is rounded as the unit roundoff says."""
        return self.smallest / self.roundoff**2

    @property
    def reach(self) -> fmpq:
        """Up to here a thousand products and their sums stay below the largest number."""
        return self.largest / 2**40

    def nearest(self, value: fmpq) -> float:
        """The number nearest to an exact one, ties to even. OverflowError beyond the largest."""
        double = nearest(value)
        if self.name == "double":
            return double
        if abs(value) > self.largest:
            raise OverflowError(f"{double} in single precision")
        import numpy as np  # of floats alone

        guess = float(np.float32(double))  # rounded twice: a neighbour may be nearer
        near = [guess, self.next_after(guess, -math.inf), self.next_after(guess, math.inf)]
        return min(near, key=lambda each: (abs(rational(each) - value), np.float32(each).view(np.uint32) & 1))

    def nearest_middle(self, ball: arb) -> float:
        """The number nearest to the middle of a ball."""
        return midpoint(ball) if self.name == "double" else self.nearest(middle(ball))

    def table(self, values: Iterable[fmpq]) -> tuple[float, ...]:
        """The numbers nearest to some exact ones."""
        return tuple(map(self.nearest, values))

    def not_below(self, value: fmpq) -> float:
        """The smallest number that is not below an exact one."""
        number = self.nearest(value)
        return number if rational(number) >= value else self.next_after(number, math.inf)


def _next_single(value: float, towards: float) -> float:
    import numpy as np

    return float(np.nextafter(np.float32(value), np.float32(towards)))


DOUBLE = Real("double", 8, fmpq(1, 2**53), fmpq(1, 2**1074), fmpq(2) ** 1023, math.nextafter)
SINGLE = Real("single", 4, fmpq(1, 2**24), fmpq(1, 2**149), fmpq(2) ** 127, _next_single)
REALS = {real.name: real for real in (DOUBLE, SINGLE)}
