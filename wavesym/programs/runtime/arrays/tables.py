"""The tables and sizes of a program as arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.program import Program
from wavesym.programs.runtime.engine import Array

Ints = NDArray[np.int64]


class ArrayTables:
    """Reals by their name in the program, whole numbers by `ints`.

    Instants are counted from the start of a cycle of windows, `span` long. Of a window what depends on its place in the
    cycle, its phase, is told so.
    """

    def __init__(self, program: Program) -> None:
        assert program.laws is not None
        self.laws, self.kind = program.laws, program.kind
        self.outputs = len(program.outputs)
        self.tau_max = program.tau_max
        self.sizes = {name: int(value) for name, value in program.constants.items() if value == int(value)}
        self.faint = 2.0**-1022 / program.constants["unit"]
        self.share, self.unit = program.constants["share"], program.constants["unit"]
        self.step, self.span = (program.constants.get(name, 1.0) for name in ("step", "span"))
        self.cycle = self.sizes.get("cycle", 1)
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

    def windows(self, phase: int) -> Ints:
        """Those of a phase."""
        return np.arange(phase, self.sizes["windows"], self.cycle)

    def begins(self, windows: Ints) -> Array:
        """When the cycles of windows begin."""
        found: Array = (windows // self.cycle).astype(np.float64) * self.span
        return found

    def section(self, phase: int, section: int) -> tuple[float, float]:
        """Where a section of a window begins and ends."""
        at = phase * self.sizes["sections"] + section
        begin, end = self["from"][at : at + 2].tolist()
        return begin, end

    def places(self, tau: Array) -> tuple[Ints, Ints, Array]:
        """Of instants on the horizon the window, the section, and the time since the cycle began."""
        cycle = (tau / self.span).astype(np.int64)
        cycle -= (cycle > 0) & (cycle * self.span > tau)
        t: Array = tau - self.begins(cycle * self.cycle)
        at = np.searchsorted(self["from"][1:-1], t, side="right")
        window, section = divmod(at, self.sizes["sections"])
        return cycle * self.cycle + window, section, t

    def on(self, strand: int, t: Array, phase: int) -> Array:
        """Where on [-1, 1] the series of a strand are."""
        at = phase * self.sizes["strands"] + strand
        since = (t - self["strand_start"][at]) + self["strand_excess"][at]
        u: Array = since * self["strand_scale"][strand] - 1
        return u
