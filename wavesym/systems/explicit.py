"""Any chain: parts from left to right, as one would draw them, and branches."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import ClassVar, Literal

from flint import fmpq
from pydantic import Field, model_validator

from wavesym.fields.loads import Load, LoadKinds
from wavesym.fields.table import SceneTable, Written, shown, wrong
from wavesym.model.network import Bar, Link, Network, Point
from wavesym.model.node import UnitLoad
from wavesym.numbers.doubles import rational
from wavesym.systems.node_loads import NodeLoad, SampledNodeLoad
from wavesym.systems.place import MisplacedError, Place, Position, position_of
from wavesym.systems.parts import Branch, LinkPart, MotionPart, Part, Parts, PointPart, RodPart


class ExplicitChain(SceneTable):
    """A chain that is written out, part by part."""

    load_kinds: ClassVar[LoadKinds] = (NodeLoad, SampledNodeLoad)
    no_loads: ClassVar[str] = ""

    type: Literal["chain"] = Field(description='"chain"')
    parts: Parts = Field(description="a list of parts")
    branch: tuple[Branch, ...] = ()

    @model_validator(mode="after")
    def _drawn(self) -> ExplicitChain:
        _ = self.drawing
        return self

    @cached_property
    def drawing(self) -> Drawing:
        """Its points, bars and links, and where they are."""
        pen = _Pen()
        pen.line("", self.parts, ("parts",))
        for number, branch in enumerate(self.branch):
            at = ("branch", number)
            if branch.from_ not in pen.names:
                raise wrong(f"{shown(branch.from_)} given, the name of a node before it expected", *at, "from")
            if branch.name in pen.lines or branch.name in pen.names:
                raise wrong(f"{shown(branch.name)} given, a name that is not taken expected", *at, "name")
            if branch.ratio == 0:
                raise wrong("0 given, a ratio other than 0 expected", *at, "ratio")
            pen.line(branch.name, branch.parts, (*at, "parts"), pen.names[branch.from_], branch.ratio)
        return pen.drawing()

    @property
    def choices(self) -> Mapping[str, str]:
        """What was chosen besides numbers, by key."""
        return {}

    @property
    def chain(self) -> None:
        """It is none of the paper's."""

    def located(self, position: Position, quantity: str) -> Place:
        """The place of an output. MisplacedError."""
        text = shown(Written(position.written))
        drawing = self.drawing
        if position.x is None and position.name in drawing.names:
            return self._at_node(drawing.names[position.name], position, quantity, text)
        line, station, rod = self._found(position, text)
        x = position.x
        assert x is not None  # a line has places
        if station is None:
            part = (x - drawing.lines[line][rod].x) / drawing.length(drawing.lines[line][rod].right)
            return Place(x, 0, line, drawing.number(line, rod) + 1, part)
        return self._at_station(line, station, position.side, quantity, text)

    def _found(self, position: Position, text: str) -> tuple[str, Station | None, int]:
        """The line, the station at a position, or the one before it with how many rods that is."""
        line, x = position.name, position.x
        if line not in self.drawing.lines or x is None:
            raise MisplacedError(f"{text} given, a place or the name of a node or branch expected")
        stations = self.drawing.lines[line]
        if not 0 <= x <= stations[-1].x:
            raise MisplacedError(f"{text} given, a place from 0 to {shown(stations[-1].x)} expected")
        place = next(k for k in reversed(range(len(stations))) if stations[k].x <= x)
        return line, stations[place] if stations[place].x == x else None, place

    def _at_node(self, point: int, position: Position, quantity: str, text: str) -> Place:
        for line, stations in self.drawing.lines.items():
            for station in stations:
                if point in station.points:
                    if quantity != "strain" and not self._beside(station, point):
                        return Place(station.x, 0, line, 0, Fraction(0), point)
                    return self._at_station(line, station, position.side, quantity, text, point)
        raise AssertionError(point)

    def _beside(self, station: Station, point: int) -> Place | None:
        """A place on a rod beside a point that moves as the point does."""
        for rod, side in ((station.left, 1), (station.right, 0)):
            if rod is not None:
                bar = self.drawing.bars[rod]
                if (bar.right if side else bar.left) == point and bar.ratios[side] == 1:
                    return Place(station.x, 0, "", rod + 1, Fraction(side))
        return None

    def _at_station(
        self, line: str, station: Station, side: int, quantity: str, text: str, point: int | None = None
    ) -> Place:
        rods = [(rod, -1 if end else 1, end) for rod, end in ((station.left, 1), (station.right, 0)) if rod is not None]
        apart = len(station.points) > 1 and point is None
        if quantity != "strain" and not apart:
            found = self._beside(station, station.points[0] if point is None else point)
            if found:
                return replace(found, line=line)
            if not rods:
                return Place(station.x, 0, line, 0, Fraction(0), station.points[0])
        divided = len(rods) > 1 and (apart or self._divided(station))
        if divided and not side:
            raise MisplacedError(f'{text} given, a side there expected: "{text}-" or "{text}+"')
        rod, which, end = next((r for r in rods if r[1] == side), rods[0])
        return Place(station.x, which if divided else 0, line, rod + 1, Fraction(end))

    def _divided(self, station: Station) -> bool:
        """Whether strains on both sides of a joint may differ."""
        assert station.left is not None and station.right is not None
        left, right = self.drawing.bars[station.left], self.drawing.bars[station.right]
        points = [self.drawing.points[point] for point in station.points]
        return (
            len(points) > 1
            or any(p != Point(fmpq(0), velocity=p.velocity) for p in points)
            or (left.impedance, left.speed) != (right.impedance, right.speed)
            or sum(1 for _ in self.drawing.ends(station.points[0])) > 2
            or any(station.points[0] in (link.left, link.right) for link in self.drawing.links)
            or station.points[0] in self._loaded
        )

    @cached_property
    def _loaded(self) -> set[int]:
        """Points that loads act on, as far as they are known (`made`)."""
        return set()

    def refused(self, load: Load) -> tuple[str, str] | None:
        """What is wrong with a load, and under which key; None where nothing is."""
        try:
            self._loaded.add(self._point(load))
        except MisplacedError as error:
            return str(error), "at"
        return None

    def _point(self, load: Load) -> int:
        """The point that a load acts on. MisplacedError."""
        text = load.at  # type: ignore[attr-defined]
        position = position_of(text)
        drawing = self.drawing
        if position.x is None and position.name in drawing.names:
            return drawing.names[position.name]
        line, station, _ = self._found(position, shown(text))
        if station is None:
            raise MisplacedError(f"{shown(text)} given, the name or place of a node expected")
        if len(station.points) > 1 and not position.side:
            raise MisplacedError(f'{shown(text)} given, a side there expected: "{text}-" or "{text}+"')
        return station.points[-1 if position.side > 0 else 0]

    def made(self, loads: Sequence[Load]) -> tuple[None, Network]:
        """No chain of the paper, and the network with the loads on its points."""
        units: dict[int, list[UnitLoad]] = {}
        for load in loads:
            point = self._point(load)
            for kind, coefficients in (("step", (fmpq(1),)), ("ramp", (fmpq(0), fmpq(1)))):
                unit = UnitLoad(f"{load.at}:{kind}", None, coefficients)  # type: ignore[attr-defined]
                if unit not in units.setdefault(point, []):
                    units[point].append(unit)
        return None, self.drawing.network(units)


