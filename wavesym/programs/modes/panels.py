"""Values of modes at many instants that lie alike in all panels: matrices, one for each of these places.

A value s after the start of a panel is linear in the states and loads there. What it takes of them depends on s alone,
so that thousands of panels of one length share it, and the functions of every mode are computed once.
"""

from __future__ import annotations

from functools import lru_cache
from math import ceil, factorial

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.modes.modal import Numbers
from wavesym.programs.program import Program
from wavesym.programs.schemes.modes import ModesScheme

_KEPT = 128  # matrices: as many as panels of a few lengths have places


class Panels(ModesScheme):
    """The panels of a program of modes."""

    @classmethod
    def of(cls, program: Program) -> Panels:
        """Those of a program in double precision."""
        return cls(program.tables, program.constants, program.tau_max, np.float64)

    def sampled(self, step: float) -> tuple[Numbers, Numbers]:
        """Instants no more than `step` apart, each panel in an even number of equal parts, and the outputs there."""
        starts = self._time[self._time < self._tau_max]
        last = len(starts) - 1
        lengths = self._length[self._kind[: last + 1]] if len(self._time) > 1 else np.empty(0)
        lengths = np.append(lengths[:last], self._tau_max - starts[-1])  # the last one ends with the horizon
        counts = [2 * ceil(length / (2 * step)) for length in lengths.tolist()]
        edges = np.cumsum([0, *counts])
        taus = np.empty(edges[-1] + 1)
        out = np.empty((self._direct.shape[2], edges[-1] + 1))
        taus[-1], out[:, -1] = self._tau_max, self.evaluate(self._tau_max)
        kinds, kind = np.unique(lengths, return_inverse=True)
        reads = lru_cache(_KEPT)(lambda s: self.reads(np.array([s]))[0])
        for first in range(0, last + 1, self.BLOCK):
            panels = np.arange(first, min(first + self.BLOCK, last + 1))
            states = self.states(first // self.BLOCK, int(panels[-1])).reshape(len(panels), -1)
            loads = self.load[:, panels].transpose(1, 0, 2).reshape(len(panels), -1)
            for k, length in enumerate(kinds.tolist()):
                chosen = panels[kind[panels] == k]
                if not len(chosen):
                    continue
                count = counts[chosen[0]]
                if len(chosen) == 1:  # shares its matrices with none: the rest, long after the last load
                    at = edges[chosen[0]] + np.arange(count)
                    taus[at] = starts[chosen[0]] + length * np.arange(count) / count
                    out[:, at] = self.evaluate(taus[at])
                    continue
                known = np.hstack([states[chosen - first], loads[chosen - first]])
                for part in range(count):
                    s = length * part / count
                    at = edges[chosen] + part
                    taus[at] = starts[chosen] + s
                    out[:, at] = (known @ reads(s)).T
        return taus, out

    def turns(self, s: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """What modes do in the times s: see `ModesScheme`."""
        return self._turned(s)

    def reads(self, s: NDArray[np.float64]) -> NDArray[np.float64]:
        """What outputs take of displacements, velocities, and of each load's slope, value and integrals, s later.

        (times, 2 modes + 4 loads, outputs).
        """
        p11, p12, p21, p22, one, two = (each[:, :, None] for each in self._turned(s))
        moved, moving, push = self._moved, self._moving, self._push
        rows = [p11 * moved + p21 * moving, p12 * moved + p22 * moving]
        for k, (pushed, speed) in enumerate(((two, one), (one, p12))):
            rows.append(push @ (pushed * moved + speed * moving) + self._direct_part(k, s))
        made: NDArray[np.float64] = np.concatenate([*rows, self._direct_part(2, s), self._direct_part(3, s)], axis=1)
        return made

    def _direct_part(self, part: int, s: NDArray[np.float64]) -> Numbers:
        """Of a slope (0), a load (1) or its integrals (2, 3), itself and integrated on: (times, loads, outputs)."""
        orders = ((k, k + 1 - part) for k in range(3))
        parts = [(s**order / factorial(order))[:, None, None] * self._direct[k] for k, order in orders if order >= 0]
        return np.asarray(sum(parts))
