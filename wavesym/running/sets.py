"""Programs whose parameters are given when they run, computed for as many sets as there are: in C, of which each part
is compiled once, when it is first asked for.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array
from wavesym.programs.program import Program
from wavesym.running.native import FAST, call, library, room, struct_size
from wavesym.running.toolchain import compiler
from wavesym.targets.files import runtime_sets

_LARGEST_BATCH = 1 << 28  # bytes

Memory = NDArray[np.uint8]


_VALUES, _SLOPES, _BOUNDS = ("peaks", "batch", "misfit"), ("gradients",), ("bound",)
"""What is compiled together: each when it is first asked for."""


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

    def _room(self, parts: tuple[str, ...], struct: str) -> Memory:
        return room(self._library(parts), struct)

    def _call(self, parts: tuple[str, ...], name: str, *given: object, result: Any = None) -> Any:
        return call(self._library(parts), f"{self._name}_{name}", *given, result=result)

    def values(self, given: Array, tau: Array) -> FoundSets:
        """Of shape (sets, 1, outputs, times)."""
        found = no_sets(len(given), (1, self._outputs, len(tau)))
        memory = self._batch(), self._room(_VALUES, "model")
        self._call(_VALUES, "sets", given, len(given), *memory, *_instants(tau), *found)
        return found

    def tangents(self, given: Array, tau: Array) -> FoundSets:
        """The values, then their derivatives by each parameter: of shape (sets, 1 + parameters, outputs, times); and as
        many estimates, of shape (sets, 1 + parameters).
        """
        lanes = 1 + given.shape[1]
        found = no_sets(len(given), (lanes, self._outputs, len(tau)), (lanes,))
        memory = self._room(_SLOPES, "tangent")
        self._call(_SLOPES, "sets_tangents", given, len(given), memory, *_instants(tau), *found)
        return found

    def peaks(self, given: Array) -> FoundSets:
        """Of shape (sets, outputs, 4): the least value, its tau, the greatest value, its tau."""
        found = no_sets(len(given), (self._outputs, 4))
        self._call(_VALUES, "sets_peaks", given, len(given), self._batch(), self._room(_VALUES, "model"), *found)
        return found

    def bounds(self, given: Array) -> FoundSets:
        """The proved bound of each output, of shape (sets, outputs)."""
        found = no_sets(len(given), (self._outputs,))
        self._call(_BOUNDS, "sets_bounds", given, len(given), self._room(_BOUNDS, "model"), *found)
        return found

    def misfit(self, tau: Array, data: Array) -> Callable[[Array], FoundSets]:
        """What makes of `given` the sums of the squares of all misfits, of shape (sets,). `data` of shape
        (outputs, times) is NaN where there is none.
        """
        size = self._call(_VALUES, "data_size", tau, len(tau), result=ctypes.c_size_t)
        kept, numbers = self._room(_VALUES, "data"), np.empty(size)
        self._call(_VALUES, "data_init", kept, numbers, tau, np.ascontiguousarray(data), len(tau))

        def misfits(given: Array) -> FoundSets:
            _ = numbers  # C reads them, so that they must live as long as this
            found = no_sets(len(given), ())
            self._call(_VALUES, "sets_misfits", given, len(given), self._room(_VALUES, "batch"), kept, *found)
            return found

        return misfits

    def _batch(self) -> Memory | None:
        """Room for sets side by side, of each call its own, so that several may run at once; none for huge models."""
        size = struct_size(self._library(_VALUES), "batch")
        return self._room(_VALUES, "batch") if size <= _LARGEST_BATCH else None


def _instants(tau: Array) -> tuple[Array, bool, int]:
    """Instants as C takes them: the first and the step of those that are even, or all; and how many there are."""
    even = len(tau) > 1 and _even(tau)
    return np.array([tau[0], tau[1] - tau[0]]) if even else tau, even, len(tau)


def _even(tau: Array) -> bool:
    """Whether `sample` has the same instants, to the last bit."""
    return bool(np.array_equal(tau, tau[0] + np.arange(len(tau)) * (tau[1] - tau[0])))
