"""Pictures of a page over place: least and greatest along the chain, and place x time as colours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from wavesym.mechanics.length import axis_text
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.pictures.groups import axis_title
from wavesym.pictures.line_histories import (
    Band,
    LineHistories,
    cells,
    describe_extremes,
    envelope,
    extremes,
    limit,
    line_name,
)
from wavesym.pictures.page.frame import Frame, PlotAxis, spread
from wavesym.pictures.page.plots import BELOW, LEFT, RIGHT, TOP, WIDTH, PagePicture, labelled_spot, picture
from wavesym.pictures.page.png import colour_image, colours
from wavesym.pictures.page.svg import Svg, box, concatenate, element, line, polyline, text
from wavesym.pictures.timescale import Timescale
from wavesym.results.presentation import number_text

_ALONG = 230.0  # pixels high
_COLUMNS = 600  # of a map
_NUMBERED = 12  # storeys with a number


def along_pictures(model: Model, found: Sequence[LineHistories], scale: Timescale) -> Iterator[PagePicture]:
    """The least and the greatest of each quantity along each line."""
    upright = model.labels.system["type"] == "building"
    for k, quantity in enumerate(found):
        for j, band in enumerate(quantity.bands):
            name = line_name(model, quantity, band)
            where = "height" if upright else "chain"
            title = f"Least and greatest {name} along the {where}"
            description = describe_extremes(quantity, band, scale)
            make = _over_height if upright else _along_line
            content, height = make(model, quantity, band, scale)
            yield PagePicture(title, picture(f"along-{k}-{j}", title, description, height, content))


def _over_height(model: Model, quantity: LineHistories, band: Band, scale: Timescale) -> tuple[Svg, float]:
    least, greatest = envelope(band)
    low, high = spread(min(0.0, float(np.min(least))), max(0.0, float(np.max(greatest))), 0.1)
    tall = max(160.0, min(30.0 * len(band.spots), 420.0))
    x, y = (
        PlotAxis(low, high, LEFT, WIDTH - RIGHT),
        PlotAxis(band.spots[0].low - 0.3, band.spots[-1].high + 0.3, TOP + tall, TOP),
    )
    places = band.tick_labels(_NUMBERED, first=1 if quantity.storeys else 0)
    title = axis_title(model, quantity.quantity, quantity.unit).replace("\n", " ")
    frame = Frame(x, y, title, "storey" if quantity.storeys else "floor", places)
    parts = [frame.draw(), line(x.pixel(0), y.start, x.pixel(0), y.end, "zero")]
    ends = [(y.pixel(spot.x), x.pixel(a), x.pixel(b)) for spot, a, b in zip(band.spots, least, greatest, strict=True)]
    if quantity.storeys:
        half = 0.38 * (y.start - y.end) / (y.high - y.low)
        for at, a, b in ends:
            parts += [box(a, at - half, b - a, 2 * half, "between")]
            parts += [line(a, at - half, a, at + half, "least"), line(b, at - half, b, at + half, "greatest")]
    else:
        parts.append(polyline([*((a, at) for at, a, _ in ends), *((b, at) for at, _, b in ends[::-1])], "between"))
        parts.append(polyline([(a, at) for at, a, _ in ends], "least"))
        parts.append(polyline([(b, at) for at, _, b in ends], "greatest"))
    parts += [
        labelled_spot(x.pixel(each.value), y.pixel(each.x), each.describe(scale), above=k == 0)
        for k, each in enumerate(extremes(quantity, band))
        if each.value
    ]
    return concatenate(*parts), TOP + tall + BELOW


def _along_line(model: Model, quantity: LineHistories, band: Band, scale: Timescale) -> tuple[Svg, float]:
    least, greatest = envelope(band)
    low, high = spread(min(0.0, float(np.min(least))), max(0.0, float(np.max(greatest))), 0.14)
    x, y = PlotAxis(band.spots[0].low, band.spots[-1].high, LEFT, WIDTH - RIGHT), PlotAxis(low, high, TOP + _ALONG, TOP)
    frame = Frame(x, y, axis_text(band.line, quantity.length), axis_title(model, quantity.quantity, quantity.unit))
    ends = [(x.pixel(spot.x), y.pixel(a), y.pixel(b)) for spot, a, b in zip(band.spots, least, greatest, strict=True)]
    parts = [
        frame.draw(),
        polyline([*((at, a) for at, a, _ in ends), *((at, b) for at, _, b in ends[::-1])], "between"),
        polyline([(at, a) for at, a, _ in ends], "least"),
        polyline([(at, b) for at, _, b in ends], "greatest"),
    ]
    parts += [
        labelled_spot(x.pixel(each.x), y.pixel(each.value), each.describe(scale), above=k == 0)
        for k, each in enumerate(extremes(quantity, band))
        if each.value
    ]
    return concatenate(*parts), TOP + _ALONG + BELOW


def maps(model: Model, found: Sequence[LineHistories], scale: Timescale) -> Iterator[PagePicture]:
    """Place x time as colours."""
    for k, quantity in enumerate(found):
        values = [cells(quantity, band, _COLUMNS) for band in quantity.bands]
        largest = limit(values)
        for j, (band, own) in enumerate(zip(quantity.bands, values, strict=True)):
            name = line_name(model, quantity, band)
            title = f"{name} over place and time".capitalize()
            description = describe_extremes(quantity, band, scale)
            content, height = _map(model, quantity, band, own, largest, scale)
            yield PagePicture(title, picture(f"map-{k}-{j}", title, description, height, content))


def _map(
    model: Model, quantity: LineHistories, band: Band, values: Array, largest: float, scale: Timescale
) -> tuple[Svg, float]:
    """Rows of equal height are asked for: places are spread evenly along a rod."""
    tall = max(120.0, min(16.0 * len(band.spots), 260.0))
    x = PlotAxis(0.0, float(quantity.taus[-1]) * scale.per_tau, LEFT, WIDTH - RIGHT)
    y = PlotAxis(band.spots[0].low, band.spots[-1].high, TOP + tall, TOP)
    places = band.tick_labels(_NUMBERED) if quantity.storeys else None
    upward = "storey" if quantity.storeys else axis_text(band.line, quantity.length)
    rows = _evenly(band, values)
    image = colour_image(rows, x, y, (-largest, largest), signed=True)
    frame = Frame(x, y, scale.title, upward, places)
    ends = f"\u2264 {number_text(-largest, digits=3)}", f"\u2265 {number_text(largest, digits=3)}"
    bar = colour_bar(axis_title(model, quantity.quantity, quantity.unit), ends, TOP + tall + BELOW, signed=True)
    return concatenate(frame.draw(), image, bar), TOP + tall + BELOW + 34


def _evenly(band: Band, values: Array) -> Array:
    """Rows of equal height, each that of the place whose stretch it lies in."""
    low, high = band.spots[0].low, band.spots[-1].high
    smallest = min(spot.high - spot.low for spot in band.spots)
    rows = min(400, max(1, round((high - low) / smallest)))
    middles = low + (np.arange(rows) + 0.5) * (high - low) / rows
    edges = np.array([spot.low for spot in band.spots])
    return np.asarray(values[np.searchsorted(edges, middles, side="right") - 1])


def colour_bar(title: str, ends: tuple[str, str], top: float, *, signed: bool) -> Svg:
    """From the least to the greatest colour, what is written at its ends, and what they mean."""
    shades = colours(signed=signed)[:-1]
    wide = 20.0
    left = (WIDTH - wide * len(shades)) / 2
    cells = (
        element("rect", fill="#{:02x}{:02x}{:02x}".format(*colour), x=left + k * wide, y=top, width=wide, height=12)
        for k, colour in enumerate(shades)
    )
    numbers = (
        text(left - 6, top + 10, ends[0], "end"),
        text(left + wide * len(shades) + 6, top + 10, ends[1], "start"),
    )
    return concatenate(*cells, *numbers, text(WIDTH / 2, top + 27, title.replace("\n", " ")))
