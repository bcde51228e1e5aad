"""Central differences in space and time at Courant number 1, straight from (2.1)-(2.4): displacements, and no waves.

A rod is N cells of length h, and a step of tau is as long. Inside a rod (2.1) becomes

    U(x, t + h) = U(x + h, t) + U(x - h, t) - U(x, t - h),

which at Courant number 1 is no approximation: fronts stay as sharp as they are. A node carries half a cell of each of
its rods, so that (2.4) becomes

    (inertia + (alpha + beta) h/4) (U+ - 2 U + U-)/h^2 + damping (U+ - U-)/(2 h)
        = (beta/2) (U_right - U)/h - (alpha/2) (U - U_left)/h + the loads' mean from t - h to t + h,

of order 2. The mean is what keeps a force on a node without mass exact. Before tau = 0 all moves at the velocities of
(2.2), without loads. Strains and velocities are central differences too, at the end of a rod with the point beyond it
that (2.1) asks for. They see h to either side, and so nothing of a front that passes at t - h or t + h.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import ceil, lcm

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import UNIT_ROUNDOFF
from wavesym.rivals.line import stated
from wavesym.rivals.problem import Array, Problem, Watch

Instants = NDArray[np.int_]

COARSEST = 16
"""Cells per rod of the coarsest grid, at least."""

# load times and places with larger denominators than this do not become points of the grid
FINEST_ALIGNED = 128

# between points of the grid outputs are read off a polynomial through so many
STENCIL = 6

# what a step costs besides its points, and besides a load's, in points
_STEP, _EVENT = 5000, 20

# a point rounds three sums, a node and what is read off a little more
ROUNDINGS = 8


@dataclass(frozen=True)
class Displaced:
    """The outputs at the instants asked for, shape (outputs, instants), and what rounding may have added to each."""

    values: Array
    roundoff: Array


@dataclass(frozen=True)
class SpaceTimeGrid:
    """A problem on rods of `cells` cells each. An instant k is tau = k / cells. Everything is dimensionless."""

    problem: Problem
    cells: int

    @property
    def aligned(self) -> bool:
        """Whether all loads begin on the grid. All fronts are on it then, and errors are a series in h^2."""
        return all(whole(float(cut) * self.cells) for cut in self.problem.cuts)

    def finer(self, times: int) -> SpaceTimeGrid:
        """The grid with that many cells for one."""
        return SpaceTimeGrid(self.problem, self.cells * times)

    def tau(self, instant: int) -> float:
        """When an instant is."""
        return instant / self.cells

    def cost(self, until: float) -> float:
        """What it takes to come to tau = `until`: points moved, roughly."""
        step = self.problem.nodes * self.cells + _STEP + _EVENT * len(self.problem.events)
        return until * self.cells * step

    def instants(self, until: float) -> Instants:
        """Those up to `until` at which what every output is read from has no front inside."""
        # one step around an output on the grid, as far as the polynomial may reach around others
        reaches = [1 if whole(watch.offset * self.cells) else STENCIL for watch in self.problem.watches]
        instants = np.arange(1, int(until * self.cells) - max(reaches) + 1)
        free = np.ones(len(instants), dtype=bool)
        for watch, reach in zip(self.problem.watches, reaches, strict=True):
            for cut in self.problem.cuts:
                for way in (watch.offset, -watch.offset):
                    passed = (instants / self.cells - float(cut) - way + 0.5) % 1 - 0.5
                    free &= np.abs(passed) * self.cells > reach - SAME
        return instants[free]

    def integrate(self, instants: Instants) -> Displaced:
        """The outputs at positive instants in ascending order. At a front, the mean of what is before and after it."""
        h = 1.0 / self.cells
        times = h * np.arange(instants[-1] + 2)
        loads = self.problem.load_mean(times - h, times + h)
        kept = np.unique(np.add.outer(instants, (-1, 0, 1)))
        history = np.empty((len(kept), len(self._points)))
        largest = 0.0
        before, now = -h * self._velocity, np.zeros_like(self._velocity)
        row = 0
        for step, load in enumerate(loads):
            if step == kept[row]:
                history[row] = now[self._points]
                largest = max(largest, float(np.max(np.abs(now))))
                row += 1
            after = np.empty_like(now)
            after[1:-1] = now[2:] + now[:-2] - before[1:-1]
            after[:: self.cells] = self._nodes.moved(before, now, load)
            before, now = now, after
        values = np.zeros((len(self._terms), len(instants)))
        rows = np.searchsorted(kept, instants)
        for output, terms in zip(values, self._terms, strict=True):
            for later, point, weight in terms:
                output += weight * history[rows + later, np.searchsorted(self._points, point)]
        return Displaced(values, largest * self._roundoff(int(instants[-1])))

    def _roundoff(self, steps: int) -> Array:
        """What rounding adds to the outputs for displacements of 1, at most.

        What is rounded at a point goes on as a displacement of every second point between two fronts (and no node
        amplifies it): a displacement sees all those of its past, a difference those on whose fronts it lies.
        """
        seen = {"displacement": steps * steps, "velocity": steps * self.cells, "strain": steps * self.cells}
        unit = ROUNDINGS * float(UNIT_ROUNDOFF)
        return np.array([unit * seen[watch.quantity] for watch in self.problem.watches])

    @cached_property
    def _nodes(self) -> _Nodes:
        return _Nodes(self.problem, self.cells)

    @cached_property
    def _velocity(self) -> Array:
        """The velocities of all points before tau = 0."""
        field = np.append(np.repeat(self.problem.rods, self.cells), 0.0)
        field[:: self.cells] = self.problem.velocity
        return field

    @cached_property
    def _terms(self) -> list[list[Term]]:
        return [list(_terms(watch, self.cells)) for watch in self.problem.watches]

    @cached_property
    def _points(self) -> NDArray[np.int_]:
        """The points that outputs are read from."""
        return np.unique([point for terms in self._terms for _, point, _ in terms])


def grid(model: Model) -> SpaceTimeGrid:
    """The coarsest grid for a model: its loads and outputs are on it where their denominators are small."""
    common = 1
    for place in (*(load.time for load in model.loads), *(reading.x for reading in model.watched)):
        if lcm(common, int(place.q)) <= FINEST_ALIGNED:
            common = lcm(common, int(place.q))
    fewest = max(COARSEST, int((COARSEST / min(fmpq(1), model.until)).ceil()))
    return SpaceTimeGrid(stated(model), common * ceil(fewest / common))


class _Nodes:
    """The conditions at the nodes, solved for the displacements one step later."""

    def __init__(self, problem: Problem, cells: int) -> None:
        h = 1.0 / cells
        mass = problem.inertia / h**2 + (problem.alpha + problem.beta) / (4 * h)
        self._cells = cells
        self._ahead = mass + problem.damping / (2 * h)
        self._now = 2 * mass / self._ahead
        self._before = (mass - problem.damping / (2 * h)) / self._ahead
        self._left = (problem.alpha / (2 * h) / self._ahead)[1:]
        self._right = (problem.beta / (2 * h) / self._ahead)[:-1]

    def moved(self, before: Array, now: Array, load: Array) -> Array:
        """The nodes' displacements (m + 1,) from all displacements before and now, and the loads."""
        here = now[:: self._cells]
        after = load / self._ahead + self._now * here - self._before * before[:: self._cells]
        after[:-1] += self._right * (now[1 :: self._cells] - here[:-1])
        after[1:] -= self._left * (here[1:] - now[self._cells - 1 :: self._cells])
        return np.asarray(after)


