"""A stream, from Python: C of a scene whose loads come sample by sample, compiled and stepped."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesym.errors import WavesymError
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.program import Program
from wavesym.running.native import FAST, address, library, struct_size
from wavesym.targets.files import sources


class StreamModel:
    """A scene whose loads come while it runs, in C: `start` gives as many streams of it as are wanted.

    `outputs` and `loads` are the names, those of loads with their units; `fields` are the parameters. CompilerError
    without a C compiler.
    """

    def __init__(self, program: Program, flags: Sequence[str] = ()) -> None:
        name = program.provenance.model.name
        files = sources(program, "c")
        loaded = library(files[f"{name}.c"], tuple(flags or FAST), (f"{name}.h", files[f"{name}.h"]))
        real, where = ctypes.c_double if program.real.bytes == 8 else ctypes.c_float, ctypes.c_void_p
        begin = "build" if program.laws else "init"
        self._begin, self._step, self._lost = (getattr(loaded, f"{name}_{word}") for word in (begin, "step", "lost"))
        self._begin.argtypes, self._begin.restype = ([where, where], ctypes.c_int) if program.laws else ([where], None)
        self._step.argtypes = [where, real, where, where]
        self._lost.argtypes, self._lost.restype = [where], real
        self.state_bytes = struct_size(loaded, "state")
        """What a stream takes."""
        self.dtype = np.dtype(f"f{program.real.bytes}")
        self.outputs = tuple(output.name for output in program.outputs)
        self.loads = program.sources
        self.fields = program.laws.fields if program.laws else ()
        self.panel = program.constants["panel"]

    def start(self, **given: ArrayLike) -> Stream:
        """A stream at tau = 0, its loads 0, with the parameters `given` by field and those of the scene for the others.

        WavesymError for a field that the program has not got, or that has another number of values.
        """
        state = np.zeros(self.state_bytes, np.uint8)
        for name in given.keys() - {field.name for field in self.fields}:
            raise WavesymError(
                f"{name}: not a parameter of this stream; write "
                f"{', '.join(field.name for field in self.fields) or 'nothing'}"
            )
        rows = []
        for field in self.fields:
            row = np.array(given.get(field.name, list(map(nearest, field.values))), self.dtype).ravel()
            if len(row) != len(field.values):
                raise WavesymError(f"{field.name}: {len(row)} values; write {len(field.values)}")
            rows.append(row)
        status = self._begin(address(state), *([address(np.concatenate(rows))] if rows else []))
        return Stream(self, state, int(status or 0))


class Stream:
    """A stream. Its `state` is plain data: a copy goes on from where it was taken.

    `refused` is 0, 1 for parameters that are bad numbers, or 2 where the degree is too low for them: then it gives NaN.
    """

    def __init__(self, model: StreamModel, state: NDArray[np.uint8], refused: int = 0) -> None:
        self._model, self.state, self.refused = model, state, refused

    def step(self, dtau: float, loads: ArrayLike) -> tuple[int, Array]:
        """Go on by dtau while loads go straight to `loads`, or jump to them with dtau = 0: the status, and all outputs.

        The status is 0, 1 where something is refused (outputs are NaN), or 2 where more than the tolerance may be lost.
        WavesymError where there are not as many loads as the scene has.
        """
        model = self._model
        given = np.array(loads, model.dtype).ravel()
        if len(given) != len(model.loads):
            raise WavesymError(
                f"loads: {len(given)} values for {len(model.loads)} loads; write one for each of "
                f"{', '.join(model.loads)}"
            )
        out = np.empty(len(model.outputs), model.dtype)
        status = int(model._step(address(self.state), dtau, address(given), address(out)))
        return status, out.astype(np.float64)

    @property
    def lost(self) -> float:
        """What polynomials have lost so far, relative to the largest wave so far: an estimate."""
        return float(self._model._lost(address(self.state)))

    def copy(self) -> Stream:
        """Another one that goes on from here."""
        return Stream(self._model, self.state.copy(), self.refused)
