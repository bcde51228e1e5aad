"""The nodes of a named system on a window, and their derivatives."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.runtime.arrays.bodies import ArrayBodies
from wavesym.programs.runtime.arrays.cone import reached
from wavesym.programs.runtime.arrays.laws import ArrayLaws
from wavesym.programs.runtime.arrays.motion import ArrayMotion, WindowTried
from wavesym.programs.runtime.arrays.tables import ArrayTables
from wavesym.programs.runtime.arrays.waves import ArrayWaves
from wavesym.programs.runtime.engine import Array


class ArrayNodes(ArrayMotion[ArrayWaves]):
    """All nodes at once."""

    def __init__(self, tables: ArrayTables, law: ArrayLaws, slope: ArrayLaws | None) -> None:
        super().__init__(tables, law, slope, ArrayWaves)
        self._massive = law["rate"] > 0
        self._on = tables.ints("force_on").tolist()
        self._moved: list[tuple[Array, Array]] = []

    @staticmethod
    def serves(tables: ArrayTables, law: ArrayLaws) -> NDArray[np.bool_]:
        """No body has become so heavy that it is none."""
        found: NDArray[np.bool_] = ~np.any((tables.ints("is_body")[:, None] > 0) & ~(law["rate"] > 0), axis=0)
        return found

    def tabulate(self) -> None:
        """See `ArrayMotion`."""
        steps = (self._law["rate"] * (2 * half) for half in self._tables["half_length"])
        self._bodies = [ArrayBodies(step, self.value.degree) for step in steps]

    def lengthen(self, degree: int) -> None:
        """See `ArrayMotion`."""
        self.value.lengthen(degree)
        self.tabulate()

    def tried(self, window: int) -> WindowTried:
        """See `ArrayMotion`."""
        law, value, massive = self._law, self.value, self._massive
        missed, size, velocity = *np.zeros((2, law["rate"].shape[1])), value.velocity
        self._moved = []
        for panel, bodies in enumerate(self._bodies):
            a, b = value.arriving(window, panel)
            p = law["alpha"] * a + law["beta"] * b
            value.push(p, panel, self._on)
            q, after = bodies.moved(p, velocity)
            q, velocity = np.where(massive, q, p), np.where(massive, after, 0.0)
            value.send(window, panel, q)
            missed = missed + np.sum(bodies.leak * np.abs(q[-1] - p[-1]), axis=0)
            means = value.sent[window % 2, :, panel, 0, 1:-1]
            size = np.maximum(size, np.maximum(np.abs(velocity).max(axis=0), np.abs(means).max(axis=(0, 1))))
            self._moved.append((p, q))
        self._after = velocity
        return WindowTried(missed, size)

    def settled(self) -> None:
        """See `ArrayMotion`."""
        self.value.velocity = self._after
        if self._lanes is not None:
            self._lanes.velocity = self._lanes_after

    def followed(self, window: int, lanes: ArrayWaves, slope: ArrayLaws) -> WindowTried:
        """See `ArrayMotion`. With q'/rate + q = p,

        dq'/rate + dq = dp + drate/rate (p - q).
        """
        value, law, massive = self.value, self._law, self._massive
        lanes.lengthen(value.degree)
        share = slope["rate"] / np.where(massive, law["rate"], 1.0)
        velocity = lanes.velocity
        missed, size = np.zeros((2, velocity.shape[0], velocity.shape[2]))
        for panel, (bodies, (push, q)) in enumerate(zip(self._bodies, self._moved, strict=True)):
            (a, b), (da, db) = value.arriving(window, panel), lanes.arriving(window, panel)
            p = law["alpha"] * da + law["beta"] * db + slope["alpha"] * a[:, None] + slope["beta"] * b[:, None]
            lanes.push(p, panel, self._on)
            p += share * (push - q)[:, None]
            self.acts = np.maximum(self.acts, np.max(self._turned(slope) * np.abs(push[0]), axis=1))
            dq, after = bodies.moved(p, velocity)
            dq, velocity = np.where(massive, dq, p), np.where(massive, after, 0.0)
            lanes.send(window, panel, dq)
            missed += np.sum(bodies.leak * np.abs(dq[-1] - p[-1]), axis=1)
            means = np.abs(lanes.sent[window % 2, :, panel, 0, :, 1:-1]).max(axis=(0, 2))
            size = np.maximum(size, np.maximum(np.abs(velocity).max(axis=1), means))
        self._lanes_after = velocity
        return WindowTried(missed, size)

    def reached(self) -> NDArray[np.bool_]:
        """See `ArrayMotion`."""
        return reached(self._tables, self._law, self._slope)

    def felt(self, slope: ArrayLaws) -> Array:
        """See `ArrayMotion`."""
        rate, massive = self._law["rate"], self._massive
        arrives = np.abs(slope["alpha"]) + np.abs(slope["beta"])
        arrives *= np.where(massive, np.minimum(rate, 1.0), 1.0)
        found: Array = np.max(np.maximum(arrives, 2 * self._turned(slope)), axis=1)
        return found

    def _turned(self, slope: ArrayLaws) -> Array:
        """How much of p - q bodies take up on a window as rates change, at most: slow ones no more than their share."""
        found: Array = np.abs(slope["rate"]) / np.maximum(self._law["rate"], 1.0)
        return found
