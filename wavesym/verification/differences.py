"""Central differences at Courant number 1 over any network of bars, straight from the wave equation: no waves.

`wavesym/methods/differences.py` has the steps. Fronts stay as sharp as they are, so that outputs are read where none is
within a cell: errors are a series in h^2 there.

Contacts push in the mean from t - h to t + h what keeps gaps at t + h from being negative, and only where they are 0:
what opens inside a step is late by a part of it, which counts among what may be wrong. What rubs pulls in the mean
what keeps it from moving, as much as it can; springs with a corner what they do at t, by return mapping.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import ceil, inf, lcm

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.differences import Grid, GridMotion, point_steps
from wavesym.methods.problem import Array
from wavesym.methods.quadrature import lagrange
from wavesym.numbers.doubles import UNIT_ROUNDOFF, fraction
from wavesym.verification.problem import BranchChange, Change, CornerProblem, KnownChanges, LinkLaw, match_changes

Instants = NDArray[np.int_]

_STEPS_WITHOUT_RODS = 64

COARSEST = 16
"""Cells per rod of the coarsest grid, at least."""

LATE = 4
"""What happens at a contact is late by so many steps at most, and what does not last as long did not happen."""

# load times and places with larger denominators than this do not become points of the grid
_FINEST_ALIGNED = 128

# between points of the grid outputs are read off a polynomial through so many
_STENCIL = 6

# a point rounds three sums, a node and what is read off a little more
_ROUNDINGS = 8

# points and instants closer than this are the same, in doubles
_SAME = 1e-6

# what a step costs besides its points, in points
_STEP = 5000

# parts of what pushes and gaps are worth that tell whether a contact is closed, and gaps that are 0
_SIGN, _ROUNDED = 1e-9, 1e-14

Term = tuple[int, int, float]
"""A displacement that a reading is the sum of: steps later (-1, 0, 1), the point, and its weight."""


@dataclass(frozen=True)
class GridReadings:
    """Readings at some instants, (readings, instants), what rounding may have added to each, (readings,);
    and which contacts opened and closed, at the ends of steps."""

    values: Array
    roundoff: Array
    changes: tuple[Change, ...]


@dataclass(frozen=True)
class SpaceTimeGrid:
    """A network whose bars have cells of a step of tau. An instant k is tau = k * step."""

    problem: CornerProblem
    step: Fraction

    @property
    def cells(self) -> int:
        """How many the shortest bar has; all of the time where there is none."""
        return int(min(self.problem.delays, default=Fraction(self.problem.until)) / self.step)

    @property
    def is_aligned(self) -> bool:
        """Whether all loads begin on the grid. All fronts are on it then, and errors are a series in h^2."""
        return all((event.time / self.step).denominator == 1 for event in self.problem.events)

    def finer(self, times: int) -> SpaceTimeGrid:
        """The grid with that many cells for one."""
        return replace(self, step=self.step / times)

    def tau(self, instant: int) -> float:
        """When an instant is."""
        return float(instant * self.step)

    def cost(self, until: float) -> float:
        """What it takes to come to tau = `until`: points moved, roughly."""
        points = float(sum(self.problem.delays) / self.step) + self.problem.points**2
        return until / float(self.step) * (points + _STEP)

    def instants(self, until: float, struck: Sequence[tuple[Change, float]] = ()) -> Instants:
        """Those up to `until` at which what every output is read from has no front inside.

        Fronts set out from points at multiples of the delays' common measure after 0, after every load, and after
        what happened at contacts: `struck` has when, and how well that is known.
        """
        measure, step = self.problem.measure or 2 * Fraction(until), float(self.step)
        cuts = {event.time % measure for event in self.problem.events} | {Fraction(0)}
        reaches = [1 if _is_whole(self._place(reading)) else _STENCIL for reading in self.problem.readings]
        instants = np.arange(1, int(until / step) - max(reaches) + 1)
        free = np.ones(len(instants), dtype=bool)
        window = float(measure / self.step)
        for reading, reach in zip(self.problem.readings, reaches, strict=True):
            bar = reading.rod - 1
            offset = Fraction(0) if reading.point is not None else fraction(reading.place) * self.problem.delays[bar]
            for way in (offset, -offset):
                for cut in cuts:
                    passed = (instants - float((cut + way) / self.step) + window / 2) % window - window / 2
                    free &= np.abs(passed) > reach - _SAME
                for change, slack in struck:
                    passed = instants - (change.tau - slack + way) / step
                    after = passed % window
                    free &= (passed < -reach) | ((after > reach + 2 * slack / step) & (window - after > reach))
        return instants[free]

    def resolve_changes(
        self, until: float, most: float, sharp: float = inf
    ) -> tuple[SpaceTimeGrid, KnownChanges] | None:
        """The coarsest grid which, halved twice, has the same happen at corners, and that; None if it costs more.

        It is known when within `sharp` parts of all of the time, if that does not cost more.
        """
        grid, best = self, None
        while grid.finer(4).cost(until) <= most and until > LATE * float(grid.step):
            last = np.array([int(until / float(grid.step))])
            changes = [grid.finer(k).integrate(k * last).changes for k in (1, 2, 4)]
            first, then = match_changes(changes[2], changes[1]), match_changes(changes[1], changes[0])
            if first is not None and then is not None:
                known = [after + before for (_, after), (_, before) in zip(first, then, strict=True)]
                late = LATE * float(grid.step) / 4
                best = grid, [(change, each + late) for (change, _), each in zip(first, known, strict=True)]
                if all(slack <= sharp * until for _, slack in best[1]):
                    return best
            grid = grid.finer(2)
        return best

    def integrate(self, instants: Instants) -> GridReadings:
        """The readings at positive instants in ascending order. At a front, the mean of what is before and after it."""
        kept = np.unique(np.add.outer(instants, (-1, 0, 1)))
        terms = [list(self._terms(reading)) for reading in self.problem.readings]
        places = np.unique([place for some in terms for _, place, _ in some])
        history = np.zeros((len(kept), len(places)))
        motion, row, largest = _ContactMotion(self, int(instants[-1]) + 3), 0, 0.0
        for step in range(int(instants[-1]) + 2):
            if step == kept[row]:
                history[row] = motion.now[places]
                largest = max(largest, float(np.max(np.abs(motion.now))))
                row += 1
            motion.advance()
        values = np.zeros((len(self.problem.readings), len(instants)))
        rows = np.searchsorted(kept, instants)
        for reading, value, some in zip(self.problem.readings, values, terms, strict=True):
            value += self.problem.start_strain[reading.rod - 1] if reading.quantity == "strain" else 0.0
            for later, place, weight in some:
                value += weight * history[rows + later, np.searchsorted(places, place)]
        unsure = largest * self._roundoff(int(instants[-1])) + motion.missed * self._impulse_effects
        return GridReadings(values, unsure, tuple(self.lasting(motion.changes)))

    @cached_property
    def _impulse_effects(self) -> Array:
        """What an impulse at a corner changes of the readings, at most: rods' ends move, masses are faster."""
        impedance, heavy = self.problem.impedance, self.problem.mass[self.problem.mass > 0]
        slowest, lightest = float(np.min(self.problem.speed)), float(np.min(heavy, initial=np.inf))
        most = {
            "displacement": 1 / float(np.min(impedance)),
            "velocity": 1 / lightest,
            "acceleration": 0.0,  # none is read where contacts are
            "strain": 1 / lightest / slowest,
        }
        return np.array([most[reading.quantity] for reading in self.problem.readings])

    def lasting(self, changes: Sequence[BranchChange]) -> Iterator[Change]:
        """What happened at corners and stayed so for some steps: the rest is what fronts between instants do."""
        kept: dict[int, list[BranchChange]] = {}
        for change in changes:
            here = kept.setdefault(change.corner, [])
            if here and change.step - here[-1].step < LATE:
                last = here.pop()
                change = change._replace(before=last.before, step=last.step)
            if change.before != change.after:
                here.append(change)
        for corner in sorted(kept):
            for change in kept[corner]:
                yield Change(corner, self.problem.happens(change), float(change.step * self.step))

    def _roundoff(self, steps: int) -> Array:
        """What rounding adds to the readings for displacements of 1, at most.

        What is rounded at a point goes on as a displacement of every second point between two fronts (and no node
        amplifies it): a displacement sees all those of its past, a difference those on whose fronts it lies.
        """
        slope = steps / float(self.step)
        sizes = {
            "displacement": float(steps * steps),
            "velocity": slope,
            "acceleration": 4 * steps / float(self.step) ** 2,
        }
        speed, readings = self.problem.speed, self.problem.readings
        found = [sizes.get(reading.quantity, slope / speed[reading.rod - 1]) for reading in readings]
        return _ROUNDINGS * float(UNIT_ROUNDOFF) * np.array(found)

    @cached_property
    def field(self) -> Grid:
        """The field of all bars and points."""
        counts = np.array([int(delay / self.step) for delay in self.problem.delays])
        return Grid(self.problem, counts, float(self.step))

    def _place(self, reading: Gauge) -> float:
        """Where a reading is, in cells from the left end of its bar."""
        if reading.point is not None:
            return 0.0
        return float(fraction(reading.place) * self.problem.delays[reading.rod - 1] / self.step)

    def _terms(self, reading: Gauge) -> Iterator[Term]:
        """What a reading is the sum of, but the strain at the start."""
        half = 1 / (2 * float(self.step))
        bar, place = reading.rod - 1, self._place(reading)
        cells, first = int(self.field.cells[bar]), int(self.field.ends[2 * bar])
        if reading.point is not None:
            cells, first = 1, int(self.field.points[reading.point])
        slope = half / self.problem.speed[bar]
        for j, weight in _interpolation(place, cells):
            match reading.quantity:
                case "displacement":
                    terms = [(0, j, 1.0)]
                case "velocity":
                    terms = [(1, j, half), (-1, j, -half)]
                case "acceleration":
                    bent = 1 / float(self.step) ** 2
                    terms = [(1, j, bent), (0, j, -2 * bent), (-1, j, bent)]
                case _ if j in (0, cells):  # the end itself is where it is between two steps
                    out = 1 if j == 0 else -1
                    terms = [(0, j + out, out * 2 * slope), (1, j, -out * slope), (-1, j, -out * slope)]
                case _:
                    terms = [(0, j + 1, slope), (0, j - 1, -slope)]
            yield from ((later, first + k, weight * factor) for later, k, factor in terms)


