"""Balls at a precision that is asked for: flint keeps it as a global, which is set here and where balls are made."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from flint import ctx

FIRST_BITS = 128
_MOST_BITS = 1 << 17

T = TypeVar("T")


def precise(attempt: Callable[[int], T | None], bits: int = FIRST_BITS, most: int = _MOST_BITS) -> T:
    """The first result of `attempt(bits)` that is not None, each time with twice the bits of working precision.

    ArithmeticError where `most` are not enough.
    """
    while bits <= most:
        with ctx.workprec(bits):
            result = attempt(bits)
        if result is not None:
            return result
        bits *= 2
    raise ArithmeticError(f"more than {most} bits would be needed, the limit is {most}")
