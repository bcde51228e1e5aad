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
from wavesym.pictures.style import FONT, HALO, SLIPS
from wavesym.systems.station import Lines, Station

_MASS, _LINK, _CONTACT, _THIN = 4.0, 2.5, 5.0, 0.6  # points
_MOVED, _HELD = "0.55", "gold"
_LETTER, _ROW = 0.62, 15  # of the font's size; points


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
    """The stations of a line, and the names of their points above them."""
    rows: list[float] = []
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
        if names := _names(network, station):
            _write(axes, float(station.x), names, rows)
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


def _write(axes: Axes, x: float, name: str, rows: list[float]) -> None:
    """A name above its place, in the lowest row where it does not lie over another; `rows` end so far to the right."""
    left, right = axes.get_xlim()
    points = axes.get_window_extent().width / axes.figure.dpi * 72
    row, align = _place_name((x - left) / (right - left), name, points, rows)
    axes.annotate(name, (x, 1), (0, 3 + _ROW * row), ("data", "axes fraction"), "offset points", ha=align)


def _place_name(part: float, name: str, points: float, rows: list[float]) -> tuple[int, str]:
    """The row of a name at a part of an axis that is so many points wide, and how it is aligned there."""
    middle, width = points * part, _LETTER * FONT * len(name)
    align = {0.0: "left", 1.0: "right"}.get(part, "center")
    begin = {"left": middle, "right": middle - width, "center": middle - width / 2}[align]
    row = next((k for k, end in enumerate(rows) if end < begin), len(rows))
    rows[row : row + 1] = [begin + width]
    return row, align


def name_rods(axes: Axes, network: Network, stations: Sequence[Station]) -> None:
    """The names of rods at the top of them, upright in narrow ones; none where there is no room for that."""
    left, right = axes.get_xlim()
    points = axes.get_window_extent().width / axes.figure.dpi * 72
    for station, following in pairwise(stations):
        assert station.right is not None  # between two stations there is a bar
        name = in_words(network.bars[station.right].name)
        middle = float(station.x + following.x) / 2
        room = points * float(following.x - station.x) / (right - left)
        upright = _LETTER * FONT * len(name) > room
        if name and room > FONT:
            axes.annotate(
                name,
                (middle, 1),
                (0, -4),
                ("data", "axes fraction"),
                "offset points",
                ha="center",
                va="top",
                rotation=90 if upright else 0,
                path_effects=HALO,
            )


def name_rows(network: Network, stations: Sequence[Station], inches: float) -> int:
    """How many rows the names of a line take above an axis of such a width."""
    rows: list[float] = []
    for station in stations:
        if names := _names(network, station):
            _place_name(float(station.x / stations[-1].x), names, 72 * inches, rows)
    return len(rows)


def _names(network: Network, station: Station) -> str:
    return ", ".join(filter(None, (network.points[point].name for point in station.points)))
