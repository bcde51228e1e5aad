"""Numbers as text: the shortest decimal that reads back to the same floating-point number."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import accumulate

from wavesym.numbers.reals import DOUBLE, Real
from wavesym.targets.number_format import number_format


def literal(value: float, real: Real = DOUBLE) -> str:
    """A number as C, Python and JSON write it, without a suffix. ValueError for what is not finite."""
    if value - value != 0.0:
        raise ValueError(f"{value} is no literal")
    return number_format(real).shortest(value)


def c_literal(value: float, real: Real) -> str:
    """A number as C writes it."""
    return literal(value, real) + number_format(real).c_suffix


def c_literals(values: Iterable[float], real: Real) -> tuple[str, ...]:
    """Numbers as lines of a table in C."""
    return lines(c_literal(value, real) for value in values)


def lines(items: Iterable[str], width: int = 116) -> tuple[str, ...]:
    """Literals joined by commas, in lines of at most `width`; a lone 0 for none, as C has no empty array."""
    made: list[str] = []
    line = ""
    for item in items:
        if line and len(line) + len(item) + 3 > width:  # with ", " before it and "," after it
            made.append(f"{line},")
            line = item
        else:
            line = f"{line}, {item}" if line else item
    return (*made, line or "0")


def firsts(counts: Iterable[int]) -> tuple[str, ...]:
    """Where each group starts in a flat table, and where the last one ends."""
    return lines(map(str, accumulate(counts, initial=0)))
