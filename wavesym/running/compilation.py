"""Generated text made to run: C compiled as a user would, strictly, and loaded; NumPy imported."""

from __future__ import annotations

import ctypes
import re
import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesym.running.native import call, room, struct_sizes
from wavesym.running.toolchain import compiler

_WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wmissing-prototypes", "-Werror")
FLAGS = ("-std=c99", "-O2", *_WARNINGS)
_WIDEST_BATCH = 64  # sets


class CompiledLibrary:
    """The library and the self-test made from NAME.h, NAME.c and NAME_selftest.c; usable while `compile_files` is open.

    A library has values at any tau, or a `model` of parameters, which has them, or a `state` that takes loads step by
    step. Its numbers are of the type `real`.
    """

    def __init__(
        self, library: Path, selftest: Path, name: str, outputs: int, longest: int, real: type[np.floating[Any]]
    ) -> None:
        self._loaded, self._name = ctypes.CDLL(str(library)), name
        self._selftest, self.outputs = selftest, outputs
        self.real = real
        self.number = ctypes.c_float if real is np.float32 else ctypes.c_double
        self.streams = not hasattr(self._loaded, f"{name}_eval")
        """Whether it has no values at any tau by itself."""
        names = (ctypes.c_char * longest * outputs).in_dll(self._loaded, f"{name}_output_name")
        self.names = tuple(bytes(row.value).decode() for row in names)
        """The names of the outputs, in order."""

    def __call__(self, taus: Sequence[float]) -> NDArray[np.float64]:
        """All outputs at taus by NAME_eval: shape (outputs, len(taus)), NaN out of range."""
        return self.values(partial(self.call, "eval"), taus)

    def sample(self, tau0: float, dtau: float, count: int) -> tuple[int, NDArray[np.float64]]:
        """What NAME_sample returns, and all outputs at tau0 + k dtau: shape (outputs, count), NaN out of range."""
        return self.samples("sample", tau0, dtau, count, (self.outputs, count))

    def model(self, parameters: ArrayLike) -> CompiledModel:
        """What NAME_build makes of parameters, in the order of the struct."""
        model = self._memory("model")
        return CompiledModel(self, model, self.call("build", model, np.array(parameters, self.real)))

    def bounded_model(self, parameters: ArrayLike) -> tuple[CompiledModel, NDArray[np.float64]]:
        """What NAME_error_bound makes of parameters, and the proved bound of each output."""
        model, bound = self._memory("model"), np.empty(self.outputs, self.real)
        status = self.call("error_bound", model, np.array(parameters, self.real), bound)
        return CompiledModel(self, model, status), bound.astype(np.float64)

    def batch(
        self, sets: ArrayLike, taus: ArrayLike, data: ArrayLike
    ) -> tuple[list[CompiledModel], NDArray[np.float64]]:
        """Models of sets of parameters, (sets, numbers), built beside each other, and the misfit of each.

        `data` are of shape (outputs, taus).
        """
        given, instants, values = (np.ascontiguousarray(each, self.real) for each in (sets, taus, data))
        batch, kept = self._memory("batch"), self._memory("data")
        self.call("build_batch", batch, given, len(given))
        models = []
        for k in range(len(given)):
            model = self._memory("model")
            models.append(CompiledModel(self, model, self.call("batch_model", batch, ctypes.c_int(k), model)))
        count = len(instants)
        numbers = np.empty(self.call("data_size", instants, count, result=ctypes.c_size_t), self.real)
        self.call("data_init", kept, numbers, instants, values, count)
        misfits = np.empty(_WIDEST_BATCH, self.real)
        self.call("batch_misfit", batch, kept, misfits, result=None)
        return models, misfits[: len(given)].astype(np.float64)

    def tangent(self, parameters: ArrayLike, tau0: float, dtau: float, count: int) -> NDArray[np.float64]:
        """Values at tau0 + k dtau, and their derivatives by each parameter: (1 + parameters, outputs, count)."""
        given, tangent = np.array(parameters, self.real), self._memory("tangent")
        self.call("build_tangent", tangent, given)
        shape = (1 + given.size, self.outputs, count)
        return self.samples("tangent_sample", tau0, dtau, count, shape, tangent)[1]

    def stream(self, parameters: ArrayLike | None = None) -> CompiledStream:
        """A state at tau = 0, built of parameters, in the order of the struct, where there are some."""
        state = self._memory("state")
        if parameters is None:
            self.call("init", state, result=None)
            return CompiledStream(self, state)
        return CompiledStream(self, state, self.call("build", state, np.array(parameters, self.real)))

    def selftest(self) -> int:
        """The exit status of the self-test: 0 where the program on this machine gives the values it should."""
        return subprocess.run([self._selftest], capture_output=True, check=False).returncode

    def call(self, name: str, *given: object, result: Any = ctypes.c_int) -> Any:
        """What the function NAME_`name` of the library returns."""
        return call(self._loaded, f"{self._name}_{name}", *given, result=result)

    def _memory(self, kind: str) -> NDArray[np.uint8]:
        """Memory of C as it may be before anything is in it: no bytes of it are a number."""
        memory = room(self._loaded, kind)
        memory[:] = 255
        return memory

    def values(self, at: Callable[..., object], taus: Sequence[float]) -> NDArray[np.float64]:
        """All outputs at taus by a function of a tau and where its outputs go: (outputs, len(taus))."""
        columns = np.empty((len(taus), self.outputs), self.real)
        for tau, column in zip(taus, columns, strict=True):
            at(self.real(tau), column)
        return np.ascontiguousarray(columns.T, np.float64)

    def samples(
        self, name: str, tau0: float, dtau: float, count: int, shape: tuple[int, ...], *of: object
    ) -> tuple[int, NDArray[np.float64]]:
        """What a function of samples, `of` a model where it is of one, returns, and all that it writes."""
        out = np.empty(shape, self.real)
        return self.call(name, *of, self.real(tau0), self.real(dtau), count, out), out.astype(np.float64)


