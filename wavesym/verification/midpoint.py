"""The midpoint rule at points that links with corners join: a complementarity problem in every step.

`wavesym/methods/grid.py` has the steps; what links with corners pull depends on the mean velocities in one
(`link_pulls.py`). Nothing is looked for inside a step, and outputs are read where no front is within one. Errors fall
as its square, and as the step where a law changes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import ceil, inf, lcm
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.grid import Links, MidpointRule, WaveMotion
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import fraction
from wavesym.verification.link_pulls import LinkPulls
from wavesym.verification.problem import BranchChange, Change, CornerProblem, KnownChanges, match_all
from wavesym.verification.stretches import Stretch, stretches, unseen_stretches

Instants = NDArray[np.int_]
L = TypeVar("L", bound=Links)
LinkMethod = Callable[[CornerProblem, Array, float], Links]
"""What links with corners pull, of a problem, from the inverse of a step's matrix and the step."""

_STEPS_WITHOUT_RODS = 64

COARSEST = 16
"""Steps per rod of the coarsest grid, at least."""

LATE = 4
"""What happens at a corner is late by so many steps at most, and what does not last as long did not happen."""

# load times and places with larger denominators than this do not become points of the grid
_FINEST_ALIGNED = 128

# steps before and after an instant that what is read there rests on
_REACH = 1

# of the instants away from fronts, so many are enough to begin with
_FEWEST = 20

# what lasts longer than all of the time over that is seen, if it does not cost more: grids may agree on nothing before
_RESOLVED = 50

# points and instants closer than this are the same, in doubles
_SAME = 1e-6

# what a step costs besides its points, in points
_STEP = 5000


