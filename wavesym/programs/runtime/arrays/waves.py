"""The waves of a named system on two windows: values, or derivatives in lanes."""

from __future__ import annotations

import numpy as np

from wavesym.programs.runtime.arrays.laws import ArrayLaws
from wavesym.programs.runtime.arrays.signals import ArraySignals
from wavesym.programs.runtime.arrays.tables import ArrayTables
from wavesym.programs.runtime.engine import Array
from wavesym.programs.runtime.line import LEFT, LOAD, RIGHT


class ArrayWaves(ArraySignals):
    """They begin with `law`.

    `sent` has the shape (2 windows, 2 ways, panels, degree + 1, ..., nodes + 2, sets), where the first and the last
    node stand for what comes from outside.
    """

    def __init__(self, tables: ArrayTables, law: ArrayLaws, change: Array) -> None:
        super().__init__(tables, change)
        rod = law["rod"]
        *lanes, rods, sets = rod.shape
        self.sent = np.zeros((2, 2, tables.sizes["panels"], tables.sizes["least"] + 1, *lanes, rods + 1, sets))
        self.sent[:, LEFT, :, 0, ..., 1:, :] = rod
        self.sent[:, RIGHT, :, 0, ..., :-1, :] = rod
        self.velocity = law["motion"]

    @property
    def degree(self) -> int:
        """Of the series."""
        return int(self.sent.shape[3]) - 1

    def lengthen(self, degree: int) -> None:
        """Give series a higher degree."""
        more = [(0, 0)] * self.sent.ndim
        more[3] = (0, degree - self.degree)
        self.sent = np.pad(self.sent, more)

    def arriving(self, window: int, panel: int) -> tuple[Array, Array]:
        """From the left and from the right, at each node."""
        before = self.sent[(window + 1) % 2, :, panel]
        return before[RIGHT][..., :-2, :], before[LEFT][..., 2:, :]

    def send(self, window: int, panel: int, q: Array) -> None:
        """What nodes that move with q send."""
        a, b = self.arriving(window, panel)
        self.sent[window % 2, LEFT, panel][..., 1:-1, :] = q - a
        self.sent[window % 2, RIGHT, panel][..., 1:-1, :] = q - b

    def heard(self, window: int, term: int) -> Array:
        """A wave that is heard on a window."""
        way, panel, sender, back = (
            int(self._tables.ints(f"term_{name}")[term]) for name in ("way", "panel", "sender", "back")
        )
        wave: Array
        if way == LOAD:
            wave = np.zeros((self.degree + 1, *self.force.shape[2:-2], self.force.shape[-1]))
            wave[:3] = self.force[panel][..., sender, :]
        else:
            wave = self.sent[(window + back) % 2, way, panel][..., sender, :]
        return wave
