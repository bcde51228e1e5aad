"""Waves by their characteristics, and the implicit midpoint rule at points: a complementarity problem in every step.

Waves are known by their means over steps; a rod sends on what came in as many steps ago as it has cells. With q and u
at the start of a step, v the mean velocity in it and a the means of what arrives,

    (2 mass/h + damping + sum of ratio^2 impedance + stiffness h/2) v
        = 2 mass/h q - stiffness u + sum of 2 ratio impedance a + loads + what links with corners pull,

q goes on to 2 v - q and u to u + h v. What links with corners pull depends on v (`link_pulls.py`). Nothing is looked
for inside a step, and outputs are read where no front is within one. Errors fall as its square, and as the step where a
law changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import ceil, inf, lcm

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.gauge import Gauge
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import UNIT_ROUNDOFF, fraction
from wavesym.verification.link_pulls import LinkPulls
from wavesym.verification.problem import BranchChange, Change, CornerProblem, KnownChanges, match_all

Instants = NDArray[np.int_]

_STEPS_WITHOUT_RODS = 64

COARSEST = 16
"""Steps per rod of the coarsest grid, at least."""

LATE = 4
"""What happens at a corner is late by so many steps at most, and what does not last as long did not happen."""

# load times and places with larger denominators than this do not become points of the grid
_FINEST_ALIGNED = 128

# steps before and after an instant that what is read there rests on
_REACH = 1

# so many roundings of a step are kept for good
_ROUNDINGS = 8

# points and instants closer than this are the same, in doubles
_SAME = 1e-6

# what a step costs besides its points, in points
_STEP = 5000


@dataclass(frozen=True)
class MidpointGrid:
    """Steps of tau, which divide all delays. An instant k is tau = k * step."""

    problem: CornerProblem
    step: Fraction

    @classmethod
    def coarsest(cls, problem: CornerProblem, until: Fraction) -> MidpointGrid:
        """The coarsest one: loads and readings are on it where their denominators are small."""
        if not problem.delays:
            return cls(problem, until / _STEPS_WITHOUT_RODS)
        measure, common = problem.measure, 1
        offsets = [_offset(problem, reading) for reading in problem.readings]
        for time in (*(event.time for event in problem.events), *offsets):
            if lcm(common, (time / measure).denominator) <= _FINEST_ALIGNED:
                common = lcm(common, (time / measure).denominator)
        shortest = min(*problem.delays, until)
        return cls(problem, measure / common / ceil(COARSEST * measure / common / shortest))

    @property
    def cells(self) -> int:
        """How many steps a wave takes through the shortest bar; all of the time where there is none."""
        return int(min(self.problem.delays, default=Fraction(self.problem.until)) / self.step)

    @property
    def is_aligned(self) -> bool:
        """Whether all loads begin on the grid, and all is read there: errors are a series in h^2 then."""
        times = [event.time for event in self.problem.events]
        times += [_offset(self.problem, reading) for reading in self.problem.readings]
        return all((time / self.step).denominator == 1 for time in times)

    def finer(self, times: int) -> MidpointGrid:
        """The grid with that many steps for one."""
        return replace(self, step=self.step / times)

    def tau(self, instant: int) -> float:
        """When an instant is."""
        return float(instant * self.step)

    def cost(self, until: float) -> float:
        """What it takes to come to tau = `until`: points moved, roughly."""
        return until / float(self.step) * (len(self.problem.delays) + self.problem.points**2 + _STEP)

    def front_offset(self, events: Sequence[float]) -> float:
        """By how much fronts of loads and events miss instants in all, where finer grids miss them alike."""
        step, times = float(self.step), [*map(float, self._cuts), *events]
        return sum(each for each in (abs(time - step * round(time / step)) for time in times) if each < step / 4)

    @property
    def _cuts(self) -> set[Fraction]:
        """When fronts set out from points: at multiples of the delays' common measure after these."""
        measure = self.problem.measure or 2 * Fraction(self.problem.until)
        return {event.time % measure for event in self.problem.events} | {Fraction(0)}

    def instants(self, until: float, struck: Sequence[tuple[Change, float]] = (), reach: int = _REACH) -> Instants:
        """Those up to `until` at which what every output is read from, `reach` steps around it, has no front inside.

        Fronts set out from points at multiples of the delays' common measure after 0, after every load, and after
        what happened at corners: `struck` has when, and how well that is known.
        """
        measure, step = self.problem.measure or 2 * Fraction(until), float(self.step)
        instants = np.arange(1, int(until / step))
        free = np.ones(len(instants), dtype=bool)
        window = float(measure / self.step)
        for reading in self.problem.readings:
            offset = _offset(self.problem, reading)
            for way in (offset, -offset):
                for cut in self._cuts:
                    passed = (instants - float((cut + way) / self.step) + window / 2) % window - window / 2
                    free &= np.abs(passed) > reach - _SAME
                for change, slack in struck:
                    passed = instants - (change.tau - slack + way) / step
                    after = passed % window
                    free &= (passed < -reach) | ((after > reach + 2 * slack / step) & (window - after > reach))
        return instants[free]

    def resolve_changes(
        self, until: float, most: float, sharp: float = inf
    ) -> tuple[MidpointGrid, KnownChanges] | None:
        """The coarsest grid which, halved twice, has the same happen at corners, and that; None if it costs more.

        It is known when within `sharp` parts of all of the time, if that does not cost more.
        """
        grid, best, found = self, None, list[tuple[Change, ...]]()
        while grid.finer(4).cost(until) <= most and until > LATE * float(grid.step):
            kept = found[1:]
            found = kept + [grid.finer(k).changes(until) for k in (1, 2, 4)[len(kept) :]]
            known = match_all(found)
            if known is not None:
                late = LATE * float(grid.step) / 4
                best = grid, [(change, slack + late) for change, slack in known]
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
            Change(corner, self.problem.happens(change), float(change.step * self.step), change.faint)
            for corner in sorted(kept)
            for change in kept[corner]
        )

    def integrate(self, instants: Instants) -> tuple[Array, Array]:
        """The readings (readings, instants) at ascending instants off fronts, and what rounding may add to each."""
        motion = self._motion(int(instants[-1]) + 2)
        taus: Array = float(self.step) * instants.astype(np.float64)
        values = np.array([motion.evaluate(reading, taus) for reading in self.problem.readings])
        roundoff = np.array([motion.roundoff(reading) for reading in self.problem.readings])
        return values.reshape(-1, len(instants)), roundoff

    def _motion(self, steps: int) -> _Motion:
        motion = _Motion(self, steps)
        for step in range(steps):
            motion.advance(step)
        return motion


