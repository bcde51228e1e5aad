"""Values with their first and second derivative along one direction: how a formula changes with time or place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Jet:
    """A value and its derivatives; they are exact numbers."""

    value: Any
    first: Any = 0
    second: Any = 0

    @classmethod
    def of(cls, value: Any) -> Jet:
        """A number as one that does not change."""
        return value if isinstance(value, Jet) else cls(value)

    def __add__(self, other: Any) -> Jet:
        that = Jet.of(other)
        return Jet(self.value + that.value, self.first + that.first, self.second + that.second)

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.value, -self.first, -self.second)

    def __sub__(self, other: Any) -> Jet:
        return self + -Jet.of(other)

    def __rsub__(self, other: Any) -> Jet:
        return Jet.of(other) + -self

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

    def of_function(self, derivative: Callable[[int], Any]) -> Jet:
        """A function of this; `derivative(order)` is what it is here: itself, its derivative, the next."""
        first, second = derivative(1), derivative(2)
        return Jet(derivative(0), first * self.first, second * (self.first * self.first) + first * self.second)
