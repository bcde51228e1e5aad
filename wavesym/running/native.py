"""C compiled for this machine, as fast as the compiler makes it, and loaded into this process."""

from __future__ import annotations

import ctypes
import re
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesym.running.toolchain import compiler

FAST = ("-O3", "-march=native", "-ffp-contract=fast")
_ALIGNED = 64  # bytes, of vectors


@cache
def library(source: str, flags: tuple[str, ...] = FAST, header: tuple[str, str] | None = None) -> ctypes.CDLL:
    """A shared library of one C file, and at most one header NAME.h (name, text) that it includes, the structs of which
    have a `struct_size` in it then. CompilerError.
    """
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        if header:
            (folder / header[0]).write_text(header[1], encoding="utf-8")
            source += "\n" + struct_sizes(header[0].removesuffix(".h"), header[1])
        (folder / "source.c").write_text(source, encoding="utf-8")
        compiler().run(["-std=c99", *flags, "-fPIC", "-shared", "source.c", "-o", "library.so", "-lm"], folder)
        # once loaded it stays, though the file goes
        return ctypes.CDLL(str(folder / "library.so"))


def struct_sizes(name: str, header: str) -> str:
    """C that has the size of each struct NAME_KIND of NAME.h, of which `header` is the text."""
    kinds = re.findall(rf"^(?:struct|\}}) {name}_(\w+)(?:;| \{{)", header, re.MULTILINE)
    return "".join(f"const size_t size_of_{kind} = sizeof({name}_{kind});\n" for kind in kinds)


def struct_size(loaded: ctypes.CDLL, kind: str) -> int:
    """How many bytes a struct NAME_`kind` has."""
    return ctypes.c_size_t.in_dll(loaded, f"size_of_{kind}").value


def address(values: NDArray[np.generic]) -> int:
    """Where an array's values lie; it must be contiguous."""
    assert values.flags.c_contiguous
    return int(values.ctypes.data)


def room(loaded: ctypes.CDLL, kind: str) -> NDArray[np.uint8]:
    """Memory for a struct NAME_`kind`, from a multiple of 64 bytes on."""
    size = struct_size(loaded, kind)
    memory = np.empty(size + _ALIGNED, np.uint8)
    return memory[-memory.ctypes.data % _ALIGNED :][:size]


def call(loaded: ctypes.CDLL, name: str, *given: object, result: Any = ctypes.c_int) -> Any:
    """What a function of a library returns.

    Args:
        loaded: the library.
        name: that of the function.
        given: an array, contiguous, for where its values lie, None for NULL, a bool for an int, any other int for a
            size_t, a Python float or a number of NumPy for a double or a float; what else ctypes takes.
        result: the type of what it returns, None for void.
    """
    function = loaded[name]  # of this call alone: threads may want other types of it
    function.restype = result
    return function(*map(_argument, given))


def _argument(given: object) -> object:
    match given:
        case None:
            return ctypes.c_void_p(None)
        case np.ndarray():
            return ctypes.c_void_p(address(given))
        case bool():
            return ctypes.c_int(given)
        case int():
            return ctypes.c_size_t(given)
        case float():
            return ctypes.c_double(given)
    return ctypes.c_float(float(given)) if isinstance(given, np.float32) else given
