"""What stands between the rods of a place x time picture: masses, ends, springs, and contacts while they are open.

All of it has a width in points. At an end of the chain it stands outside of the rod, but for a contact with the rod,
which lies over it as everything does elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from matplotlib.axes import Axes
from matplotlib.transforms import ScaledTranslation

from wavesym.mechanics.network import Link, Network, Point
from wavesym.pictures.naming import in_words
from wavesym.pictures.stations import Loose, ground_links, standing
from wavesym.pictures.style import FONT, SLIPS
from wavesym.systems.station import Lines, Station

_MASS, _LINK, _CONTACT, _THIN = 4.0, 2.5, 5.0, 0.6  # points
_MOVED, _HELD = "0.55", "gold"
_LETTER, _ROW = 0.62, 15  # of the font's size; points
_ROD_NAME, _ROD_ROWS = "0.4", 2


def legend(network: Network, lines: Lines) -> str:
    """What the lines between rods are, as far as they occur."""
    items = [item.what for stations in lines.values() for station in stations for item in _items(network, station)]
    points = [item for item in items if isinstance(item, Point)]
    links = [item for item in items if isinstance(item, Link)]
    texts = {
        "thick black: a mass": any(point.mass for point in points),
        "thick grey: fixed, or of given motion": any(point.motion for point in points),
        "yellow: a spring or dashpot": any(link.stiffness or link.damping for link in links),
        "white between two lines: an open contact": any(link.contact for link in links),
        "white in yellow: a spring that does not act": any(link.side for link in links),
        "purple: what slides or yields": any(link.friction or link.limits for link in links),
    }
    return "; ".join(words for words, occurs in texts.items() if occurs)


def draw_nodes(axes: Axes, network: Network, stations: Sequence[Station], loose: Loose, until: float) -> None:
    """The stations of a line."""
    for station in stations:
        items = list(_items(network, station))
        width = sum(item.width for item in items)
        at = -width / 2
        if station.left is None:
            at = -_outside_width(items)
            axes.spines["left"].set_position(("outward", -at))
        elif station.right is None:
            at = _outside_width(items[::-1]) - width
        for item in items:
            _draw_item(_Pen(axes, float(station.x), at + item.width / 2), item, loose, until)
            at += item.width
    axes.spines[["left", "right"]].set_visible(False)


@dataclass(frozen=True)
class _Item:
    """A point or link of a station, with its width."""

    what: Point | Link
    width: float


def _items(network: Network, station: Station) -> Iterator[_Item]:
    """From left to right; what has no mass and stands beside a link has no line of its own."""
    for what in standing(network, station):
        if isinstance(what, Link):
            yield _Item(what, _CONTACT if what.contact else _LINK)
        else:
            yield _Item(what, _MASS if what.mass or what.motion else _THIN)
    for number in station.points:
        yield from (_Item(link, _LINK) for link in ground_links(network, number))


def _outside_width(items: Sequence[_Item]) -> float:
    """The width of what does not lie over the rod, the last of them beside it."""
    beside = items[-1]
    touching = isinstance(beside.what, Link) and beside.what.contact
    return sum(item.width for item in items[: -1 if touching else None])


@dataclass(frozen=True)
class _Pen:
    """Draws upright lines at a place, so many points beside it."""

    axes: Axes
    x: float
    beside_width: float

    def line(self, low: float, high: float, width: float, colour: str = "black", farther: float = 0.0) -> None:
        """`farther` is how many points more."""
        beside = ScaledTranslation((self.beside_width + farther) / 72, 0, self.axes.figure.dpi_scale_trans)
        self.axes.plot(
            [self.x, self.x],
            [low, high],
            color=colour,
            linewidth=width,
            solid_capstyle="butt",
            clip_on=False,
            transform=self.axes.transData + beside,
        )


def _draw_item(pen: _Pen, item: _Item, loose: Loose, until: float) -> None:
    if isinstance(item.what, Point):
        pen.line(0, until, item.width, _MOVED if item.what.motion else "black")
        return
    link = item.what
    if not link.friction:  # what sticks is a point
        pen.line(0, until, *((_THIN,) if link.contact else (item.width, _HELD)))
    for low, high in loose.get(link, ()):
        if link.friction or link.limits:
            pen.line(low, high, item.width, SLIPS)
            continue
        pen.line(low, high, item.width, "white")
        for side in (-1, 1):
            pen.line(low, high, _THIN, "black" if link.contact else _HELD, side * item.width / 2)


def write_names(axes: Axes, network: Network, stations: Sequence[Station]) -> None:
    """The names of nodes and rods, those of rods in grey, above their places: in a picture they would lie on waves."""
    points = axes.get_window_extent().width / axes.figure.dpi * 72
    for name, is_rod, x, row, align in _placed_names(network, stations, points):
        colour = _ROD_NAME if is_rod else "black"
        above = (0, 3 + _ROW * row)
        axes.annotate(name, (x, 1), above, "axes fraction", "offset points", ha=align, color=colour)


def name_rows(network: Network, stations: Sequence[Station], inches: float) -> int:
    """How many rows the names of a line take above an axis of such a width."""
    return max((row + 1 for *_, row, _ in _placed_names(network, stations, 72 * inches)), default=0)


def _placed_names(
    network: Network, stations: Sequence[Station], points: float
) -> Iterator[tuple[str, bool, float, int, str]]:
    """Each name, whether it is a rod's, its part of an axis of so many points, its row, and how it is aligned.

    It has the lowest row where it does not lie over another. A rod goes without, where that is not one of the first.
    """
    ends: list[float] = []  # of each row, so far to the right
    for name, is_rod, x in _names(network, stations):
        width, part = _LETTER * FONT * len(name), x / float(stations[-1].x)
        begin = points * part - width / 2
        align = "left" if begin < 0 else "right" if begin + width > points else "center"
        begin, part = {"left": (0.0, 0.0), "right": (points - width, 1.0), "center": (begin, part)}[align]
        row = next((k for k, end in enumerate(ends) if end < begin), len(ends))
        if row < _ROD_ROWS or not is_rod:
            ends[row : row + 1] = [begin + width]
            yield name, is_rod, part, row, align


def _names(network: Network, stations: Sequence[Station]) -> Iterator[tuple[str, bool, float]]:
    """From left to right: names, whether they are a rod's, and their places."""
    for station, following in pairwise([*stations, None]):
        assert station is not None
        if points := ", ".join(filter(None, (network.points[point].name for point in station.points))):
            yield points, False, float(station.x)
        if following is not None:
            assert station.right is not None  # between two stations there is a bar
            if rod := in_words(network.bars[station.right].name):
                yield rod, True, float(station.x + following.x) / 2