def coarsest_grid(problem: CornerProblem, until: Fraction, kind: type[SpaceTimeGrid] = SpaceTimeGrid) -> SpaceTimeGrid:
    """The coarsest grid of a kind: loads and readings are on it where their denominators are small."""
    if not problem.delays:
        return kind(problem, until / _STEPS_WITHOUT_RODS)
    measure, common = problem.measure, 1
    offsets = [fraction(each.place) * problem.delays[each.rod - 1] for each in problem.readings if each.point is None]
    for time in (*(event.time for event in problem.events), *offsets):
        if lcm(common, (time / measure).denominator) <= _FINEST_ALIGNED:
            common = lcm(common, (time / measure).denominator)
    shortest = min(*problem.delays, until)
    return kind(problem, measure / common / ceil(COARSEST * measure / common / shortest))


class _ContactMotion(GridMotion):
    """The displacements of all bars and points where contacts open and close, and when these did."""

    def __init__(self, grid: SpaceTimeGrid, steps: int) -> None:
        super().__init__(grid.field, point_steps(grid.problem, float(grid.step), steps))
        problem = self._problem = grid.problem
        self._h = float(grid.step)
        self._open = problem.gaps > 0
        self._pushed = np.zeros((LATE, len(problem.gaps)))
        self._longer, self._pulls = np.zeros(len(problem.laws)), np.zeros(len(problem.laws))
        self._branches = [law.first for law in problem.laws]
        self.changes: list[BranchChange] = []
        self.missed = 0.0

    def settle(self, after: Array, influence: Array) -> Array:
        """Displacements with what links with corners pull and push."""
        for number, law in enumerate(self._problem.laws):
            after -= influence @ law.row * self._pull(number, law, after, influence)
        return self._separate(after, influence) if len(self._problem.gaps) else after

    def _pull(self, number: int, law: LinkLaw, after: Array, influence: Array) -> float:
        """What a link pulls: of friction what keeps it from moving, as much as it can."""
        if law.friction:
            pull = float(law.row @ (after - self._before) / (law.row @ influence @ law.row))
        else:
            longer = float(law.row @ self._u)
            since = law.side * law.gap if law.side else self._longer[number]
            pull = law.stiffness * (longer - since) + (0.0 if law.side else self._pulls[number])
            self._longer[number], self._pulls[number] = longer, law.limit(pull)
        before = self._branches[number]
        branch = self._branches[number] = law.branch(pull, _SIGN * self._problem.worth[1], before)
        if branch != before and self.step > 2:  # what it is from the start is no event
            self.changes.append(BranchChange(law.corner, before, branch, self.step))
            self.missed += 2 * self._h * law.friction  # it may turn inside the step
        return law.limit(pull)

    def _separate(self, after: Array, influence: Array) -> Array:
        """Displacements with what contacts push: as little as keeps every gap from being negative."""
        problem, parting = self._problem, self._problem.parting
        gaps = problem.gaps + parting @ after
        length, force = problem.worth
        pushes = np.zeros(len(gaps))
        yields = parting @ influence @ parting.T
        pushing = np.zeros(len(gaps), dtype=bool)
        while len(wrong := np.flatnonzero(np.where(pushing, pushes < 0, gaps + yields @ pushes < -_ROUNDED * length))):
            pushing[wrong[0]] ^= True  # the first of all: this comes to an end
            pushes = np.zeros(len(gaps))
            pushes[pushing] = np.linalg.solve(yields[np.ix_(pushing, pushing)], -gaps[pushing])
        after += influence @ parting.T @ pushes
        gaps += yields @ pushes
        for contact in np.flatnonzero(np.where(self._open, pushes > _SIGN * force, gaps > _SIGN * length)).tolist():
            self._open[contact] ^= True
            self.missed += 2 * self._h * float(np.max(self._pushed[:, contact]))
            closed = int(not self._open[contact])
            self.changes.append(BranchChange(problem.contacts[contact], 1 - closed, closed, self.step))
        self._pushed[self.step % LATE] = pushes
        return after


def _interpolation(place: float, cells: int) -> Iterator[tuple[int, float]]:
    """Points of a rod, and the weights with which they stand for a place between them."""
    if _is_whole(place):
        yield round(place), 1.0
        return
    first = min(max(int(place) - _STENCIL // 2 + 1, 0), cells + 1 - _STENCIL)
    yield from enumerate(lagrange(np.array([place]), first, _STENCIL)[0].tolist(), first)


def _is_whole(place: float) -> bool:
    return abs(place - round(place)) < _SAME
