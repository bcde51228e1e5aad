"""The generated C of a scene in a loop that is C, too, so that nothing else is timed; the most that a core can do."""

from __future__ import annotations

import ctypes
import os
import platform
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from wavesym.running.native import FAST, address, library
from wavesym.running.toolchain import Compiler, at_hand
from wavesym.scene import Scene, lower

SAMPLES = 10_001
# for this machine, for most of its kind (vectors of 256 bits), and as nothing is said
_COMMON = ("-O3", "-march=x86-64-v3", "-ffp-contract=fast")
EVERY = (FAST, *([_COMMON] if platform.machine().lower() in {"x86_64", "amd64"} else []), ("-O2",))
CALLS = 20
"""Of `sample`, or of the floor, in a turn: so many that what it takes to call C does not count."""
_HARNESS = """
void many(double dtau, size_t count, double *out, int calls)
{
    for (int call = 0; call < calls; ++call) {
        NAME_sample(0.0, dtau, count, out);
    }
}

void each(const double *tau, size_t count, double *out)
{
    for (size_t k = 0; k < count; ++k) {
        NAME_eval(tau[k], out);
    }
}
"""
_PEAK = """
#include <stddef.h>
enum { LANES = 32 };
void peak(size_t count, double *x)
{
    double s[LANES], t[LANES], w[LANES];
    UNROLLED
    for (int j = 0; j < LANES; ++j) s[j] = t[j] = w[j] = x[j];
    for (size_t k = 0; k < count; ++k) {
        const double next = x[k % 2];
        UNROLLED
        for (int j = 0; j < LANES; ++j) s[j] = s[j] * w[j] + next;
        UNROLLED
        for (int j = 0; j < LANES; ++j) t[j] = t[j] * w[j] + next;
    }
    UNROLLED
    for (int j = 0; j < LANES; ++j) x[j] = s[j] + t[j];
}
"""
_UNROLLED = {"gcc": 'UNROLLED=_Pragma("GCC unroll 32")', "clang": 'UNROLLED=_Pragma("clang loop unroll(full)")'}


def compilers() -> list[Compiler]:
    """Those that the loops are written for."""
    return [compiler for compiler in at_hand() if compiler.name in _UNROLLED]


@contextmanager
def chosen_compiler(name: str) -> Iterator[None]:
    """The C compiler that `toolchain` is to choose, for a while."""
    before = os.environ.get("CC")
    library.cache_clear()
    os.environ["CC"] = name
    try:
        yield
    finally:
        library.cache_clear()
        if before is None:
            del os.environ["CC"]
        else:
            os.environ["CC"] = before


def toolchains() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Each compiler with each choice of flags; `toolchain` chooses it until the next."""
    for compiler in compilers():
        for flags in EVERY:
            with chosen_compiler(compiler.name):
                yield compiler.name, flags


def flags_cell(flags: tuple[str, ...]) -> str:
    """Flags as tables show them."""
    return f"`{' '.join(flags)}`"


def _library(each: Scene, made: dict[str, str], flags: tuple[str, ...]) -> ctypes.CDLL:
    name = each.name
    return library(made[f"{name}.c"] + _HARNESS.replace("NAME", name), flags, (f"{name}.h", made[f"{name}.h"]))


def many(
    each: Scene, made: dict[str, str], flags: tuple[str, ...], calls: int = CALLS, samples: int = SAMPLES
) -> Callable[[], object]:
    """So many calls of `sample` for so many samples."""
    function = _library(each, made, flags).many
    function.argtypes = [ctypes.c_double, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_int]
    step = lower(each).horizon() / (samples - 1)
    out = np.empty((len(each.outputs), samples))

    def call() -> object:
        return function(step, samples, address(out), calls)

    return call


def one_by_one(each: Scene, made: dict[str, str], flags: tuple[str, ...], tau_max: float) -> Callable[[], object]:
    """`eval` at random tau."""
    function = _library(each, made, flags).each
    function.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p]
    taus = np.random.default_rng(1).uniform(0.0, tau_max, SAMPLES)
    out = np.empty(len(each.outputs))

    def call() -> object:
        return function(address(taus), SAMPLES, address(out))

    return call


def peak(compiler: str, flags: tuple[str, ...]) -> Callable[[], object]:
    """As many multiplications with additions as a core can do: 64 times 10 000."""
    function = library(_PEAK, (*flags, f"-D{_UNROLLED[compiler]}")).peak
    function.argtypes = [ctypes.c_size_t, ctypes.c_void_p]
    values = np.full(32, 0.5)

    def call() -> object:
        return function(10_000, address(values))

    return call
