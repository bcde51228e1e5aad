"""Sums of exponentials: the exact numbers that wave functions have at rational instants.

sum_q c_q exp(q) with rational q and c_q. The exp(q) of different rational q are linearly independent over the rationals
(Lindemann and Weierstrass), so that two of these numbers are equal only if all their c_q are: equality is decided, not
estimated.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Union

from flint import arb, fmpq

Exact = Union[int, fmpq]
DIGITS_BITS = 128
"""Enough for what is shown; nothing is decided by it."""


class Exponentials:
    """sum_q parts[q] exp(q); parts that are 0 are left out."""

    __slots__ = ("parts",)

    def __init__(self, parts: Mapping[fmpq, fmpq]) -> None:
        self.parts = {q: c for q, c in parts.items() if c != 0}

    @classmethod
    def of(cls, value: Number) -> Exponentials:
        """A rational as such a sum."""
        return value if isinstance(value, Exponentials) else cls({fmpq(0): fmpq(value)})

    def __add__(self, other: Number) -> Exponentials:
        total = dict(self.parts)
        for q, c in Exponentials.of(other).parts.items():
            total[q] = total.get(q, fmpq(0)) + c
        return Exponentials(total)

    __radd__ = __add__

    def __neg__(self) -> Exponentials:
        return Exponentials({q: -c for q, c in self.parts.items()})

    def __sub__(self, other: Number) -> Exponentials:
        return self + -Exponentials.of(other)

    def __rsub__(self, other: Number) -> Exponentials:
        return -self + other

    def __mul__(self, other: Number) -> Exponentials:
        if not isinstance(other, Exponentials):  # most often
            factor = fmpq(other)
            return Exponentials({q: c * factor for q, c in self.parts.items()})
        total: dict[fmpq, fmpq] = {}
        for p, b in self.parts.items():
            for q, c in Exponentials.of(other).parts.items():
                total[p + q] = total.get(p + q, fmpq(0)) + b * c
        return Exponentials(total)

    __rmul__ = __mul__

    def __truediv__(self, other: Exact) -> Exponentials:
        return self * (1 / fmpq(other))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, (Exponentials, int, fmpq)):
            return NotImplemented
        return self.parts == Exponentials.of(other).parts

    def __hash__(self) -> int:
        return hash(frozenset(self.parts.items()))

    def __float__(self) -> float:
        from flint import ctx

        with ctx.workprec(DIGITS_BITS):
            return float(sum((arb(c) * arb(q).exp() for q, c in self.parts.items()), arb(0)).mid())

    def __str__(self) -> str:
        if not self.parts:
            return "0"
        if self.parts.keys() == {fmpq(0)}:
            return str(self.parts[fmpq(0)])
        return f"{float(self):.6g}"


Number = Union[int, fmpq, Exponentials]


def exponential(exponent: Exact) -> Exponentials:
    """e to a rational power."""
    return Exponentials({fmpq(exponent): fmpq(1)})
