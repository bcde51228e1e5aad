"""The problem of a network with all that integrators ask of it: when fronts may come where, and what is noise."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from heapq import heapify, heappop, heappush
from math import copysign, inf
from typing import NamedTuple

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.methods.network_problem import network_problem, opening
from wavesym.methods.problem import Problem
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest


@dataclass(frozen=True)
class Change:
    """What happens at tau at the link with this number among those with corners: a contact opens, a spring yields."""

    corner: int
    kind: str
    tau: float


KnownChanges = list[tuple[Change, float]]
"""What happens at corners in the order of time, and how well it is known when."""


def match_changes(finer: Sequence[Change], coarser: Sequence[Change]) -> KnownChanges | None:
    """What happens in two solutions, and how far apart in time; None where it is not the same."""
    found: KnownChanges = []
    for corner in {change.corner for change in (*finer, *coarser)}:
        both = [[change for change in changes if change.corner == corner] for changes in (finer, coarser)]
        if [change.kind for change in both[0]] != [change.kind for change in both[1]]:
            return None
        found += [(one, abs(one.tau - other.tau)) for one, other in zip(*both, strict=True)]
    return sorted(found, key=lambda each: (each[0].tau, each[0].corner))


def match_all(found: Sequence[Sequence[Change]]) -> KnownChanges | None:
    """What happens on three grids, ever finer ones, and how well it is known when; None where it is not the same."""
    coarse, half, quarter = found
    first, then = match_changes(quarter, half), match_changes(half, coarse)
    if first is None or then is None:
        return None
    return [(change, after + before) for (change, after), (_, before) in zip(first, then, strict=True)]


class OneSidedStep(NamedTuple):
    """A step of so much time; beyond its gap a spring is by `before` at first, by `share` times s + `rest` on average.

    That is what its own pull follows, and s is by how much it is beyond at the end.
    """

    length: float
    before: float
    share: float
    rest: float


@dataclass(frozen=True)
class LinkLaw:
    """Friction, or a spring with a corner, between two points: its pull depends on how much longer it gets.

    That is `row` @ displacements; it pulls on the points by `row` transposed. `corner` is its number among the links
    with corners. Friction takes `friction` either way, at rest up to `rest`. A spring has a `stiffness`; with a `side`
    it acts where it is longer (1) or shorter (-1) by more than `gap`, and a `dashpot` with it; else it yields at the
    largest `pull` and `push`, and pulls with its `preload` at first.
    """

    corner: int
    row: Array
    friction: float
    rest: float
    stiffness: float
    dashpot: float
    side: int
    gap: float
    pull: float
    push: float
    preload: float

    @classmethod
    def from_network(cls, network: Network, corner: int) -> LinkLaw:
        """That of a link that is no contact."""
        link = network.links[network.corners[corner]]
        pull, push = map(nearest, link.limits or (fmpq(0), fmpq(0)))
        rest = max(link.friction, link.breakaway)
        of_friction = nearest(link.friction), nearest(rest)
        stiffness, gap, preload = map(nearest, (link.stiffness, link.gap, link.preload))
        dashpot = nearest(link.damping - link.steady_damping)
        row = opening(network, link)
        return cls(corner, row, *of_friction, stiffness, dashpot, link.side, gap, pull, push, preload)

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Between which its pull is."""
        if self.side:
            return (0.0, inf) if self.side > 0 else (-inf, 0.0)
        return (-self.rest, self.rest) if self.friction else (-self.push, self.pull)

    def limit(self, pull: float) -> float:
        """What it pulls where it would pull so much; friction, from rest."""
        least, most = self.limits
        if self.friction and not least <= pull <= most:
            return copysign(self.friction, pull)
        return min(max(pull, least), most)

    def excess(self, longer: float) -> float:
        """How far beyond its gap a spring on one side is that has got so much longer."""
        return self.side * longer - self.gap

    def push_back(self, free: float, compliance: float, step: OneSidedStep) -> tuple[float, float, float]:
        """The mean force of a spring on one side in a step, towards its gap; its slope over `free`; where it acts at.

        With s beyond its gap it is K s + c s' where s > 0: the mean of the second is that of how fast max(s, 0) grows,
        whatever happens within the step. So it never falls as s at the end gets larger, and there is one solution.

        Args:
            free: s at the end of the step without its force, which is less by `compliance` for each unit of force.
            compliance: that.
            step: what its force is made of.
        """
        stiffness, dashpot, before = self.stiffness, self.dashpot / step.length, max(step.before, 0.0)

        def force(end: float) -> float:
            return stiffness * max(step.share * end + step.rest, 0.0) + dashpot * (max(end, 0.0) - before)

        acts, ends = (at + compliance * force(at) < free for at in (-step.rest / step.share, 0.0))
        slope = acts * stiffness * step.share + ends * dashpot
        constant = acts * stiffness * step.rest - dashpot * before
        found = (slope * free + constant) / (1 + compliance * slope)
        return found, slope / (1 + compliance * slope), step.share * (free - compliance * found) + step.rest

    @property
    def first(self) -> int:
        """The branch that it is on at rest: what only touches acts."""
        return int(self.side != 0 and self.gap <= 0)

    def branch(self, pull: float, noise: float, before: int) -> int:
        """Which branch it is on where it would pull so much: 1 where it acts, which way it slides or yields, else 0.

        What no more than touches stays on that of `before`.
        """
        if self.side:
            return before if abs(pull) <= noise else int(self.side * pull > 0)
        least, most = self.limits
        return int(pull > most + noise) - int(pull < least - noise)

    def happens(self, branch: int) -> str:
        """What it does when it comes to a branch."""
        if self.side:
            return "engages" if branch else "releases"
        if self.friction:
            return "slips" if branch else "sticks"
        return "yields" if branch else "holds"


