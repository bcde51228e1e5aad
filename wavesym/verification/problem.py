"""The problem of a network with all that integrators ask of it: when fronts may come where, and what is noise."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from heapq import heapify, heappop, heappush

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.model import Model
from wavesym.methods.network_problem import network_problem
from wavesym.methods.problem import Problem


@dataclass(frozen=True)
class Change:
    """The contact with this number opens or closes at tau."""

    contact: int
    kind: str
    tau: float


KnownChanges = list[tuple[Change, float]]
"""What happens at contacts in the order of time, and how well it is known when."""


def match_changes(finer: Sequence[Change], coarser: Sequence[Change]) -> KnownChanges | None:
    """What happens in two solutions, and how far apart in time; None where it is not the same."""
    found: KnownChanges = []
    for contact in {change.contact for change in (*finer, *coarser)}:
        both = [[change for change in changes if change.contact == contact] for changes in (finer, coarser)]
        if [change.kind for change in both[0]] != [change.kind for change in both[1]]:
            return None
        found += [(one, abs(one.tau - other.tau)) for one, other in zip(*both, strict=True)]
    return sorted(found, key=lambda each: (each[0].tau, each[0].contact))


@dataclass(frozen=True)
class ContactProblem(Problem):
    """A network in which contacts may open and close."""

    @cached_property
    def is_free(self) -> NDArray[np.bool_]:
        """Which points are free to move: (points,)."""
        return np.asarray(~np.isin(np.arange(self.points), self.prescribed))

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
            for front in self.onward_arrivals(now, here):
                heappush(queue, front)

    def onward_arrivals(self, now: Fraction, groups: set[int]) -> Iterator[tuple[Fraction, int]]:
        """When what sets out from groups now comes to others."""
        for end, point in enumerate(self.end_points.tolist()):
            if self.group_of[point] in groups:
                yield now + self.delays[end // 2], self.group_of[int(self.end_points[end ^ 1])]


def problem_of(model: Model) -> ContactProblem:
    """State the problem of a model. UnservedError where modes are damped."""
    model.refuse_damping()
    return network_problem(model, ContactProblem)
