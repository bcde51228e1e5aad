"""A scene as a network, read straight from its numbers: what integrators start from.

Programs start from the nodes of a system, or from the drawing of a chain. None of that is used here, nor where these
put loads and outputs: what is wrong there is wrong in all programs alike, and only integrators can see it. A rod of
length 1, speed 1 and impedance Z weighs Z. So (2.3), (2.4) and what (4.3)-(4.5) say of kappa are

    collision   rods of impedance 1 on both sides of bodies of mass 1/kappa_i, all three with v_i;
    drive       discs J_i/J_1, shafts of impedance kappa_i J_i/J_1; moments count kappa_1, the last one against
                rotation;
    building    columns of impedance 1, floors of mass 1/kappa_i, on a base that the ground accelerates by a
                ("ground"), or that has no mass and is pushed by -a/kappa_0 ("force").
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.fields.loads import Load, TimedLoad
from wavesym.fields.shapes import ShapedLoad
from wavesym.mechanics.dead_loads import dead_loads
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Bar, Link, Network, Point
from wavesym.mechanics.node import UnitLoad
from wavesym.mechanics.probe import Probe
from wavesym.mechanics.quantities import QUANTITIES
from wavesym.numbers.doubles import fraction, rational
from wavesym.records.load import RecordedLoad
from wavesym.scene import Scene
from wavesym.systems.building import Building
from wavesym.systems.collision import Collision
from wavesym.systems.drive import Drive
from wavesym.systems.explicit import ExplicitChain
from wavesym.systems.parts import ContactPart, LinkPart, MotionPart, PointPart, RodPart, SpringLaw
from wavesym.systems.place import Position, position_of

Span = tuple[Bar | Link, ...]
"""What is between two points; which points these are, the sketch knows."""
Push = tuple[int, Fraction]
"""The point that a load acts on, and what 1 of the load is there."""


class Node(NamedTuple):
    """A point, and the links between it and the ground whose laws have corners."""

    point: Point
    ground_links: tuple[Link, ...] = ()


Row = Sequence[Point | Node | Span]
"""Points and spans by turns."""
_FREE = Point(fmpq(0))


@dataclass
class Sketch:
    """Points and what is between them, line by line.

    `spots` has how far along its line each point is, `rods` where each bar begins and ends on it. `push` is for loads.
    """

    push: Callable[[Any], Push] = lambda _: (0, Fraction(1))
    points: list[Point] = field(default_factory=list)
    bars: list[Bar] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    names: dict[str, int] = field(default_factory=dict)
    spots: dict[str, list[tuple[Fraction, int]]] = field(default_factory=dict)
    rods: dict[str, list[tuple[Fraction, Fraction, int]]] = field(default_factory=dict)

    def line(self, name: str, row: Row, start: int | None = None, ratio: Fraction = Fraction(1)) -> None:
        """A line; a branch starts at a point that is there, with a span that moves `ratio` times as fast as it."""
        x, turns = Fraction(0), rational(ratio)
        span: Span = ()
        held: list[Link] = []
        spots, rods = self.spots.setdefault(name, []), self.rods.setdefault(name, [])
        if start is not None:
            spots.append((x, start))
        for each in row:
            node = Node(each) if isinstance(each, Point) else each
            if not isinstance(node, Node):
                span = node
                continue
            here = len(self.points)
            self.points.append(node.point)
            if node.point.name:
                self.names[node.point.name] = here
            held += [replace(link, right=here) for link in node.ground_links]
            for part in span:
                before = spots[-1][1]
                if isinstance(part, Link):
                    self.links.append(replace(part, left=before, right=here, ratio=turns))
                else:
                    rods.append((x, x + fraction(part.length), len(self.bars)))
                    self.bars.append(replace(part, left=before, right=here, ratios=(turns, fmpq(1))))
            x = rods[-1][1] if rods else x
            spots.append((x, here))
            turns = fmpq(1) if span else turns
        for link in held:
            self.links.append(replace(link, left=len(self.points)))
            self.points.append(Point(fmpq(0), motion="fixed"))

    def point(self, position: Position) -> int:
        """The point at a place: of several the left one, unless the right side is asked for."""
        if position.x is None:
            return self.names[position.name]
        here = [point for x, point in self.spots[position.name] if x == position.x]
        return here[-1 if position.side > 0 else 0]

    def probe(self, output: Probe, position: Position) -> Probe:
        """An output at a place."""
        if output.quantity == "drift":
            _, _, bar = self.rods[position.name][int(position.x or 0) - 1]
            return replace(output, rod=bar + 1, place=fmpq(1), point=None)
        line, x = position.name, position.x
        if x is None:
            point = self.names[position.name]
            line, x = next((line, x) for line, spots in self.spots.items() for x, other in spots if other == point)
        rods = [(begin, end, bar) for begin, end, bar in self.rods[line] if begin <= x <= end]
        inside = any(begin < x < end for begin, end, _ in rods)
        spread = line and x == 0 and len([spot for spot, _ in self.spots[line] if spot == x]) == 1  # a gear's branch
        if inside or output.computed_quantity in ("strain", "force") or (spread and position.x is not None):
            begin, end, bar = rods[-1 if position.side > 0 else 0]
            return replace(output, rod=bar + 1, place=rational((x - begin) / (end - begin)), point=None)
        return replace(output, rod=0, place=fmpq(0), point=self.point(position))


def independent_model(scene: Scene, model: Model) -> Model:
    """The model of a scene on a network, with loads and with outputs, that are read here and nowhere else.

    Args:
        scene: what the user wrote, without units.
        model: what it was lowered to; its horizon, tolerance, damping and units are taken as they are.
    """
    sketch = _sketch(scene.system)
    loads: list[AppliedLoad] = []
    units: dict[int, list[UnitLoad]] = {}
    for number, load in enumerate(scene.load):
        point, size = sketch.push(load)
        kinds = [f"{number}:{power}" for power in (0, 1)]
        units.setdefault(point, []).extend(
            UnitLoad(kind, None, (*[fmpq(0)] * power, rational(size))) for power, kind in enumerate(kinds)
        )
        loads += [
            AppliedLoad(kind, rational(time), rational(value))
            for time, *values in changes(load)
            for kind, value in zip(kinds, values, strict=True)
        ]
    points = (replace(point, loads=tuple(units.get(k, ()))) for k, point in enumerate(sketch.points))
    network = Network(tuple(points), tuple(sketch.bars), tuple(sketch.links))
    if isinstance(scene.system, ExplicitChain):
        network = scene.system.with_dead_loads(network)
        loads += dead_loads(network)
    places = (at for quantity in QUANTITIES for at in getattr(scene.output, quantity))
    return replace(
        model,
        preset=None,
        network=network,
        loads=tuple(sorted(loads, key=lambda load: load.time)),
        probes=tuple(sketch.probe(probe, at) for probe, at in zip(model.probes, places, strict=True)),
    )


def changes(load: Load) -> Iterator[tuple[Fraction, Fraction, Fraction]]:
    """When a load jumps, by how much, and by how much its slope changes then."""
    if isinstance(load, TimedLoad):
        steps, ramps = (getattr(load, name) or [Fraction(0)] * len(load.times) for name in load.lists)
        yield from zip(load.times, steps, ramps, strict=True)
        return
    step, begin = load.step, Fraction(0)
    assert step is not None  # as it has samples
    if isinstance(load, RecordedLoad):
        # a record goes to 0 after its end, and comes from 0 where it begins later than all else
        values = [load.scale * Fraction(sample) for sample in load.record.samples] + [Fraction(0)]
        if load.begin:
            begin, values = load.begin - step, [Fraction(0), *values]
    elif isinstance(load, ShapedLoad):
        begin, values = load.start, [fraction(sample) for sample in load.polyline]
    else:
        values = list(load.samples)  # type: ignore[attr-defined]
    slopes = [Fraction(0), *((after - before) / step for before, after in pairwise(values)), Fraction(0)]
    yield begin, values[0], Fraction(0)
    for k, (before, after) in enumerate(pairwise(slopes)):
        yield begin + k * step, Fraction(0), after - before


def _sketch(system: Any) -> Sketch:
    """A system, by what it is called in a scene. UnservedError for one that has no reader here."""
    if isinstance(system, ExplicitChain):
        return _chain(system)
    if system.type not in READERS:
        known = ", ".join([*READERS, "chain"])
        raise UnservedError(f"system.type: {system.type} is not supported by integrators; write {known}")
    return READERS[system.type](system)


def _rod(impedance: Fraction | int = 1, velocity: Fraction | int = 0) -> Span:
    return (Bar(0, 0, fmpq(1), fmpq(1), rational(impedance), velocity=rational(velocity)),)


def _body(mass: Fraction, velocity: Fraction | int = 0) -> Point:
    return Point(rational(mass), velocity=rational(velocity))


def _collision(system: Collision) -> Sketch:
    row: list[Point | Span] = [_FREE]
    for kappa, velocity in zip(system.kappa, system.velocity, strict=True):
        if len(row) > 1 and system.contacts == "open":
            row += [(Link(0, 0, contact=True),), _FREE]
        row += [_rod(1, velocity), _body(1 / kappa, velocity), _rod(1, velocity), _FREE]
    sketch = Sketch()
    sketch.line("", row)
    return sketch


def _drive(system: Drive) -> Sketch:
    discs, unit = [inertia / system.inertia[0] for inertia in system.inertia], system.kappa[0]
    row: list[Point | Span] = [_body(discs[0])]
    for kappa, before, disc in zip(system.kappa, discs, discs[1:], strict=False):
        row += [_rod(kappa * before), _body(disc)]
    sketch = Sketch(lambda load: (load.body - 1, -unit if load.body == len(discs) else unit))
    sketch.line("", row)
    return sketch


def _building(system: Building) -> Sketch:
    ground = system.base == "ground"
    row: list[Point | Span] = [Point(fmpq(0), motion="acceleration") if ground else _FREE]
    for kappa in system.kappa[1:]:
        row += [_rod(), _body(1 / kappa)]
    sketch = Sketch(lambda _: (0, Fraction(1) if ground else -1 / system.kappa[0]))
    sketch.line("", row)
    return sketch


READERS: dict[str, Callable[[Any], Sketch]] = {"collision": _collision, "drive": _drive, "building": _building}
"""The systems by their type; one more system is one more entry."""


def _chain(system: ExplicitChain) -> Sketch:
    sketch = Sketch()
    sketch.push = lambda load: (sketch.point(position_of(load.at)), Fraction(1))
    sketch.line("", _row(system.parts))
    for branch in system.branch:
        first, start = branch.parts[0], sketch.names[branch.from_]
        parts = branch.parts[isinstance(first, PointPart) :]
        if isinstance(first, PointPart):  # a wheel of the node
            (wheel, _), node, square = _point(first, ()), sketch.points[start], rational(branch.ratio) ** 2
            names = ("mass", "damping", "stiffness")
            gathered = {name: getattr(node, name) + square * getattr(wheel, name) for name in names}
            sketch.points[start] = replace(node, **gathered)
        sketch.line(branch.name, _row(parts, branch=True) if parts else [], start, branch.ratio)
    return sketch


def _row(parts: Sequence[Any], *, branch: bool = False) -> Row:
    """Parts as points and spans; where no point is written between spans, or at an end, there is one without mass."""
    written: list[Any] = []
    for part in parts:
        span = ContactPart(contact=Fraction(0)) if part == "contact" else part
        if isinstance(span, _SPANS) and (isinstance(written[-1], _SPANS) if written else not branch):
            written.append("joint")
        written.append(span)
    if isinstance(written[-1], _SPANS):
        written.append("joint")
    return [
        _span(part) if isinstance(part, _SPANS) else _point(part, [*written[max(k - 1, 0) : k], *written[k + 1 :][:1]])
        for k, part in enumerate(written)
    ]


_SPANS = (RodPart, LinkPart, ContactPart)


def _span(part: RodPart | LinkPart | ContactPart) -> Span:
    if isinstance(part, ContactPart):
        return (Link(0, 0, contact=True, gap=rational(part.contact)),)
    held = _springs(part, part.dashpot) if part.spring or part.dashpot else ()
    held += _friction(part)
    if isinstance(part, LinkPart):
        return held
    rod, speed, impedance, velocity, strain = map(
        rational, (part.rod, part.speed, part.impedance, part.velocity, part.strain)
    )
    return (Bar(0, 0, rod, speed, impedance, velocity=velocity, strain=strain), *held)


def _friction(part: SpringLaw) -> tuple[Link, ...]:
    """What rubs beside a part, or at a node."""
    if part.friction == 0:
        return ()
    more = part.breakaway if part.breakaway != part.friction else 0
    return (Link(0, 0, friction=rational(part.friction), breakaway=rational(more)),)


def _springs(part: SpringLaw, dashpot: Fraction) -> tuple[Link, ...]:
    """A spring and a dashpot beside it; two springs that act on one side each."""
    linear = Link(0, 0, rational(part.spring), rational(dashpot))
    strained = replace(linear, preload=rational(part.preload))
    if part.yields is not None:
        pull, push = map(rational, part.yields)
        return (replace(strained, limits=(pull, push)),)
    sides = tuple(replace(linear, side=side, gap=rational(gap)) for side, gap in part.sides)
    return sides or (strained,)


def _point(part: Any, beside: Sequence[Any]) -> Node:
    rods = [other for other in beside if isinstance(other, RodPart)]
    if isinstance(part, MotionPart):
        return Node(Point(fmpq(0), velocity=rational(part.velocity), motion=part.motion, name=part.name or ""))
    if isinstance(part, PointPart):
        velocity = part.velocity if part.velocity is not None else rods[0].velocity if rods else 0
        spring = 0 if part.has_law else part.spring
        steady, engaged = (0, part.dashpot) if part.sides else (part.dashpot, Fraction(0))
        mass, dashpot, stiffness = map(rational, (getattr(part, "mass", 0), steady, spring))
        sprung = _springs(part, engaged) if part.has_law else ()
        return Node(
            Point(mass, dashpot, stiffness, rational(velocity), name=part.name or ""), (*sprung, *_friction(part))
        )
    if part == "fixed":
        return Node(Point(fmpq(0), motion="fixed"))
    absorbing = Point(fmpq(0), damping=rational(rods[0].impedance), absorbing=True) if part == "absorbing" else _FREE
    return Node(absorbing)
