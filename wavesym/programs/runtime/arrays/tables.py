"""The tables and sizes of a program as arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.program import Program
from wavesym.programs.runtime.engine import Array

Ints = NDArray[np.int64]


class ArrayTables:
    """Reals by their name in the program, whole numbers by `ints`."""

    def __init__(self, program: Program) -> None:
        assert program.laws is not None
        self.laws = program.laws
        self.outputs = len(program.outputs)
        self.tau_max = program.tau_max
        self.sizes = {name: int(value) for name, value in program.constants.items() if value == int(value)}
        self.share, self.unit = program.constants["share"], program.constants["unit"]
        self._reals = {name: np.array(values, np.float64) for name, values in program.tables.items()}
        self._ints = {name: np.array(values).astype(np.int64) for name, values in program.tables.items()}

    def __getitem__(self, name: str) -> Array:
        return self._reals[name]

    def ints(self, name: str) -> Ints:
        """A table of whole numbers."""
        return self._ints[name]

    def strands(self, section: int, output: int) -> Ints:
        """Those that are an output on a section."""
        at = section * self.outputs + output
        first = self.ints("first_strand")
        return self.ints("strand_at")[first[at] : first[at + 1]]

    def on(self, strand: int, t: Array) -> Array:
        """Where on [-1, 1] the series of a strand are at t after the start of a window."""
        since = (t - self["strand_start"][strand]) + self["strand_excess"][strand]
        u: Array = since * self["strand_scale"][strand] - 1
        return u
