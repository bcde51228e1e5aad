"""Place x time: what every rod carries at every instant, as waves are drawn on paper, time upward.

A cell of the picture shows the value at its middle, which is shifted by a part of a cell that no front lies on, so that
fronts are as crisp as the picture is fine.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from wavesym.exact.contacts.events import contact_ends
from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest, rational
from wavesym.pictures.field import Field
from wavesym.pictures.naming import heading
from wavesym.pictures.stations import loose_times
from wavesym.pictures.style import WIDTH, colours, new_figure, with_style
from wavesym.pictures.timescale import timescale
from wavesym.pictures.units import unit_text
from wavesym.pictures.xt_nodes import draw_nodes, legend, name_rows, write_names
from wavesym.scene.physical.scale import Scale
from wavesym.scene.physical.scene import PhysicalScene
from wavesym.systems.station import Lines, Station

_PANEL, _BELOW, _LINE = 3.4, 0.62, 0.21  # inches: a panel, the axis below it, a line of text
_LEFT, _RIGHT = 0.9, 0.95  # inches beside the panels
_LETTERS = 74  # of a line of text
_ROWS, _COLUMNS = 600, 500  # cells of all lines together
_OFF = 0.4142  # of a cell: where in it the value is taken
_MOST_FRONTS = 400  # lines that can be told apart
_NARROWEST = 0.12  # of all lines together: where names and numbers still fit
_NUMBER = 0.5  # inches of a number below a panel
_DIGITS = 36  # that numbers below a panel may have together
_SENSE = {"velocity": "", "force": ": pull red, push blue"}


@with_style
def draw(model: Model, lines: Lines, physical: PhysicalScene | None = None) -> Figure:
    """Velocity above force of all rods over the horizon, with a panel for each line.

    Args:
        model: what moves.
        lines: its main line and its branches.
        physical: a scene with units, which are those of the axes.

    Raises:
        CostError: as for outputs of all rods.
    """
    field, scale = Field(model), timescale(model)
    units = physical.scale if physical else None
    shown = {name: stations for name, stations in lines.items() if stations[-1].x}
    until = nearest(model.until) * scale.per_tau
    loose = {
        link: [(low * scale.per_tau, high * scale.per_tau) for low, high in times]
        for link, times in loose_times(model, field.events).items()
    }
    widths = _widths(shown)
    wide = WIDTH - _LEFT - _RIGHT
    names = max(
        name_rows(model.network, each, wide * w / sum(widths)) for each, w in zip(shown.values(), widths, strict=True)
    )
    notes = wrap(legend(model.network, shown), _LETTERS)
    above, gap = _LINE * (2.8 + len(notes) + names), _BELOW + _LINE * (1.5 + names)
    height = above + 2 * _PANEL + gap + _BELOW
    figure = new_figure(height, constrained=False)
    figure.text(
        0.01, 1 - 0.4 * _LINE / height, f"{heading(model.name)}: waves over place and time", weight="bold", va="top"
    )
    for k, note in enumerate(notes):
        figure.text(0.01, 1 - _LINE * (1.5 + k) / height, note, color="0.3", va="top")
    for row, quantity in enumerate(("velocity", "force")):
        factor = nearest(rational(units.factor(quantity, 1))) if units else 1.0
        images = [_image(field, stations, model, quantity, factor) for stations in shown.values()]
        largest = max(float(np.max(np.abs(image[2]), initial=0.0)) for rods in images for image in rods) or 1.0
        norm, shades = Normalize(-largest, largest), colours(signed=True)
        top = height - above - row * (_PANEL + gap)
        left = _LEFT
        for width, (name, stations), rods in zip(widths, shown.items(), images, strict=True):
            own = wide * width / sum(widths)
            room = own - 0.25 * (len(shown) > 1)
            axes = figure.add_axes((left / WIDTH, (top - _PANEL) / height, room / WIDTH, _PANEL / height))
            for x, tau, values in rods:
                axes.pcolormesh(x, tau, values, cmap=shades, norm=norm, rasterized=True)
            _draw_fronts(axes, field, stations, until, scale.per_tau)
            _frame(axes, name, stations, until, scale.title if left == _LEFT else "")
            if model.length is not None:
                _lengths(axes, axis_text(name, model.length), float(model.length.size))
            _thin_ticks(axes, room, first=left == _LEFT)
            draw_nodes(axes, model.network, stations, loose, until)
            write_names(axes, model.network, stations)
            if not name:
                _formal(axes, model, float(stations[-1].x))
            left += own
        place = figure.add_axes(((left + 0.08) / WIDTH, (top - _PANEL) / height, 0.14 / WIDTH, _PANEL / height))
        bar = figure.colorbar(ScalarMappable(norm, shades), cax=place)
        bar.ax.locator_params(nbins=7)
        words = _quantity_title(quantity, units)
        figure.text(_LEFT / WIDTH, (top + _LINE * (names + 0.35)) / height, words, weight="bold", va="bottom")
    return figure


def _draw_fronts(axes: Axes, field: Field, stations: Sequence[Station], until: float, per_tau: float) -> None:
    """The fronts of all waves of a line as thin lines; none where they are too many to be told apart."""
    paths = []
    for station, following in pairwise(stations):
        assert station.right is not None  # between two stations there is a bar
        low, high, delay = float(station.x), float(following.x), field.delay(station.right) * per_tau
        left, right = (times * per_tau for times in field.fronts(station.right))
        paths += [[(low, t), (high, t + delay)] for t in left if t < until]
        paths += [[(high, t), (low, t + delay)] for t in right if t < until]
    if len(paths) <= _MOST_FRONTS:
        axes.add_collection(LineCollection(paths, colors="0.15", linewidths=0.5), autolim=False)


def _quantity_title(quantity: str, units: Scale | None) -> str:
    """A quantity in its unit; only along a rod is one sign a pull."""
    if units is None:
        return quantity.capitalize() if quantity == "velocity" else f"Force (impedance \u00d7 strain){_SENSE[quantity]}"
    words = QUANTITIES[quantity].in_words_of(units.kind).phrase
    return (
        f"{words.capitalize()} in {unit_text(units.unit(quantity))}{_SENSE[quantity] * (units.kind == 'longitudinal')}"
    )


def _lengths(axes: Axes, label: str, length: float) -> None:
    """Places that are lengths, one of x being so long; named systems go on counting rods."""
    low, high = axes.get_xlim()
    end = high * length * (1 + 1e-9)  # rounding must not take the tick at the end
    most = min(len(axes.get_xticks()), max(2, _DIGITS // len(f"{end:.0f}")))
    places = [x for x in MaxNLocator(most).tick_values(0, high * length) if x <= end]
    axes.set_xticks([min(place / length, high) for place in places], [f"{place:.6g}" for place in places])
    axes.set_xlim(low, high)
    axes.set_xlabel(label)


def _thin_ticks(axes: Axes, room: float, *, first: bool) -> None:
    """So many numbers as fit below a panel; the 0 of a later one would lie over the end of the one before it."""
    low, high = axes.get_xlim()
    ticks = [(x, text.get_text()) for x, text in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)]
    inside = [tick for tick in ticks if low < tick[0] <= high or (first and tick[0] == low)]
    step = -(-len(inside) // max(1, int(room / _NUMBER)))
    axes.set_xticks(*zip(*inside[::-step][::-1], strict=True))


def _formal(axes: Axes, model: Model, long: float) -> None:
    """What the opening of a contact reaches that counts as closed, one rod in one tau: hatched."""
    until, per_tau = nearest(model.until), timescale(model).per_tau
    for end in contact_ends(model):
        x = np.array([max(0.0, end.x - (until - end.double)), end.x, min(long, end.x + until - end.double)])
        reached = (end.double + np.abs(x - end.x)) * per_tau
        axes.fill_between(
            x, reached, until * per_tau, facecolor="none", edgecolor="0.3", hatch="///", linewidth=0, zorder=1.5
        )


def _widths(lines: Lines) -> list[float]:
    lengths = [float(stations[-1].x) for stations in lines.values()]
    return [max(length, _NARROWEST * sum(lengths)) for length in lengths]


def _image(
    field: Field, stations: Sequence[Station], model: Model, quantity: str, factor: float
) -> list[tuple[Array, Array, Array]]:
    """The cells of every bar of a line: their edges, and the values in them, (rows, columns)."""
    edges = np.linspace(0.0, nearest(model.until), _ROWS + 1)
    tau = edges[:-1] + _OFF * (edges[1] - edges[0])
    images = []
    for station, following in pairwise(stations):
        assert station.right is not None  # between two stations there is a bar
        low, high = float(station.x), float(following.x)
        count = max(8, int(_COLUMNS * (high - low) / float(stations[-1].x)))
        columns = np.linspace(low, high, count + 1)
        part = (np.arange(count) + _OFF) / count
        velocity, force = field.values_at(station.right, *np.meshgrid(part, tau))
        values = factor * (velocity if quantity == "velocity" else force)
        images.append((columns, edges * timescale(model).per_tau, values))
    return images


def _frame(axes: Axes, name: str, stations: Sequence[Station], until: float, upward: str) -> None:
    axes.set_xlim(0, float(stations[-1].x))
    axes.set_ylim(0, until)
    axes.set_xlabel(axis_text(name))
    axes.locator_params(axis="x", nbins=8 if upward else 2)
    axes.locator_params(axis="y", nbins=8)
    axes.tick_params(labelleft=bool(upward))
    axes.set_ylabel(upward)
