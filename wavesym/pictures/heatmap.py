"""Place x time as colours, for horizons in which waves cross the chain too often to be drawn one by one.

A cell shows the value of the largest size that its place has in its stretch of time, so that no peak is lost.
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
from wavesym.pictures.line_histories import Band, LineHistories, cells, limit
from wavesym.pictures.style import colours, draw_grid, new_figure, set_title, with_style
from wavesym.pictures.timescale import timescale

_LOAD, _PANEL = 1.3, 2.7  # inches
_COLUMNS = 600  # cells
_NAMED = 10  # storeys with a number


@with_style
def draw(model: Model, found: Sequence[LineHistories], loads: Sequence[History]) -> Figure:
    """A picture for each quantity and line, under the loads; colours end where all but the largest few cells do."""
    scale = timescale(model)
    until = float(found[0].taus[-1]) * scale.per_tau
    heights = [_LOAD] * bool(loads) + [_PANEL] * sum(len(quantity.bands) for quantity in found)
    figure = new_figure(sum(heights) + 0.7)
    set_title(figure, f"{model.name}: place over time")
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
