"""Programs whose parameters are given when they run, computed for as many sets as there are: in C, of which each part
is compiled once, when it is first asked for.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.program import Program
from wavesym.programs.runtime.arrays.engine import ArraySets
from wavesym.programs.runtime.engine import Array, Engine, FoundSets, no_sets
from wavesym.running.native import FAST, address, library
from wavesym.running.toolchain import CompilerError, compiler
from wavesym.targets.files import runtime_sets

_MANY, _WHERE = ctypes.c_size_t, ctypes.c_void_p
_LARGEST_BATCH = 1 << 28  # bytes

Memory = NDArray[np.uint8]


def sets_engine(program: Program) -> Engine:
    """What computes a program here: C, or NumPy where there is no compiler."""
    try:
        compiler()
    except CompilerError:
        return ArraySets(program)
    return CompiledSets(program)


_VALUES, _SLOPES, _BOUNDS = ("peaks", "batch", "misfit"), ("gradients",), ("bound",)
"""What is compiled together: each when it is first asked for."""
_AT = [_WHERE, ctypes.c_int, _MANY]  # instants


class CompiledSets:
    """Several sets side by side, derivatives and bounds of one after the other, in the memory of one model.

    CompilerError where there is no C compiler.
    """

    def __init__(self, program: Program) -> None:
        self._program = program
        self._name = program.provenance.model.name
        self._outputs = len(program.outputs)
        self._libraries: dict[tuple[str, ...], ctypes.CDLL] = {}

    def _function(
        self, parts: tuple[str, ...], name: str, arguments: list[Any], result: Any = None
    ) -> ctypes._NamedFuncPointer:
        if parts not in self._libraries:
            files = runtime_sets(self._program, parts)
            header = (f"{self._name}.h", files[f"{self._name}.h"])
            # joints have loops over a few states, which -O3 takes three times as long to compile for a tenth of their
            # time
            flags = ("-O2", *FAST[1:]) if self._program.kind == "joints" else FAST
            self._libraries[parts] = library(files[f"{self._name}.c"], flags, header)
        found: ctypes._NamedFuncPointer = getattr(self._libraries[parts], f"{self._name}_{name}")
        found.argtypes, found.restype = arguments, result
        return found

    def _room(self, parts: tuple[str, ...], struct: str) -> Memory:
        return np.empty(self._function(parts, f"{struct}_size", [], _MANY)(), np.uint8)

    def values(self, given: Array, tau: Array) -> FoundSets:
        """See `Engine`."""
        sets = self._function(_VALUES, "sets", [_WHERE, _MANY, _WHERE, _WHERE, *_AT, _WHERE, _WHERE, _WHERE])
        shape = (1, self._outputs, len(tau))
        return self._at(sets, [self._batch(), self._room(_VALUES, "model")], given, tau, no_sets(len(given), shape))

    def tangents(self, given: Array, tau: Array) -> FoundSets:
        """See `Engine`."""
        tangents = self._function(_SLOPES, "sets_tangents", [_WHERE, _MANY, _WHERE, *_AT, _WHERE, _WHERE, _WHERE])
        lanes = 1 + given.shape[1]
        found = no_sets(len(given), (lanes, self._outputs, len(tau)), (lanes,))
        return self._at(tangents, [self._room(_SLOPES, "tangent")], given, tau, found)

    def peaks(self, given: Array) -> FoundSets:
        """See `Engine`."""
        peaks = self._function(_VALUES, "sets_peaks", [_WHERE, _MANY, _WHERE, _WHERE, _WHERE, _WHERE, _WHERE])
        return self._of_each(peaks, [self._batch(), self._room(_VALUES, "model")], given, (self._outputs, 4))

    def bounds(self, given: Array) -> FoundSets:
        """See `Engine`."""
        bounds = self._function(_BOUNDS, "sets_bounds", [_WHERE, _MANY, _WHERE, _WHERE, _WHERE, _WHERE])
        return self._of_each(bounds, [self._room(_BOUNDS, "bounded")], given, (self._outputs,))

    def misfit(self, tau: Array, data: Array) -> Callable[[Array], FoundSets]:
        """See `Engine`."""
        misfit = self._function(_VALUES, "sets_misfits", [_WHERE, _MANY, _WHERE, _WHERE, _WHERE, _WHERE, _WHERE])
        size = self._function(_VALUES, "data_size", [_WHERE, _MANY], _MANY)
        init = self._function(_VALUES, "data_init", [_WHERE, _WHERE, _WHERE, _WHERE, _MANY], ctypes.c_int)
        values = np.ascontiguousarray(data)
        kept, numbers = np.empty(self._sizes[1], np.uint8), np.empty(size(address(tau), len(tau)))
        init(address(kept), address(numbers), address(tau), address(values), len(tau))

        def misfits(given: Array) -> FoundSets:
            _ = numbers  # C reads them, so that they must live as long as this
            found = no_sets(len(given), ())
            batch = _aligned(self._sizes[0])
            misfit(address(given), len(given), address(batch), address(kept), *_places(found))
            return found

        return misfits

    @cached_property
    def _sizes(self) -> tuple[int, int]:
        """Of a batch and of data."""
        sizes = (_MANY * 2)()
        self._function(_VALUES, "sets_sizes", [_MANY * 2])(sizes)
        return sizes[0], sizes[1]

    def _batch(self) -> Memory | None:
        """Room for sets side by side, of each call its own, so that several may run at once; none for huge models."""
        return _aligned(self._sizes[0]) if self._sizes[0] <= _LARGEST_BATCH else None

    def _of_each(
        self,
        function: ctypes._NamedFuncPointer,
        room: Sequence[Memory | None],
        given: Array,
        shape: tuple[int, ...],
    ) -> FoundSets:
        found = no_sets(len(given), shape)
        function(address(given), len(given), *map(_place, room), *_places(found))
        return found

    def _at(
        self,
        function: ctypes._NamedFuncPointer,
        room: Sequence[Memory | None],
        given: Array,
        tau: Array,
        found: FoundSets,
    ) -> FoundSets:
        even = len(tau) > 1 and _even(tau)
        told = np.array([tau[0], tau[1] - tau[0]]) if even else tau
        function(address(given), len(given), *map(_place, room), address(told), even, len(tau), *_places(found))
        return found


def _place(room: Memory | None) -> int | None:
    return None if room is None else address(room)


def _aligned(size: int) -> Memory:
    """Memory from a multiple of 64 bytes on."""
    memory = np.empty(size + 64, np.uint8)
    begin = -memory.ctypes.data % 64
    return memory[begin : begin + size]


def _places(found: FoundSets) -> tuple[int, int, int]:
    return address(found.status), address(found.estimate), address(found.values)


def _even(tau: Array) -> bool:
    """Whether `sample` has the same instants, to the last bit."""
    return bool(np.array_equal(tau, tau[0] + np.arange(len(tau)) * (tau[1] - tau[0])))
