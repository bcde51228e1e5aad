"""Place x time: what every rod carries at every instant, as waves are drawn on paper, time upward.

A cell of the picture shows the value at its middle, which is shifted by a part of a cell that no front lies on, so that
fronts are as crisp as the picture is fine.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from wavesym.exact.contacts.events import contact_ends
from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest, rational
from wavesym.pictures.field import Field
from wavesym.pictures.stations import open_times
from wavesym.pictures.timescale import timescale
from wavesym.pictures.xt_nodes import draw_nodes, legend
from wavesym.scene.physical.scale import Scale
from wavesym.scene.physical.scene import PhysicalScene
from wavesym.systems.station import Lines, Station

Array = NDArray[np.float64]

_WIDTH, _HEIGHT, _FONT = 11.0, 7.5, 9  # inches, points
_ROWS, _COLUMNS = 900, 700  # cells of all lines together
_OFF = 0.4142  # of a cell: where in it the value is taken
_SHADES = 101  # an odd number, so that 0 is white; few, so that files are small
_NARROWEST = 0.12  # of all lines together: where names and numbers still fit
_SENSE = {"velocity": "", "force": ", pull red, push blue"}
_NAMED = {"velocity": "velocity", "force": f"force (impedance times strain){_SENSE['force']}"}


def draw(model: Model, lines: Lines, physical: PhysicalScene | None = None) -> Figure:
    """Velocity and force of all rods over the horizon, in a picture of each line. CostError as for their outputs.

    A `physical` scene has its units at the axes.
    """
    field, scale = Field(model), timescale(model)
    units = physical.scale if physical else None
    shown = {name: stations for name, stations in lines.items() if stations[-1].x}
    until = nearest(model.until) * scale.per_tau
    opened = {
        place: [(low * scale.per_tau, high * scale.per_tau) for low, high in times]
        for place, times in open_times(model, field.events).items()
    }
    figure = Figure(figsize=(_WIDTH, _HEIGHT), dpi=120)
    FigureCanvasAgg(figure)
    widths = _widths(shown)
    grid = figure.add_gridspec(
        2,
        2 * len(shown) + 1,
        width_ratios=[*widths, 0.1 * sum(widths), *widths],
        height_ratios=(1, 0.03),
        left=0.06,
        right=0.98,
        top=0.88,
        bottom=0.08,
        wspace=0.2 if len(shown) > 1 else 0.1,
        hspace=0.16,
    )
    upward = scale.title if scale.unit else scale.symbol
    title = f"{model.name}: {model.labels.system['type']}, {scale.symbol} upward to {scale.of(nearest(model.until))}"
    figure.suptitle(title, x=0.06, y=0.985, ha="left")
    figure.text(0.06, 0.935, legend(model.network, shown), fontsize=_FONT - 1, color="0.3")
    for first, quantity in ((0, "velocity"), (len(shown) + 1, "force")):
        factor = nearest(rational(units.factor(quantity, 1))) if units else 1.0
        images = [_image(field, stations, model, quantity, factor) for stations in shown.values()]
        largest = max(float(np.max(np.abs(image[2]), initial=0.0)) for rods in images for image in rods) or 1.0
        norm, colours = Normalize(-largest, largest), colormaps["RdBu_r"].resampled(_SHADES)
        for column, ((name, stations), rods) in enumerate(zip(shown.items(), images, strict=True)):
            axes = figure.add_subplot(grid[0, first + column])
            for x, tau, values in rods:
                axes.pcolormesh(x, tau, values, cmap=colours, norm=norm, rasterized=True)
            _frame(axes, name, stations, until, upward if column == 0 else "")
            if model.length is not None:
                _lengths(axes, axis_text(name, model.length), float(model.length.size))
            draw_nodes(axes, model.network, stations, opened, until)
            if not name:
                _formal(axes, model, float(stations[-1].x))
        place = figure.add_subplot(grid[1, first : first + len(shown)])
        bar = figure.colorbar(ScalarMappable(norm, colours), cax=place, orientation="horizontal")
        bar.ax.tick_params(labelsize=_FONT - 1)
        bar.set_label(
            _NAMED[quantity] if units is None else _named(quantity, units),
            fontsize=_FONT,
        )
    return figure


def _named(quantity: str, units: Scale) -> str:
    """In its unit; only along a rod is one sign a pull."""
    called = "moment" if (quantity, units.kind) == ("force", "torsional") else quantity
    return f"{called} in {units.unit(quantity)}{_SENSE[quantity] if units.kind == 'longitudinal' else ''}"


def _lengths(axes: Axes, label: str, length: float) -> None:
    """Places that are lengths, one of x being so long; named systems go on counting rods."""
    low, high = axes.get_xlim()
    end = high * length * (1 + 1e-9)  # rounding must not take the tick at the end
    places = [x for x in MaxNLocator(len(axes.get_xticks())).tick_values(0, high * length) if x <= end]
    axes.set_xticks([min(place / length, high) for place in places], [f"{place:g}" for place in places])
    axes.set_xlim(low, high)
    axes.set_xlabel(label, fontsize=_FONT)


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
        velocity, force = field.at(station.right, *np.meshgrid(part, tau))
        values = factor * (velocity if quantity == "velocity" else force)
        images.append((columns, edges * timescale(model).per_tau, values))
    return images


def _frame(axes: Axes, name: str, stations: Sequence[Station], until: float, upward: str) -> None:
    axes.set_xlim(0, float(stations[-1].x))
    axes.set_ylim(0, until)
    axes.set_xlabel(axis_text(name), fontsize=_FONT)
    axes.locator_params(axis="x", nbins=6 if upward else 3)
    axes.tick_params(labelsize=_FONT - 1, labelleft=bool(upward))
    if upward:
        axes.set_ylabel(upward, fontsize=_FONT)
