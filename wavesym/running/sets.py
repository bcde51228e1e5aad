"""Parameters at run time, from Python: C of a scene compiled once, then run for as many sets as are given."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesym.errors import WavesymError
from wavesym.programs.program import Program
from wavesym.running.native import FAST, address, library
from wavesym.targets.files import runtime_sets

Array = NDArray[np.float64]


class RuntimeModel:
    """A scene whose parameters are given when it runs; all dimensionless.

    `outputs` are the names of its outputs, `tau_max` its horizon, `parameters` how many numbers each field has.
    CompilerError where there is no C compiler.
    """

    def __init__(self, program: Program) -> None:
        laws, name = program.laws, program.provenance.model.name
        assert laws is not None
        files = runtime_sets(program)
        loaded = library(files[f"{name}.c"], FAST, (f"{name}.h", files[f"{name}.h"]))
        size = getattr(loaded, f"{name}_model_size")
        size.restype = ctypes.c_size_t
        self._model = np.zeros(size(), np.uint8)
        self._sets = getattr(loaded, f"{name}_sets")
        many, where = ctypes.c_size_t, ctypes.c_void_p
        self._sets.argtypes = [where, many, where, where, ctypes.c_int, many, where, where, where]
        self._sets.restype = None
        self._own = {field.name: np.array([float(value) for value in field.values]) for field in laws.fields}
        self.outputs = tuple(output.name for output in program.outputs)
        self.tau_max = program.tau_max
        self.parameters: Mapping[str, int] = {name: len(values) for name, values in self._own.items()}

    def run(self, tau: ArrayLike, **parameters: ArrayLike) -> tuple[Array, NDArray[np.int32], Array]:
        """Values of shape (sets, outputs, times), the status of each set and its error estimate.

        `parameters` by name have the shape (sets, numbers), or (numbers,) for all sets; those that are not given are
        the scene's. A set that is refused (status 1: a bad number; 2: bodies too light) has NaN throughout, as has tau
        out of range. WavesymError for a name that was not asked for, and for other shapes.
        """
        given = self._given(parameters)
        instants = np.ascontiguousarray(tau, np.float64).ravel()
        even = len(instants) > 1 and _even(instants)
        told = np.array([instants[0], instants[1] - instants[0]]) if even else instants
        sets, count = len(given), len(instants)
        status, estimate = np.zeros(sets, np.int32), np.zeros(sets)
        out = np.zeros((sets, len(self.outputs), count))
        places = (address(values) for values in (status, estimate, out))
        self._sets(address(given), sets, address(self._model), address(told), even, count, *places)
        return out, status, estimate

    def _given(self, parameters: Mapping[str, ArrayLike]) -> Array:
        """All fields side by side, a row for each set."""
        columns = dict(self._own)
        for name, values in parameters.items():
            if name not in columns:
                raise WavesymError(f"{name} given, {' or '.join(columns)} expected")
            numbers = np.asarray(values, np.float64)
            if numbers.ndim not in (1, 2) or numbers.shape[-1] != self.parameters[name]:
                wanted = f"(sets, {self.parameters[name]})"
                raise WavesymError(f"{name}: an array of shape {numbers.shape} given, {wanted} expected")
            columns[name] = numbers
        counts = {len(values) for values in columns.values() if values.ndim == 2}
        if len(counts) > 1:
            raise WavesymError(f"{' and '.join(map(str, sorted(counts)))} sets given, as many of each expected")
        sets = counts.pop() if counts else 1
        rows = [np.broadcast_to(values, (sets, values.shape[-1])) for values in columns.values()]
        return np.ascontiguousarray(np.concatenate(rows, axis=1))


def _even(tau: Array) -> bool:
    """Whether `sample` has the same instants, to the last bit."""
    return bool(np.array_equal(tau, tau[0] + np.arange(len(tau)) * (tau[1] - tau[0])))
