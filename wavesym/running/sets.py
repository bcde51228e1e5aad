"""Programs whose parameters are given when they run, computed for as many sets as there are: in C, compiled once."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.program import Program
from wavesym.programs.runtime.arrays.engine import ArraySets
from wavesym.programs.runtime.engine import Array, Engine, FoundSets
from wavesym.running.native import FAST, address, library
from wavesym.running.toolchain import CompilerError, compiler
from wavesym.targets.files import runtime_sets


def sets_engine(program: Program) -> Engine:
    """What computes a program here: C, or NumPy where there is no compiler."""
    try:
        compiler()
    except CompilerError:
        return ArraySets(program)
    return CompiledSets(program)


class CompiledSets:
    """One set after the other, in the memory of one model. CompilerError where there is no C compiler."""

    def __init__(self, program: Program) -> None:
        name = program.provenance.model.name
        files = runtime_sets(program)
        loaded = library(files[f"{name}.c"], FAST, (f"{name}.h", files[f"{name}.h"]))
        self._outputs = len(program.outputs)
        self._values, self._peaks, self._tangents, self._misfits, self._bounds = (
            getattr(loaded, f"{name}_sets{kind}") for kind in ("", "_peaks", "_tangents", "_misfits", "_bounds")
        )
        many, where = ctypes.c_size_t, ctypes.c_void_p
        for of_taus in (self._values, self._tangents):
            of_taus.argtypes = [where, many, where, where, ctypes.c_int, many, where, where, where]
            of_taus.restype = None
        for of_sets in (self._peaks, self._bounds):
            of_sets.argtypes = [where, many, where, where, where, where]
            of_sets.restype = None
        self._misfits.argtypes = [where, many, where, where, where, where, where]
        self._misfits.restype = None
        self._data_size, self._data = getattr(loaded, f"{name}_data_size"), getattr(loaded, f"{name}_data_init")
        self._data_size.argtypes, self._data_size.restype = [where, many], many
        self._data.argtypes = [where, where, where, where, many]
        sizes = (many * 2)()
        getattr(loaded, f"{name}_sets_sizes")(sizes)
        self._batch_size, self._data_bytes = sizes
        self._size, self._tangent_size = (
            ctypes.CFUNCTYPE(ctypes.c_size_t)((f"{name}_{kind}_size", loaded))() for kind in ("model", "tangent")
        )

    def values(self, given: Array, tau: Array) -> FoundSets:
        """See `Engine`."""
        return self._at(self._values, self._size, given, tau, 1)

    def tangents(self, given: Array, tau: Array) -> FoundSets:
        """See `Engine`."""
        return self._at(self._tangents, self._tangent_size, given, tau, 1 + given.shape[1])

    def peaks(self, given: Array) -> FoundSets:
        """See `Engine`."""
        return self._of_each(self._peaks, given, (self._outputs, 4))

    def bounds(self, given: Array) -> FoundSets:
        """See `Engine`."""
        return self._of_each(self._bounds, given, (self._outputs,))

    def _of_each(self, function: ctypes._NamedFuncPointer, given: Array, shape: tuple[int, ...]) -> FoundSets:
        found = _none(len(given), shape)
        model = np.empty(self._size, np.uint8)
        function(address(given), len(given), address(model), *_places(found))
        return found

    def misfit(self, tau: Array, data: Array) -> Callable[[Array], FoundSets]:
        """See `Engine`."""
        values = np.ascontiguousarray(data)
        kept, numbers = np.empty(self._data_bytes, np.uint8), np.empty(self._data_size(address(tau), len(tau)))
        self._data(address(kept), address(numbers), address(tau), address(values), len(tau))

        def misfits(given: Array) -> FoundSets:
            _ = numbers  # C reads them, so that they must live as long as this
            found = _none(len(given), ())
            batch = _aligned(self._batch_size)
            self._misfits(address(given), len(given), address(batch), address(kept), *_places(found))
            return found

        return misfits

    def _at(self, function: ctypes._NamedFuncPointer, size: int, given: Array, tau: Array, lanes: int) -> FoundSets:
        even = len(tau) > 1 and _even(tau)
        told = np.array([tau[0], tau[1] - tau[0]]) if even else tau
        found = _none(len(given), (lanes, self._outputs, len(tau)))
        model = np.empty(size, np.uint8)  # of this call, so that several may run at once
        function(address(given), len(given), address(model), address(told), even, len(tau), *_places(found))
        return found


def _aligned(size: int) -> NDArray[np.uint8]:
    """Memory from a multiple of 64 bytes on."""
    memory = np.empty(size + 64, np.uint8)
    begin = -memory.ctypes.data % 64
    return memory[begin : begin + size]


def _none(sets: int, shape: tuple[int, ...]) -> FoundSets:
    return FoundSets(np.empty(sets, np.int32), np.empty(sets), np.empty((sets, *shape)))


def _places(found: FoundSets) -> tuple[int, int, int]:
    return address(found.status), address(found.estimate), address(found.values)


def _even(tau: Array) -> bool:
    """Whether `sample` has the same instants, to the last bit."""
    return bool(np.array_equal(tau, tau[0] + np.arange(len(tau)) * (tau[1] - tau[0])))
