"""Modes whose numbers are given when they run, in C: compiled where there is a compiler, as fast as it makes it."""

from __future__ import annotations

import ctypes
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.mode_sets.making import ModeSetsTables
from wavesym.programs.mode_sets.parameters import ModeParameters
from wavesym.programs.request import Request
from wavesym.running.native import FAST, address, library
from wavesym.running.toolchain import CompilerError, compiler
from wavesym.targets.files import runtime_sets

Array = NDArray[np.float64]

_WHERE, _MANY = ctypes.c_void_p, ctypes.c_size_t


class ModeSetResponses(NamedTuple):
    """Of each set its estimate (NaN for one that is refused), extremes (sets, outputs, 4): the least value, its tau,
    the greatest value, its tau; and histories (sets, outputs, instants)."""

    estimate: Array
    peaks: Array
    values: Array


class CompiledModeSets:
    """The C of the numbers of modes of a model."""

    def __init__(self, parameters: ModeParameters) -> None:
        self._parameters = parameters

    @staticmethod
    def is_possible() -> bool:
        """Whether there is a C compiler."""
        try:
            compiler()
        except CompilerError:
            return False
        return True

    @cached_property
    def _library(self) -> ctypes.CDLL:
        names = tuple(field.name for field in self._parameters.fields)
        program = ModeSetsTables(self._parameters).program(Request(runtime=names))
        files, name = runtime_sets(program, ("peaks",)), self._parameters.model.name
        header = f"{name}.h"
        return library(files[f"{name}.c"], FAST, (header, files[header]))

    def _function(self, name: str) -> ctypes._NamedFuncPointer:
        found: ctypes._NamedFuncPointer = getattr(self._library, f"{self._parameters.model.name}_{name}")
        return found

    def responses(self, given: Array, tau: Array) -> ModeSetResponses:
        """Those of sets of numbers (sets, numbers), at instants in any order."""
        size = self._function("model_size")
        size.restype = _MANY
        room = np.empty(size(), np.uint8)
        order = np.argsort(tau, kind="stable")
        instants, outputs = np.ascontiguousarray(tau[order]), len(self._parameters.model.probes)
        status = np.empty(len(given), np.int32)
        estimate, peaks = np.empty(len(given)), np.empty((len(given), outputs, 4))
        values = np.empty((len(given), outputs, len(tau)))
        run, numbers = self._function("sets"), np.ascontiguousarray(given)
        run.argtypes = [_WHERE, _MANY, _WHERE, _WHERE, _MANY, _WHERE, _WHERE, _WHERE, _WHERE]
        places = (address(each) for each in (status, estimate, peaks, values))
        run(address(numbers), len(given), address(room), address(instants), len(tau), *places)
        back = np.empty_like(order)
        back[order] = np.arange(len(order))
        return ModeSetResponses(estimate, peaks, values[:, :, back])
