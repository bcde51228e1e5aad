"""Any chain as a graph: points, the bars between them, and what links points at one place; all numbers exact.

A bar carries two waves, each counted as a velocity: seen from its end, where a wave a arrives, it is a dashpot Z (its
impedance) and a force 2 Z a. A bar's end may move `ratio` times as fast as its point (gears).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from heapq import heapify, heappop, heappush
from math import isqrt
from typing import Any, Literal, NamedTuple

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Node, UnitLoad

_ZERO, _ONE = fmpq(0), fmpq(1)
DEAD = ":dead"
"""How the kinds of unit loads end that never change (dead_loads.py)."""


@dataclass(frozen=True)
class Point:
    """What moves as one: a rigid mass, or none; a dashpot and a spring to the ground; its velocity at tau = 0.

    A `motion` is prescribed by the loads on the point: its velocity, or its acceleration. What is fixed has no loads.
    `place` is where a scene would say that it is. What is `absorbing` has the dashpot that its rod asks for. What is
    `is_glued` is a contact that is taken to stay closed.
    """

    mass: fmpq
    damping: fmpq = _ZERO
    stiffness: fmpq = _ZERO
    velocity: fmpq = _ZERO
    motion: Literal["fixed", "velocity", "acceleration"] | None = None
    loads: tuple[UnitLoad, ...] = ()
    name: str = ""
    place: str = field(default="", compare=False)
    absorbing: bool = field(default=False, compare=False)
    is_glued: bool = field(default=False, compare=False)

    @property
    def label(self) -> str:
        """What people call it: by its name, or else by its place, of which a wall beside a spring has a side alone."""
        return self.name or ("fixed" if self.motion == "fixed" and self.place.endswith(("-", "+")) else self.place)

    def action(self, unit: UnitLoad) -> tuple[Any, ...]:
        """The force that a unit load makes here, or the velocity that it prescribes: coefficients by powers of tau."""
        if self.motion != "acceleration":
            return unit.coefficients
        return (_ZERO, *(coefficient / (power + 1) for power, coefficient in enumerate(unit.coefficients)))


@dataclass(frozen=True)
class Bar:
    """An elastic rod from one point to another, with its state at tau = 0. Its delay is length / speed.

    With a `loss` its modulus is 1 + i loss times as large under harmonic motions, and it has no others. Of one with
    weight (`gravity` acts along it) the waves are what moves it besides that (dead_loads.py); its strain at tau = 0
    is that in its middle, and grows by `gradient` along it.
    """

    left: int
    right: int
    length: fmpq
    speed: fmpq
    impedance: fmpq
    ratios: tuple[fmpq, fmpq] = (_ONE, _ONE)
    velocity: fmpq = _ZERO
    strain: fmpq = _ZERO
    name: str = ""
    loss: fmpq = _ZERO
    gravity: fmpq = _ZERO
    gradient: fmpq = _ZERO

    @cached_property
    def delay(self) -> fmpq:
        """How long a wave takes from end to end."""
        return self.length / self.speed

    def initial_wave(self, side: int, since: fmpq | None = None) -> fmpq:
        """The wave that it holds at tau = 0 and that was sent from its left (0) or right (1) end.

        It is that in the middle, or `since` the first of it was sent, its delay before tau = 0.
        """
        middle = (self.velocity + (-self.speed if side == 0 else self.speed) * self.strain) / 2
        return middle if since is None else middle + self.initial_slope * (since - self.delay / 2)

    @property
    def initial_slope(self) -> fmpq:
        """How fast either of these waves grows, as they come to an end."""
        return (self.speed**2 * self.gradient + self.gravity) / 2

    def weight_strain(self, place: fmpq) -> fmpq:
        """The strain that it has besides that of its waves, at a part of its length."""
        return self.gravity * self.length * (1 - 2 * place) / (2 * self.speed**2)


@dataclass(frozen=True)
class Link:
    """A spring and a dashpot between two points; their left end moves `ratio` times as fast as its point.

    A `contact` has neither: it pushes and never pulls, and is open while its two sides are apart, at tau = 0 by `gap`.
    Where it has `friction` R it has neither, too: its sides stick while it takes no more than R to hold them, else it
    takes R against their sliding (Coulomb); where `breakaway` is not 0, it holds them while it takes no more than that,
    which is larger. With a `side` its spring only pulls (1) or only pushes (-1), where it is
    longer, or shorter, than at tau = 0 by more than `gap`: it acts then, and so does its dashpot, which has a force of
    either sign. With `limits` its spring yields: the largest pull and push.
    `preload` is what a spring pulls at tau = 0, where no gap says it. `place` is what a scene calls it.
    """

    left: int
    right: int
    stiffness: fmpq = _ZERO
    damping: fmpq = _ZERO
    ratio: fmpq = _ONE
    contact: bool = False
    gap: fmpq = _ZERO
    place: str = ""
    friction: fmpq = _ZERO
    side: int = 0
    limits: tuple[fmpq, fmpq] | None = None
    preload: fmpq = _ZERO
    breakaway: fmpq = _ZERO

    @property
    def has_corner(self) -> bool:
        """Whether its law has a corner: it is another one from some instants on, which have to be found."""
        return self.contact or self.friction != 0 or self.is_spring_with_corner

    @property
    def is_spring_with_corner(self) -> bool:
        """Whether it is a spring that acts on one side alone, or that yields."""
        return self.side != 0 or self.limits is not None

    @property
    def steady_damping(self) -> fmpq:
        """Its dashpot, where that acts all the time."""
        return _ZERO if self.side != 0 else self.damping

    @property
    def law(self) -> str:
        """What it is, where its law has a corner, in a word."""
        if self.is_spring_with_corner:
            return "spring"
        return "friction" if self.friction != 0 else "contact"

    @property
    def changes(self) -> str:
        """What it does at a corner of its law, in words."""
        if self.side != 0:
            return f"the spring at {self.place} engages and releases"
        if self.limits is not None:
            return f"the spring at {self.place} yields"
        if self.friction != 0:
            return f"what rubs at {self.place} sticks and slips"
        return f"the contact at {self.place} opens and closes"


class End(NamedTuple):
    """One end of a bar: the left one (0) or the right one (1)."""

    bar: int
    side: int


@dataclass(frozen=True)
class Joint:
    """Points that links connect, which are solved together, and the ends of bars at them (with the point of each)."""

    points: tuple[int, ...]
    ends: tuple[tuple[End, int], ...]


@dataclass(frozen=True)
class Network:
    """A chain with its branches."""

    points: tuple[Point, ...]
    bars: tuple[Bar, ...]
    links: tuple[Link, ...] = ()

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The joints, in the order of their first points."""
        leader = list(range(len(self.points)))

        def leader_of(point: int) -> int:
            while leader[point] != point:
                point = leader[point]
            return point

        for link in self.links:
            one, other = sorted((leader_of(link.left), leader_of(link.right)))
            leader[other] = one
        members: dict[int, list[int]] = {}
        for point in range(len(self.points)):
            members.setdefault(leader_of(point), []).append(point)
        ends: dict[int, list[tuple[End, int]]] = {first: [] for first in members}
        for number, bar in enumerate(self.bars):
            for side, point in enumerate((bar.left, bar.right)):
                ends[leader_of(point)].append((End(number, side), point))
        return tuple(Joint(tuple(points), tuple(ends[first])) for first, points in members.items())

    @cached_property
    def corners(self) -> tuple[int, ...]:
        """The links whose laws have corners: contacts, friction, springs that act on one side or yield."""
        return tuple(number for number, link in enumerate(self.links) if link.has_corner)

    def refuse_corners(self) -> None:
        """UnservedError where a law has a corner: for what is one law from the start to the end.

        (A contact may close without any front, where what it parts moves at constant speed.)
        """
        for number in self.corners:
            raise UnservedError(
                f"system: {self.links[number].changes}, which tables, closed form and march do not support "
                "(take pieces or `run`)"
            )

    def refuse_dead_loads(self) -> None:
        """UnservedError where something has weight, or a preload: for what knows the loads of a scene alone."""
        if any(bar.gravity != 0 for bar in self.bars) or any(
            unit.kind.endswith(DEAD) for point in self.points for unit in point.loads
        ):
            raise UnservedError(
                "system: gravity and preloads are supported by pieces and `run` only (take one of them)"
            )

    def refuse_loss(self, instead: str = "leave it out, or write damping, or a dashpot in the rod") -> None:
        """UnservedError where a rod has a loss, for all but frequency responses; and what to do `instead`."""
        if any(bar.loss != 0 for bar in self.bars):
            raise UnservedError(
                "system.parts: a loss of a rod is for frequency responses (`frf`) alone, as its motions in time would "
                f"begin before their cause; {instead}"
            )

    @property
    def takes_modal_damping(self) -> bool:
        """Whether its modes may be damped by ratios: nothing else takes energy out of it, or has a corner."""
        dashpots = [*(point.damping for point in self.points), *(link.damping for link in self.links)]
        return not self.corners and not any(dashpots)

    def refuse_rodless(self, what: str, instead: str) -> None:
        """UnservedError where there is no bar, for `what` is of rods; and what to do `instead`."""
        if not self.bars:
            raise UnservedError(f"system.parts: no rod, and {what} is of rods; {instead}")

    @cached_property
    def shortest(self) -> fmpq:
        """How long a wave takes through the shortest bar; without bars a time in which hardly anything moves.

        That is 1 over a rate that no motion exceeds: of the sums of springs and dashpots that hold each point.
        """
        if self.bars:
            return min(bar.delay for bar in self.bars)
        stiffness, damping = ([getattr(point, name) for point in self.points] for name in ("stiffness", "damping"))
        for link in self.links:
            for end, ratio in ((link.left, link.ratio), (link.right, _ONE)):
                stiffness[end] += ratio**2 * link.stiffness
                damping[end] += ratio**2 * link.damping
        square, rate = _ZERO, _ZERO
        for point, k, c in zip(self.points, stiffness, damping, strict=True):
            if point.motion is None and point.mass != 0:
                square, rate = square + k / point.mass, rate + c / point.mass
            elif point.motion is None and c != 0:
                rate += k / c
        whole = isqrt(int(square.floor())) + (square != 0) + rate.ceil()
        return 1 / fmpq(whole) if whole else _ONE

    @property
    def loses(self) -> bool:
        """Whether dashpots take energy from it: any but those between points that move as they are told."""
        free = {number for number, point in enumerate(self.points) if point.motion is None}
        return any(self.points[number].damping != 0 for number in free) or any(
            link.damping != 0 and not link.contact and free & {link.left, link.right} for link in self.links
        )

    @property
    def parallel_bars(self) -> frozenset[int]:
        """The bars that springs or dashpots lie beside, between the same two points."""
        pairs = {frozenset((k.left, k.right)) for k in self.links if k.stiffness != 0 or k.damping != 0}
        return frozenset(n for n, bar in enumerate(self.bars) if frozenset((bar.left, bar.right)) in pairs)

    @cached_property
    def joint_of(self) -> Mapping[int, int]:
        """The number of each point's joint."""
        return {point: number for number, joint in enumerate(self.joints) for point in joint.points}

    def distances(self, places: Iterable[tuple[int, fmpq]], points: Iterable[int] = ()) -> dict[int, fmpq]:
        """How long a wave takes from each joint to the nearest of some places (bar, part of it from its left end).

        Points are places too.
        """
        coming = [(fmpq(0), self.joint_of[point]) for point in points]
        for number, place in places:
            bar = self.bars[number]
            coming.append((place * bar.delay, self.joint_of[bar.left]))
            coming.append(((1 - place) * bar.delay, self.joint_of[bar.right]))
        return self.first_times(coming)

    def first_times(self, starts: Iterable[tuple[fmpq, int]], latest: fmpq | None = None) -> dict[int, fmpq]:
        """When a wave that starts at these (times, joints) first comes to each joint, until `latest` where given."""
        coming = list(starts)
        heapify(coming)
        first: dict[int, fmpq] = {}
        while coming:
            time, joint = heappop(coming)
            if joint in first or (latest is not None and time > latest):
                continue
            first[joint] = time
            for end, _ in self.joints[joint].ends:
                other = self.joint_of[self.point_at(self.opposite_end(end))]
                heappush(coming, (time + self.bars[end.bar].delay, other))
        return first

    def at_rest(self, joint: Joint) -> bool:
        """Whether a joint goes on as it is at tau = 0, as far as no load acts on it and nothing else arrives."""
        velocities = {point: self.points[point].velocity for point in joint.points}
        pulls = {point: -self.points[point].damping * velocities[point] for point in joint.points}
        for end, point in joint.ends:
            bar = self.bars[end.bar]
            ratio, arriving = bar.ratios[end.side], bar.initial_wave(1 - end.side, fmpq(0))
            if bar.initial_slope != 0 or ratio * velocities[point] - arriving != bar.initial_wave(end.side, bar.delay):
                return False
            pulls[point] += ratio * bar.impedance * (2 * arriving - ratio * velocities[point])
        for link in self.links:
            if link.left in velocities:
                opening = velocities[link.right] - link.ratio * velocities[link.left]
                if opening != 0 and (link.stiffness != 0 or link.friction != 0):
                    return False
                if (link.side != 0 and link.gap < 0) or link.preload != 0:  # it is strained
                    return False
                pull = link.damping * opening
                pulls[link.left] += link.ratio * pull
                pulls[link.right] -= pull
        return all(
            self.points[point].motion is not None
            or (pull == 0 and (self.points[point].stiffness == 0 or velocities[point] == 0))
            for point, pull in pulls.items()
        )

    def is_free(self, end: End) -> bool:
        """Whether nothing at all acts on an end of a bar."""
        number = self.point_at(end)
        point = self.points[number]
        alone = self.joints[self.joint_of[number]] == Joint((number,), ((end, number),))
        bare = point.mass == point.damping == point.stiffness == 0 and point.motion is None and not point.loads
        return alone and bare and not any(number in (link.left, link.right) for link in self.links)

    @cached_property
    def ends_at(self) -> Mapping[int, tuple[End, ...]]:
        """The ends of bars at each point that has some, in their order."""
        found: dict[int, list[End]] = {}
        for number, bar in enumerate(self.bars):
            for side, point in enumerate((bar.left, bar.right)):
                found.setdefault(point, []).append(End(number, side))
        return {point: tuple(ends) for point, ends in found.items()}

    def opposite_end(self, end: End) -> End:
        """The other end of a bar."""
        return End(end.bar, 1 - end.side)

    def point_at(self, end: End) -> int:
        """The point at an end."""
        bar = self.bars[end.bar]
        return bar.right if end.side else bar.left


