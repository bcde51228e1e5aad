"""Place x time as colours, for horizons in which waves cross the chain too often to be drawn one by one.

A cell shows the value of the largest size that its place has in its stretch of time, so that no peak is lost.
"""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.pictures.along import Along, Band, cells, limit
from wavesym.pictures.groups import axis_title, load_panel
from wavesym.pictures.histories import History
from wavesym.pictures.timescale import timescale

_FONT = 9  # points
_WIDTH, _LOAD, _PANEL = 11.0, 1.1, 2.9  # inches
_COLUMNS = 900  # cells
_SHADES = 101  # an odd number, so that 0 is white
_NAMED = 12  # storeys with a number
_BEYOND = "0.75"  # what is formal


def draw(model: Model, found: Sequence[Along], loads: Sequence[History]) -> Figure:
    """A picture for each quantity and line, under the loads; colours end where all but the largest few cells do."""
    scale = timescale(model)
    until = float(found[0].taus[-1]) * scale.per_tau
    heights = [_LOAD] * bool(loads) + [_PANEL] * sum(len(quantity.bands) for quantity in found)
    with mpl.rc_context({"font.size": _FONT, "font.family": "DejaVu Sans"}):
        figure = Figure(figsize=(_WIDTH, sum(heights) + 0.7), dpi=100, layout="constrained")
        FigureCanvasAgg(figure)
        figure.suptitle(f"{model.name}: {model.labels.system['type']}, place x time", x=0.01, ha="left", weight="bold")
        panels = iter(figure.subplots(len(heights), 1, squeeze=False, sharex=True, height_ratios=heights)[:, 0])
        if loads:
            axes = next(panels)
            for load in loads:
                axes.plot(load.points[:, 0] * scale.per_tau, load.points[:, 1], color="black", linewidth=0.8)
            axes.set_ylabel(load_panel(loads, _LOAD).title)
            axes.axhline(0, color="0.6", linewidth=0.6)
        for quantity in found:
            shown = [(band, cells(quantity, band, _COLUMNS)) for band in quantity.bands]
            largest = limit([values for _, values in shown])
            norm, colours = Normalize(-largest, largest), colormaps["RdBu_r"].resampled(_SHADES)
            mine = []
            for band, values in shown:
                mine.append(axes := next(panels))
                edges = np.linspace(0, until, _COLUMNS + 1), [*(spot.low for spot in band.spots), band.spots[-1].high]
                axes.set_facecolor(_BEYOND)
                axes.pcolormesh(*edges, values, norm=norm, cmap=colours, rasterized=True)
                _frame(axes, quantity, band)
            bar = figure.colorbar(ScalarMappable(norm, colours), ax=mine, extend="both", fraction=0.05, pad=0.01)
            bar.set_label(axis_title(model, quantity.quantity, quantity.unit))
        axes.set_xlim(0, until)
        axes.set_xlabel(scale.title)
    return figure


def _frame(axes: Axes, quantity: Along, band: Band) -> None:
    """The places, upward."""
    if quantity.storeys:
        axes.set_yticks(*zip(*band.numbered(_NAMED), strict=True))
        axes.set_ylabel("storey")
    else:
        axes.set_ylabel(axis_text(band.line, quantity.length))