class CompiledModel:
    """A model in memory of its own; `status` is what the function returned that made it."""

    def __init__(self, program: CompiledLibrary, model: NDArray[np.uint8], status: int) -> None:
        self._program, self._model, self.status = program, model, status

    @property
    def estimate(self) -> float:
        """What it states of its errors, relative to each output's largest value."""
        return float(self._program.call("error_estimate", self._model, result=self._program.number))

    def __call__(self, taus: Sequence[float]) -> NDArray[np.float64]:
        """All outputs at taus by NAME_model_eval: shape (outputs, len(taus)), NaN out of range."""
        return self._program.values(partial(self._program.call, "model_eval", self._model), taus)

    def sample(self, tau0: float, dtau: float, count: int) -> NDArray[np.float64]:
        """All outputs at tau0 + k dtau by NAME_model_sample: shape (outputs, count), NaN out of range."""
        shape = (self._program.outputs, count)
        return self._program.samples("model_sample", tau0, dtau, count, shape, self._model)[1]

    def peaks(self) -> NDArray[np.float64]:
        """Of each output the least value, its tau, the greatest and its tau, by NAME_model_peaks: (outputs, 2, 2)."""
        out = np.empty((self._program.outputs, 2, 2), self._program.real)
        self._program.call("model_peaks", self._model, out)
        return out.astype(np.float64)


class CompiledStream:
    """A state of a stream, which goes on step by step.

    `refused` is what made it returned: 0, 1 for parameters that are bad numbers, or 2 where the degree is too low.
    """

    def __init__(self, program: CompiledLibrary, state: NDArray[np.uint8], refused: int = 0) -> None:
        self.program, self.state, self.status, self.refused = program, state, 0, refused

    def step(self, dtau: float, loads: ArrayLike) -> NDArray[np.float64]:
        """All outputs after dtau, in which loads go straight to `loads`, or jump to them where it is 0.

        The largest `status` so far is kept.
        """
        program, out = self.program, np.empty(self.program.outputs, self.program.real)
        status = program.call("step", self.state, program.real(dtau), np.array(loads, program.real), out)
        self.status = max(self.status, status)
        return out.astype(np.float64)

    @property
    def lost(self) -> float:
        """What it says that polynomials have lost so far, relative to the largest wave."""
        return float(self.program.call("lost", self.state, result=self.program.number))


@contextmanager
def compile_files(
    files: Mapping[str, str],
    outputs: int,
    real: type[np.floating[Any]] = np.float64,
    flags: Sequence[str] = (),
) -> Iterator[CompiledLibrary]:
    """Generated C (file name -> text) with `outputs` outputs, compiled in a directory that goes when this is closed.

    Numbers are of the type `real`; without `flags` the compiler gets FLAGS. There need not be a self-test.
    CompilerError where there is no compiler, or where it finds anything to warn of.
    """
    chosen, flags = compiler(), flags or FLAGS
    (name,) = (file.removesuffix(".h") for file in files if file.endswith(".h"))
    declared = re.search(r"_output_name\[\w+\]\[(\d+)\]", files[f"{name}.h"])
    assert declared  # by every header
    sizes = f'#include "{name}.h"\n{struct_sizes(name, files[f"{name}.h"])}'
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        for file, text in {**files, "sizes.c": sizes}.items():
            (folder / file).write_text(text, encoding="utf-8")
        chosen.run([*flags, "-fPIC", "-c", f"{name}.c", "-o", "made.o"], folder)
        chosen.run(["-fPIC", "-shared", "made.o", "sizes.c", "-o", "library.so", "-lm"], folder)
        if f"{name}_selftest.c" in files:
            chosen.run([*flags, "made.o", f"{name}_selftest.c", "-o", "selftest", "-lm"], folder)
        yield CompiledLibrary(folder / "library.so", folder / "selftest", name, outputs, int(declared[1]), real)


def import_text(text: str, name: str) -> ModuleType:
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
