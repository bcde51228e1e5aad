"""Programs whose parameters are given when they run, computed for as many sets as there are: in C, compiled once."""

from __future__ import annotations

import ctypes

import numpy as np

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
        self._values, self._peaks, self._tangents = (
            getattr(loaded, f"{name}_sets{kind}") for kind in ("", "_peaks", "_tangents")
        )
        many, where = ctypes.c_size_t, ctypes.c_void_p
        for of_taus in (self._values, self._tangents):
            of_taus.argtypes = [where, many, where, where, ctypes.c_int, many, where, where, where]
            of_taus.restype = None
        self._peaks.argtypes = [where, many, where, where, where, where]
        self._peaks.restype = None
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
        found = _none(len(given), (self._outputs, 4))
        model = np.empty(self._size, np.uint8)
        self._peaks(address(given), len(given), address(model), *_places(found))
        return found

    def _at(self, function: ctypes._NamedFuncPointer, size: int, given: Array, tau: Array, lanes: int) -> FoundSets:
        even = len(tau) > 1 and _even(tau)
        told = np.array([tau[0], tau[1] - tau[0]]) if even else tau
        found = _none(len(given), (lanes, self._outputs, len(tau)))
        model = np.empty(size, np.uint8)  # of this call, so that several may run at once
        function(address(given), len(given), address(model), address(told), even, len(tau), *_places(found))
        return found


def _none(sets: int, shape: tuple[int, ...]) -> FoundSets:
    return FoundSets(np.empty(sets, np.int32), np.empty(sets), np.empty((sets, *shape)))


def _places(found: FoundSets) -> tuple[int, int, int]:
    return address(found.status), address(found.estimate), address(found.values)


def _even(tau: Array) -> bool:
    """Whether `sample` has the same instants, to the last bit."""
    return bool(np.array_equal(tau, tau[0] + np.arange(len(tau)) * (tau[1] - tau[0])))
