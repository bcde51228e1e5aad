"""Numbers as text: the shortest decimal that reads back to the same one, and what languages call their types."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE, SINGLE, Real

Lines = tuple[str, ...]


@dataclass(frozen=True)
class NumberFormat:
    """A format as languages know it.

    `c_type` and `c_suffix` (of literals) are for C, `numpy_type` is the name of NumPy's type,
    `largest` the largest finite number. `shortest` writes a number as the shortest decimal that reads back to it.
    """

    c_type: str
    c_suffix: str
    numpy_type: str
    largest: float
    shortest: Callable[[float], str]


def _largest(real: Real) -> float:
    return nearest(real.largest * (2 - 2 * real.roundoff))


def _shortest_single(value: float) -> str:
    import numpy as np

    return str(np.float32(value))


_FORMATS = {
    DOUBLE.name: NumberFormat("double", "", "float64", _largest(DOUBLE), repr),
    SINGLE.name: NumberFormat("float", "f", "float32", _largest(SINGLE), _shortest_single),
}


def number_format(real: Real) -> NumberFormat:
    """What languages call `real` numbers."""
    return _FORMATS[real.name]


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
    """Tables as C writes them, each number in the shortest decimal that reads back to the same bits.

    Args:
        tables: numbers by name; integers are indices, and stay whole.
        real: the type of all other numbers, double or float.

    Returns:
        Lines by name; a lone 0 for an empty table, as C has no empty array.
    """
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
