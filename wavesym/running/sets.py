"""Programs whose parameters are given when they run, computed for as many sets as there are: in C, of which each part
is compiled once, when it is first asked for.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array
from wavesym.programs.program import Program
from wavesym.running.native import FAST, address, library, struct_size
from wavesym.running.toolchain import compiler
from wavesym.targets.files import runtime_sets

_MANY, _WHERE = ctypes.c_size_t, ctypes.c_void_p
_LARGEST_BATCH = 1 << 28  # bytes

Memory = NDArray[np.uint8]


_VALUES, _SLOPES, _BOUNDS = ("peaks", "batch", "misfit"), ("gradients",), ("bound",)
"""What is compiled together: each when it is first asked for."""
_AT = [_WHERE, ctypes.c_int, _MANY]  # instants


class FoundSets(NamedTuple):
    """Of each set its status (0; 1 a bad number; 2 bodies too light), its error estimate, or one of values and of each
    derivative, and what was asked for, all NaN where the status is not 0.
    """

    status: NDArray[np.int32]
    estimate: Array
    values: Array


def no_sets(sets: int, shape: tuple[int, ...], estimates: tuple[int, ...] = ()) -> FoundSets:
    """Room for what is found."""
    return FoundSets(np.empty(sets, np.int32), np.empty((sets, *estimates)), np.empty((sets, *shape)))


class CompiledSets:
    """Several sets side by side, derivatives and bounds of one after the other, in the memory of one model.

    `given` has a row for each set, with all fields side by side; `tau` is one-dimensional. CompilerError where there is
    no C compiler.
    """

    def __init__(self, program: Program) -> None:
        compiler()
        laws = program.laws
        assert laws is not None
        self._program = program
        self.fields, self.model, self.tau_max = laws.fields, program.provenance.model, program.tau_max
        self._name = program.provenance.model.name
        self._outputs = len(program.outputs)
        self._libraries: dict[tuple[str, ...], ctypes.CDLL] = {}

    def _library(self, parts: tuple[str, ...]) -> ctypes.CDLL:
        if parts not in self._libraries:
            files = runtime_sets(self._program, parts)
            header = (f"{self._name}.h", files[f"{self._name}.h"])
            self._libraries[parts] = library(files[f"{self._name}.c"], FAST, header)
        return self._libraries[parts]

    def _function(
        self, parts: tuple[str, ...], name: str, arguments: list[Any], result: Any = None
    ) -> ctypes._NamedFuncPointer:
        found: ctypes._NamedFuncPointer = getattr(self._library(parts), f"{self._name}_{name}")
        found.argtypes, found.restype = arguments, result
        return found

    def _room(self, parts: tuple[str, ...], struct: str) -> Memory:
        """Memory for a struct, from a multiple of 64 bytes on."""
        memory = np.empty(struct_size(self._library(parts), struct) + 64, np.uint8)
        return memory[-memory.ctypes.data % 64 :]

    def values(self, given: Array, tau: Array) -> FoundSets:
        """Of shape (sets, 1, outputs, times)."""
        sets = self._function(_VALUES, "sets", [_WHERE, _MANY, _WHERE, _WHERE, *_AT, _WHERE, _WHERE, _WHERE])
        shape = (1, self._outputs, len(tau))
        return self._call_at(
            sets, [self._batch(), self._room(_VALUES, "model")], given, tau, no_sets(len(given), shape)
        )

    def tangents(self, given: Array, tau: Array) -> FoundSets:
        """The values, then their derivatives by each parameter: of shape (sets, 1 + parameters, outputs, times); and as
        many estimates, of shape (sets, 1 + parameters).
        """
        tangents = self._function(_SLOPES, "sets_tangents", [_WHERE, _MANY, _WHERE, *_AT, _WHERE, _WHERE, _WHERE])
        lanes = 1 + given.shape[1]
        found = no_sets(len(given), (lanes, self._outputs, len(tau)), (lanes,))
        return self._call_at(tangents, [self._room(_SLOPES, "tangent")], given, tau, found)

    def peaks(self, given: Array) -> FoundSets:
        """Of shape (sets, outputs, 4): the least value, its tau, the greatest value, its tau."""
        peaks = self._function(_VALUES, "sets_peaks", [_WHERE, _MANY, _WHERE, _WHERE, _WHERE, _WHERE, _WHERE])
        return self._call_for_each(peaks, [self._batch(), self._room(_VALUES, "model")], given, (self._outputs, 4))

    def bounds(self, given: Array) -> FoundSets:
        """The proved bound of each output, of shape (sets, outputs)."""
        bounds = self._function(_BOUNDS, "sets_bounds", [_WHERE, _MANY, _WHERE, _WHERE, _WHERE, _WHERE])
        return self._call_for_each(bounds, [self._room(_BOUNDS, "model")], given, (self._outputs,))

    def misfit(self, tau: Array, data: Array) -> Callable[[Array], FoundSets]:
        """What makes of `given` the sums of the squares of all misfits, of shape (sets,). `data` of shape
        (outputs, times) is NaN where there is none.
        """
        misfit = self._function(_VALUES, "sets_misfits", [_WHERE, _MANY, _WHERE, _WHERE, _WHERE, _WHERE, _WHERE])
        size = self._function(_VALUES, "data_size", [_WHERE, _MANY], _MANY)
        init = self._function(_VALUES, "data_init", [_WHERE, _WHERE, _WHERE, _WHERE, _MANY], ctypes.c_int)
        values = np.ascontiguousarray(data)
        kept, numbers = self._room(_VALUES, "data"), np.empty(size(address(tau), len(tau)))
        init(address(kept), address(numbers), address(tau), address(values), len(tau))

        def misfits(given: Array) -> FoundSets:
            _ = numbers  # C reads them, so that they must live as long as this
            found = no_sets(len(given), ())
            batch = self._room(_VALUES, "batch")
            misfit(address(given), len(given), address(batch), address(kept), *_places(found))
            return found

        return misfits

    def _batch(self) -> Memory | None:
        """Room for sets side by side, of each call its own, so that several may run at once; none for huge models."""
        size = struct_size(self._library(_VALUES), "batch")
        return self._room(_VALUES, "batch") if size <= _LARGEST_BATCH else None

    def _call_for_each(
        self,
        function: ctypes._NamedFuncPointer,
        room: Sequence[Memory | None],
        given: Array,
        shape: tuple[int, ...],
    ) -> FoundSets:
        found = no_sets(len(given), shape)
        function(address(given), len(given), *map(_place, room), *_places(found))
        return found

    def _call_at(
        self,
        function: ctypes._NamedFuncPointer,
        room: Sequence[Memory | None],
        given: Array,
        tau: Array,
        found: FoundSets,
    ) -> FoundSets:
        even = len(tau) > 1 and _even(tau)
        instants = np.array([tau[0], tau[1] - tau[0]]) if even else tau
        function(address(given), len(given), *map(_place, room), address(instants), even, len(tau), *_places(found))
        return found


def _place(room: Memory | None) -> int | None:
    return None if room is None else address(room)


def _places(found: FoundSets) -> tuple[int, int, int]:
    return address(found.status), address(found.estimate), address(found.values)


def _even(tau: Array) -> bool:
    """Whether `sample` has the same instants, to the last bit."""
    return bool(np.array_equal(tau, tau[0] + np.arange(len(tau)) * (tau[1] - tau[0])))
