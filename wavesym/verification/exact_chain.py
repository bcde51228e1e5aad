"""The numbers of a chain as one kind of exact number."""

from __future__ import annotations

from flint import fmpq

from wavesym.model.node import Quantity, Rod
from wavesym.numbers.doubles import rational


def exact(value: Quantity) -> fmpq:
    """An int, a Fraction or an fmpq, as an fmpq."""
    return value if isinstance(value, fmpq) else rational(value)


def start(rod: Rod | None) -> fmpq:
    """The velocity v of (2.2) with which a rod starts; 0 where there is no rod."""
    return exact(rod.velocity) if rod else fmpq(0)
