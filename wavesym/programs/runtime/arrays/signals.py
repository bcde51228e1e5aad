"""What all marches share: loads on a window, and what outputs hear of waves; values, or derivatives in lanes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.polynomial.chebyshev import chebval

from wavesym.programs.runtime.arrays.tables import ArrayTables
from wavesym.programs.runtime.engine import Array


class ArraySignals(ABC):
    """`change` are the changes of loads, of shape (..., events, sets).

    `force` has the series of loads on the panels of a window: of shape (panels, 3, ..., forces, sets).
    """

    def __init__(self, tables: ArrayTables, change: Array) -> None:
        lanes, sets = change.shape[:-2], change.shape[-1]
        forces = tables.sizes["forces"]
        self._tables, self._change, self._event = tables, change, 0
        self.force = np.zeros((tables.sizes["panels"], 3, *lanes, forces, sets))
        self.total = np.zeros((*lanes, tables.sizes["heard"], sets))
        self._load = np.zeros((3, *lanes, forces, sets))
        self._since = np.zeros((2, forces), np.int64)

    @property
    @abstractmethod
    def degree(self) -> int:
        """Of the series."""

    @abstractmethod
    def heard(self, window: int, term: int) -> Array:
        """A wave that is heard on a window."""

    def press(self, window: int) -> None:
        """The loads on the panels of a window, as series."""
        tables, load = self._tables, self._load
        events = [tables.ints(f"event_{name}") for name in ("window", "panel", "force", "power")]
        for panel, half in enumerate(tables["half_length"]):
            while self._event < tables.sizes["events"]:
                at, on, force, power = (int(of[self._event]) for of in events)
                if (at, on) != (window, panel):
                    break
                c = load[..., force, :]
                gone = self._gone(window, panel)[force]
                c[0] += gone * (c[1] + gone * c[2])
                c[1] += 2 * gone * c[2]
                c *= power < 3  # else what acts is told anew
                c[power % 3] += self._change[..., self._event, :]
                self._since[:, force] = window, panel
                self._event += 1
            middle = (self._gone(window, panel) + half)[:, None]
            self.force[panel, 0] = (load[0] + middle * load[1]) + (middle * middle + half * half / 2) * load[2]
            self.force[panel, 1] = half * (load[1] + 2 * middle * load[2])
            self.force[panel, 2] = half * half / 2 * load[2]

    def _gone(self, window: int, panel: int) -> Array:
        """The time since each load changed."""
        since = self._tables["since_panel"][panel * self._tables.sizes["panels"] + self._since[1]]
        gone: Array = (window - self._since[0]) * self._tables.step + since
        return gone

    def push(self, p: Array, panel: int, on: Sequence[int]) -> None:
        """Add the loads on a panel to p: `on` says which acts on each place of it, -1 for none."""
        loaded = np.array(on, np.int64)
        p[:3, ..., loaded >= 0, :] += self.force[panel][..., loaded[loaded >= 0], :]

    def listen(self, window: int, gain: Array) -> Array:
        """What all strands hear on a window, each wave times its gain: (strands, degree + 2, ..., sets)."""
        tables = self._tables
        lanes = gain.shape[:-2] or self.total.shape[:-2]
        found = np.zeros((tables.sizes["strands"], self.degree + 2, *lanes, gain.shape[-1]))
        first = tables.ints("first_term")
        for strand, series in enumerate(found):
            for term in range(first[strand], first[strand + 1]):
                number = tables.ints("term_heard")[term]
                wave, weight, total = self.heard(window, term), gain[..., number, :], self.total[..., number, :]
                if tables["term_summed"][term]:
                    wave = tables["half_length"][tables.ints("term_panel")[term]] * _integral(wave)
                    low = chebval(tables["term_low"][term], wave)
                    wave[0] += total - low
                    total += chebval(tables["term_high"][term], wave) - total
                for k, of_degree in enumerate(wave):
                    series[k] += weight * of_degree
        return found


def _integral(w: Array) -> Array:
    """The antiderivative of series, the first coefficient 0."""
    degree = len(w) - 1
    c = np.zeros((degree + 2, *w.shape[1:]))
    c[1:] = w
    c[1] *= 2
    c[1:degree] -= w[2:]
    c[1:] /= (2.0 * np.arange(1, degree + 2)).reshape(-1, *[1] * (w.ndim - 1))
    return c
