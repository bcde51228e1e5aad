"""Central differences at Courant number 1 over any network of bars, straight from the wave equation: no waves.

`wavesym/methods/differences.py` has the steps. Fronts stay as sharp as they are, so that outputs are read where none is
within a cell: errors are a series in h^2 there.

Links have no corners here: `midpoint.py` steps where they have.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import ceil, lcm
from typing import Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.differences import Grid, GridMotion, point_steps
from wavesym.methods.problem import Array
from wavesym.methods.quadrature import lagrange
from wavesym.numbers.doubles import UNIT_ROUNDOFF, fraction
from wavesym.verification.problem import Change, CornerProblem

Instants = NDArray[np.int_]

_STEPS_WITHOUT_RODS = 64

COARSEST = 16
"""Cells per rod of the coarsest grid, at least."""

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

Term = tuple[int, int, float]
"""A displacement that a reading is the sum of: steps later (-1, 0, 1), the point, and its weight."""


@dataclass(frozen=True)
class GridReadings:
    """Readings at some instants, (readings, instants), and what rounding may have added to each, (readings,)."""

    values: Array
    roundoff: Array


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

    def finer(self, times: int) -> Self:
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

    def integrate(self, instants: Instants) -> GridReadings:
        """The readings at positive instants in ascending order. At a front, the mean of what is before and after it."""
        kept = np.unique(np.add.outer(instants, (-1, 0, 1)))
        terms = [list(self._terms(reading)) for reading in self.problem.readings]
        places = np.unique([place for some in terms for _, place, _ in some])
        history = np.zeros((len(kept), len(places)))
        points = point_steps(self.problem, float(self.step), int(instants[-1]) + 3)
        motion, row, largest = GridMotion(self.field, points), 0, 0.0
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
        return GridReadings(values, largest * self._roundoff(int(instants[-1])))

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


SomeGrid = TypeVar("SomeGrid", bound=SpaceTimeGrid)


def coarsest_grid(problem: CornerProblem, until: Fraction, kind: type[SomeGrid]) -> SomeGrid:
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


def _interpolation(place: float, cells: int) -> Iterator[tuple[int, float]]:
    """Points of a rod, and the weights with which they stand for a place between them."""
    if _is_whole(place):
        yield round(place), 1.0
        return
    first = min(max(int(place) - _STENCIL // 2 + 1, 0), cells + 1 - _STENCIL)
    yield from enumerate(lagrange(np.array([place]), first, _STENCIL)[0].tolist(), first)


def _is_whole(place: float) -> bool:
    return abs(place - round(place)) < _SAME
