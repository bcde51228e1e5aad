"""The structure of a scene, drawn: a building upright, any other chain from left to right with its branches below.

Signs have their own size; rods share what is left as their lengths ask for it, and are as thick as their impedance.
"""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass, field

from flint import fmpq

from wavesym.mechanics.length import LengthUnit, place_text
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Bar, Link, Network, Point
from wavesym.numbers.doubles import nearest
from wavesym.pictures.loads import load_histories
from wavesym.pictures.naming import in_words
from wavesym.pictures.page import symbols
from wavesym.pictures.page.svg import Svg, box, concatenate, element, line, polyline, text
from wavesym.pictures.stations import ground_links, standing
from wavesym.rendering import text_of
from wavesym.systems.station import Lines, Station

WIDTH = 900.0
_LEFT, _RIGHT, _ROW = 60.0, 60.0, 150.0
_MASS, _LINK, _CONTACT, _END, _BARE = 18.0, 44.0, 10.0, 6.0, 2.0
_THICK, _THIN = 24.0, 6.0  # of a rod
_ASIDE = 30.0  # from its node a branch hangs
_LETTER = 7.4  # of a name, wide
_NAMES = 3  # rows of names over one another
_STOREY, _TALLEST, _FLOOR = 46.0, 520.0, 190.0


@dataclass(frozen=True)
class Picture:
    """Markup, how high it is, what it says for those who do not see it, and whether it stands upright in the middle."""

    markup: Svg
    height: float
    description: str
    is_upright: bool = False


def structure(model: Model, lines: Lines) -> Picture:
    """The structure with its supports, loads, names, and the places of its outputs."""
    if model.labels.system["type"] == "building":
        return _building(model)
    shown = {name: stations for name, stations in lines.items() if stations[-1].x or not name}  # branches hang from ""
    return _Pen(model.network, shown, model.length).chain(model)


def structure_html(title: str, model: Model, lines: Lines) -> str:
    """The structure under a title, as markup that stands by itself."""
    found = structure(model, lines)
    alone = element(
        "svg",
        element("style", Svg(text_of("html/report.css"))),
        found.markup,
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {WIDTH:g} {found.height:g}",
    )
    source = f"data:image/svg+xml;base64,{b64encode(alone.encode()).decode()}"
    return concatenate(element("p", title), element("img", src=source, alt=found.description, style="max-width: 100%"))


