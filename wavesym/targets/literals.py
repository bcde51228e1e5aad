"""Numbers as text: the shortest decimal that reads back to the same floating-point number."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from wavesym.numbers.reals import DOUBLE, Real
from wavesym.targets.number_format import number_format

Lines = tuple[str, ...]


def literal(value: float, real: Real = DOUBLE) -> str:
    """A number as C, Python and JSON write it, without a suffix. ValueError for what is not finite."""
    if value - value != 0.0:
        raise ValueError(f"{value} is no literal")
    return number_format(real).shortest(value)


def c_literal(value: float, real: Real) -> str:
    """A number as C writes it."""
    return literal(value, real) + number_format(real).c_suffix


def c_literals(values: Iterable[float], real: Real) -> Lines:
    """Numbers as lines of a table in C; indices stay whole."""
    return lines(str(value) if isinstance(value, int) else c_literal(value, real) for value in values) or ("0",)


def c_tables(tables: Mapping[str, Iterable[float]], real: Real) -> dict[str, Lines]:
    """Tables as C writes them, by name; a lone 0 for none, as C has no empty array."""
    return {name: c_literals(values, real) for name, values in tables.items()}


def c_constants(constants: Mapping[str, float], real: Real) -> dict[str, str]:
    """Single numbers as C writes them, by name."""
    return {name: " ".join(c_literals([value], real)) for name, value in constants.items()}


def lines(items: Iterable[str], width: int = 116) -> Lines:
    """Literals joined by commas, in lines of at most `width`."""
    made: list[str] = []
    line = ""
    for item in items:
        if line and len(line) + len(item) + 3 > width:  # with ", " before it and "," after it
            made.append(f"{line},")
            line = item
        else:
            line = f"{line}, {item}" if line else item
    return (*made, line) if line else ()
