"""Place x time of all rods as waves are drawn on paper: cells of colour, and over them what stands between rods."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from wavesym.errors import WavesymError
from wavesym.exact.contacts.events import ContactEnd, contact_ends
from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest, rational
from wavesym.pictures.field import Field
from wavesym.pictures.line_histories import limit
from wavesym.pictures.page.frame import Frame, PlotAxis
from wavesym.pictures.page.places import colour_bar
from wavesym.pictures.page.plots import BELOW, LEFT, RIGHT, TOP, WIDTH, PagePicture, picture
from wavesym.pictures.page.png import colour_image
from wavesym.pictures.page.svg import Svg, box, concatenate, element, line
from wavesym.pictures.stations import Loose, ground_links, loose_times, standing
from wavesym.pictures.timescale import timescale
from wavesym.pictures.units import unit_text
from wavesym.results.presentation import number_text, readable_unit
from wavesym.scene.physical.scale import Scale
from wavesym.systems.station import Lines, Station

_MOST = 60  # crossings of the shortest rod that can be told apart
_ROWS, _COLUMNS = 240, 280  # cells
_OFF = 0.4142  # of a cell: where in it the value is taken, so that no front lies there
_TALL = 380.0
_QUANTITIES = {"velocity": 0, "force": 1}


def crossings(model: Model, lines: Lines, units: Scale | None) -> list[PagePicture]:
    """Velocity and force of the main line, or of the first branch with a rod.

    Nothing where waves cross too often, or it would cost too much.
    """
    shortest = model.network.shortest
    if model.until > _MOST * shortest:
        return []
    try:
        field = Field(model)
    except WavesymError:
        return []
    return [_draw(model, lines, field, name, units) for name in _QUANTITIES]


def _draw(model: Model, lines: Lines, field: Field, name: str, units: Scale | None) -> PagePicture:
    line_name, stations = next(each for each in lines.items() if each[1][-1].x)
    scale = timescale(model)
    until, long = nearest(model.until), float(stations[-1].x)
    factor = nearest(rational(units.factor(name, 1))) if units else 1.0
    values = factor * _cells(field, stations, until, _QUANTITIES[name])
    largest = limit([values])
    readable, unit = readable_unit(largest, units.unit(name) if units else "")
    values, largest = values / readable, largest / readable
    x, y = PlotAxis(0.0, long, LEFT, WIDTH - RIGHT), PlotAxis(0.0, until * scale.per_tau, TOP + _TALL, TOP)
    image = colour_image(values, x, y, (-largest, largest), signed=True)
    formal = concatenate(*(_formal(end, x, y, until, long, scale.per_tau) for end in contact_ends(model)))
    nodes = concatenate(*_nodes(model, stations, loose_times(model, field.events), x, scale.per_tau, y))
    ends = f"\u2264 {number_text(-largest, digits=3)}", f"\u2265 {number_text(largest, digits=3)}"
    words = f"{name} in {unit_text(unit)}" if units else f"{name} (dimensionless)"
    bar = colour_bar(words, ends, TOP + _TALL + BELOW, signed=True)
    description = (
        f"Colours show the {name} of every rod of {_line_text(line_name)}, place to the right and time upward to "
        f"{scale.format(until)}; waves are bands that slope by one rod in one crossing."
    )
    title = f"{name}: place to the right, time upward".capitalize()
    height = TOP + _TALL + BELOW + 34
    size = float(model.length.size) if model.length else 1.0
    frame = Frame(replace(x, high=size * long), y, axis_text("", model.length), scale.title).draw()
    return PagePicture(title, picture(f"xt-{name}", title, description, height, frame, image, formal, nodes, bar))


def _line_text(name: str) -> str:
    return f"the branch {name}" if name else "the main line"


def _formal(end: ContactEnd, x: PlotAxis, y: PlotAxis, until: float, long: float, per_tau: float) -> Svg:
    """What the opening of a contact reaches, one rod in one tau: the formal continuation, hatched."""
    reach = until - end.double
    low, high = max(0.0, end.x - reach), min(long, end.x + reach)
    corners = [(end.x, end.double), (low, end.double + end.x - low), (low, until), (high, until)]
    corners.append((high, end.double + high - end.x))
    points = " ".join(f"{x.pixel(at):.1f},{y.pixel(tau * per_tau):.1f}" for at, tau in corners)
    return element("polygon", points=points, class_="hatched")


def _cells(field: Field, stations: tuple[Station, ...], until: float, quantity: int) -> Array:
    """A value for each row of time and each column of place, whatever rod it lies in."""
    tau = (np.arange(_ROWS) + _OFF) * until / _ROWS
    x = (np.arange(_COLUMNS) + _OFF) * float(stations[-1].x) / _COLUMNS
    result = np.zeros((_ROWS, _COLUMNS))
    for station, following in pairwise(stations):
        low, high = float(station.x), float(following.x)
        here = (x >= low) & (x < high)
        if station.right is not None and here.any():
            part, instants = np.meshgrid((x[here] - low) / (high - low), tau)
            result[:, here] = field.values_at(station.right, part, instants)[quantity]
    return result


def _nodes(
    model: Model, stations: tuple[Station, ...], loose: Loose, x: PlotAxis, per_tau: float, y: PlotAxis
) -> Iterator[Svg]:
    """Masses and ends as thick lines; links as lines, a white gap while they are open, purple while they slide."""
    for station in stations:
        at = x.pixel(float(station.x))
        held = (link for point in station.points for link in ground_links(model.network, point))
        for what in (*standing(model.network, station), *held):
            if isinstance(what, Link):
                if not what.friction:  # what sticks is a point
                    yield line(at, y.start, at, y.end, "thin" if what.contact else "held")
                for low, high in loose.get(what, ()):
                    top, bottom = y.pixel(high * per_tau), y.pixel(low * per_tau)
                    yield box(at - 2, top, 4, bottom - top, "slip" if what.friction or what.limits else "gap")
            elif what.mass:
                yield line(at, y.start, at, y.end, "body")
            elif what.motion:
                yield line(at, y.start, at, y.end, "told")