class BranchChange(NamedTuple):
    """A link with a corner goes from one branch to another in a step: 1 is a closed contact, else see `LinkLaw`."""

    corner: int
    before: int
    after: int
    step: int


@dataclass(frozen=True)
class CornerProblem(Problem):
    """A network in which contacts may open and close, and links may have other laws with corners.

    `contacts` are the numbers of the contacts among the links with corners.
    """

    contacts: tuple[int, ...] = ()
    laws: tuple[LinkLaw, ...] = ()

    def happens(self, change: BranchChange) -> str:
        """What a link does when it changes its branch."""
        law = next((law for law in self.laws if law.corner == change.corner), None)
        return ("closes" if change.after else "opens") if law is None else law.happens(change.after)

    @cached_property
    def is_free(self) -> NDArray[np.bool_]:
        """Which points are free to move: (points,)."""
        return np.asarray(~np.isin(np.arange(self.points), self.prescribed_points))

    @cached_property
    def worth(self) -> tuple[float, float]:
        """A displacement and a force that the start and the loads are worth: what is far smaller is noise."""
        longest = float(max(self.delays, default=self.until))
        # what resists: rods, or without any what has mass over all of the time
        resisting = self.impedance if len(self.impedance) else self.mass[self.mass > 0] / longest
        found = [
            *self.velocity,
            *self.start_velocity,
            *(self.speed * self.start_strain),
            *(self.start_slope * self.delay),
        ]
        for event in self.events:
            size = sum(abs(c) * longest**k for k, c in enumerate(event.coefficients))
            found.append(size / float(np.min(resisting)) if self.is_free[event.point] else size)
        pace = float(np.max(np.abs(found))) or 1.0
        return pace * longest, pace * float(np.max(resisting))

    @cached_property
    def swings(self) -> float:
        """How fast masses swing on their springs, at most, roughly; radians per unit of tau."""
        heavy = self.mass > 0
        stiff = np.sum(np.abs(self.stiffness), axis=1)
        return float(np.sqrt(np.max(stiff[heavy] / self.mass[heavy], initial=0.0)))

    def sliding_mass(self, law: LinkLaw) -> float:
        """The mass that a force against its sliding slows down; 0 where a side has none."""
        free = (law.row != 0) & self.is_free
        return float(1 / np.sum(law.row[free] ** 2 / self.mass[free])) if np.all(self.mass[free] > 0) else 0.0

    @cached_property
    def soonest(self) -> float:
        """How soon friction alone would stop what moves at first."""
        stops = [
            self.sliding_mass(law) * abs(law.row @ self.velocity) / law.friction for law in self.laws if law.friction
        ]
        return float(min((stop for stop in stops if stop > 0), default=inf))

    @cached_property
    def groups(self) -> tuple[tuple[int, ...], ...]:
        """The points that springs, dashpots and contacts join, which are solved together."""
        pairs = np.eye(self.points) + (self.damping != 0) + (self.stiffness != 0)
        for row in (*self.parting, *(law.row for law in self.laws)):
            pairs += np.outer(row != 0, row != 0)
        reached = np.linalg.matrix_power(pairs > 0, self.points)
        return tuple(dict.fromkeys(tuple(np.flatnonzero(row).tolist()) for row in reached))

    @cached_property
    def group_of(self) -> dict[int, int]:
        """The number of each point's group."""
        return {point: number for number, group in enumerate(self.groups) for point in group}

    def fronts(self, more: Sequence[tuple[Fraction, int]] = ()) -> Iterator[tuple[Fraction, set[int]]]:
        """When something not smooth may come to points, in the order of time without end, and to which groups.

        It sets out from all points at tau = 0, where loads change, and at the times and points of `more`.
        """
        queue = [(Fraction(0), group) for group in range(len(self.groups))]
        queue += [(event.time, self.group_of[event.point]) for event in self.events]
        queue += [(time, self.group_of[point]) for time, point in more]
        heapify(queue)
        while queue:
            now, here = queue[0][0], set[int]()
            while queue and queue[0][0] == now:
                here.add(heappop(queue)[1])
            yield now, here
            for front in self.onward_arrivals(now, here):
                heappush(queue, front)

    def onward_arrivals(self, now: Fraction, groups: set[int]) -> Iterator[tuple[Fraction, int]]:
        """When what sets out from groups now comes to others."""
        for end, point in enumerate(self.end_points.tolist()):
            if self.group_of[point] in groups:
                yield now + self.delays[end // 2], self.group_of[int(self.end_points[end ^ 1])]


def corner_problem(model: Model) -> CornerProblem:
    """State the problem of a model. UnservedError where modes are damped."""
    model.refuse_damping()
    network = model.network
    contacts = tuple(k for k, number in enumerate(network.corners) if network.links[number].contact)
    laws = tuple(LinkLaw.from_network(network, k) for k in range(len(network.corners)) if k not in contacts)
    return CornerProblem(**vars(network_problem(model)), contacts=contacts, laws=laws)
