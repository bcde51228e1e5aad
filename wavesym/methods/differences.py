"""Central differences in space and time at Courant number 1, where they are exact inside a rod, over any network.

A step h divides all delays, so that a rod has as many cells as a wave takes steps through it; `grid.py` has the steps.
What is read lies on lines between displacements at points of the grid.
"""

from __future__ import annotations

from fractions import Fraction
from math import ceil

import numpy as np

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.elements import FEWEST, stencil
from wavesym.methods.grid import MidpointRule, Places, WaveMotion
from wavesym.methods.network_problem import gridded_problem
from wavesym.methods.problem import Evaluate, Method, Problem
from wavesym.numbers.arrays import Array


def _solve(problem: Problem, resolution: float) -> Evaluate:
    least = FEWEST * problem.measure / min(problem.delays)
    parts = ceil(max(problem.measure * Fraction(resolution), least))
    h = float(problem.measure) / parts
    cells = np.array([int(delay / problem.measure) * parts for delay in problem.delays])
    steps = int(np.ceil(problem.until / h)) + 1
    rule = MidpointRule(problem, h, steps + 1)
    times: Array = h * np.arange(steps + 2, dtype=np.float64)

    def read(motion: WaveMotion, reading: Gauge, taus: Array) -> Array:
        bar = reading.rod - 1
        if reading.point is not None:
            field = motion.wave(problem.ends.size + reading.point, times, 0.0, -1)
            at_first = float(problem.velocity[reading.point])
        else:
            places, weights = stencil(reading, int(cells[bar]))
            if reading.quantity == "strain":
                weights = weights / (problem.speed[bar] * h)
            sides = [(2 * bar, places), (2 * bar + 1, cells[bar] - places)]
            moved = [[motion.wave(end, times, h * k, -1) for k in late] for end, late in sides]
            field = weights @ np.array(moved).sum(axis=0)
            at_first = float(weights @ _start_velocities(problem, bar, places, int(cells[bar])))
        if reading.quantity == "velocity":
            field = np.append(at_first, (field[2:] - field[:-2]) / (2 * h))
        return np.interp(taus, times[:-1], field[: steps + 1]) + problem.strain_at_start(reading)

    def evaluate(taus: Array) -> Array:
        motion = WaveMotion(problem, cells, h, steps + 1, rule.linear())
        return np.array([read(motion, reading, taus) for reading in problem.readings])

    return evaluate


def _start_velocities(problem: Problem, bar: int, places: Places, cells: int) -> Array:
    """The velocities of points of the grid on a bar at tau = 0: at its ends those of what it is fixed to."""
    left, right = problem.ratios[bar] * problem.velocity[problem.ends[bar]]
    return np.asarray(np.where(places == 0, left, np.where(places == cells, right, problem.start_velocity[bar])))


METHOD = Method(
    "central differences",
    "NumPy",
    "cells in a unit of delay",
    (10, 20, 50, 100, 200, 500, 1000),
    gridded_problem,
    _solve,
)