@dataclass(frozen=True)
class Station:
    """A place of a line where parts meet: x from its start, the points there from left to right, the bars beside it."""

    x: Fraction
    points: tuple[int, ...]
    left: int | None
    right: int | None


@dataclass(frozen=True)
class Drawing:
    """The points, bars and links of a chain; `lines` are the stations of the main line ("") and of the branches."""

    points: tuple[Point, ...]
    bars: tuple[Bar, ...]
    links: tuple[Link, ...]
    lines: Mapping[str, tuple[Station, ...]]
    names: Mapping[str, int]

    def network(self, sources: Mapping[int, Sequence[UnitLoad]]) -> Network:
        """With unit loads on its points."""
        points = (
            Point(p.mass, p.damping, p.stiffness, p.velocity, p.motion, tuple(sources.get(k, ())), p.name)
            for k, p in enumerate(self.points)
        )
        return Network(tuple(points), self.bars, self.links)

    def length(self, bar: int | None) -> Fraction:
        """The length of a bar."""
        assert bar is not None
        length = self.bars[bar].length
        return Fraction(int(length.numer()), int(length.denom()))

    def number(self, line: str, station: int) -> int:
        """The bar that begins at a station of a line."""
        bar = self.lines[line][station].right
        assert bar is not None
        return bar

    def ends(self, point: int) -> Iterator[tuple[int, int]]:
        """The bars at a point, each with the side of it that is there."""
        for number, bar in enumerate(self.bars):
            if bar.left == point:
                yield number, 0
            if bar.right == point:
                yield number, 1


