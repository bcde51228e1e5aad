"""Exact numbers that formulas are evaluated in: sums of exponentials, and values with their derivatives.

sum_q c_q exp(q) with rational q and c_q. The exp(q) of different rational q are linearly independent over the rationals
(Lindemann and Weierstrass), so that two of these numbers are equal only if all their c_q are: equality is decided, not
estimated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import product
from typing import Any

from flint import arb, fmpq

Exact = int | fmpq
DIGITS_BITS = 128
"""Enough for what is shown; nothing is decided by it."""


Key = tuple[int, int]
"""A rational as numerator and denominator, which Python hashes ten times faster."""


class Exponentials:
    """sum_q c_q exp(q): `parts` holds the c_q that are not 0, by the key of q."""

    __slots__ = ("parts",)
    parts: dict[Key, fmpq]

    @classmethod
    def from_number(cls, value: Number) -> Exponentials:
        """A rational as such a sum."""
        return value if isinstance(value, Exponentials) else _from_parts({(0, 1): fmpq(value)})

    @classmethod
    def total(cls, terms: Iterable[tuple[fmpq, fmpq]]) -> Exponentials:
        """The sum of c exp(q) for pairs (q, c), in which a q may occur again."""
        parts: dict[Key, fmpq] = {}
        for q, c in terms:
            key = int(q.p), int(q.q)
            parts[key] = parts[key] + c if key in parts else c
        return _from_parts(parts)

    def __add__(self, other: Number) -> Exponentials:
        if not isinstance(other, Exponentials) and other == 0:
            return self
        total = dict(self.parts)
        for q, c in Exponentials.from_number(other).parts.items():
            total[q] = total[q] + c if q in total else c
            if total[q] == 0:
                del total[q]
        return _from_nonzero_parts(total)

    __radd__ = __add__

    def __neg__(self) -> Exponentials:
        return _from_nonzero_parts({q: -c for q, c in self.parts.items()})

    def __sub__(self, other: Number) -> Exponentials:
        return self + -Exponentials.from_number(other)

    def __rsub__(self, other: Number) -> Exponentials:
        return -self + other

    def __mul__(self, other: Number) -> Exponentials:
        if not isinstance(other, Exponentials):
            return _from_nonzero_parts({q: c * other for q, c in self.parts.items()} if other != 0 else {})
        pairs = product(self.parts.items(), other.parts.items())
        return Exponentials.total((fmpq(*p) + fmpq(*q), b * c) for (p, b), (q, c) in pairs)

    __rmul__ = __mul__

    def __truediv__(self, other: Exact) -> Exponentials:
        return self * (1 / fmpq(other))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, (Exponentials, int, fmpq)):
            return NotImplemented
        return self.parts == Exponentials.from_number(other).parts

    def __hash__(self) -> int:
        return hash(frozenset(self.parts.items()))

    def __float__(self) -> float:
        from flint import ctx

        with ctx.workprec(DIGITS_BITS):
            return float(sum((arb(c) * arb(fmpq(*q)).exp() for q, c in self.parts.items()), arb(0)).mid())

    def __str__(self) -> str:
        if not self.parts:
            return "0"
        if self.parts.keys() == {(0, 1)}:
            return str(self.parts[0, 1])
        return f"{float(self):.6g}"


Number = int | fmpq | Exponentials


def _from_parts(parts: dict[Key, fmpq]) -> Exponentials:
    """The sum with these parts, those left out that are 0."""
    return _from_nonzero_parts({q: c for q, c in parts.items() if c != 0})


def _from_nonzero_parts(parts: dict[Key, fmpq]) -> Exponentials:
    """The sum with these parts, none of which is 0."""
    total = Exponentials.__new__(Exponentials)
    total.parts = parts
    return total


def exponential(exponent: Exact) -> Exponentials:
    """e to a rational power."""
    q = fmpq(exponent)
    return _from_nonzero_parts({(int(q.p), int(q.q)): fmpq(1)})


@dataclass(slots=True)
class Jet:
    """A value and its derivatives; they are exact numbers."""

    value: Any
    first: Any = 0
    second: Any = 0

    @classmethod
    def from_number(cls, value: Any) -> Jet:
        """A number as one that does not change."""
        return value if isinstance(value, Jet) else cls(value)

    def __add__(self, other: Any) -> Jet:
        that = Jet.from_number(other)
        return Jet(self.value + that.value, self.first + that.first, self.second + that.second)

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.value, -self.first, -self.second)

    def __sub__(self, other: Any) -> Jet:
        return self + -Jet.from_number(other)

    def __rsub__(self, other: Any) -> Jet:
        return Jet.from_number(other) + -self

    def __mul__(self, other: Any) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.value * other, self.first * other, self.second * other)
        return Jet(
            self.value * other.value,
            self.first * other.value + self.value * other.first,
            self.second * other.value + 2 * (self.first * other.first) + self.value * other.second,
        )

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:
        return Jet(self.value / other, self.first / other, self.second / other)

    def apply(self, derivative: Callable[[int], Any], most: int = 2) -> Jet:
        """A function of this; `derivative(order)` is what it is here: itself, its derivative, the next.

        Those that nothing asks for are not taken: the second with `most` 1, and none of what does not change.
        """
        if self.first == 0 and self.second == 0:
            return Jet(derivative(0))
        first = derivative(1)
        second = derivative(2) * (self.first * self.first) if most > 1 else 0
        return Jet(derivative(0), first * self.first, second if self.second == 0 else second + first * self.second)
