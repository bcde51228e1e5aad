"""Where outputs and loads are on a chain that is drawn."""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction

from flint import fmpq

from wavesym.errors import did_you_mean
from wavesym.fields.table import WrittenDecimal, show
from wavesym.mechanics.network import Point
from wavesym.systems.drawing import Drawing
from wavesym.systems.place import MisplacedError, Place, Position, position_of
from wavesym.systems.station import Station


def node(drawing: Drawing, at: str) -> int:
    """The point that a load acts on. MisplacedError."""
    position = position_of(at)
    text = show(position.text)
    if position.x is None and position.name in drawing.names:
        return drawing.names[position.name]
    _, station, _ = _locate(drawing, position, text)
    if station is None:
        raise MisplacedError(f"{text} is not a node; write the name or place of one")
    if len(station.points) > 1 and not position.side:
        raise MisplacedError(f'{text} has two sides; write "{position.text}-" or "{position.text}+"')
    return station.points[-1 if position.side > 0 else 0]


def place(drawing: Drawing, position: Position, quantity: str, loaded: Collection[int]) -> Place:
    """The place of an output; `loaded` are the points that loads act on. MisplacedError."""
    text = show(WrittenDecimal(position.text))
    if position.x is None and position.name in drawing.names:
        return _at_node(drawing, drawing.names[position.name], position.side, quantity, text, loaded)
    line, station, before = _locate(drawing, position, text)
    x = position.x
    assert x is not None  # a line has places
    if station is not None:
        return _at_station(drawing, line, station, position.side, quantity, text, loaded)
    rod = drawing.lines[line][before].right
    assert rod is not None  # what is no station is on a rod
    return Place(x, 0, line, rod + 1, (x - drawing.lines[line][before].x) / drawing.length(rod))


def _locate(drawing: Drawing, position: Position, text: str) -> tuple[str, Station | None, int]:
    """The line of a position, its station if it is at one, and the number of the last station up to it."""
    line, x = position.name, position.x
    if line not in drawing.lines or x is None:
        meant = did_you_mean(line, [*drawing.names, *filter(None, drawing.lines)])
        what = "write one, or the name of a node or branch (rods have no place)"
        raise MisplacedError(f"{text} is not a place; {what}{meant and f'. {meant}'}")
    stations = drawing.lines[line]
    if not 0 <= x <= stations[-1].x:
        raise MisplacedError(f"{text} is not on the chain; write a place from 0 to {show(stations[-1].x)}")
    before = next(k for k in reversed(range(len(stations))) if stations[k].x <= x)
    return line, stations[before] if stations[before].x == x else None, before


def _at_node(drawing: Drawing, point: int, side: int, quantity: str, text: str, loaded: Collection[int]) -> Place:
    for line, stations in drawing.lines.items():
        for station in stations:
            if point in station.points:
                if quantity in ("strain", "force"):
                    return _at_station(drawing, line, station, side, quantity, text, loaded)
                return _moving(drawing, line, station, point)
    raise AssertionError(point)


def _moving(drawing: Drawing, line: str, station: Station, point: int) -> Place:
    """The end of a rod that moves as a point does, or the point itself."""
    for rod, end in drawing.ends(point):
        if drawing.bars[rod].ratios[end] == 1:
            return Place(station.x, 0, line, rod + 1, Fraction(end))
    return Place(station.x, 0, line, 0, Fraction(0), point)


def _at_station(
    drawing: Drawing, line: str, station: Station, side: int, quantity: str, text: str, loaded: Collection[int]
) -> Place:
    apart = len(station.points) > 1
    if quantity not in ("strain", "force"):
        if apart and not side:
            raise _one_sided(text)
        if apart or line == "" or station.x != 0:
            return _moving(drawing, line, station, station.points[-1 if side > 0 else 0])
    rods = [(rod, way, end) for rod, way, end in ((station.left, -1, 1), (station.right, 1, 0)) if rod is not None]
    if not rods:
        raise MisplacedError(f"{text} is not at a rod; write a place that is")
    divided = len(rods) > 1 and (_has_two_strains if quantity == "strain" else _has_forces)(drawing, station, loaded)
    if divided and not side:
        raise _one_sided(text)
    rod, way, end = next((each for each in rods if each[1] == side), rods[0])
    return Place(station.x, way if divided else 0, line, rod + 1, Fraction(end))


def _one_sided(text: str) -> MisplacedError:
    return MisplacedError(f'{text} has two sides; write "{text}-" or "{text}+"')


def _has_two_strains(drawing: Drawing, station: Station, loaded: Collection[int]) -> bool:
    """Whether the strains on both sides of a joint may differ; of what parts two points, a contact takes no force."""
    assert station.left is not None
    assert station.right is not None
    left, right = drawing.bars[station.left], drawing.bars[station.right]
    links = [link for link in drawing.links if {link.left, link.right} & {*station.points}]
    return (
        _has_forces(drawing, station, loaded)
        or (left.impedance, left.speed) != (right.impedance, right.speed)
        or not all(link.contact for link in links)
    )


def _has_forces(drawing: Drawing, station: Station, loaded: Collection[int]) -> bool:
    """Whether the forces on both sides of a joint may differ: a link between them passes all that it takes."""
    links = [link for link in drawing.links if {link.left, link.right} & {*station.points}]
    return (
        any(not _bare(drawing.points[point]) or point in loaded for point in station.points)
        or sum(1 for point in station.points for _ in drawing.ends(point)) > 2
        or len(links) != len(station.points) - 1
    )


def _bare(point: Point) -> bool:
    return point == Point(fmpq(0), velocity=point.velocity, name=point.name)
