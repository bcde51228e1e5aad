"""A family of curves as a picture that needs no colours: markers and dashes tell curves apart, labels name them.

A filled marker is an evaluator that would be used, a hollow one would be refused; a cross at the top has no value.
Dotted is what was proved. Each picture says so itself, in a line under its title, where that is needed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from wavesym.lab.atlas.family import AtlasPoint, CurveFamily
from wavesym.numbers.arrays import Array
from wavesym.pictures.labels import Curve, label

_FONT = 8.5
_PANEL = (5.6, 4.8)  # inches
_MOST_COLUMNS = 3
_CROSSES = 24  # lines of crosses that would fit under each other
_STYLES = (
    ("s", "-", "black"),
    ("o", "-", "0.35"),
    ("D", "--", "black"),
    ("^", "--", "0.35"),
    ("v", "-.", "black"),
    ("P", "-.", "0.35"),
    ("X", ":", "black"),
    ("h", ":", "0.35"),
)


def draw(family: CurveFamily) -> Figure:
    """The picture of a family; the same bytes from the same numbers when it is written by `saving.save`."""
    panels = family.panels
    columns = min(len(panels), _MOST_COLUMNS) if len(panels) != 4 else 2
    rows = -(-len(panels) // columns)
    with mpl.rc_context({"font.size": _FONT, "font.family": "DejaVu Sans"}):
        width = max(columns * _PANEL[0], 8.6)
        figure = Figure(figsize=(width, rows * _PANEL[1] + 0.8), dpi=100, layout="constrained")
        FigureCanvasAgg(figure)
        note = f"\n{family.note}" if family.note else ""
        figure.suptitle(f"{family.title}{note}", fontsize=_FONT + 2, x=0.01, ha="left")
        grid = figure.subplots(rows, columns, squeeze=False, sharex=False, sharey=True)
        drawn = list(zip(panels, grid.flat, strict=False))
        for panel, axes in drawn:
            _panel(axes, family, panel, named=len(panels) > 1)
        for row in grid:
            row[0].set_ylabel(family.y)
        # labels are placed round the curves, so where these are must be settled first
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        for panel, axes in drawn:
            _label(axes, family, panel)
    return figure


def _panel(axes: Axes, family: CurveFamily, panel: str, named: bool) -> None:
    axes.set(xscale=family.x.scale, yscale="log", ylim=(family.least, family.most))
    axes.set_xlabel(family.x.label)
    if named:
        axes.set_title(panel, fontsize=_FONT + 1, loc="left")
    axes.grid(True, which="major", color="0.9", linewidth=0.5)
    axes.yaxis.set_minor_locator(NullLocator())
    for (marker, dashes, grey), name in zip(_STYLES, family.curves(panel), strict=False):
        valued, missing, proved = _parts(family.curve(panel, name))
        places = _places(family, valued, [point.error for point in valued])
        _line(axes, places, valued, color=grey, linestyle=dashes, linewidth=1.2, zorder=3)
        for (x, y), point in zip(places, valued, strict=True):
            filled = "white" if point.refusal else grey
            axes.plot(x, y, marker, color=grey, markerfacecolor=filled, markersize=5, zorder=4)
        for x, y in _missing(family, panel, name, missing):
            axes.plot(x, y, "x", color=grey, markersize=6, zorder=4)
        bounds = _places(family, proved, [point.bound for point in proved])
        if len(proved) == 1:
            axes.plot(*bounds[0], "_", color=grey, markersize=12)
        else:
            _line(axes, bounds, proved, color=grey, linestyle=(0, (1, 2)), linewidth=1.0, zorder=2)
    if family.x.zero is not None:
        _mark_zero(axes, family)
    if family.x.falling:
        axes.invert_xaxis()


def _parts(points: Sequence[AtlasPoint]) -> tuple[list[AtlasPoint], list[AtlasPoint], list[AtlasPoint]]:
    """Those with a value, those without, and those of the first for which something is proved."""
    valued = [point for point in points if not math.isnan(point.error)]
    missing = [point for point in points if math.isnan(point.error)]
    return valued, missing, [point for point in valued if math.isfinite(point.bound)]


def _line(axes: Axes, places: Array, points: Sequence[AtlasPoint], **style: Any) -> None:
    """A line through points; between the smallest x and exactly 0 nothing is known."""
    joined = [k for k, point in enumerate(points) if point.x]
    axes.plot(places[joined, 0], places[joined, 1], **style)


def _places(family: CurveFamily, points: Sequence[AtlasPoint], values: Sequence[float]) -> Array:
    """Where points are drawn: inside the axes."""
    heights = np.clip(values, family.least * 1.5, family.most / 1.5)
    return np.column_stack([[point.x or family.x.zero or 0.0 for point in points], heights])


def _missing(family: CurveFamily, panel: str, name: str, points: Sequence[AtlasPoint]) -> Array:
    """Where points without a value are drawn: near the top, each curve's on a line of its own."""
    depth = (1.5 + family.curves(panel).index(name)) / _CROSSES
    height = family.most * (family.least / family.most) ** depth
    return _places(family, points, [height] * len(points))


def _mark_zero(axes: Axes, family: CurveFamily) -> None:
    """Exactly 0 gets a place of its own on the axis."""
    zero = family.x.zero
    assert zero is not None
    xs = sorted({point.x for point in family.points if point.x})
    ticks = [zero, *(x for k, x in enumerate(xs) if k % 4 == 0)]
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xticklabels(["0", *(f"1e{round(math.log10(x))}" if x < 1 else f"{x:g}" for x in ticks[1:])])
    axes.axvline(math.sqrt(zero * xs[0]), color="0.7", linewidth=0.8)


def _label(axes: Axes, family: CurveFamily, panel: str) -> None:
    curves = []
    for (_, _, grey), name in zip(_STYLES, family.curves(panel), strict=False):
        valued, missing, proved = _parts(family.curve(panel, name))
        for points, places, text, weight in (
            (valued, _places(family, valued, [point.error for point in valued]), name, "bold"),
            (missing, _missing(family, panel, name, missing), f"{name}: no value", "bold"),
            (proved, _places(family, proved, [point.bound for point in proved]), f"{name}: proved", "normal"),
        ):
            if points:
                curves.append(Curve(text, places, grey, weight))
    label(axes, curves, _FONT)