def _building(model: Model) -> Picture:
    network, m = model.network, len(model.network.bars)
    storey = min(_STOREY, _TALLEST / m)
    base, middle = 40 + m * storey, WIDTH / 2
    half, thick = _FLOOR / 2, min(10.0, storey / 3)
    parts = []
    for k in range(m):
        y = base - k * storey
        parts += [
            line(middle + side * (half - 14), y, middle + side * (half - 14), y - storey, "column") for side in (-1, 1)
        ]
    for k in range(1, m + 1):
        parts.append(box(middle - half, base - k * storey - thick / 2, _FLOOR, thick, "mass"))
    step = -(-m // max(1, int(m * storey / 18)))
    for k in range(0, m + 1, step):
        parts.append(text(middle + half + 24, base - k * storey + 4, f"x = {k}{_floor_note(k, m)}", "start"))
    if network.points[0].motion:
        hatches = (line(middle + k, base, middle + k - 8, base + 8, "thin") for k in range(-110, 120, 10))
        parts += [line(middle - 115, base, middle + 115, base, "face"), *hatches]
    else:
        parts.append(box(middle - half - 15, base - 7, _FLOOR + 30, 14, "mass"))
    acting = bool(load_histories(model))
    if acting:
        parts.append(symbols.motion_arrow(middle, base + 26, "acceleration of the base"))
    parts += [
        polyline([(middle - half - 26, y - 4), (middle - half - 18, y), (middle - half - 26, y + 4)], "place")
        for y in sorted({base - nearest(probe.rod - 1 + probe.place) * storey for probe in model.probes})
    ]
    kind = "moves with the ground" if network.points[0].motion else "is pushed by the force of the paper's (4.5)"
    description = f"A building of {m} storeys, elastic columns between rigid floors; its foundation {kind}."
    return Picture(concatenate(*parts), base + (60 if acting else 30), description, is_upright=True)


def _floor_note(k: int, m: int) -> str:
    return {0: ", foundation", m: ", roof"}.get(k, "")


def _parallel(link: Link, bar: Bar) -> bool:
    """Whether a spring or a dashpot stands beside a rod, between its two ends."""
    return {link.left, link.right} == {bar.left, bar.right} and not link.contact


@dataclass
class _Pen:
    """Draws the lines of a chain, and knows where things are for what comes after."""

    network: Network
    lines: Lines
    length: LengthUnit | None
    positions: dict[int, tuple[float, float]] = field(default_factory=dict)  # points
    rods: dict[int, tuple[float, float, float]] = field(default_factory=dict)  # bars: from, to, and their height
    parts: list[Svg] = field(default_factory=list)

    def chain(self, model: Model) -> Picture:
        scale = self._scale()
        y = 70.0 + self.name_height
        for name, stations in self.lines.items():
            self._line(name, stations, y, scale)
            y += _ROW
        self._ends()
        self._loads(model)
        self._places(model)
        bodies = len([point for point in self.network.points if point.mass])
        more = [
            f"{len(self.lines) - 1} branches" * (len(self.lines) > 1),
            f"{len(self.network.corners)} contacts" * bool(self.network.corners),
            "springs or dashpots" * any(not link.contact for link in self.network.links),
        ]
        description = f"A chain of {len(self.network.bars)} rods and {bodies} rigid bodies"
        return Picture(
            concatenate(*self.parts), y - _ROW + 90, f"{', with '.join([description, *filter(None, more)])}."
        )

    @property
    def name_height(self) -> float:
        """How much higher names stand where something is parallel to a rod."""
        return 26.0 * any(_parallel(link, bar) for link in self.network.links for bar in self.network.bars)

    def _widths(self, station: Station) -> list[tuple[Point | Link, float]]:
        """What stands there and is not drawn yet, from left to right."""
        drawn = [self.network.points[point] for point in station.points if point in self.positions]
        found = standing(self.network, station)
        return [(what, self._width(what)) for what in found if not any(what is point for point in drawn)]

    def _width(self, what: Point | Link) -> float:
        if isinstance(what, Link):
            return _CONTACT if what.contact else _LINK
        return _MASS if what.mass else _END if what.motion else _BARE

    def _scale(self) -> tuple[float, float]:
        """How much smaller signs are than they should be, and the pixels of a unit of length."""
        room, shrink, unit = WIDTH - _LEFT - _RIGHT, 1.0, 1e9
        for stations in self.lines.values():
            signs = sum(width for station in stations for _, width in self._widths(station))
            shrink = min(shrink, 0.6 * room / signs if signs else 1.0)
        for stations in self.lines.values():
            signs = sum(width for station in stations for _, width in self._widths(station)) * shrink
            unit = min(unit, (room - signs) / float(stations[-1].x)) if stations[-1].x else unit
        return shrink, unit

    def _line(self, name: str, stations: tuple[Station, ...], y: float, scale: tuple[float, float]) -> None:
        shrink, unit = scale
        x = self._begin(stations, y, scale) if name else _LEFT
        numbers: list[float] = []
        names: list[float] = []
        if name:
            self.parts.append(text(8, y + 4, name, "start", class_="name"))
        for station, following in zip(stations, [*stations[1:], None], strict=True):
            start = x
            new = [point for point in station.points if point not in self.positions]
            for what, width in self._widths(station):
                self._sign(what, x, y, width * shrink)
                for point in new:
                    if what is self.network.points[point]:
                        self.positions[point] = x + width * shrink / 2, y
                        self._write_above(x + width * shrink / 2, y - 36 - self.name_height, in_words(what.name), names)
                x += width * shrink
            self.positions.update({point: ((start + x) / 2, y) for point in new if point not in self.positions})
            held = any(any(self._supports(point)) for point in new)
            self._write_below((start + x) / 2, y + 52, place_text(station.x, unit=self.length), numbers, beside=held)
            if following is not None and station.right is not None:
                length = unit * float(following.x - station.x)
                self._rod(station.right, x, length, y)
                x += length

    def _begin(self, stations: tuple[Station, ...], y: float, scale: tuple[float, float]) -> float:
        """Where a branch begins: below its node, if there is room; and what it hangs from."""
        shrink, unit = scale
        signs = sum(width for station in stations for _, width in self._widths(station)) * shrink
        above, high = self.positions[stations[0].points[0]]
        x = max(_LEFT, min(above, WIDTH - _RIGHT - signs - unit * float(stations[-1].x)))
        x = max(x, above + _ASIDE) if x == above else x  # beside what may lead to the ground there
        ratio = next((self.network.bars[each.right].ratios[0] for each in stations if each.right is not None), fmpq(1))
        if ratio != 1:  # the wheel that meshes with the node's; the node has its inertia
            self.parts += [box(x - 4, y - 18, 8, 36, "mass"), text(x - 9, y - 8, f"\u00d7 {nearest(ratio):.4g}", "end")]
            y -= 18
        turns = [(above + 5, high + 16), (above + 5, high + 24), (above + _ASIDE, high + 24), (above + _ASIDE, y - 46)]
        self.parts.append(polyline([*turns, (x, y - 46), (x, y)], "hang"))
        return x

    def _rod(self, number: int, x: float, length: float, y: float) -> None:
        bar, thickest = self.network.bars[number], max(nearest(bar.impedance) for bar in self.network.bars)
        thick = max(_THIN, _THICK * (nearest(bar.impedance) / thickest) ** 0.5)
        self.rods[number] = x, x + length, y
        self.parts.append(box(x, y - thick / 2, length, thick, "rod"))
        self._draw_parallel(bar, x, length, y)

    def _sign(self, what: Point | Link, x: float, y: float, width: float) -> None:
        if isinstance(what, Link):
            sign = (
                symbols.contact(x, y, width)
                if what.contact
                else symbols.link(x, y, width, elastic=bool(what.stiffness), damped=bool(what.damping))
            )
            self.parts.append(sign)
        elif what.mass:
            heaviest = max(nearest(point.mass) for point in self.network.points)
            self.parts.append(symbols.mass(x, y, width, 16 + 14 * (nearest(what.mass) / heaviest) ** 0.5))
        elif not what.motion:
            self.parts.append(line(x + width / 2, y - 14, x + width / 2, y + 14, "thin"))

    def _draw_parallel(self, bar: Bar, x: float, length: float, y: float) -> None:
        """What is parallel to a rod, its name, and how it moves at first."""
        for each in self.network.links:
            if _parallel(each, bar):
                sign = symbols.link(x, y - 38, length, elastic=bool(each.stiffness), damped=bool(each.damping))
                legs = (line(at, y - 38, at, y - symbols.HALF, "wire") for at in (x, x + length))
                self.parts += [sign, *legs]
        moving = f"v = {bar.velocity}"
        if bar.velocity and length > _LETTER * len(moving):
            self.parts.append(text(x + length / 2, y + 4, moving, class_="act"))
        if bar.name and length > _LETTER * len(bar.name):
            self.parts.append(text(x + length / 2, y - 18, in_words(bar.name), class_="name"))

    def _ends(self) -> None:
        """What holds points to the ground, or moves them."""
        first, last = self.lines[""][0].points[0], {stations[-1].points[-1] for stations in self.lines.values()}
        for number, (x, y) in self.positions.items():
            point = self.network.points[number]
            side = -1 if number == first else 1
            edge = x + side * (_END / 2 if point.motion else _MASS / 2)
            if point.motion and (number == first or number in last):
                self.parts.append(
                    symbols.wall(x, y, side) if point.motion == "fixed" else line(x, y - 20, x, y + 20, "face")
                )
            if point.motion and point.motion != "fixed":
                self.parts.append(symbols.motion_arrow(edge, y - 26, ""))
            if any(held := self._supports(number)):
                elastic, damped, rubs = held
                below = y + 62
                self.parts.append(line(x, y + 6, x, below, "thin"))
                if elastic or damped:
                    self.parts.append(symbols.ground_link(x, below, elastic=elastic, damped=damped))
                if rubs:
                    self.parts.append(symbols.sole(x, below))

    def _supports(self, number: int) -> tuple[bool, bool, bool]:
        """Whether a spring, a dashpot, friction hold a point to the ground."""
        point, links = self.network.points[number], ground_links(self.network, number)
        elastic = bool(point.stiffness) or any(link.stiffness for link in links)
        damped = bool(point.damping) or any(link.damping for link in links)
        return elastic, damped, any(link.friction for link in links)

    def _loads(self, model: Model) -> None:
        acting = {load.source for load in model.loads}
        for number, (x, y) in self.positions.items():
            if not self.network.points[number].motion and acting & {
                u.source for u in self.network.points[number].loads
            }:
                self.parts.append(symbols.load_arrow(x - _MASS / 2 - 1, y - 24))
                self.parts.append(line(x - _MASS / 2, y - 30, x - _MASS / 2, y - 16, "act"))

    def _places(self, model: Model) -> None:
        """Where outputs are."""
        spots = set()
        for probe in model.probes:
            if probe.point is not None:
                spots.add(self.positions[probe.point])
            else:
                low, high, y = self.rods[probe.rod - 1]
                spots.add((low + nearest(probe.place) * (high - low), y))
        self.parts += [polyline([(x - 4, y + 38), (x, y + 30), (x + 4, y + 38)], "place") for x, y in sorted(spots)]

    def _write_below(self, x: float, y: float, words: str, taken: list[float], *, beside: bool) -> None:
        """A number, beside what leads to the ground, unless it would lie over the one before."""
        half = _LETTER * len(words) / 2
        x -= (half + 6) * beside
        if not taken or taken[-1] + 6 < x - half:
            taken.append(x + half)
            self.parts.append(text(x, y, words))

    def _write_above(self, x: float, y: float, words: str, rows: list[float]) -> None:
        """A name, in the lowest row where it does not lie over another; none where all rows are taken."""
        half = _LETTER * len(words) / 2
        row = next((k for k, end in enumerate(rows) if end + 4 < x - half), len(rows))
        if words and row < _NAMES:
            rows[row : row + 1] = [x + half]
            self.parts.append(text(x, y - 14 * row, words, class_="name"))
