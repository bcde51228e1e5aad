"""Labels beside the curves they name, placed so that they cover neither each other nor the curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import Bbox

from wavesym.numbers.arrays import Array

_DISTANCES = (8.0, 14.0, 22.0, 32.0, 44.0, 60.0, 80.0, 105.0, 135.0, 170.0)
_DIRECTIONS = tuple((float(np.cos(a)), float(np.sin(a))) for a in np.arange(16) * np.pi / 8)
_MARGIN = 4.0  # pixels kept free round a label
_LEADER = 12.0  # a label farther away than this gets a line to its curve
_WAY = 24  # points on the way from a curve to a label
_ROUNDS = 3  # every label is placed again, now that the others are known


@dataclass(frozen=True)
class Curve:
    """A polyline to be named: its vertices in data coordinates, (n, 2), and how its label is written."""

    text: str
    points: Array
    color: str
    weight: str


@dataclass(frozen=True)
class _Place:
    box: Bbox
    anchor: Array
    distance: float

    @property
    def leader(self) -> Array:
        """Points on the line to its curve, if it has one: (n, 2)."""
        if self.distance <= _LEADER:
            return np.empty((0, 2))
        return _resample(np.array([self.anchor, np.clip(self.anchor, self.box.min, self.box.max)]))


def label(axes: Axes, curves: Sequence[Curve], fontsize: float) -> None:
    """Write the curves' names into axes whose limits and size are final."""
    named = [curve for curve in curves if curve.text]  # others are there only to be kept free
    texts = [axes.text(0, 0, curve.text, fontsize=fontsize, color=curve.color, weight=curve.weight) for curve in named]
    renderer = axes.figure.canvas.get_renderer()  # type: ignore[attr-defined]
    sizes = [text.get_window_extent(renderer) for text in texts]
    inside = axes.get_window_extent(renderer)
    ink = np.vstack([_resample(axes.transData.transform(curve.points)) for curve in curves])
    places: dict[int, _Place] = {}
    for _ in range(_ROUNDS):
        for k in sorted(range(len(named)), key=lambda k: len(named[k].points)):  # few points leave the fewest places
            others = [place for j, place in places.items() if j != k]
            drawn = np.vstack([ink, *(place.leader for place in others)])
            places[k] = _best(axes.transData.transform(named[k].points), sizes[k], inside, drawn, others)
    back = axes.transData.inverted()
    for k, (text, curve) in enumerate(zip(texts, named, strict=True)):
        x, y = back.transform(places[k].box.get_points().mean(axis=0))
        text.set(x=x, y=y, ha="center", va="center")
        if len(leader := places[k].leader):
            line = back.transform(leader[[0, -1]])
            axes.plot(line[:, 0], line[:, 1], color=curve.color, linewidth=0.5, zorder=1)


def _best(points: Array, size: Bbox, inside: Bbox, ink: Array, taken: Sequence[_Place]) -> _Place:
    """The cheapest place: inside, over no label nor past one, over little ink, near; of equals the first."""
    reach = np.array([(distance, *direction) for distance in _DISTANCES for direction in _DIRECTIONS])
    anchors = np.repeat(points, len(reach), axis=0)
    distance, *direction = np.tile(reach, (len(points), 1)).T
    half = np.array([size.width, size.height]) / 2
    centres = anchors + np.column_stack(direction) * (distance[:, np.newaxis] + half)
    low, high = centres - half - _MARGIN, centres + half + _MARGIN
    out = np.any((low < inside.min) | (high > inside.max), axis=1)
    cost = 1e6 * out + distance
    way = anchors + np.linspace(0, 1, _WAY)[:, np.newaxis, np.newaxis] * (centres - anchors)
    for box in (place.box for place in taken):
        cost += 1e5 * np.all((low < box.max) & (high > box.min), axis=1)
        crossed = np.any(np.all((way > box.min) & (way < box.max), axis=2), axis=0)
        cost += 1e5 * (crossed & (distance > _LEADER))
    x, y = ink.T
    for k in np.flatnonzero(cost < 1e5) if np.any(cost < 1e5) else range(len(cost)):
        cost[k] += 500.0 * np.count_nonzero((x > low[k, 0]) & (x < high[k, 0]) & (y > low[k, 1]) & (y < high[k, 1]))
    best = int(np.argmin(cost))
    return _Place(Bbox(centres[best] + np.outer((-1, 1), half)), anchors[best], float(distance[best]))


def _resample(points: Array) -> Array:
    """Points on a polyline, every few pixels."""
    parts = [points[:1]]
    for low, high in pairwise(points):
        steps = max(1, int(np.hypot(*(high - low)) / 4))
        parts.append(low + np.linspace(0, 1, steps + 1)[1:, np.newaxis] * (high - low))
    return np.vstack(parts)
