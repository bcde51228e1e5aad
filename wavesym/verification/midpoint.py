"""Waves by their characteristics, and the implicit midpoint rule at points: a complementarity problem in every step.

Waves are known by their means over steps; a rod sends on what came in as many steps ago as it has cells. With q and u
at the start of a step, v the mean velocity in it and a the means of what arrives,

    (2 mass/h + damping + sum of ratio^2 impedance + stiffness h/2) v
        = 2 mass/h q - stiffness u + sum of 2 ratio impedance a + loads + what links with corners pull,

q goes on to 2 v - q and u to u + h v. What such links pull depends on v: a contact pushes as little as keeps its gap
from being negative, friction takes what keeps its sides together, as much as it can, and springs have the mean of their
pulls at both ends of the step. Each of these is monotone in v, so they are found one after another, again and again.
Nothing is looked for inside a step. Errors fall as its square, and as the step where a law changes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Self

import numpy as np

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.problem import Array
from wavesym.numbers.doubles import UNIT_ROUNDOFF
from wavesym.verification.differences import GridReadings, Instants, SpaceTimeGrid
from wavesym.verification.problem import BranchChange, Change, CornerProblem, KnownChanges, LinkLaw, match_changes

LATE = 4
"""What happens at a corner is late by so many steps at most, and what does not last as long did not happen."""

# pulls of links are found as exactly as this, relative to the largest, in so many rounds
_EXACT, _ROUNDS = 1e-15, 1000

# parts of what pushes and gaps are worth that tell whether a contact is closed
_SIGN = 1e-9

# so many roundings of a step are kept for good
_ROUNDINGS = 8


class MidpointGrid(SpaceTimeGrid):
    """The steps of tau, which divide all delays."""

    def resolve_changes(self, until: float, most: float, sharp: float = inf) -> tuple[Self, KnownChanges] | None:
        """The coarsest grid which, halved twice, has the same happen at corners, and that; None if it costs more.

        It is known when within `sharp` parts of all of the time, if that does not cost more.
        """
        grid, best, found = self, None, list[tuple[Change, ...]]()
        while grid.finer(4).cost(until) <= most and until > LATE * float(grid.step):
            kept = found[1:]
            found = kept + [grid.finer(k).changes(until) for k in (1, 2, 4)[len(kept) :]]
            first, then = match_changes(found[2], found[1]), match_changes(found[1], found[0])
            if first is not None and then is not None:
                known = [after + before for (_, after), (_, before) in zip(first, then, strict=True)]
                late = LATE * float(grid.step) / 4
                best = grid, [(change, each + late) for (change, _), each in zip(first, known, strict=True)]
                if all(slack <= sharp * until for _, slack in best[1]):
                    return best
            grid = grid.finer(2)
        return best

    def changes(self, until: float) -> tuple[Change, ...]:
        """What happens at corners by tau = `until` and stays so for some steps: the rest is what fronts do."""
        kept: dict[int, list[BranchChange]] = {}
        for change in self._motion(int(until / float(self.step)) + 2).changes:
            here = kept.setdefault(change.corner, [])
            if here and change.step - here[-1].step < LATE:
                last = here.pop()
                change = change._replace(before=last.before, step=last.step)
            if change.before != change.after:
                here.append(change)
        return tuple(
            Change(corner, self.problem.happens(change), float(change.step * self.step))
            for corner in sorted(kept)
            for change in kept[corner]
        )

    def integrate(self, instants: Instants) -> GridReadings:
        """The readings at positive instants in ascending order, off fronts."""
        steps = int(instants[-1]) + 2
        motion = self._motion(steps)
        taus: Array = float(self.step) * instants.astype(np.float64)
        values = np.array([motion.evaluate(reading, taus) for reading in self.problem.readings])
        rounded = _ROUNDINGS * float(UNIT_ROUNDOFF) * steps * np.max(np.abs(values), axis=1, initial=0.0)
        return GridReadings(values.reshape(-1, len(instants)), rounded)

    def _motion(self, steps: int) -> _Motion:
        motion = _Motion(self, steps)
        for step in range(steps):
            motion.advance(step)
        return motion


class _Motion:
    """What is sent from the ends of bars, and how points move, step by step."""

    def __init__(self, grid: MidpointGrid, steps: int) -> None:
        problem = self._problem = grid.problem
        h = self._h = float(grid.step)
        times: Array = h * np.arange(steps + 1, dtype=np.float64)
        self._ends, self._middles = times, times[:-1] + h / 2
        self._lags = np.repeat(np.array([int(delay / grid.step) for delay in problem.delays], dtype=int), 2)
        self._beyond = np.arange(2 * len(problem.delays)) ^ 1
        self._sent = np.zeros((steps, 2 * len(problem.delays)))
        self._v, self._u = np.zeros((steps, problem.points)), np.zeros((steps + 1, problem.points))
        self._q = problem.velocity.copy()
        self._loads = problem.load_means(times[:-1], times[1:])
        self._impedance = np.repeat(problem.impedance, 2)
        matrix: Array = np.diag(2 * problem.mass / h + problem.incidence**2 @ self._impedance)
        matrix += problem.damping + h / 2 * problem.stiffness
        prescribed = list(problem.prescribed)
        matrix[prescribed] = np.eye(problem.points)[prescribed]
        self._inverse: Array = np.linalg.inv(matrix).astype(np.float64)
        self._links = _Links(problem, self._inverse, h)
        self.changes = self._links.changes

    def advance(self, step: int) -> None:
        """One step."""
        problem, h, u = self._problem, self._h, self._u[step]
        came = np.where(
            step < self._lags,
            problem.start_waves.ravel()[self._beyond],
            self._sent[np.maximum(step - self._lags, 0), self._beyond],
        )
        acting = 2 * problem.mass / h * self._q - problem.stiffness @ u + self._loads[step]
        acting += 2 * problem.incidence @ (self._impedance * came)
        prescribed = list(problem.prescribed)
        acting[prescribed] = self._loads[step, prescribed]
        v = self._links.settle(self._inverse @ acting, self._q, u, step)
        self._v[step], self._u[step + 1], self._q = v, u + h * v, 2 * v - self._q
        self._sent[step] = problem.incidence.T @ v - came

    def evaluate(self, reading: Gauge, taus: Array) -> Array:
        """A strain, a velocity or a displacement at instants."""
        displaced = reading.quantity == "displacement"
        if reading.point is not None:
            known = (self._ends, self._u) if displaced else (self._middles, self._v)
            return np.interp(taus, known[0], known[1][:, reading.point])
        bar, place = reading.rod - 1, float(reading.place)
        right, left = (
            self._wave(2 * bar + side, taus, float(part * self._problem.delay[bar]), displaced)
            for side, part in enumerate((place, 1 - place))
        )
        return (left - right) / self._problem.speed[bar] if reading.quantity == "strain" else left + right

    def _wave(self, end: int, taus: Array, late: float, summed: bool) -> Array:
        """What was sent from an end so long ago, or its integral from tau = 0."""
        since, start = taus - late, float(self._problem.start_waves.ravel()[end])
        if summed:
            return start * np.minimum(taus, late) + np.interp(since, self._ends, self._sums[:, end])
        return np.where(since < 0, start, np.interp(since, self._middles, self._sent[:, end]))

    @cached_property
    def _sums(self) -> Array:
        """The integrals of what is sent, at the ends of steps."""
        return np.concatenate([np.zeros((1, self._sent.shape[1])), self._h * np.cumsum(self._sent, axis=0)])


@dataclass
class _Spring:
    """A spring with a corner: its pull, what that would be without limits, and its branch."""

    law: LinkLaw
    branch: int
    pull: float = 0.0
    trial: float = 0.0

    def mean(self, rate: float, longer: float, compliance: float, h: float) -> float:
        """Its mean pull in a step, where it gets longer at a `rate` without: less by `compliance` times the pull."""
        law, stiff = self.law, self.law.stiffness * h / 2
        if law.side:
            self.trial = law.stiffness * (longer + h / 2 * rate - law.side * law.gap) / (1 + stiff * compliance)
            return law.limit(self.trial)
        self.trial = 2 * (self.pull + stiff * rate) / (1 + stiff * compliance) - self.pull
        return (self.pull + law.limit(self.trial)) / 2

    def finish(self) -> None:
        """Go on to the next step."""
        self.pull = self.law.limit(self.trial)


@dataclass
class _Friction:
    """What rubs on the ground: its `speed` at the start of a step, 0 where it has no mass, and its branch.

    `inertia` is its mean velocity in a step if nothing but its mass acts, over that speed.
    """

    law: LinkLaw
    branch: int
    inertia: float
    speed: float = 0.0
    trial: float = 0.0

    def mean(self, rate: float, _: float, compliance: float, __: float) -> float:
        """Its mean pull in a step, where it would go at a mean `rate` without: less by `compliance` times the pull.

        What comes to rest and goes back is pulled one way first, and the other way for the rest of the step.
        """
        most, before = self.law.friction, abs(self.speed)
        way = 1.0 if self.speed > 0 else -1.0
        held = (rate - self.inertia * self.speed) / compliance  # what keeps it at rest
        if before == 0:
            self.trial = held
            return self.law.limit(held)
        after = 2 * (way * rate - compliance * most) - before
        self.trial = 2 * most * way
        if after >= 0:
            return most * way
        if abs(held) <= most:
            self.trial = held
            return (rate - self.speed / 2) / compliance
        self.trial = -self.trial
        return most * way * (2 * before / (before - after) - 1)

    def finish(self) -> None:
        """Go on to the next step."""


class _Links:
    """All links with corners: contacts, then others."""

    def __init__(self, problem: CornerProblem, inverse: Array, h: float) -> None:
        self._problem, self._h = problem, h
        self._rows = np.array([*problem.parting, *(law.row for law in problem.laws)]).reshape(-1, problem.points)
        # what is prescribed gives no way
        self._influence = inverse @ (self._rows * problem.is_free).T
        self._compliance = self._rows @ self._influence
        self._pulls = np.zeros(len(self._rows))
        self._laws = [self._link(law, inverse) for law in problem.laws]
        self._open = problem.gaps > 0
        self.changes: list[BranchChange] = []

    def _link(self, law: LinkLaw, inverse: Array) -> _Spring | _Friction:
        if not law.friction:
            return _Spring(law, law.first)
        point = int(np.flatnonzero(law.row * self._problem.is_free)[0])
        inertia = float(inverse[point, point]) * 2 * float(self._problem.mass[point]) / self._h
        return _Friction(law, law.first, inertia)

    def settle(self, free: Array, q: Array, u: Array, step: int) -> Array:
        """The mean velocities of points in a step, from those without links, `free`, and their state before it."""
        if not len(self._rows):
            return free
        for link in self._laws:
            if isinstance(link, _Friction):
                link.speed = float(link.law.row @ (q * (self._problem.mass > 0)))
        rates, longer = self._rows @ free, self._rows @ u
        for _ in range(_ROUNDS):
            before = self._pulls.copy()
            for k in range(len(self._rows)):
                compliance = self._compliance[k, k]
                rate = float(rates[k] - self._compliance[k] @ self._pulls + compliance * self._pulls[k])
                self._pulls[k] = self._mean(k, rate, float(longer[k]), float(compliance))
            if np.max(np.abs(self._pulls - before)) <= _EXACT * np.max(np.abs(self._pulls)):
                break
        v = free - self._influence @ self._pulls
        self._record_branches(longer + self._h * (self._rows @ v), step)
        return np.asarray(v)

    def _mean(self, k: int, rate: float, longer: float, compliance: float) -> float:
        contacts = len(self._problem.gaps)
        if k >= contacts:
            return self._laws[k - contacts].mean(rate, longer, compliance, self._h)
        return min(((float(self._problem.gaps[k]) + longer) / self._h + rate) / compliance, 0.0)

    def _record_branches(self, longer: Array, step: int) -> None:
        """On which branches links are at the end of a step."""
        problem = self._problem
        length, force = problem.worth
        for k, number in enumerate(problem.contacts):
            apart = problem.gaps[k] + longer[k]
            if -self._pulls[k] > _SIGN * force if self._open[k] else apart > _SIGN * length:
                self._open[k] ^= True
                closed = int(not self._open[k])
                self.changes.append(BranchChange(number, 1 - closed, closed, step))
        for moving in self._laws:
            law, before = moving.law, moving.branch
            moving.finish()
            moving.branch = law.branch(moving.trial, _SIGN * force, before)
            if moving.branch != before and step:  # what it is from the start is no event
                self.changes.append(BranchChange(law.corner, before, moving.branch, step))
