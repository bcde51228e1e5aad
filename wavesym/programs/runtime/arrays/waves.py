"""The waves on two windows, with loads and what outputs hear of them: values, or derivatives in lanes."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.chebyshev import chebval

from wavesym.programs.march.plan import LEFT, LOAD, RIGHT
from wavesym.programs.runtime.arrays.laws import ArrayLaws
from wavesym.programs.runtime.arrays.tables import ArrayTables
from wavesym.programs.runtime.engine import Array


class ArrayWaves:
    """They begin with `law`; `change` are the changes of loads, of shape (..., events, sets).

    `sent` has the shape (2 windows, 2 ways, panels, degree + 1, ..., nodes + 2, sets), where the first and the last
    node stand for what comes from outside.
    """

    def __init__(self, tables: ArrayTables, law: ArrayLaws, change: Array) -> None:
        *lanes, rods, sets = law.rod.shape
        forces = tables.sizes["forces"]
        self._tables, self._change, self._event = tables, change, 0
        self.sent = np.zeros((2, 2, tables.sizes["panels"], tables.sizes["least"] + 1, *lanes, rods + 1, sets))
        self.sent[:, LEFT, :, 0, ..., 1:, :] = law.rod
        self.sent[:, RIGHT, :, 0, ..., :-1, :] = law.rod
        self.velocity = law.motion
        self.force = np.zeros((tables.sizes["panels"], 3, *lanes, forces, sets))
        self.total = np.zeros((*lanes, tables.sizes["heard"], sets))
        self._load = np.zeros((3, *lanes, forces, sets))
        self._since = np.zeros((2, forces), np.int64)

    @property
    def degree(self) -> int:
        """Of the series."""
        return int(self.sent.shape[3]) - 1

    def lengthen(self, degree: int) -> None:
        """Give series a higher degree."""
        more = [(0, 0)] * self.sent.ndim
        more[3] = (0, degree - self.degree)
        self.sent = np.pad(self.sent, more)

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
        gone: Array = (window - self._since[0]) + since
        return gone

    def arriving(self, half: int, panel: int) -> tuple[Array, Array]:
        """From the left and from the right, at each node."""
        before = self.sent[1 - half, :, panel]
        return before[RIGHT][..., :-2, :], before[LEFT][..., 2:, :]

    def push(self, p: Array, panel: int) -> None:
        """Add the loads on a panel."""
        on = self._tables.ints("force_on")
        p[:3, ..., on >= 0, :] += self.force[panel][..., on[on >= 0], :]

    def send(self, half: int, panel: int, q: Array) -> None:
        """What nodes that move with q send."""
        a, b = self.arriving(half, panel)
        self.sent[half, LEFT, panel][..., 1:-1, :] = q - a
        self.sent[half, RIGHT, panel][..., 1:-1, :] = q - b

    def heard(self, half: int, term: int) -> Array:
        """A wave that is heard on a window."""
        way, panel, sender, back = (
            int(self._tables.ints(f"term_{name}")[term]) for name in ("way", "panel", "sender", "back")
        )
        wave: Array
        if way == LOAD:
            wave = np.zeros((self.degree + 1, *self.force.shape[2:-2], self.force.shape[-1]))
            wave[:3] = self.force[panel][..., sender, :]
        else:
            wave = self.sent[1 - half if back else half, way, panel][..., sender, :]
        return wave

    def listen(self, half: int, gain: Array) -> Array:
        """What all strands hear on a window, each wave times its gain: (strands, degree + 2, ..., sets)."""
        tables = self._tables
        lanes = gain.shape[:-2] or self.total.shape[:-2]
        found = np.zeros((tables.sizes["strands"], self.degree + 2, *lanes, gain.shape[-1]))
        first = tables.ints("first_term")
        for strand, series in enumerate(found):
            for term in range(first[strand], first[strand + 1]):
                number = tables.ints("term_heard")[term]
                wave, weight, total = self.heard(half, term), gain[..., number, :], self.total[..., number, :]
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
