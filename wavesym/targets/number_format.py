"""What languages call the numbers of a program: asked here and nowhere else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE, SINGLE, Real


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
