"""Numbers beside an axis, as people write them: 10\u202f000, 0.25, and a power of ten only where numbers are long."""

from __future__ import annotations

from math import floor, log10

from wavesym.pictures.units import RAISED
from wavesym.results.presentation import group_thousands


def omitted_power(low: float, high: float) -> int:
    """The power of ten that is left out of the numbers of an axis, 0 where these are short.

    >>> omitted_power(-1e4, 2e4), omitted_power(0, 3e6)
    (0, 6)
    """
    largest = max(abs(low), abs(high))
    return 0 if 1e-3 <= largest < 1e5 or not largest else 3 * floor(log10(largest) / 3)


def power_text(power: int) -> str:
    """What stands once beside numbers without their power of ten."""
    return f"\u00d710{str(power).translate(RAISED)}"


def tick_text(value: float, step: float) -> str:
    """A number to the last digit that steps of such a size change."""
    if abs(step) >= 1e5 or abs(step) < 1e-4:
        digits = max(0, floor(log10(abs(value))) - floor(log10(step)) + 1) if value else 0
        return f"{value:.{digits}e}" if value else "0"
    decimals = next(d for d in range(6) if abs(round(step, d) - step) < 1e-6 * step)
    return group_thousands(f"{value:.{decimals}f}") if value else "0"
