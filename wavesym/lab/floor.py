"""The least that a sample can cost: straight lines written into memory, in a loop that is C, too."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from wavesym.running.native import FAST, address, library

_SOURCE = """\
#include <stddef.h>

void straight(TYPE v, TYPE d, size_t count, TYPE *out);
__attribute__((noinline)) void straight(TYPE v, TYPE d, size_t count, TYPE *out)
{
    for (size_t k = 0; k < count; ++k) {
        out[k] = v + d * (TYPE)(int)k;
    }
}

void lines(TYPE d, size_t rows, size_t count, TYPE *out, int calls)
{
    for (int call = 0; call < calls; ++call) {
        for (size_t row = 0; row < rows; ++row) {
            straight((TYPE)call, d, count, out + row * count);
        }
    }
}
"""


def floor(
    rows: int, count: int, calls: int, *, single: bool = False, flags: tuple[str, ...] = FAST
) -> Callable[[], NDArray[np.generic]]:
    """A call that writes `rows` straight lines of `count` doubles (floats if `single`), `calls` times: (rows, count).

    With many of them what it takes to call C does not count. CompilerError where there is no C compiler.
    """
    number, dtype = (ctypes.c_float, np.float32) if single else (ctypes.c_double, np.float64)
    lines = library(_SOURCE, (*flags, f"-DTYPE={'float' if single else 'double'}")).lines
    lines.argtypes = [number, ctypes.c_size_t, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_int]
    lines.restype = None
    out = np.empty((rows, count), dtype=dtype)

    def write() -> NDArray[np.generic]:
        lines(0.5, rows, count, address(out), calls)
        return out

    return write
