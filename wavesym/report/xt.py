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

from wavesym.exact.field import Field
from wavesym.model.clock import Clock
from wavesym.model.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.report.stations import open_times
from wavesym.report.xt_nodes import draw_nodes, legend
from wavesym.scene.physical.scene import PhysicalScene
from wavesym.systems.station import Lines, Station

Array = NDArray[np.float64]

_WIDTH, _HEIGHT, _FONT = 11.0, 7.5, 9  # inches, points
_ROWS, _COLUMNS = 900, 700  # cells of all lines together
_OFF = 0.4142  # of a cell: where in it the value is taken
_SHADES = 101  # an odd number, so that 0 is white; few, so that files are small
_NARROWEST = 0.12  # of all lines together: where names and numbers still fit
_NAMED = {"velocity": "velocity", "force": "force (impedance times strain), pull red, push blue"}


def draw(model: Model, lines: Lines, physical: PhysicalScene | None = None) -> Figure:
    """Velocity and force of all rods over the horizon, in a picture of each line. CostError as for their outputs.

    A `physical` scene has its units at the axes.
    """
    field = Field(model)
    shown = {name: stations for name, stations in lines.items() if stations[-1].x}
    until = nearest(model.until)
    opened = open_times(model, field.events)
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
    end = f"t upward to {model.clock.told(model.until)}" if model.clock else f"tau upward to {until:g}"
    figure.suptitle(f"{model.name}: {model.labels.system['type']}, {end}", x=0.06, y=0.985, ha="left")
    figure.text(0.06, 0.935, legend(model.network, shown), fontsize=_FONT - 1, color="0.3")
    for first, quantity in ((0, "velocity"), (len(shown) + 1, "force")):
        images = [_image(field, stations, until, quantity) for stations in shown.values()]
        largest = max(float(np.max(np.abs(image[2]), initial=0.0)) for rods in images for image in rods) or 1.0
        norm, colours = Normalize(-largest, largest), colormaps["RdBu_r"].resampled(_SHADES)
        for column, ((name, stations), rods) in enumerate(zip(shown.items(), images, strict=True)):
            axes = figure.add_subplot(grid[0, first + column])
            for x, tau, values in rods:
                axes.pcolormesh(x, tau, values, cmap=colours, norm=norm, rasterized=True)
            _frame(axes, name, stations, until, column == 0)
            if physical:
                _in_units(axes, physical, name, float(stations[-1].x), until, column == 0)
            draw_nodes(axes, model.network, stations, opened, until)
        place = figure.add_subplot(grid[1, first : first + len(shown)])
        label = _NAMED[quantity]
        if physical:
            size = float(physical.scale.factor(quantity, 1))
            norm = Normalize(-largest * size, largest * size)
            label = f"{quantity} in {physical.scale.unit(quantity)}{', pull red, push blue' * (quantity == 'force')}"
        bar = figure.colorbar(ScalarMappable(norm, colours), cax=place, orientation="horizontal")
        bar.ax.tick_params(labelsize=_FONT - 1)
        bar.set_label(label, fontsize=_FONT)
    return figure


def _widths(lines: Lines) -> list[float]:
    lengths = [float(stations[-1].x) for stations in lines.values()]
    return [max(length, _NARROWEST * sum(lengths)) for length in lengths]


def _image(field: Field, stations: Sequence[Station], until: float, quantity: str) -> list[tuple[Array, Array, Array]]:
    """The cells of every bar of a line: their edges, and the values in them, (rows, columns)."""
    edges = np.linspace(0.0, until, _ROWS + 1)
    tau = edges[:-1] + _OFF * (edges[1] - edges[0])
    images = []
    for station, following in pairwise(stations):
        assert station.right is not None  # between two stations there is a bar
        low, high = float(station.x), float(following.x)
        count = max(8, int(_COLUMNS * (high - low) / float(stations[-1].x)))
        columns = np.linspace(low, high, count + 1)
        part = (np.arange(count) + _OFF) / count
        velocity, force = field.at(station.right, *np.meshgrid(part, tau))
        images.append((columns, edges, velocity if quantity == "velocity" else force))
    return images


def _frame(axes: Axes, name: str, stations: Sequence[Station], until: float, first: bool) -> None:
    axes.set_xlim(0, float(stations[-1].x))
    axes.set_ylim(0, until)
    axes.set_xlabel(f"{name}:x" if name else "x", fontsize=_FONT)
    axes.locator_params(axis="x", nbins=6 if first else 3)
    axes.tick_params(labelsize=_FONT - 1, labelleft=first)
    if first:
        axes.set_ylabel("tau", fontsize=_FONT)


def _in_units(axes: Axes, physical: PhysicalScene, name: str, long: float, until: float, first: bool) -> None:
    """Axes that count the time, and where places are lengths these; named systems go on counting rods."""
    length = physical.length
    per_tau, unit = _readable(physical.scale.clock, until)
    times = MaxNLocator(8).tick_values(0, until * per_tau)
    axes.set_yticks([time / per_tau for time in times if time <= until * per_tau])
    axes.set_yticklabels([f"{time:g}" for time in times if time <= until * per_tau])
    axes.set_ylim(0, until)
    if first:
        axes.set_ylabel(f"t in {unit}", fontsize=_FONT)
    if length is None:
        return
    places = MaxNLocator(6 if first else 3).tick_values(0, long * length)
    axes.set_xticks([place / length for place in places if place <= long * length])
    axes.set_xticklabels([f"{place:g}" for place in places if place <= long * length])
    axes.set_xlim(0, long)
    axes.set_xlabel(f"{name}:x in {physical.scale.results.texts['length']}".removeprefix(":"), fontsize=_FONT)


def _readable(clock: Clock, until: float) -> tuple[float, str]:
    """One tau in the clock's unit, or in a smaller one where seconds would have many zeros."""
    per_tau = nearest(clock.per_tau)
    smaller = ((1.0, "s"), (1e3, "ms"), (1e6, "us")) if clock.unit == "s" else ((1.0, clock.unit),)
    size, unit = next((each for each in smaller if until * per_tau * each[0] >= 1), smaller[-1])
    return per_tau * size, unit
