"""How what is marched moves on a window: what nodes and joints have to say."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from wavesym.programs.runtime.arrays.laws import ArrayLaws
from wavesym.programs.runtime.arrays.signals import ArraySignals
from wavesym.programs.runtime.arrays.tables import ArrayTables
from wavesym.programs.runtime.engine import Array


class WindowTried(NamedTuple):
    """Of each set what the polynomials of a window miss, and the largest velocity or mean of a wave there; or of each
    derivative and set.
    """

    missed: Array
    size: Array


S = TypeVar("S", bound=ArraySignals)


class ArrayMotion(ABC, Generic[S]):
    """`value` are the waves under `law`, and their derivatives are in lanes where there is a `slope`."""

    def __init__(
        self,
        tables: ArrayTables,
        law: ArrayLaws,
        slope: ArrayLaws | None,
        signals: Callable[[ArrayTables, ArrayLaws, Array], S],
    ) -> None:
        self._tables, self._law, self._slope = tables, law, slope
        self.value = signals(tables, law, _changes(tables, law, law))
        self._lanes: S | None = None
        self.acts: Array = np.zeros(1)
        """The largest of what acts on derivatives as laws change, before it cancels: (lanes, sets)."""
        if slope is not None:
            self._lanes = signals(tables, slope, _changes(tables, slope, law) + _changes(tables, law, slope))

    @staticmethod
    @abstractmethod
    def serves(tables: ArrayTables, law: ArrayLaws) -> NDArray[np.bool_]:
        """Which sets of finite numbers can be marched."""

    @abstractmethod
    def tabulate(self) -> None:
        """What a window needs of bodies at the degree of now."""

    @abstractmethod
    def lengthen(self, degree: int) -> None:
        """Go to a higher degree."""

    @abstractmethod
    def tried(self, window: int) -> WindowTried:
        """March a window, from where the last one that was settled ended."""

    @abstractmethod
    def settled(self) -> None:
        """It is enough: the next window begins where this one ends."""

    @abstractmethod
    def followed(self, window: int, lanes: S, slope: ArrayLaws) -> WindowTried:
        """Derivatives, after the window has been marched."""

    def press(self, window: int) -> None:
        """The loads on a window."""
        for signals in (self.value, self._lanes):
            if signals is not None:
                signals.press(window)

    def followed_all(self, window: int) -> WindowTried:
        """Derivatives, if there are any."""
        if self._slope is None or self._lanes is None:
            return WindowTried(np.zeros(1), np.zeros(1))
        return self.followed(window, self._lanes, self._slope)

    @abstractmethod
    def reached(self) -> NDArray[np.bool_]:
        """Of each output and set whether anything can be felt there up to the horizon, and in the derivatives by each
        parameter: (1 + lanes, outputs, sets).
        """

    @abstractmethod
    def felt(self, slope: ArrayLaws) -> Array:
        """How much of what values are wrong by acts on derivatives on a window, at most: (lanes, sets)."""

    def inherited(self, wrong: Array, of_windows: Array) -> tuple[Array, Array]:
        """What derivatives are wrong by as values are, by `wrong`, and by `of_windows` on all windows together, of
        which an eighth counts: as velocities, of shape (1 + lanes, sets), and of each output, as it weighs waves
        otherwise, (1 + lanes, outputs, sets).
        """
        none, here = np.zeros((1, len(wrong))), np.zeros((1, self._tables.outputs, len(wrong)))
        if self._slope is None:
            return none, here
        weights = self._tables.weights(self._slope["gain"])
        return np.concatenate([none, self.felt(self._slope) * of_windows / 8]), np.concatenate([here, weights * wrong])

    def heard(self, window: int) -> Array:
        """All strands of a window that was settled, and their derivatives: (strands, degree + 2, 1 + lanes, sets)."""
        gain = self._law["gain"]
        if self._slope is None or self._lanes is None:
            return self.value.listen(window, gain)[:, :, None]
        found = self._lanes.listen(window, gain)
        if self._slope["gain"].any():  # what outputs weigh changes, too
            total = self.value.total.copy()
            found += self.value.listen(window, self._slope["gain"])
            self.value.total = total
        return np.concatenate([self.value.listen(window, gain)[:, :, None], found], axis=2)


def _changes(tables: ArrayTables, loads: ArrayLaws, strengths: ArrayLaws) -> Array:
    """What each change of a load is: an amplitude times a strength."""
    load, strength = tables.ints("event_load"), tables.ints("event_strength")
    found: Array = (
        tables["event_weight"][:, None] * loads["load"][..., load, :] * strengths["strength"][..., strength, :]
    )
    return found
