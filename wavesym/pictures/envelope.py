"""The least and the greatest of what happens along a chain: of a building over its height, else along its lines."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.pictures.along import Along, Band
from wavesym.pictures.envelope_values import envelope, extremes
from wavesym.pictures.groups import axis_title
from wavesym.pictures.timescale import timescale

_FONT = 9  # points
_GREATEST, _LEAST, _BETWEEN = "#b2431f", "#1f4e9c", "0.9"
_NARROWEST = 0.25  # of the main line: where numbers still fit
_TICKS = 20  # storeys with a number
_ROOM = 0.6  # storeys above and below


def draw(model: Model, found: Sequence[Along]) -> Figure:
    """Each quantity beside the other over the height of a building; one under the other along other chains."""
    upright, scale = model.labels.system["type"] == "building", timescale(model)
    with mpl.rc_context({"font.size": _FONT, "font.family": "DejaVu Sans"}):
        figure = Figure(figsize=(9.0, 6.0) if upright else (11.0, 7.0), dpi=100, layout="constrained")
        FigureCanvasAgg(figure)
        title = (
            f"{model.name}: {model.labels.system['type']}, least and greatest to {scale.told(float(found[0].taus[-1]))}"
        )
        figure.suptitle(title, x=0.01, ha="left", weight="bold")
        lengths = [band.spots[-1].high for band in found[0].bands]
        widths = [max(length / lengths[0], _NARROWEST) for length in lengths]
        rows, columns = (1, len(found)) if upright else (len(found), len(widths))
        axes = figure.subplots(rows, columns, squeeze=False, width_ratios=None if upright else widths)
        for panel, (quantity, band) in zip(
            axes.flat, ((one, band) for one in found for band in one.bands), strict=True
        ):
            if upright:
                _over_height(panel, quantity, band)
            else:
                _along_line(panel, quantity, band)
            title = axis_title(model, quantity.quantity, quantity.unit)
            (panel.set_xlabel if upright else panel.set_ylabel)(title)
            for extreme, above in zip(extremes(quantity, band), (True, False), strict=True):
                if not extreme.value:
                    continue
                point = (extreme.value, extreme.x) if upright else (extreme.x, extreme.value)
                _mark(panel, point, extreme.told(scale), above)
    return figure


def _over_height(axes: Axes, quantity: Along, band: Band) -> None:
    """Of a building: bars for storeys, curves from floor to floor."""
    least, greatest = envelope(band)
    x = [spot.x for spot in band.spots]
    if quantity.storeys:
        axes.barh(x, greatest - least, left=least, height=0.8, color=_BETWEEN)
        for values, colour in ((greatest, _GREATEST), (least, _LEAST)):
            axes.vlines(values, [k - 0.4 for k in x], [k + 0.4 for k in x], color=colour, linewidth=2)
    else:
        axes.fill_betweenx(x, least, greatest, color=_BETWEEN, linewidth=0)
        for values, colour in ((greatest, _GREATEST), (least, _LEAST)):
            axes.plot(values, x, "o-", color=colour, markersize=4)
    axes.axvline(0, color="0.6", linewidth=0.8)
    axes.set_ylabel("storey" if quantity.storeys else "floor")
    axes.set_yticks(*zip(*band.numbered(_TICKS, first=1 if quantity.storeys else 0), strict=True))
    axes.set_ylim(band.spots[0].low - _ROOM, band.spots[-1].high + _ROOM)
    axes.use_sticky_edges = False
    axes.margins(x=0.25)
    axes.ticklabel_format(axis="x", scilimits=(-3, 5))


def _along_line(axes: Axes, quantity: Along, band: Band) -> None:
    least, greatest = envelope(band)
    x = [spot.x for spot in band.spots]
    axes.fill_between(x, least, greatest, color=_BETWEEN, linewidth=0)
    for values, colour in ((greatest, _GREATEST), (least, _LEAST)):
        axes.plot(x, values, "-", color=colour)
    axes.axhline(0, color="0.6", linewidth=0.8)
    axes.set_xlabel(axis_text(band.line, quantity.length))
    axes.set_xlim(band.spots[0].low, band.spots[-1].high)
    axes.margins(y=0.2)
    axes.ticklabel_format(axis="y", scilimits=(-3, 5))


def _mark(axes: Axes, point: tuple[float, float], text: str, above: bool) -> None:
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
        path_effects=[withStroke(linewidth=2, foreground="white")],
    )