def _offset(problem: CornerProblem, reading: Gauge) -> Fraction:
    """How long a wave takes from the left end of its bar to where a reading is."""
    return Fraction(0) if reading.point is not None else fraction(reading.place) * problem.delays[reading.rod - 1]


class _Motion:
    """What is sent from the ends of bars, with the velocities of points behind that, step by step."""

    def __init__(self, grid: MidpointGrid, steps: int) -> None:
        problem = self._problem = grid.problem
        h = self._h = float(grid.step)
        times: Array = h * np.arange(steps + 1, dtype=np.float64)
        self._ends, self._middles = times, times[:-1] + h / 2
        self._lags = np.repeat(np.array([int(delay / grid.step) for delay in problem.delays], dtype=int), 2)
        self._late, self._slopes = np.repeat(problem.delay, 2), np.repeat(problem.start_slope, 2)
        self._slowest = max(self._lags, default=0)
        self._beyond = np.arange(2 * len(problem.delays)) ^ 1
        self._start_waves = problem.start_waves.ravel()[self._beyond]
        self._inertia, self._incidence = 2 * problem.mass / h, 2 * problem.incidence
        self._sent = np.zeros((steps, 2 * len(problem.delays) + problem.points))
        self._u, self._q = np.zeros(problem.points), problem.velocity.copy()
        self._loads = problem.load_means(times[:-1], times[1:])
        self._begun = problem.loads(times[:-1])
        self._impedance = np.repeat(problem.impedance, 2)
        matrix: Array = np.diag(2 * problem.mass / h + problem.incidence**2 @ self._impedance)
        matrix += problem.damping + h / 2 * problem.stiffness
        self._prescribed = list(problem.prescribed_points)
        matrix[self._prescribed] = np.eye(problem.points)[self._prescribed]
        self._inverse: Array = np.linalg.inv(matrix).astype(np.float64)
        self._links = LinkPulls(problem, self._inverse, h)
        self.changes = self._links.changes

    def advance(self, step: int) -> None:
        """One step."""
        problem, h, u = self._problem, self._h, self._u
        came: Array = self._sent[np.maximum(step - self._lags, 0), self._beyond]
        if step < self._slowest:
            at_start = self._start_waves + self._slopes * ((step + 0.5) * h - self._late / 2)
            came = np.where(step < self._lags, at_start, came)
        acting = self._inertia * self._q - problem.stiffness @ u + self._loads[step]
        acting += self._incidence @ (self._impedance * came)
        if prescribed := self._prescribed:
            acting[prescribed] = self._loads[step, prescribed]
            self._q[prescribed] = self._begun[prescribed, step]  # it may jump there
        v = self._links.settle(self._inverse @ acting, self._q, u, step)
        self._u, self._q = u + h * v, 2 * v - self._q
        self._sent[step, : len(came)] = problem.incidence.T @ v - came
        self._sent[step, len(came) :] = v

    def evaluate(self, reading: Gauge, taus: Array) -> Array:
        """A strain, a velocity, a displacement or an acceleration at instants."""
        waves = self._problem.waves(reading)
        parts = [weight * self._wave(end, taus, float(late), reading.order) for end, weight, late in waves]
        return np.asarray(np.sum(parts, axis=0))

    def roundoff(self, reading: Gauge) -> float:
        """What rounding may have added to a reading: it adds up over steps, and no point amplifies it."""
        largest = float(np.max(np.abs(self._sent), initial=0.0))
        scale = {-1: float(self._ends[-1]), 0: 1.0, 1: 2 / self._h}[reading.order]
        slow = float(self._problem.speed[reading.rod - 1]) if reading.quantity == "strain" else 1.0
        return _ROUNDINGS * float(UNIT_ROUNDOFF) * len(self._sent) * largest * scale / slow

    def _wave(self, end: int, taus: Array, late: float, order: int) -> Array:
        """What was sent from an end so long ago, its derivative (`order` 1), or its integral from tau = 0 (-1)."""
        times = {-1: self._ends, 0: self._middles, 1: self._ends[1:-1]}[order]
        known = {-1: self._sums, 0: self._sent, 1: np.diff(self._sent, axis=0) / self._h}[order]
        found, held = np.interp(taus - late, times, known[:, end]), self._problem.held_part(end, taus, late, order)
        return held + found if order < 0 else np.where(taus < late, held, found)

    @cached_property
    def _sums(self) -> Array:
        """The integrals of what is sent, at the ends of steps."""
        return np.concatenate([np.zeros((1, self._sent.shape[1])), self._h * np.cumsum(self._sent, axis=0)])
