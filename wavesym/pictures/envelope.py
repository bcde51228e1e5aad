"""The least and the greatest of what happens along a chain: of a building over its height, else along its lines."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.pictures.envelope_values import envelope, extremes
from wavesym.pictures.groups import axis_title
from wavesym.pictures.line_histories import Band, LineHistories
from wavesym.pictures.style import BETWEEN, GREATEST, HALO, LEAST, draw_grid, new_figure, set_title, with_style
from wavesym.pictures.timescale import timescale

_PANEL = 3.6  # inches
_NARROWEST = 0.25  # of the main line: where numbers still fit
_TICKS = 11  # storeys with a number
_ROOM = 0.6  # storeys above and below


def description(model: Model, found: Sequence[LineHistories]) -> str:
    """The extremes of all lines in words."""
    scale = timescale(model)
    return " ".join(
        f"{word} {quantity.quantity}{band.line and ' of branch '}{band.line}: {each.describe(scale)}."
        for quantity in found
        for band in quantity.bands
        for word, each in zip(("Greatest", "Least"), extremes(quantity, band), strict=True)
    )


@with_style
def draw(model: Model, found: Sequence[LineHistories]) -> Figure:
    """Each quantity below the other, over the height of a building, or along the lines of any other chain.

    Args:
        model: what moves.
        found: its quantities, at many places.
    """
    upright, scale = model.labels.system["type"] == "building", timescale(model)
    figure = new_figure(_PANEL * len(found) + 0.4)
    set_title(figure, f"{model.name}: least and greatest to {scale.format(float(found[0].taus[-1]))}")
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
