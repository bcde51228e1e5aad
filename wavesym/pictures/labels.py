"""Labels beside the curves they name, placed so that they cover neither each other nor the curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

Points = NDArray[np.float64]

_DISTANCES = (8.0, 14.0, 22.0, 32.0, 44.0, 60.0, 80.0, 105.0, 135.0, 170.0)
_DIRECTIONS = tuple((float(np.cos(a)), float(np.sin(a))) for a in np.arange(16) * np.pi / 8)
_MARGIN = 4.0  # pixels kept free round a label
_LEADER = 12.0  # a label farther away than this gets a line to its curve
_ROUNDS = 3  # every label is placed again, now that the others are known


@dataclass(frozen=True)
class Curve:
    """A polyline to be named: its vertices in data coordinates, (n, 2), and how its label is written."""

    text: str
    points: Points
    color: str
    weight: str


@dataclass(frozen=True)
class _Place:
    box: Bbox
    anchor: Points
    distance: float


def label(axes: Axes, curves: Sequence[Curve], fontsize: float) -> None:
    """Write the curves' names into axes whose limits and size are final."""
    texts = [axes.text(0, 0, curve.text, fontsize=fontsize, color=curve.color, weight=curve.weight) for curve in curves]
    renderer = axes.figure.canvas.get_renderer()  # type: ignore[attr-defined]
    sizes = [text.get_window_extent(renderer) for text in texts]
    inside = axes.get_window_extent(renderer)
    pixels = [np.asarray(axes.transData.transform(curve.points)) for curve in curves]
    ink = np.vstack([_resample(points) for points in pixels])
    places: list[_Place | None] = [None] * len(curves)
    for _ in range(_ROUNDS):
        for k, (points, size) in enumerate(zip(pixels, sizes, strict=True)):
            if not curves[k].text:  # there only to be kept free
                continue
            taken = [place.box for j, place in enumerate(places) if place and j != k]
            places[k] = _best(points, size, inside, ink, taken)
    back = axes.transData.inverted()
    for text, curve, place in zip(texts, curves, places, strict=True):
        if place is None:
            continue
        x, y = back.transform(((place.box.x0 + place.box.x1) / 2, (place.box.y0 + place.box.y1) / 2))
        text.set(x=x, y=y, ha="center", va="center")
        if place.distance > _LEADER:
            near = (
                np.clip(place.anchor[0], place.box.x0, place.box.x1),
                np.clip(place.anchor[1], place.box.y0, place.box.y1),
            )
            line = np.array([back.transform(place.anchor), back.transform(near)])
            axes.plot(line[:, 0], line[:, 1], color=curve.color, linewidth=0.5, zorder=1)


def _best(points: Points, size: Bbox, inside: Bbox, ink: Points, taken: Sequence[Bbox]) -> _Place:
    """The cheapest place: inside, over no label, over little ink, near; of equals the first."""
    reach = np.array([(distance, *direction) for distance in _DISTANCES for direction in _DIRECTIONS])
    anchors = np.repeat(points, len(reach), axis=0)
    distance, *direction = np.tile(reach, (len(points), 1)).T
    half = np.array([size.width, size.height]) / 2
    centres = anchors + np.column_stack(direction) * (distance[:, np.newaxis] + half)
    low, high = centres - half - _MARGIN, centres + half + _MARGIN
    out = np.any((low < inside.min) | (high > inside.max), axis=1)
    cost = 1e6 * out + distance
    for box in taken:
        cost += 1e5 * np.all((low < box.max) & (high > box.min), axis=1)
    x, y = ink.T
    for k in np.flatnonzero(cost < 1e5) if np.any(cost < 1e5) else range(len(cost)):
        cost[k] += 500.0 * np.count_nonzero((x > low[k, 0]) & (x < high[k, 0]) & (y > low[k, 1]) & (y < high[k, 1]))
    best = int(np.argmin(cost))
    return _Place(Bbox(centres[best] + np.outer((-1, 1), half)), anchors[best], float(distance[best]))


def _resample(points: Points) -> Points:
    """Points on a polyline, every few pixels."""
    parts = [points[:1]]
    for low, high in pairwise(points):
        steps = max(1, int(np.hypot(*(high - low)) / 4))
        parts.append(low + np.linspace(0, 1, steps + 1)[1:, np.newaxis] * (high - low))
    return np.vstack(parts)
