"""The waves of a chain in their rings: values, or derivatives in lanes."""

from __future__ import annotations

import numpy as np

from wavesym.programs.runtime.arrays.laws import ArrayLaws
from wavesym.programs.runtime.arrays.signals import ArraySignals
from wavesym.programs.runtime.arrays.tables import ArrayTables
from wavesym.programs.runtime.engine import Array


class ArrayTracks(ArraySignals):
    """They begin with `law`. `sent` has the shape (slots, panels, degree + 1, ..., sets), `state`, of all joints,
    (..., states, sets).
    """

    def __init__(self, tables: ArrayTables, law: ArrayLaws, change: Array) -> None:
        super().__init__(tables, change)
        held = law["held"]
        *lanes, _, sets = held.shape
        sizes, first = tables.sizes, tables.ints("ring")
        self.sent = np.zeros((sizes["slots"], sizes["panels"], sizes["least"] + 1, *lanes, sets))
        for track, steps in enumerate(tables.ints("steps")):
            self.sent[first[track] : first[track] + steps + 1, :, 0] = held[..., track, :]
        self.state = law["begun"]

    @property
    def degree(self) -> int:
        """Of the series."""
        return int(self.sent.shape[2]) - 1

    def lengthen(self, degree: int) -> None:
        """Give series a higher degree."""
        more = [(0, 0)] * self.sent.ndim
        more[2] = (0, degree - self.degree)
        self.sent = np.pad(self.sent, more)

    def wave(self, track: int, window: int, ago: int, panel: int) -> Array:
        """What was sent on a track so many windows ago."""
        turn = int(self._tables.ints("steps")[track]) + 1
        wave: Array = self.sent[self._tables.ints("ring")[track] + (window - ago) % turn, panel]
        return wave

    def heard(self, window: int, term: int) -> Array:
        """A wave that is heard on a window."""
        track, panel, back = (int(self._tables.ints(f"term_{name}")[term]) for name in ("track", "panel", "back"))
        return self.wave(track, window, back, panel).copy()