@dataclass(frozen=True)
class MidpointGrid:
    """Steps of tau, which divide all delays. An instant k is tau = k * step."""

    problem: CornerProblem
    step: Fraction
    _seen_branches: dict[tuple[Fraction, float], tuple[BranchChange, ...]] = field(
        default_factory=dict, repr=False, compare=False
    )
    """What happens at corners, by the step and until when: finer grids know what coarser ones found."""

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
        return {event.time % self._period for event in self.problem.events} | {Fraction(0)}

    @property
    def _period(self) -> Fraction:
        """The delays' common measure, after which fronts are where they were; without delays none comes back."""
        return self.problem.measure or 2 * Fraction(self.problem.until)

    def instants(
        self, until: float, struck: Sequence[tuple[Change, float]] = (), reach: int = _REACH
    ) -> list[Instants]:
        """By output those up to `until` at which what it is read from, `reach` steps around it, has no front inside.

        Fronts set out from points at multiples of the delays' common measure after 0, after every load, and after
        what happened at corners: `struck` has when, and how well that is known.
        """
        problem, instants = self.problem, np.arange(1, int(until / float(self.step)))
        offsets = [_offset(problem, reading) for reading in problem.readings]
        free = {offset: self._is_free(instants, offset, struck, reach) for offset in {*offsets}}
        everywhere = np.ones(len(instants), dtype=bool)
        return [
            instants[np.all([everywhere, *(free[offsets[k]] for k in np.flatnonzero(weights))], axis=0)]
            for weights in problem.weights
        ]

    def _is_free(
        self, instants: Instants, offset: Fraction, struck: Sequence[tuple[Change, float]], reach: int
    ) -> NDArray[np.bool_]:
        """At which instants there is no front so long a way from points."""
        step = float(self.step)
        free, window = np.ones(len(instants), dtype=bool), float(self._period / self.step)
        for way in {offset, -offset}:
            for cut in self._cuts:
                passed = (instants - float((cut + way) / self.step) + window / 2) % window - window / 2
                free &= np.abs(passed) > reach - _SAME
            for change, slack in struck:
                passed = instants - (change.tau - slack + way) / step
                after = passed % window
                free &= (passed < -reach) | ((after > reach + 2 * slack / step) & (window - after > reach))
        return free

    def tells(self, until: float, struck: Sequence[tuple[Change, float]], reach: int) -> bool:
        """Whether there are `instants` enough of each output, and some in every stretch between what happens."""
        parts, step = self.stretches(until, struck), float(self.step)
        return all(
            len(each) >= _FEWEST and not unseen_stretches(parts, step * each.astype(np.float64))
            for each in self.instants(until, struck, reach)
        )

    def stretches(self, until: float, struck: Sequence[tuple[Change, float]]) -> list[Stretch]:
        """Those between loads and what happened at corners."""
        loads = [float(event.time) for event in self.problem.events]
        return stretches(until, [*loads, *(change.tau for change, _ in struck)])

    def resolve_changes(
        self, until: float, most: float, sharp: float = inf
    ) -> tuple[MidpointGrid, KnownChanges] | None:
        """The coarsest grid which, halved twice, has the same happen at corners, and that; None if it costs more.

        What lasts less than some steps of the coarsest, which is a fiftieth of the time at most, counts on none. It is
        known when within `sharp` parts of all of the time. Both unless that costs more.
        """
        grid, best = self, None
        while grid.finer(4).cost(until) <= most and until > LATE * float(grid.step):
            known = match_all([grid.finer(k).changes(until, LATE * k) for k in (1, 2, 4)])
            if known is not None:
                late = LATE * float(grid.step) / 4
                best = grid, [(change, slack + late) for change, slack in known]
                resolved = LATE * float(grid.step) <= until / _RESOLVED
                if resolved and all(slack <= sharp * until for _, slack in best[1]):
                    return best
            grid = grid.finer(2)
        return best

    def changes(self, until: float, shortest: int = LATE) -> tuple[Change, ...]:
        """What happens at corners by tau = `until` and stays so for some steps: the rest is what fronts do."""
        if (self.step, until) not in self._seen_branches:
            _, links = self._solve(int(until / float(self.step)) + 2, LinkPulls)
            self._seen_branches[self.step, until] = tuple(links.changes)
        kept: dict[int, list[BranchChange]] = {}
        for change in self._seen_branches[self.step, until]:
            here = kept.setdefault(change.corner, [])
            if here and change.step - here[-1].step < shortest:
                last = here.pop()
                change = change._replace(before=last.before, step=last.step)
            if change.before != change.after:
                here.append(change)
        return tuple(
            Change(corner, self.problem.happens(change), float(change.step * self.step))
            for corner in sorted(kept)
            for change in kept[corner]
        )

    def integrate(self, instants: Instants, method: LinkMethod = LinkPulls) -> tuple[Array, Array]:
        """The readings (readings, instants) at ascending instants off fronts, and what rounding may add to each."""
        motion, _ = self._solve(int(instants[-1]) + 2, method)
        taus: Array = float(self.step) * instants.astype(np.float64)
        values = np.array([motion.evaluate(reading, taus) for reading in self.problem.readings])
        roundoff = np.array([motion.roundoff(reading) for reading in self.problem.readings])
        return values.reshape(-1, len(instants)), roundoff

    def _solve(self, steps: int, method: Callable[[CornerProblem, Array, float], L]) -> tuple[WaveMotion, L]:
        h = float(self.step)
        lags = np.array([min(int(delay / self.step), steps) for delay in self.problem.delays], dtype=int)
        rule = MidpointRule(self.problem, h, steps)
        links = method(self.problem, rule.inverse, h)
        move = rule.nonlinear(links) if len(self.problem.contacts + self.problem.laws) else rule.linear()
        return WaveMotion(self.problem, lags, h, steps, move), links


def _offset(problem: CornerProblem, reading: Gauge) -> Fraction:
    """How long a wave takes from the left end of its bar to where a reading is."""
    return Fraction(0) if reading.point is not None else fraction(reading.place) * problem.delays[reading.rod - 1]
