"""Histories drawn: a panel for each quantity over a shared tau, every curve named where it runs, jumps as jumps.

Dashes tell curves apart without their colour, and the colours differ in how dark they are. Panels have room for eight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.pictures.groups import PlotPanel, load_panel, notes, panels, restless
from wavesym.pictures.histories import Histories, History
from wavesym.pictures.labels import Curve, label
from wavesym.pictures.naming import heading
from wavesym.pictures.reduction import reduce_vertices
from wavesym.pictures.stations import slip_times, slip_words
from wavesym.pictures.style import (
    CURVES,
    FONT,
    HALO,
    SLIPS,
    WIDTH,
    Dashes,
    draw_grid,
    new_figure,
    with_style,
    write_plain_numbers,
)
from wavesym.pictures.timescale import Timescale, timescale

CHARACTERS = 66  # in a line of text across the figure
_LEFT, _RIGHT, _GAP = 1.05, 0.1, 0.22  # inches
_TITLE = 0.62  # of an axis, to its left
_LINE = 0.21  # height of a line of text
_WIDEST_TIME, _WIDEST_VALUE = 4, 5  # characters of a tick that there is room for: below the axis, beside the title
_WIDEST_LAST = 3  # of one at the end of the axis, half of which is right of it
_CHARACTER = 0.106  # inches
_AXIS = 0.55  # below the last panel
_BEYOND = 1.01  # what happens at the end of the horizon is not hidden by the frame
_ALPHA = {False: 1.0, True: 0.55}  # of what is formal
_VERTICES, _ANCHORS = 18, 8  # of a curve: places where its name may hang, and where others are near most of them
_INK = 150  # vertices of a curve that labels keep free
_NEAR = 0.03  # curves this near to each other, in heights of a panel, are not told apart by a label
_COLUMNS = 2000  # of a panel
_LOAD = 1.2  # inches
_SHADE = 0.12


@dataclass(frozen=True)
class Instant:
    """A tau that is marked in all panels, and what happens then."""

    tau: float
    text: str
    dashes: str = ":"


def draw(histories: Histories, loads: Sequence[History] = ()) -> Figure:
    """The outputs of a scene under its loads; the same bytes from the same scene where `saving.save` writes it."""
    model = histories.model
    until, scale = nearest(model.until), timescale(model)
    title = [f"{heading(model.name)}: outputs over time, to {scale.format(until)}"]
    title += [line for note in notes(histories) for line in wrap(note, CHARACTERS)]
    opened = [
        Instant(end.double, f"contact at x = {end.x} opens, {scale.format(end.double)}") for end in histories.contacts
    ]
    if opened:
        title.append("thin and light: the formal continuation, as if the opened contact stayed closed")
    slips = slip_times(model)
    if slips:
        title.append(f"purple: while {slip_words(slips)}")
    acting = [load_panel(loads[: len(CURVES)], _LOAD)] if loads else []
    shaded = [times for of_link in slips.values() for times in of_link]
    return stack_panels([*acting, *panels(histories)], until, title, instants=opened, shaded=shaded, scale=scale)


@with_style
def stack_panels(
    panels: Sequence[PlotPanel],
    until: float,
    title: Sequence[str],
    instants: Sequence[Instant] = (),
    shaded: Sequence[tuple[float, float]] = (),
    scale: Timescale = Timescale(),  # noqa: B008  (frozen)
) -> Figure:
    """Panels one under the other, lines of text above them; all in tau, drawn in the time of `scale`.

    What is `shaded` is from when to when, in all panels.
    """
    title = [part for line in title for part in wrap(line, CHARACTERS)]
    panels, until = [_in_scene_time(panel, scale) for panel in panels], until * scale.per_tau
    instants = [replace(instant, tau=instant.tau * scale.per_tau) for instant in instants]
    gaps = [0.0 if panel.goes_on(before) else _GAP for before, panel in pairwise(panels)]
    gaps = [_GAP, *gaps]
    above = (len(title) + 0.9) * _LINE - _GAP
    height = above + sum(gaps) + sum(panel.height for panel in panels) + _AXIS
    figure = new_figure(height, constrained=False)
    for k, line in enumerate(title):
        y = 1 - (k + 0.4) * _LINE / height
        figure.text(0.1 / WIDTH, y, line, va="top", weight="bold" if k == 0 else "normal")
    top = height - above
    for k, (panel, gap) in enumerate(zip(panels, gaps, strict=True)):
        top -= gap + panel.height
        axes = figure.add_axes((_LEFT / WIDTH, top / height, 1 - (_LEFT + _RIGHT) / WIDTH, panel.height / height))
        axes.set_xlim(0, _BEYOND * until)
        axes.tick_params(labelbottom=k == len(panels) - 1)
        _draw_curves(axes, panel, instants)
        for low, high in shaded:
            axes.axvspan(low * scale.per_tau, high * scale.per_tau, color=SLIPS, alpha=_SHADE, linewidth=0, zorder=0)
    _make_room(figure.axes)
    for axes, panel in zip(figure.axes, panels, strict=True):
        _name_curves(axes, panel, instants)
    axes.set_xlabel(scale.title)
    _shorten_times(axes)
    return figure


def _ticks(axis: Axis) -> list[float]:
    """Those that are seen."""
    low, high = sorted(axis.get_view_interval())
    return [tick for tick in axis.get_majorticklocs() if low <= tick <= high]


def _characters(axis: Axis) -> float:
    """Of the longest number beside an axis; a sign is wider than a digit."""
    numbers = axis.get_major_formatter().format_ticks(_ticks(axis))
    return max((len(number) + 0.3 * number.startswith("\u2212") for number in numbers), default=0)


def _shorten_times(axes: Axes) -> None:
    """Write long times with no more digits than they need, and the last one so that it ends within the figure."""
    widest, ticks = _characters(axes.xaxis), _ticks(axes.xaxis)
    if widest > _WIDEST_TIME:
        axes.xaxis.set_major_formatter("{x:g}")
    if widest > _WIDEST_TIME or (widest > _WIDEST_LAST and ticks[-1] > 0.98 * axes.get_xlim()[1]):
        axes.set_xticks(ticks)
        axes.get_xticklabels()[-1].set_horizontalalignment("right")


def _in_scene_time(panel: PlotPanel, scale: Timescale) -> PlotPanel:
    """A panel in the time of `scale`."""
    if not scale.unit:
        return panel
    factor = np.array((scale.per_tau, 1.0))
    return replace(
        panel,
        histories=tuple(
            replace(each, stretches=tuple(part * factor for part in each.stretches), formal=each.formal * factor[0])
            for each in panel.histories
        ),
        marks=tuple(replace(mark, points=mark.points * factor) for mark in panel.marks),
    )


def _make_room(panels: Sequence[Axes]) -> None:
    """Move the left of panels to the right where their numbers are wider than the room beside the titles."""
    titled = [_characters(axes.yaxis) for axes in panels if axes.get_ylabel()]
    missing = _CHARACTER * (max([_WIDEST_VALUE, *titled]) - _WIDEST_VALUE)
    for axes in panels:
        x, y, width, height = axes.get_position().bounds
        axes.set_position((x + missing / WIDTH, y, width - missing / WIDTH, height))
        axes.yaxis.set_label_coords(-(_TITLE + missing) / WIDTH / (width - missing / WIDTH), 0.5)


def _draw_curves(axes: Axes, panel: PlotPanel, instants: Sequence[Instant]) -> None:
    axes.set_ylabel(panel.title)
    axes.tick_params(labelsize=FONT)  # else there are more ticks once the figure is saved, with the user's settings
    draw_grid(axes)
    write_plain_numbers(axes.yaxis)
    for history, (dashes, color) in zip(panel.histories, CURVES, strict=False):
        _curve(axes, history, dashes, color)
    axes.margins(x=0, y=0.14)
    axes.autoscale_view(scalex=False)
    for instant in instants:
        axes.axvline(instant.tau, color="black", linestyle=instant.dashes, linewidth=0.9, zorder=1)
    for mark in panel.marks:
        upright = mark.points[0, 0] == mark.points[-1, 0]
        axes.plot(*mark.points.T, "-o" if upright else ":o", color="black", markersize=3, linewidth=0.9, zorder=4)
    if panel.limits:
        _strip(axes, panel)


def _name_curves(axes: Axes, panel: PlotPanel, instants: Sequence[Instant]) -> None:
    if panel.limits:
        return  # a strip says what it is
    names = _labels(axes, panel, instants)
    if names:
        label(axes, names, FONT)
    for text in axes.texts:  # legible even where curves leave no room
        text.set(zorder=5, path_effects=HALO)


def _strip(axes: Axes, panel: PlotPanel) -> None:
    """A strip with the axis of its like, and what there is to say of it in the room above its curve."""
    assert panel.limits is not None  # of a strip
    low, high = panel.limits
    size = high - low
    axes.set_ylim(low - 0.1 * size, high + 0.5 * size)
    inside = (low - 0.1 * size, high + 0.1 * size)  # above are the words, and another strip
    axes.set_yticks([tick for tick in MaxNLocator(3).tick_values(low, high) if inside[0] <= tick <= inside[1]])
    axes.yaxis.set_major_formatter("{x:g}")  # no room for a power of ten beside it
    axes.text(0.004, 0.95, panel.summary, transform=axes.transAxes, va="top", path_effects=HALO)


def _labels(axes: Axes, panel: PlotPanel, instants: Sequence[Instant]) -> list[Curve]:
    """What is to be labelled: curves, where they run apart from the others; marks; instants."""
    low, high = axes.get_ylim()
    curves = []
    for history, (_, color) in zip(panel.histories, CURVES, strict=False):
        others = [other.points for other in panel.histories if other is not history]
        shape = thin_polyline(history.points, _VERTICES)
        places = isolated_vertices(shape, others, _NEAR * (high - low))
        anchors = shape if len(places) == len(shape) else thin_polyline(places, _ANCHORS)
        curves.append(Curve(history.name, anchors, color, "bold"))
        # no name can hang on the rest of the curve, yet none may cover it
        curves.append(Curve("", thin_polyline(history.points, _INK), "none", "normal"))
    curves += [Curve(mark.text, mark.points, "black", mark.weight) for mark in panel.marks]
    for instant in instants:
        upright = np.column_stack([np.full(9, instant.tau), np.linspace(low, high, 9)])
        curves.append(Curve(instant.text, upright, "black", "normal"))
    return curves


def _curve(axes: Axes, history: History, dashes: Dashes, color: str) -> None:
    """A curve between its fronts, thin upright lines where it jumps; thin and light where it is formal."""
    until, thick = float(history.points[-1, 0]), 0.9 if restless(history) else 1.4
    for stretch in (reduce_vertices(each, until, _COLUMNS) for each in history.stretches):
        tau = stretch[:, 0]
        for formal, width in ((False, thick), (True, 0.7)):
            part = stretch[tau >= history.formal if formal else tau <= history.formal]
            if len(part):
                axes.plot(*part.T, color=color, linestyle=dashes, linewidth=width, alpha=_ALPHA[formal])
    for (_, before), (tau, after) in jumps(history):
        alpha = _ALPHA[tau > history.formal]
        axes.plot([tau, tau], [before, after], color=color, linewidth=0.7, alpha=alpha, zorder=1.5)


def jumps(history: History) -> list[tuple[Array, Array]]:
    """The two ends (tau, value) of each jump."""
    return [(before[-1], after[0]) for before, after in pairwise(history.stretches)]


def thin_polyline(points: Array, count: int) -> Array:
    """The vertices of a polyline, `count` at most, that keep its shape: always the one farthest from those so far."""
    kept = [0, len(points) - 1]
    places = np.arange(len(points))
    while len(kept) < min(count, len(points)):
        missed = np.abs(points[:, 1] - np.interp(places, sorted(kept), points[sorted(kept), 1]))
        worst = int(np.argmax(missed))
        if missed[worst] == 0:
            break
        kept.append(worst)
    return points[sorted(set(kept))]


def isolated_vertices(places: Array, others: Sequence[Array], near: float) -> Array:
    """Those vertices of a curve that are not near another curve; all where there are hardly any."""
    distances = [np.abs(places[:, 1] - np.interp(places[:, 0], *other.T)) for other in others]
    alone = places[np.min(distances, axis=0) > near] if distances else places
    return alone if len(alone) > 2 else places
