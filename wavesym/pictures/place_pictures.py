"""What happens along a chain, drawn: the least and the greatest at each place, and place x time as colours.

The latter is for horizons in which waves cross the chain too often to be drawn one by one: a cell shows the value of
the largest size that its place has in its stretch of time, so that no peak is lost.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.pictures.groups import axis_title, load_panel
from wavesym.pictures.histories import History
from wavesym.pictures.line_histories import Band, LineHistories, cells, envelope, extremes, limit
from wavesym.pictures.naming import heading
from wavesym.pictures.style import BETWEEN, GREATEST, HALO, LEAST, colours, draw_grid, new_figure, set_title, with_style
from wavesym.pictures.timescale import timescale

_ENVELOPE = 3.6  # inches
_NARROWEST = 0.25  # of the main line: where numbers still fit
_TICKS = 11  # storeys with a number
_ROOM = 0.6  # storeys above and below


@with_style
def draw_envelope(model: Model, found: Sequence[LineHistories]) -> Figure:
    """Each quantity below the other, over the height of a building, or along the lines of any other chain.

    Args:
        model: what moves.
        found: its quantities, at many places.
    """
    upright, scale = model.labels.system["type"] == "building", timescale(model)
    figure = new_figure(_ENVELOPE * len(found) + 0.4)
    set_title(figure, f"{heading(model.name)}: least and greatest to {scale.format(float(found[0].taus[-1]))}")
    lengths = [band.spots[-1].high for band in found[0].bands]
    widths = [max(length / lengths[0], _NARROWEST) for length in lengths]
    axes = figure.subplots(len(found), len(widths), squeeze=False, width_ratios=widths)
    for panel, (quantity, band) in zip(axes.flat, ((one, band) for one in found for band in one.bands), strict=True):
        if upright:
            _over_height(panel, quantity, band)
        else:
            _along_line(panel, quantity, band)
        title = axis_title(model, quantity.quantity, quantity.unit)
        moved = [each for each in extremes(quantity, band) if each.value]
        if upright:  # beside a curve there is no room
            panel.set_xlabel(title.replace("\n", " "))
            panel.plot([each.value for each in moved], [each.x for each in moved], "o", color="black", zorder=4)
            panel.set_title("\n".join(each.describe(scale) for each in moved), loc="left")
        else:
            panel.set_ylabel(title)
            for each in moved:
                _mark(panel, (each.x, each.value), each.describe(scale), above=each is moved[0])
    return figure


def _over_height(axes: Axes, quantity: LineHistories, band: Band) -> None:
    """Of a building: bars for storeys, curves from floor to floor."""
    least, greatest = envelope(band)
    x = [spot.x for spot in band.spots]
    if quantity.storeys:
        axes.barh(x, greatest - least, left=least, height=0.8, color=BETWEEN)
        for values, colour in ((greatest, GREATEST), (least, LEAST)):
            axes.vlines(values, [k - 0.4 for k in x], [k + 0.4 for k in x], color=colour, linewidth=2)
    else:
        axes.fill_betweenx(x, least, greatest, color=BETWEEN, linewidth=0)
        for values, colour in ((greatest, GREATEST), (least, LEAST)):
            axes.plot(values, x, "o-", color=colour, markersize=4)
    draw_grid(axes, zero=False)
    axes.axvline(0, color="0.6", linewidth=0.8)
    axes.set_ylabel("storey" if quantity.storeys else "floor")
    axes.set_yticks(*zip(*band.tick_labels(_TICKS, first=1 if quantity.storeys else 0), strict=True))
    axes.set_ylim(band.spots[0].low - _ROOM, band.spots[-1].high + _ROOM)
    axes.use_sticky_edges = False
    axes.margins(x=0.25)
    axes.ticklabel_format(axis="x", scilimits=(-3, 5))


def _along_line(axes: Axes, quantity: LineHistories, band: Band) -> None:
    least, greatest = envelope(band)
    x = [spot.x for spot in band.spots]
    axes.fill_between(x, least, greatest, color=BETWEEN, linewidth=0)
    for values, colour in ((greatest, GREATEST), (least, LEAST)):
        axes.plot(x, values, "-", color=colour)
    draw_grid(axes)
    axes.set_xlabel(axis_text(band.line, quantity.length))
    axes.set_xlim(band.spots[0].low, band.spots[-1].high)
    axes.margins(y=0.2)
    axes.ticklabel_format(axis="y", scilimits=(-3, 5))


def _mark(axes: Axes, point: tuple[float, float], text: str, *, above: bool) -> None:
    """A spot on a curve and what it is, written above or below it and towards the middle."""
    axes.plot(*point, "o", color="black", markersize=4, zorder=4)
    x, _ = axes.transAxes.inverted().transform(axes.transData.transform(point))
    axes.annotate(
        text,
        point,
        (-6 if x > 0.5 else 6, 6 if above else -6),
        textcoords="offset points",
        ha="right" if x > 0.5 else "left",
        va="bottom" if above else "top",
        zorder=5,
        path_effects=HALO,
    )


_LOAD, _MAP = 1.3, 2.7  # inches
_COLUMNS = 600  # cells
_NAMED = 10  # storeys with a number


@with_style
def draw_map(model: Model, found: Sequence[LineHistories], loads: Sequence[History]) -> Figure:
    """A map of each quantity and line, under the loads; colours end where all but the largest few cells do."""
    scale = timescale(model)
    until = float(found[0].taus[-1]) * scale.per_tau
    heights = [_LOAD] * bool(loads) + [_MAP] * sum(len(quantity.bands) for quantity in found)
    figure = new_figure(sum(heights) + 0.7)
    set_title(figure, f"{heading(model.name)}: place over time")
    panels = iter(figure.subplots(len(heights), 1, squeeze=False, sharex=True, height_ratios=heights)[:, 0])
    if loads:
        axes = next(panels)
        for load in loads:
            axes.plot(load.points[:, 0] * scale.per_tau, load.points[:, 1], color="black", linewidth=0.8)
        axes.set_ylabel(load_panel(loads, _LOAD).title)
        draw_grid(axes)
    for quantity in found:
        shown = [(band, cells(quantity, band, _COLUMNS)) for band in quantity.bands]
        largest = limit([values for _, values in shown])
        norm, shades = Normalize(-largest, largest), colours(signed=True)
        mine = []
        for band, values in shown:
            mine.append(axes := next(panels))
            edges = np.linspace(0, until, _COLUMNS + 1), [*(spot.low for spot in band.spots), band.spots[-1].high]
            axes.pcolormesh(*edges, values, norm=norm, cmap=shades, rasterized=True)
            _frame(axes, quantity, band)
        bar = figure.colorbar(ScalarMappable(norm, shades), ax=mine, extend="both", fraction=0.05, pad=0.01)
        bar.set_label(axis_title(model, quantity.quantity, quantity.unit))
    axes.set_xlim(0, until)
    axes.set_xlabel(scale.title)
    return figure


def _frame(axes: Axes, quantity: LineHistories, band: Band) -> None:
    """The places, upward."""
    if quantity.storeys:
        axes.set_yticks(*zip(*band.tick_labels(_NAMED), strict=True))
        axes.set_ylabel("storey")
    else:
        axes.set_ylabel(axis_text(band.line, quantity.length))
