"""Generated text made to run: C compiled as a user would, strictly, and loaded; NumPy imported."""

from __future__ import annotations

import ctypes
import re
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from wavesym.running.toolchain import compiler

_WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wmissing-prototypes", "-Werror")
FLAGS = ("-std=c99", "-O2", *_WARNINGS)


class Compiled:
    """The library and the self-test made from NAME.h, NAME.c and NAME_selftest.c; usable while `compiled` is open."""

    def __init__(self, library: Path, selftest: Path, name: str, outputs: int, longest: int) -> None:
        loaded = ctypes.CDLL(str(library))
        doubles = ctypes.POINTER(ctypes.c_double)
        self.streams = not hasattr(loaded, f"{name}_eval")
        """Whether it takes loads sample by sample: it has no values at any tau then."""
        if not self.streams:
            self._eval = getattr(loaded, f"{name}_eval")
            self._eval.argtypes = [ctypes.c_double, doubles]
            self._sample = getattr(loaded, f"{name}_sample")
            self._sample.argtypes = [ctypes.c_double, ctypes.c_double, ctypes.c_size_t, doubles]
        self._selftest = selftest
        self._outputs = outputs
        names = (ctypes.c_char * longest * outputs).in_dll(loaded, f"{name}_output_name")
        self.names = tuple(bytes(row.value).decode() for row in names)
        """The names of the outputs, in order."""

    def __call__(self, taus: Sequence[float]) -> NDArray[np.float64]:
        """All outputs at taus by NAME_eval: shape (outputs, len(taus)), NaN out of range."""
        columns = np.empty((len(taus), self._outputs))
        for tau, column in zip(taus, columns, strict=True):
            self._eval(tau, _pointer(column))
        return np.ascontiguousarray(columns.T)

    def sample(self, tau0: float, dtau: float, count: int) -> tuple[int, NDArray[np.float64]]:
        """What NAME_sample returns, and all outputs at tau0 + k dtau: shape (outputs, count), NaN out of range."""
        out = np.empty((self._outputs, count))
        return int(self._sample(tau0, dtau, count, _pointer(out))), out

    def selftest(self) -> int:
        """The exit status of the self-test: 0 where the program on this machine gives the values it should."""
        return subprocess.run([self._selftest], capture_output=True, check=False).returncode


@contextmanager
def compiled(files: Mapping[str, str], outputs: int) -> Iterator[Compiled]:
    """Generated C (file name -> text) with `outputs` outputs, compiled in a directory that goes when this is closed.

    CompilerError where there is no compiler, or where it finds anything to warn of.
    """
    chosen = compiler()
    (name,) = (file.removesuffix(".h") for file in files if file.endswith(".h"))
    declared = re.search(r"_output_name\[\w+\]\[(\d+)\]", files[f"{name}.h"])
    assert declared  # by every header
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        for file, text in files.items():
            (folder / file).write_text(text, encoding="utf-8")
        chosen.run([*FLAGS, "-fPIC", "-shared", f"{name}.c", "-o", "library.so", "-lm"], folder)
        chosen.run([*FLAGS, f"{name}.c", f"{name}_selftest.c", "-o", "selftest", "-lm"], folder)
        yield Compiled(folder / "library.so", folder / "selftest", name, outputs, int(declared[1]))


def imported(text: str, name: str) -> ModuleType:
    """Generated Python as a module."""
    with TemporaryDirectory() as directory:
        path = Path(directory, f"{name}.py")
        path.write_text(text, encoding="utf-8")
        spec = spec_from_file_location(name, path)
        assert spec  # a .py file has one, with a loader
        assert spec.loader
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
    return module


def _pointer(values: NDArray[np.float64]) -> ctypes._Pointer[ctypes.c_double]:
    return values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
