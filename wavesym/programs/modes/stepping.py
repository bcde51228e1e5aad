"""Modes that are stepped panel by panel: their states at the starts of panels, in order, each stepped once."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.schemes.modes import ModesScheme


class SteppedModes(ModesScheme):
    """A scheme that keeps the states of the block that it has stepped last; whoever goes on steps no block twice."""

    _last_block: tuple[int, NDArray[np.float64]] | None = None

    def states(self, block: int, last: int) -> NDArray[np.float64]:
        """As those of a scheme: displacements and velocities at the starts of panels, (panels, 2, modes)."""
        first = block * self.BLOCK
        if self._last_block is None or self._last_block[0] != block:
            while len(self._marks) <= block:  # each adds the mark of the next one
                self.states(len(self._marks) - 1, (len(self._marks) - 1) * self.BLOCK)
            end = min(first + self.BLOCK, len(self._time) - 1)
            states = self._step_states(self._marks[block], first, end)
            if len(self._marks) == block + 1 and end == first + self.BLOCK:
                self._marks.append(states[-1].copy())  # alone: a view would keep all states
            self._last_block = block, states
        return self._last_block[1][: last - first + 1]

    def starts(self) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Block by block the states at the starts of its panels, and the outputs there: (panels, outputs)."""
        last = len(self._time) - 1
        for block in range(last // self.BLOCK + 1):
            first, end = block * self.BLOCK, min((block + 1) * self.BLOCK - 1, last)
            states = self.states(block, end)
            _, load, once, twice = self.load[:, first : end + 1]
            inside = self._time[first : end + 1] <= self.tau_max
            out = states[:, 0] @ self._moved + states[:, 1] @ self._moving
            out += load @ self._direct[0] + once @ self._direct[1] + twice @ self._direct[2]
            yield states, out[inside]
