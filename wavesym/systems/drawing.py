"""Parts drawn one after another: the points, bars and links of a chain, and where on its lines they are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from flint import fmpq

from wavesym.fields.table import refusal, show
from wavesym.mechanics.length import LengthUnit, place_text
from wavesym.mechanics.network import Bar, Link, Network, Point
from wavesym.mechanics.node import UnitLoad
from wavesym.numbers.doubles import rational
from wavesym.systems.contacts import name_contacts, refuse_impacts, refuse_joined_corners
from wavesym.systems.lines import EMPTY, Keys, PlacedBetween, PlacedNode, alternating
from wavesym.systems.parts import (
    BETWEEN,
    Branch,
    ChainPart,
    ContactPart,
    LinkPart,
    MotionPart,
    PointPart,
    RodPart,
    SpringLaw,
)
from wavesym.systems.station import MAIN, Lines, Station


def draw_parts(parts: Sequence[ChainPart | str], branches: Sequence[Branch]) -> Drawing:
    """A chain and its branches. Raises the error of `table.refusal`."""
    pen = _Pen()
    pen.line(MAIN, parts, ("parts",))
    for number, branch in enumerate(branches):
        at = ("branch", number)
        if branch.from_ not in pen.names:
            raise refusal(f"{show(branch.from_)} is not a node before it; write the name of one", *at, "from")
        if branch.name in pen.lines or branch.name in pen.names:
            raise refusal(f"{show(branch.name)} is taken; write another name", *at, "name")
        if branch.ratio == 0:
            raise refusal("0 is no ratio; write another number", *at, "ratio")
        pen.agree(pen.names[branch.from_], branch)
        pen.line(branch.name, branch.parts, (*at, "parts"), pen.names[branch.from_], branch.ratio)
    return pen.drawing()


@dataclass(frozen=True)
class Drawing:
    """The points, bars and links of a chain; `lines` are the stations of the main line ("") and of the branches, and
    `contacts` says of the links that are some on which line they are, and where."""

    points: tuple[Point, ...]
    bars: tuple[Bar, ...]
    links: tuple[Link, ...]
    lines: Lines
    names: Mapping[str, int]
    contacts: Mapping[int, tuple[str, Fraction]]

    def network(self, sources: Mapping[int, Sequence[UnitLoad]], length: LengthUnit | None = None) -> Network:
        """With unit loads on its points; its places are in a unit of length."""
        places = self._places(length)
        points = (
            replace(point, loads=tuple(sources.get(k, ())), place=places.get(k, "ground"))
            for k, point in enumerate(self.points)
        )
        called = {k: place_text(x, line, "", length) for k, (line, x) in self.contacts.items()}
        links = (replace(link, place=called.get(k, "")) for k, link in enumerate(self.links))
        return Network(tuple(points), self.bars, tuple(name_contacts([*links])))

    def _places(self, length: LengthUnit | None) -> Mapping[int, str]:
        """Where each point is: its line and how far along it, with a side where more than one is there."""
        places: dict[int, str] = {}
        for line, stations in self.lines.items():
            for station in stations:
                sides = ("-", *("" for _ in station.points[2:]), "+") if len(station.points) > 1 else ("",)
                for point, side in zip(station.points, sides, strict=True):
                    places.setdefault(point, place_text(station.x, line, side, length))
        return places

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


_UNSAID = "missing, and the rods beside this mass have two velocities; write that of the mass"


@dataclass
class _Pen:
    """Draws lines of parts one after another."""

    points: list[Point] = field(default_factory=list)
    bars: list[Bar] = field(default_factory=list)
    default_velocities: dict[int, Keys] = field(default_factory=dict)  # masses whose velocity is that of their rods
    links: list[Link] = field(default_factory=list)
    names: dict[str, int] = field(default_factory=dict)
    lines: dict[str, tuple[Station, ...]] = field(default_factory=dict)
    contacts: list[tuple[Link, Keys]] = field(default_factory=list)
    paths: dict[int, Keys] = field(default_factory=dict)  # points by the parts that they are, or that come next
    places: dict[int, tuple[str, Fraction]] = field(default_factory=dict)  # of contacts, by the number of the link
    kinds: set[type[BETWEEN]] = field(default_factory=set)  # of parts between nodes, of all lines

    def drawing(self) -> Drawing:
        """What was drawn."""
        self._refuse_empty()
        for k, point in enumerate(self.points):
            self._bearable(k, point)
        refuse_impacts(self.points, self.contacts)
        refuse_joined_corners(self.points, self.links, self.paths)
        return Drawing(tuple(self.points), tuple(self.bars), tuple(self.links), self.lines, self.names, self.places)

    def _refuse_empty(self) -> None:
        """A chain has something between its nodes, on its branches at least, unless the ground holds its only one."""
        held = self.links or any(point.stiffness != 0 or point.damping != 0 for point in self.points)
        if not self.kinds and not held:
            raise refusal(EMPTY, "parts")
        if self.kinds == {ContactPart}:
            raise refusal("contacts alone; write a rod, a spring or a dashpot, too", "parts")

    def line(
        self,
        name: str,
        parts: Sequence[ChainPart | str],
        at: Keys,
        begin: int | None = None,
        ratio: Fraction = Fraction(1),
    ) -> None:
        """Parts from left to right; a branch begins at a point that is there already."""
        self.lines[name] = ()  # so that no node of it has its name
        nodes, between = alternating(parts, at, branch=begin is not None)
        self.kinds |= {type(part) for _, part in between}
        if begin is not None and nodes[0] is not None:
            self._wheel(begin, nodes[0][1], ratio, (*at, nodes[0][0]))
        numbers = [self._draw_node(nodes, between, k, at) if k or begin is None else begin for k in range(len(nodes))]
        stations = [Station(Fraction(0), (numbers[0],), None, None)]
        for k, ((number, part), left, right) in enumerate(zip(between, numbers, numbers[1:], strict=False)):
            last, turns = stations[-1], ratio if begin is not None and k == 0 else Fraction(1)
            if isinstance(part, RodPart):
                self.places[len(self.links)] = name, last.x
                if part.name and any(part.name == bar.name for bar in self.bars):
                    raise refusal(f"{show(part.name)} is taken; write another name", *at, number, "name")
                bar = self._bar(part, left, right, turns)
                stations[-1] = replace(last, right=bar)
                stations.append(Station(last.x + part.rod, (right,), bar, None))
                continue
            self.places[len(self.links)] = name, last.x
            if isinstance(part, LinkPart):
                self._link(part, left, right, turns)
            else:
                self._contact(part, left, right, turns, (*at, number))
            stations[-1] = replace(last, points=(*last.points, right))
        self.lines[name] = tuple(stations)
        for placed, number in zip(nodes, numbers, strict=True):
            if placed is not None and isinstance(placed[1], PointPart) and (placed[1].friction or placed[1].has_law):
                x = next(station.x for station in stations if number in station.points)
                self._hold(placed[1], number, (name, x), (*at, placed[0]))

    def _draw_node(self, nodes: Sequence[PlacedNode | None], between: Sequence[PlacedBetween], k: int, at: Keys) -> int:
        """A new point for a node."""
        self.points.append(Point(fmpq(0)))
        number = len(self.points) - 1
        placed = nodes[k]
        self.paths[number] = (*at, (placed or between[min(k, len(between) - 1)])[0])
        if placed is not None:
            beside = [between[n][1] for n in (k - 1, k) if 0 <= n < len(between)]
            self._become(number, placed[1], [part for part in beside if isinstance(part, RodPart)], (*at, placed[0]))
        return number

    def _hold(self, part: PointPart, point: int, place: tuple[str, Fraction], at: Keys) -> None:
        """Friction, or a spring with a law, between a point and the ground, a point of its own."""
        self.points.append(Point(fmpq(0), motion="fixed"))
        ground = len(self.points) - 1
        self.paths[ground] = at
        self.places[len(self.links)] = place
        linear = {} if part.has_law else {"spring": Fraction(0)}  # which the point has
        steady = {} if part.sides else {"dashpot": Fraction(0)}
        self._link(part.model_copy(update=linear | steady), ground, point, Fraction(1))

    def _wheel(self, point: int, part: ChainPart | str, ratio: Fraction, at: Keys) -> None:
        """What stands first in a branch turns with its node, `ratio` times as fast: the node has all of it."""
        if not isinstance(part, PointPart):
            raise refusal(f"{show(part)} first; write a mass, or what holds the branch to its node", *at)
        if part.name or part.velocity is not None:
            key = "name" if part.name else "velocity"
            raise refusal(
                f"what stands first in a branch is part of its node, and has the {key} of that; leave it out", *at, key
            )
        if part.friction or part.has_law:
            key = "friction" if part.friction else "spring"
            raise refusal("not of what turns with the node of a branch; write it at the node", *at, key)
        square, here = rational(ratio) ** 2, self.points[point]
        if here.motion is not None:
            raise refusal("a mass on an end whose motion is prescribed; write what holds the branch to it", *at)
        mass, damping, spring = (square * rational(each) for each in (part.inertia, part.dashpot, part.spring))
        self.points[point] = replace(
            here, mass=here.mass + mass, damping=here.damping + damping, stiffness=here.stiffness + spring
        )

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
                rational(part.loss),
            )
        )
        if part.spring or part.dashpot or part.friction:
            self._link(part, left, right, ratio)
        return len(self.bars) - 1

    def _link(self, part: SpringLaw, left: int, right: int, ratio: Fraction) -> None:
        """A spring and a dashpot, with a gap on both sides two springs; and friction."""
        linear = Link(left, right, rational(part.spring), rational(part.dashpot), rational(ratio))
        strained = replace(linear, preload=rational(part.preload))
        number = len(self.links)
        if part.yields is not None:
            pull, push = part.yields
            self.links.append(replace(strained, limits=(rational(pull), rational(push))))
        elif part.sides:
            self.links += [replace(linear, side=side, gap=rational(gap)) for side, gap in part.sides]
        elif part.spring or part.dashpot:
            self.links.append(strained)
        if part.friction:
            friction, breakaway = rational(part.friction), rational(part.larger_at_rest)
            self.links.append(Link(left, right, ratio=rational(ratio), friction=friction, breakaway=breakaway))
        if number in self.places:
            self.places |= dict.fromkeys(range(number, len(self.links)), self.places[number])

    def _contact(self, part: ContactPart, left: int, right: int, ratio: Fraction, at: Keys) -> None:
        gap = rational(part.contact)
        self.links.append(Link(left, right, ratio=rational(ratio), contact=True, gap=gap))
        self.contacts.append((self.links[-1], at))

    def agree(self, point: int, branch: Branch) -> None:
        """A mass that takes its velocity from its rods takes it from that of a branch, too."""
        first = next(iter(branch.parts), None)
        if point not in self.default_velocities or not isinstance(first, RodPart):
            return
        if rational(first.velocity) != rational(branch.ratio) * self.points[point].velocity:
            raise refusal(_UNSAID, *self.default_velocities[point], "velocity")

    def _become(self, point: int, part: ChainPart | str, rods: Sequence[RodPart], at: Keys) -> None:
        """Give a point what a part says of it; `rods` are those beside it."""
        if isinstance(part, PointPart):
            velocities = {rod.velocity for rod in rods}
            if part.velocity is None and len(velocities) > 1 and part.inertia:
                raise refusal(_UNSAID, *at, "velocity")
            if part.velocity is None and part.inertia:
                self.default_velocities[point] = at
            velocity = part.velocity if part.velocity is not None else min(velocities, default=Fraction(0))
            spring = Fraction(0) if part.has_law else part.spring
            dashpot = Fraction(0) if part.sides else part.dashpot
            mass, damping, stiffness = map(rational, (part.inertia, dashpot, spring))
            self.points[point] = Point(mass, damping, stiffness, rational(velocity), name=part.name or "")
        elif isinstance(part, MotionPart):
            start = rational(part.velocity)
            self.points[point] = Point(fmpq(0), velocity=start, motion=part.motion, name=part.name or "")
        elif part == "fixed":
            self.points[point] = Point(fmpq(0), motion="fixed")
        elif part == "absorbing":
            if not rods:
                raise refusal('"absorbing" without a rod; write a rod beside it', *at)
            self.points[point] = Point(fmpq(0), damping=rational(rods[0].impedance), absorbing=True)
        name = part.name if isinstance(part, PointPart | MotionPart) else None
        if name:
            if name in self.names or name in self.lines:
                raise refusal(f"{show(name)} is taken; write another name", *at, "name")
            self.names[name] = point

    def _is_damped(self, number: int) -> bool:
        """Whether a point has a rod, a dashpot or a motion, or others hold it that have, or a mass, by dashpots."""
        seen, coming = {number}, [number]
        while coming:
            point = self.points[number := coming.pop()]
            held = any(number in (bar.left, bar.right) for bar in self.bars)
            if point.damping != 0 or point.mass != 0 or point.motion is not None or held:
                return True
            ties = [{link.left, link.right} for link in self.links if link.steady_damping != 0]
            beside = set().union(*(tie for tie in ties if number in tie)) - seen
            seen |= beside
            coming += beside
        return False

    def _bearable(self, number: int, point: Point) -> None:
        """A point must have something that says how fast it is."""
        if point.mass != 0 or self._is_damped(number):
            return
        at = self.paths[number]
        if any(number in (link.left, link.right) for link, _ in self.contacts):
            raise refusal(
                "no mass, rod or dashpot holds a side of a contact, and what has lifted off needs a motion of "
                "its own; write a dashpot beside its spring, or a mass",
                *at,
            )
        raise refusal("a joint without mass, rod or dashpot; write one of these at it", *at)
