"""Central differences in space and time at Courant number 1, where they are exact inside a rod, over any network.

A step h divides all delays, so that a rod has as many cells as a wave takes steps through it. A point takes half a cell
of each of its bars along; with U the displacement beside it, and sums over the ends of bars at it,

    (mass + sum of ratio^2 impedance h/2) (u+ - 2 u + u-)/h^2 + damping (u+ - u-)/(2 h) + stiffness (u+ + 2 u + u-)/4
        = sum of ratio impedance (U - ratio u)/h + the loads' mean from t - h to t + h,

which is of order 2, and where two equal bars meet the same as inside a rod.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.elements import FEWEST, interpolate_readings, keep_places, stencil
from wavesym.methods.network_problem import gridded_problem
from wavesym.methods.problem import Evaluate, Method, Problem
from wavesym.numbers.arrays import Array

Places = NDArray[np.int_]


@dataclass(frozen=True)
class Grid:
    """The field: bar after bar with both ends, then the points. A bar has `cells` cells of a step h: (bars,)."""

    problem: Problem
    cells: Places
    h: float

    @cached_property
    def lasts(self) -> Places:
        """Where the right end of each bar is: (bars,)."""
        return np.asarray(np.cumsum(self.cells + 1) - 1)

    @cached_property
    def points(self) -> Places:
        """Where the points are: (points,)."""
        return int(self.lasts[-1]) + 1 + np.arange(self.problem.points)

    @cached_property
    def ends(self) -> Places:
        """Where the ends of the bars are, left and right by turns: (2 * bars,)."""
        return np.stack([self.lasts - self.cells, self.lasts], axis=1).ravel()

    @cached_property
    def spread(self) -> Array:
        """From the points to ends and points: (2 * bars + points, points)."""
        return np.vstack([self.problem.incidence.T, np.eye(self.problem.points)])

    @cached_property
    def start_velocity(self) -> Array:
        """The velocity of the field at tau = 0."""
        field = np.append(np.repeat(self.problem.start_velocity, self.cells + 1), self.problem.velocity)
        field[np.append(self.ends, self.points)] = self.spread @ self.problem.velocity
        return field

    def stencil(self, reading: Gauge) -> tuple[Places, Array]:
        """What of the field a reading is interpolated from, and the weights."""
        if reading.point is not None:
            return self.points[[reading.point]], np.ones(1)
        bar = reading.rod - 1
        places, weights = stencil(reading, int(self.cells[bar]))
        slope = 1 / (self.problem.speed[bar] * self.h) if reading.quantity == "strain" else 1.0
        return self.lasts[bar] - self.cells[bar] + places, weights * slope


class PointSteps(NamedTuple):
    """The next displacements of points: `neighbours` times what is beside ends and at points, less `previous` times
    those a step earlier, and `loads[step]`; `first` are those after the first step."""

    neighbours: Array
    previous: Array
    loads: Array
    first: Array
    yields: Array
    first_yields: Array


def point_steps(problem: Problem, h: float, steps: int) -> PointSteps:
    """How points move in `steps` steps of length h."""
    impedance, onto = np.repeat(problem.impedance, 2), problem.incidence
    radiated = np.diag(onto**2 @ impedance)
    mass = np.diag(problem.mass)
    prescribed = list(problem.prescribed_points)
    unit = np.eye(problem.points)
    times: Array = h * np.arange(steps + 2, dtype=np.float64)
    # over the step before and after: what a jump or a kink adds is the same then on odd and on even points
    loads = problem.load_means(np.maximum(times - h, 0.0), times + h)
    moved = problem.load_means(np.zeros(steps + 1), times[1:]) * times[1:, np.newaxis]

    def solve(matrix: Array, right: Array, motion: Array) -> Array:
        matrix, right = matrix.copy(), right.copy()
        matrix[prescribed], right[prescribed] = unit[prescribed], motion[prescribed]
        return np.asarray(np.linalg.solve(matrix, right))

    inertia, damping, stiffness = (mass + h / 2 * radiated) / h**2, problem.damping / (2 * h), problem.stiffness / 4
    ahead, still = inertia + damping + stiffness, np.zeros_like(unit)
    near = np.hstack([onto * impedance / h, 2 * (inertia - stiffness) - radiated / h])
    # in the first step a mass may be faster than its bars, and what comes is what was in them at the start
    arriving = problem.start_waves[:, ::-1].ravel()
    force = 2 * problem.mass * problem.velocity / h + 2 * onto @ (impedance * arriving) + loads[0]
    begin = 2 * mass / h + radiated + problem.damping + h / 2 * problem.stiffness
    # the field does not have the strain at the start
    turns = np.tile([1.0, -1.0], len(problem.speed))
    strained = onto @ (np.repeat(problem.impedance * problem.speed * problem.start_strain, 2) * turns)
    return PointSteps(
        neighbours=solve(ahead, near, np.zeros_like(near)),
        previous=solve(ahead, inertia - damping + stiffness, still),
        loads=solve(ahead, (loads[:-1] + strained).T, moved.T).T,
        first=solve(begin, h * force, moved[0]),
        yields=solve(ahead, unit, still),
        first_yields=solve(begin, h * unit, still),
    )


Settle = Callable[[Array, Array, Array, Array], Array]
"""Where points are after a step, of where they would be without more forces, what these add to it, and where they are
now and were a step before."""


def fields(grid: Grid, points: PointSteps, settle: Settle = lambda after, *_: after) -> Iterator[Array]:
    """The displacements of the field after each step."""
    placed = np.append(grid.ends, grid.points)
    beside = np.append(grid.ends + np.tile([1, -1], len(grid.cells)), grid.points)
    past, now = np.zeros_like(grid.start_velocity), grid.h * grid.start_velocity
    before = np.zeros(grid.problem.points)
    u = settle(points.first.copy(), points.first_yields, before, before)
    padded = np.zeros(len(now) + 2)
    for loads in points.loads[1:]:
        now[placed] = grid.spread @ u
        yield now
        after = points.neighbours @ now[beside] - points.previous @ before + loads
        before, u = u, settle(after, points.yields, u, before)
        padded[1:-1] = now
        past, now = now, padded[:-2] + padded[2:] - past
    now[placed] = grid.spread @ u
    yield now


def _solve(problem: Problem, resolution: float) -> Evaluate:
    least = FEWEST * problem.measure / min(problem.delays)
    parts = ceil(max(problem.measure * Fraction(resolution), least))
    h = float(problem.measure) / parts
    grid = Grid(problem, np.array([int(delay / problem.measure) * parts for delay in problem.delays]), h)
    steps = int(np.ceil(problem.until / h)) + 1
    points = point_steps(problem, h, steps)
    kept, stencils = keep_places([grid.stencil(reading) for reading in problem.readings])
    times: Array = h * np.arange(steps + 1, dtype=np.float64)

    def evaluate(taus: Array) -> Array:
        history = np.zeros((steps + 2, len(kept)))
        for row, field in zip(history[1:], fields(grid, points), strict=True):
            row[:] = field[kept]
        velocity = np.empty((steps + 1, len(kept)))
        velocity[0] = grid.start_velocity[kept]
        velocity[1:] = (history[2:] - history[:-2]) / (2 * h)
        return interpolate_readings(problem, stencils, times, (history[:-1], velocity), taus)

    return evaluate


METHOD = Method(
    "central differences",
    "NumPy",
    "cells in a unit of delay",
    (10, 20, 50, 100, 200, 500, 1000),
    gridded_problem,
    _solve,
)