@dataclass
class _Pen:
    """Draws lines of parts one after another."""

    points: list[Point] = field(default_factory=list)
    bars: list[Bar] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    names: dict[str, int] = field(default_factory=dict)
    lines: dict[str, tuple[Station, ...]] = field(default_factory=dict)

    def drawing(self) -> Drawing:
        for k, point in enumerate(self.points):
            self._bearable(k, point)
        return Drawing(tuple(self.points), tuple(self.bars), tuple(self.links), self.lines, self.names)

    def line(
        self,
        name: str,
        parts: Sequence[Part | str],
        at: Keys,
        begin: int | None = None,
        ratio: Fraction = Fraction(1),
    ) -> None:
        """Parts from left to right; a branch begins at a point that is there already."""
        nodes, between = _alternating(parts, at)
        if begin is not None and nodes[0] is not None:
            raise wrong("a node given first, what holds the branch to its node expected", *at, nodes[0][0])
        numbers = [self._drawn(nodes, between, k, at) if k or begin is None else begin for k in range(len(nodes))]
        stations = [Station(Fraction(0), (numbers[0],), None, None)]
        for k, (part, left, right) in enumerate(zip(between, numbers, numbers[1:], strict=False)):
            last = stations[-1]
            if isinstance(part, RodPart):
                bar = self._bar(part, left, right, ratio if begin is not None and k == 0 else Fraction(1))
                stations[-1] = replace(last, right=bar)
                stations.append(Station(last.x + part.rod, (right,), bar, None))
            else:
                self.links.append(Link(left, right, rational(part.spring), rational(part.dashpot)))
                stations[-1] = replace(last, points=(*last.points, right))
        self.lines[name] = tuple(stations)

    def _drawn(self, nodes: Sequence[Placed | None], between: Sequence[RodPart | LinkPart], k: int, at: Keys) -> int:
        """A new point for a node."""
        self.points.append(Point(fmpq(0)))
        number = len(self.points) - 1
        if (placed := nodes[k]) is not None:
            beside = [between[n] for n in (k - 1, k) if 0 <= n < len(between)]
            self._become(number, placed[1], [part for part in beside if isinstance(part, RodPart)], (*at, placed[0]))
        return number

    def _bar(self, part: RodPart, left: int, right: int, ratio: Fraction) -> int:
        self.bars.append(
            Bar(
                left,
                right,
                rational(part.rod),
                rational(part.speed),
                rational(part.impedance),
                (rational(ratio), fmpq(1)),
                rational(part.velocity),
                rational(part.strain),
                part.name or "",
            )
        )
        if part.spring or part.dashpot:
            self.links.append(Link(left, right, rational(part.spring), rational(part.dashpot)))
        return len(self.bars) - 1

    def _become(self, point: int, part: Part | str, rods: Sequence[RodPart], at: Keys) -> None:
        """Give a point what a part says of it; `rods` are those beside it."""
        if isinstance(part, PointPart):
            velocities = {rod.velocity for rod in rods}
            if part.velocity is None and len(velocities) > 1 and part.inertia:
                raise wrong("missing, the velocity of a mass between rods of two velocities expected", *at, "velocity")
            velocity = part.velocity if part.velocity is not None else min(velocities, default=Fraction(0))
            mass, damping, spring = map(rational, (part.inertia, part.dashpot, part.spring))
            self.points[point] = Point(mass, damping, spring, rational(velocity), name=part.name or "")
        elif isinstance(part, MotionPart):
            start = rational(part.velocity)
            self.points[point] = Point(fmpq(0), velocity=start, motion=part.motion, name=part.name or "")
        elif part == "fixed":
            self.points[point] = Point(fmpq(0), motion="velocity")
        elif part == "absorbing":
            if not rods:
                raise wrong('"absorbing" given, a rod beside it expected', *at)
            self.points[point] = Point(fmpq(0), damping=rational(rods[0].impedance))
        name = part.name if isinstance(part, PointPart | MotionPart) else None
        if name:
            if name in self.names or name in self.lines:
                raise wrong(f"{shown(name)} given, a name that is not taken expected", *at, "name")
            self.names[name] = point

    def _bearable(self, number: int, point: Point) -> None:
        ends = any(number in (bar.left, bar.right) for bar in self.bars)
        damped = point.damping != 0 or any(link.damping != 0 and number in (link.left, link.right) for link in self.links)
        if point.mass == 0 and point.motion is None and not ends and not damped:
            raise wrong("a joint without mass, rod or dashpot given, one of these at it expected", "parts")



Keys = tuple[str | int, ...]
Placed = tuple[int, Part | str]
"""A node of a line, and which of the parts it is."""


def _alternating(
    parts: Sequence[Part | str], at: Keys
) -> tuple[list[Placed | None], list[RodPart | LinkPart]]:
    """A line as nodes and what is between them; None for a node that is not written: a joint, or a free end."""
    nodes: list[Placed | None] = [None]
    between: list[RodPart | LinkPart] = []
    for k, part in enumerate(parts):
        if part == "contact":
            raise wrong('"contact" given, a chain without contacts expected (collisions have them)', *at, k)
        if isinstance(part, RodPart | LinkPart):
            between.append(part)
            nodes.append(None)
            continue
        if nodes[-1] is not None:
            raise wrong("a node given beside another, a rod, a spring or a dashpot between them expected", *at, k)
        if 0 < k < len(parts) - 1 and (part in ("free", "fixed", "absorbing") or isinstance(part, MotionPart)):
            raise wrong("an end given between other parts, a mass or a joint expected", *at, k)
        nodes[-1] = k, part
    if not any(isinstance(part, RodPart) for part in between):
        raise wrong("no rod given, at least 1 expected", *at)
    for k, part in enumerate(between):
        if isinstance(part, LinkPart) and (k == 0 and nodes[0] is None and at[0] == "parts" or k == len(between) - 1 and nodes[-1] is None):
            raise wrong("a spring or dashpot given at an end, something for it to hold expected", *at)
    return nodes, between
