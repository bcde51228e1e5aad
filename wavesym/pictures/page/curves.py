"""Curves as paths of whole numbers on a grid: as short as they are exact to what can be seen.

A grid has `columns` of time, and HEIGHT steps of the value, downward. The script of the page reads values off these
paths; a column that is crossed by more than a line shows from where to where.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import floor

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.pictures.histories import History
from wavesym.pictures.page.svg import Svg, element
from wavesym.pictures.reduction import columns_of, reduce_vertices

HEIGHT = 1000
_PER_FRONT = 4  # columns


@dataclass(frozen=True)
class Grid:
    """Columns of time up to `until`, and values from `low` to `high`."""

    columns: int
    until: float
    low: float
    high: float

    @classmethod
    def from_limits(cls, columns: int, until: float, low: float, high: float) -> Grid:
        """One that has these values, and a step at 0."""
        step = (high - low) / (HEIGHT - 1)
        first = floor(low / step)
        return cls(columns, until, first * step, (first + HEIGHT) * step)

    def path(self, stretches: Iterable[Array]) -> str:
        """Polylines (n, 2) of tau and value, each begun anew."""
        return "".join("".join(self._draw(stretch)) for stretch in stretches)

    def _draw(self, stretch: Array) -> Iterator[str]:
        points = reduce_vertices(stretch, self.until, self.columns)
        x = columns_of(points[:, 0], self.until, self.columns)
        y = np.rint((self.high - points[:, 1]) / (self.high - self.low) * HEIGHT).astype(int)
        yield f"M{x[0]} {y[0]}"
        command = ""
        for dx, dy in zip(np.diff(x).tolist(), np.diff(y).tolist(), strict=True):
            if dx == dy == 0:
                continue
            needed = "l" if dx else "v"
            if needed != command:
                yield needed
            elif (dx or dy) >= 0:
                yield " "
            yield f"{dx}{'' if dy < 0 else ' '}{dy}" if dx else f"{dy}"
            command = needed


def curve(history: History, grid: Grid, look: int) -> Svg:
    """A curve: between its fronts, upright where it jumps, and light where it is the formal continuation."""
    real, formal, jumps = [], [], []
    # fronts that lie closer are not told apart, and one line shows as much
    stretches = history.stretches if len(history.stretches) <= grid.columns // _PER_FRONT else (history.points,)
    for stretch in stretches:
        late = stretch[:, 0] > history.formal
        if not late.all():
            real.append(stretch[~late])
        if late.any():
            formal.append(stretch[max(0, int(np.argmax(late)) - 1) :])
    for before, after in pairwise(stretches):
        jumps.append(np.array([(after[0, 0], before[-1, 1]), after[0]]))
    parts = [
        element("path", class_=kind, d=grid.path(paths))
        for kind, paths in (("jump", jumps), ("formal", formal), ("real", real))
        if paths
    ]
    return element("g", *parts, class_=f"curve look{look}", data_name=history.output.name)
