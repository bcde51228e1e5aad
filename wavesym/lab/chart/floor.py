"""The least that a sample can cost: a straight line written into memory, in C."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from wavesym.running.native import FAST, address, library

_SOURCE = """\
#include <stddef.h>

void straight(TYPE v, TYPE d, size_t count, TYPE *out)
{
    for (size_t k = 0; k < count; ++k) {
        out[k] = v + d * (TYPE)(int)k;
    }
}
"""


def floor(
    rows: int, count: int, single: bool = False, flags: tuple[str, ...] = FAST
) -> Callable[[], NDArray[np.generic]]:
    """A call that writes `rows` straight lines of `count` doubles (floats if `single`): shape (rows, count).

    CompilerError where there is no C compiler.
    """
    number, dtype = (ctypes.c_float, np.float32) if single else (ctypes.c_double, np.float64)
    straight = library(_SOURCE, (*flags, f"-DTYPE={'float' if single else 'double'}")).straight
    straight.argtypes = [number, number, ctypes.c_size_t, ctypes.c_void_p]
    straight.restype = None
    out = np.empty((rows, count), dtype=dtype)
    starts = [address(row) for row in out]

    def write() -> NDArray[np.generic]:
        for start in starts:
            straight(1.0, 0.5, count, start)
        return out

    return write