def with_contacts(network: Network, contacts: Collection[int]) -> Network:
    """A line of rods whose points in `contacts` are two, a contact between them; points stay in their order."""
    points = [
        replace(point, is_glued=point.is_glued and x not in contacts)
        for x, point in enumerate(network.points)
        for _ in range(1 + (x in contacts))
    ]

    def right(x: int) -> int:
        """The point at x from which the rod on the right starts."""
        return x + sum(1 for contact in contacts if contact <= x)

    bars = [
        replace(bar, left=right(bar.left), right=right(bar.right) - (bar.right in contacts)) for bar in network.bars
    ]
    links = [Link(right(x) - 1, right(x), contact=True, place=network.points[x].place) for x in contacts]
    return Network(tuple(points), tuple(bars), tuple(links))


def network_of(chain: Chain) -> Network:
    """A chain of the paper as a network: rod i is bar i - 1, node x is point x.

    Each node's condition is multiplied by what makes the impedances at both ends of a rod one.

    Args:
        chain: with exact numbers, or functions of parameters.

    Returns:
        The network in units of the chain: lengths and delays of a rod are 1.
    """
    points: list[Point] = []
    bars: list[Bar] = []
    scale = fmpq(1)
    for x, node in enumerate(chain.nodes):
        if node.left and node.alpha != 0:
            scale = bars[-1].impedance / (node.alpha / 2)
        points.append(replace(_point(node, scale), place=str(x), is_glued=node.contact))
        if node.right:
            impedance = scale * node.beta / 2 or fmpq(1)  # a prescribed motion does not feel its rod
            bars.append(Bar(x, x + 1, fmpq(1), fmpq(1), impedance, velocity=_ZERO + node.right.velocity))
    return Network(tuple(points), tuple(bars))


def _point(node: Node, scale: fmpq) -> Point:
    if (node.alpha if node.left else 0) == (node.beta if node.right else 0) == 0:
        return _prescribed_point(node)
    loads = tuple(UnitLoad(load.kind, load.number, tuple(scale * c for c in load.coefficients)) for load in node.loads)
    return Point(scale * node.inertia, scale * node.damping, velocity=_ZERO + node.velocity, loads=loads)


def _prescribed_point(node: Node) -> Point:
    """A node whose rod does not act on it: damping U_t = loads alone."""
    loads = tuple(
        UnitLoad(load.kind, load.number, tuple(c / node.damping for c in load.coefficients)) for load in node.loads
    )
    return Point(fmpq(0), motion="velocity", velocity=_ZERO + node.velocity, loads=loads)
