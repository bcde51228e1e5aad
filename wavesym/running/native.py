"""C compiled for this machine, as fast as the compiler makes it, and loaded into this process."""

from __future__ import annotations

import ctypes
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from wavesym.running.toolchain import compiler

FAST = ("-O3", "-march=native", "-ffp-contract=fast")


@cache
def library(source: str, flags: tuple[str, ...] = FAST, header: tuple[str, str] | None = None) -> ctypes.CDLL:
    """A shared library of one C file, and at most one header (name, text) that it includes. CompilerError."""
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        (folder / "source.c").write_text(source, encoding="utf-8")
        if header:
            (folder / header[0]).write_text(header[1], encoding="utf-8")
        compiler().run(["-std=c99", *flags, "-fPIC", "-shared", "source.c", "-o", "library.so", "-lm"], folder)
        # once loaded it stays, though the file goes
        return ctypes.CDLL(str(folder / "library.so"))


def address(values: NDArray[np.generic]) -> int:
    """Where an array's values lie; it must be contiguous."""
    assert values.flags.c_contiguous
    return int(values.ctypes.data)
