"""The midpoint rule at points that links with corners join: a complementarity problem in every step.

`wavesym/methods/grid.py` has the steps; what links with corners pull depends on the mean velocities in one
(`link_pulls.py`). Nothing is looked for inside a step, and outputs are read where no front is within one. Errors fall
as its square, and as the step where a law changes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
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

# of the instants away from fronts, so many are enough to begin with, and so many in the last quarter of the time
_FEWEST, _FEWEST_LATE = 20, 5

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

    def tells(self, until: float, struck: Sequence[tuple[Change, float]], reach: int) -> bool:
        """Whether there are `instants` enough, and some of them late."""
        instants = self.instants(until, struck, reach)
        late = int(np.count_nonzero(instants * float(self.step) > 3 / 4 * until))
        return len(instants) >= _FEWEST and late >= _FEWEST_LATE

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
        _, links = self._solve(int(until / float(self.step)) + 2, LinkPulls)
        kept: dict[int, list[BranchChange]] = {}
        for change in links.changes:
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

    def integrate(self, instants: Instants, method: LinkMethod = LinkPulls) -> tuple[Array, Array]:
        """The readings (readings, instants) at ascending instants off fronts, and what rounding may add to each."""
        motion, _ = self._solve(int(instants[-1]) + 2, method)
        taus: Array = float(self.step) * instants.astype(np.float64)
        values = np.array([motion.evaluate(reading, taus) for reading in self.problem.readings])
        roundoff = np.array([motion.roundoff(reading) for reading in self.problem.readings])
        return values.reshape(-1, len(instants)), roundoff

    def _solve(self, steps: int, method: Callable[[CornerProblem, Array, float], L]) -> tuple[WaveMotion, L]:
        h, lags = float(self.step), np.array([int(delay / self.step) for delay in self.problem.delays], dtype=int)
        rule = MidpointRule(self.problem, h, steps)
        links = method(self.problem, rule.inverse, h)
        move = rule.nonlinear(links) if len(self.problem.contacts + self.problem.laws) else rule.linear()
        return WaveMotion(self.problem, lags, h, steps, move), links


def _offset(problem: CornerProblem, reading: Gauge) -> Fraction:
    """How long a wave takes from the left end of its bar to where a reading is."""
    return Fraction(0) if reading.point is not None else fraction(reading.place) * problem.delays[reading.rod - 1]