Term = tuple[int, int, float]
"""A displacement that an output is read from: steps later (-1, 0, 1), the point, and its weight."""


def _terms(watch: Watch, cells: int) -> Iterator[Term]:
    for j, weight in between(watch.offset * cells, cells):
        for later, point, factor in read(watch.quantity, j, cells, cells):
            yield later, (watch.rod - 1) * cells + point, weight * factor


def between(place: float, cells: int) -> Iterator[tuple[int, float]]:
    """Points of a rod, and the weights with which they stand for a place between them."""
    if whole(place):
        yield round(place), 1.0
        return
    first = min(max(int(place) - STENCIL // 2 + 1, 0), cells + 1 - STENCIL)
    points = range(first, first + STENCIL)
    for j in points:
        yield j, float(np.prod([(place - k) / (j - k) for k in points if k != j]))


def read(quantity: str, j: int, cells: int, rate: float) -> list[Term]:
    """A quantity at point j of a rod of so many cells; `rate` is 1 over the step of what it is the slope in."""
    half = rate / 2
    if quantity == "displacement":
        return [(0, j, 1.0)]
    if quantity == "velocity":
        return [(1, j, half), (-1, j, -half)]
    if j == 0:
        return [(0, 1, 2 * half), (1, 0, -half), (-1, 0, -half)]
    if j == cells:
        return [(0, j - 1, -2 * half), (1, j, half), (-1, j, half)]
    return [(0, j + 1, half), (0, j - 1, -half)]


# points and instants are told apart in doubles
SAME = 1e-6


def whole(place: float) -> bool:
    return abs(place - round(place)) < SAME
