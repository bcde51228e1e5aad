"""Networks with contacts, written as one would draw them from left to right."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from flint import ctx, fmpq

from wavesym.exact.contacts.events import events
from wavesym.exact.motion import Motion
from wavesym.exact.tables.ball import Balls
from wavesym.mechanics.event import ContactEvent
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.model import Labels, Model
from wavesym.mechanics.network import Bar, Link, Network, Point
from wavesym.mechanics.node import UnitLoad
from wavesym.mechanics.probe import Probe


def q(value: object) -> fmpq:
    """An exact number: "1/3", "0.7", 2."""
    if isinstance(value, fmpq):
        return value
    exact = Fraction(str(value))
    return fmpq(exact.numerator, exact.denominator)


def rod(length: object = 1, impedance: object = 1, speed: object = 1, velocity: object = 0) -> tuple[Any, ...]:
    return ("rod", q(length), q(impedance), q(speed), q(velocity))


def contact(gap: object = 0) -> tuple[Any, ...]:
    return ("contact", q(gap))


def body(mass: object = 0, force: object = 0, acceleration: object = None, **more: object) -> tuple[Any, ...]:
    """A mass, a joint (mass 0) or, with an acceleration, what is moved so; a force acts on it from tau = 0."""
    return ("body", q(mass), q(force), acceleration, {key: q(value) for key, value in more.items()})


FIXED = ("fixed",)


def line(parts: Sequence[tuple[Any, ...]], until: object, watched: Sequence[Probe] = ()) -> Model:
    """The model. What stands between two rods without anything between them is a joint; contacts are named 0, 1, ..."""
    points: list[Point] = []
    bars: list[Bar] = []
    links: list[Link] = []
    applied: list[AppliedLoad] = []
    here: int | None = None

    def new(point: Point) -> int:
        points.append(point)
        return len(points) - 1

    for part in parts:
        kind, *values = part
        if kind == "rod":
            length, impedance, speed, velocity = values
            left = new(Point(q(0))) if here is None else here
            here = new(Point(q(0)))
            bars.append(Bar(left, here, length, speed, impedance, velocity=velocity))
        elif kind == "contact":
            left = new(Point(q(0))) if here is None else here
            here = new(Point(q(0)))
            links.append(Link(left, here, contact=True, gap=values[0], place=str(len(links))))
        else:
            if here is None:
                here = new(Point(q(0)))
            name = f"load{here}"
            if kind == "fixed":
                points[here] = Point(q(0), motion="fixed")
                continue
            mass, force, acceleration, more = values
            motion = None if acceleration is None else "acceleration"
            size = force if acceleration is None else q(acceleration)
            loads = (UnitLoad(name, None, (size,)),) if size != 0 else ()
            points[here] = Point(mass, motion=motion, loads=loads, **more)
            if loads:
                applied.append(AppliedLoad(name, q(0), q(1)))
    network = Network(tuple(points), tuple(bars), tuple(links))
    probes = tuple(watched) or (seen(0),)
    return Model("line", network, tuple(applied), probes, q(until), q("1e-10"), Labels({}, (), ""))


def seen(bar: int, place: object = 0, quantity: str = "velocity") -> Probe:
    """An output on a bar, which counts from 0."""
    return Probe(f"{quantity}@{bar}+{place}", quantity, bar + 1, q(place))


def values(model: Model, taus: Sequence[object], bits: int = 256) -> list[list[fmpq]]:
    """The outputs, to 30 digits at least."""
    from wavesym.numbers.doubles import middle

    motion = Motion(model, model.until)
    rows = []
    with ctx.workprec(bits):
        for probe in model.probes:
            balls = Balls(motion.segments(probe, bits))
            found = [balls.evaluate(q(tau)) for tau in taus]
            assert all(ball.rad() < fmpq(1, 10**30) for ball in found), probe.name
            rows.append([middle(ball) for ball in found])
    return rows


def told(model: Model) -> list[tuple[str, str, ContactEvent]]:
    return [(event.x, event.kind, event) for event in events(model)]


def at(event: ContactEvent, tau: object) -> bool:
    """Whether an event is at an exact instant."""
    with ctx.workprec(320):
        from flint import arb

        return bool(abs(event.tau - arb(q(tau))) < fmpq(1, 10**60))
