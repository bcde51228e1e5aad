"""Worst-case rounding, counted operation by operation: numbers that know what each rounding on their way does to them.

To first order a rounding by u makes a result wrong by u times what depends on it. Each rounding is a symbol of its own,
so that errors which cancel do, and programs are counted as they are: they run on these numbers instead of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count
from typing import Any

import numpy as np

_symbols = count()
_Parts = dict[int, Any]


class Rounded:
    """A value, or values of some runs side by side; by symbol what a rounding by u, or a product that loses 1, adds."""

    def __init__(self, value: Any, noise: _Parts | None = None, lost: _Parts | None = None) -> None:
        self.value = value
        self.noise = noise or {}
        self.lost = lost or {}

    @classmethod
    def wrong(cls, value: Any, roundings: float = 1) -> Rounded:
        """A number with an error of so many roundings."""
        return cls(value, {next(_symbols): roundings * value})

    @classmethod
    def table(cls, values: Any) -> np.ndarray:
        """Numbers that are each rounded once."""
        made = [cls.wrong(value) for value in np.asarray(values).flat]
        return cls.array(made).reshape(np.shape(values))

    @staticmethod
    def array(numbers: Sequence[Any]) -> np.ndarray:
        """An array of them, whatever they hold."""
        made = np.empty(len(numbers), object)
        for k, number in enumerate(numbers):
            made[k] = number
        return made

    @property
    def error(self) -> Any:
        """In units of u."""
        return sum((abs(part) for part in self.noise.values()), np.zeros_like(self.value, dtype=float))

    @property
    def underflow(self) -> Any:
        """In units of the smallest number."""
        return sum((abs(part) for part in self.lost.values()), 0.0)

    def _rounded(self, product: bool = False) -> Rounded:
        symbol = next(_symbols)
        self.noise[symbol] = self.value
        if product:
            self.lost[symbol] = 1.0
        return self

    def _scaled(self, factor: Any) -> Rounded:
        """By an exact number, exactly."""
        return Rounded(
            self.value * factor,
            {symbol: part * factor for symbol, part in self.noise.items()},
            {symbol: part * factor for symbol, part in self.lost.items()},
        )

    def _plus(self, other: Rounded, sign: int = 1) -> Rounded:
        return Rounded(
            self.value + sign * other.value,
            _merged(self.noise, other.noise, sign),
            _merged(self.lost, other.lost, sign),
        )

    def __add__(self, other: Any) -> Rounded:
        if other is self:
            return self._scaled(2)
        return self if _nothing(other) else self._plus(_number(other))._rounded()

    __radd__ = __add__

    def __sub__(self, other: Any) -> Rounded:
        return self if _nothing(other) else self._plus(_number(other), -1)._rounded()

    def __rsub__(self, other: Any) -> Rounded:
        return -self if _nothing(other) else (_number(other) - self)

    def __neg__(self) -> Rounded:
        return self._scaled(-1)

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, int | np.integer):  # 0, or a power of 2
            return self._scaled(other) if other else 0
        other = _number(other)
        product = self._scaled(other.value)._plus(other._scaled(self.value))
        product.value = self.value * other.value
        return product._rounded(product=np.ndim(product.value) > 0)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Rounded:
        other = _number(other)
        quotient = self._scaled(1 / other.value)._plus(other._scaled(self.value / other.value**2), -1)
        quotient.value = self.value / other.value
        return quotient._rounded(product=np.ndim(quotient.value) > 0)

    def __abs__(self) -> Rounded:
        return self

    def __lt__(self, other: float) -> bool:
        return bool(abs(self.value) < other)

    def __bool__(self) -> bool:
        return True


def _number(value: Any) -> Rounded:
    return value if isinstance(value, Rounded) else Rounded(value)


def _nothing(value: Any) -> bool:
    return not isinstance(value, Rounded) and np.ndim(value) == 0 and value == 0


def _merged(one: _Parts, other: _Parts, sign: int) -> _Parts:
    merged = dict(one)
    for symbol, part in other.items():
        merged[symbol] = merged.get(symbol, 0) + sign * part
    return merged
