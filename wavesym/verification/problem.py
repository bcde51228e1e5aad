"""A network in doubles, as the wave equation in its bars and the balance of forces at its points say it.

In a bar U_tt = speed^2 U_xx, and its force is impedance * speed * U_x. Its end moves `ratio` times as fast as its
point, on which `ratio` times its force acts. At the points, all at once,

    mass u'' + damping u' + stiffness u = sum over ends of ratio * force of the bar + loads.

A contact between two points keeps its gap from being negative; while that is 0 it pushes, and never pulls.

At tau = 0 nothing is displaced: what a bar is strained then is counted besides. Nothing here knows of joints, waves or
their laws. Everything is dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from fractions import Fraction
from functools import cached_property
from heapq import heapify, heappop, heappush
from math import prod

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.model import Model
from wavesym.methods.problem import LOAD_TERMS, Array, Problem, undamped_problem
from wavesym.numbers.doubles import nearest

# so many values of loads are made at once
_AT_ONCE = 1_000_000


@dataclass(frozen=True)
class Change:
    """The contact with this number opens or closes at tau."""

    contact: int
    kind: str
    tau: float


Struck = list[tuple[Change, float]]
"""What happens at contacts in the order of time, and how well it is known when."""


def alike(finer: Sequence[Change], coarser: Sequence[Change]) -> Struck | None:
    """What happens in two solutions, and how far apart in time; None where it is not the same."""
    found: Struck = []
    for contact in {change.contact for change in (*finer, *coarser)}:
        both = [[change for change in changes if change.contact == contact] for changes in (finer, coarser)]
        if [change.kind for change in both[0]] != [change.kind for change in both[1]]:
            return None
        found += [(one, abs(one.tau - other.tau)) for one, other in zip(*both, strict=True)]
    return sorted(found, key=lambda each: (each[0].tau, each[0].contact))


@dataclass(frozen=True)
class ContactProblem(Problem):
    """A network in which contacts may open and close; its outputs are for others (observed.py).

    The gaps of contacts are `gaps` + `parting` @ displacements, (contacts,); their pushes act on points by `parting`
    transposed. End 2 b is the left one of bar b, end 2 b + 1 the right one.
    """

    gaps: Array = field(default_factory=lambda: np.zeros(0))
    parting: Array = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def end_points(self) -> NDArray[np.int_]:
        """The point of each end: (2 bars,)."""
        return self.ends.ravel()

    @property
    def end_ratios(self) -> Array:
        """The ratio of each end: (2 bars,)."""
        return self.ratios.ravel()

    @cached_property
    def is_free(self) -> NDArray[np.bool_]:
        """Which points are free to move: (points,)."""
        return np.asarray(~np.isin(np.arange(self.points), self.prescribed))

    def load_integral(self, times: Array, order: int) -> Array:
        """The loads integrated `order` times from tau = 0 on: shape (points, times)."""
        starts = np.array([[float(event.time)] for event in self.events]).reshape(-1, 1)
        coefficients = np.array([event.coefficients for event in self.events]).reshape(-1, LOAD_TERMS)
        onto = np.arange(self.points)[:, np.newaxis] == [event.point for event in self.events]
        found = []
        for some in np.array_split(times, 1 + len(times) * len(starts) // _AT_ONCE):
            since = some - starts
            values = np.zeros(since.shape)
            for k, c in enumerate(coefficients.T):
                divided = prod(range(k + 1, k + order + 1))
                values += c[:, np.newaxis] / divided * np.maximum(since, 0.0) ** (k + order)
            found.append(onto @ np.where(since >= 0, values, 0.0))
        return np.concatenate(found, axis=1)

    @cached_property
    def worth(self) -> tuple[float, float]:
        """A displacement and a force that the start and the loads are worth: what is far smaller is noise."""
        longest = float(max(self.delays))
        found = [*self.velocity, *self.start_velocity, *(self.speed * self.start_strain)]
        for event in self.events:
            size = sum(abs(c) * longest**k for k, c in enumerate(event.coefficients))
            found.append(size / float(np.min(self.impedance)) if self.is_free[event.point] else size)
        pace = float(np.max(np.abs(found))) or 1.0
        return pace * longest, pace * float(np.max(self.impedance))

    @cached_property
    def swings(self) -> float:
        """How fast masses swing on their springs, at most, roughly; radians per unit of tau."""
        heavy = self.mass > 0
        stiff = np.sum(np.abs(self.stiffness), axis=1)
        return float(np.sqrt(np.max(stiff[heavy] / self.mass[heavy], initial=0.0)))

    @cached_property
    def groups(self) -> tuple[tuple[int, ...], ...]:
        """The points that springs, dashpots and contacts join, which are solved together."""
        pairs = np.eye(self.points) + (self.damping != 0) + (self.stiffness != 0)
        for row in self.parting:
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
            for front in self.sent_on(now, here):
                heappush(queue, front)

    def sent_on(self, now: Fraction, groups: set[int]) -> Iterator[tuple[Fraction, int]]:
        """When what sets out from groups now comes to others."""
        for end, point in enumerate(self.end_points.tolist()):
            if self.group_of[point] in groups:
                yield now + self.delays[end // 2], self.group_of[int(self.end_points[end ^ 1])]

    def carried(self, point: int, *, bars: bool = False, springs: bool = False) -> tuple[Array, Array]:
        """How fast points (points,) and bars (bars,) move with a point of velocity 1, all contacts closed.

        With `bars` these are rigid, with `springs` springs and dashpots are, too. What is not reached has velocity 0.
        """
        points, rods = np.zeros(self.points), np.zeros(len(self.delays))
        held = (self.damping != 0) | (self.stiffness != 0)
        points[point], waiting = 1.0, [point]
        while waiting:
            here = waiting.pop()
            found = [
                (int(o), -row[here] / row[o] * points[here])
                for row in self.parting
                for o in np.flatnonzero(row)
                if row[here] != 0
            ]
            if bars:
                for end in np.flatnonzero(self.end_points == here).tolist():
                    rods[end // 2] = self.end_ratios[end] * points[here]
                    found.append((int(self.end_points[end ^ 1]), rods[end // 2] / self.end_ratios[end ^ 1]))
            if springs:
                found += [(int(other), points[here]) for other in np.flatnonzero(held[here])]
            for other, speed in found:
                if points[other] == 0:
                    points[other] = speed
                    waiting.append(other)
        return points, rods


def problem_of(model: Model) -> ContactProblem:
    """State the network of a model with its loads. UnservedError where modes are damped."""
    network = model.network
    contacts = [link for link in network.links if link.contact]
    parting = np.zeros((len(contacts), len(network.points)))
    for pair, link in zip(parting, contacts, strict=True):
        pair[link.left], pair[link.right] = -nearest(link.ratio), 1.0
    held = replace(network, links=tuple(link for link in network.links if not link.contact))
    stated = undamped_problem(replace(model, network=held))
    same = {each.name: getattr(stated, each.name) for each in fields(stated)}
    return ContactProblem(**same, gaps=np.array([nearest(link.gap) for link in contacts]), parting=parting)
