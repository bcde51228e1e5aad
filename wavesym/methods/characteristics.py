"""Characteristics on a grid, exponential integration at the points, in C: what a careful engineer would write.

Waves are kept at grid points of tau; a mass's velocity between two of them is exact for what arrives being a line
(order 2) or a cubic (order 4) between neighbouring points. A window is the longest time that all delays are multiples
of, so that what arrives was sent a whole number of windows earlier. The grid has a point wherever a load jumps, so that
no interpolation reaches over a front. `characteristics.c` has the loops, this file the weights.
"""

from __future__ import annotations

import ctypes
from bisect import bisect_right
from fractions import Fraction
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import UnservedError
from wavesym.mechanics.model import Model
from wavesym.methods.network_problem import gridded_problem
from wavesym.methods.problem import Evaluate, Method, Problem
from wavesym.methods.quadrature import gauss, lagrange
from wavesym.numbers.arrays import Array
from wavesym.running.native import FAST, address, library

_SOURCE = Path(__file__).with_suffix(".c")
_POINTS = 24  # of Gauss


def unlinked_problem(model: Model) -> Problem:
    """State the problem of a model whose points are masses, dashpots and ends of bars alone.

    Raises:
        UnservedError: as `gridded_problem`, and where there are springs, or dashpots between points.
    """
    problem = gridded_problem(model)
    if np.any(problem.stiffness) or np.any(problem.damping - np.diag(np.diag(problem.damping))):
        raise UnservedError(
            "system: a spring, or a dashpot between points, is not supported by characteristics; take another method"
        )
    return problem


def _solve(order: int, problem: Problem, resolution: float) -> Evaluate:
    compiled = library(_SOURCE.read_text(encoding="utf-8"), (*FAST, f"-DPOINTS={order}"))
    sizes, tables = _tables(order, problem, resolution)
    numbers = {**sizes, "window": float(problem.measure)} | {name: address(table) for name, table in tables.items()}
    kinds = [(name, ctypes.c_size_t) for name in sizes] + [("window", ctypes.c_double)]

    class Grid(ctypes.Structure):
        _fields_ = [*kinds, *((name, ctypes.c_void_p) for name in tables)]

    grid = Grid(**numbers)
    waves = sizes["ends"] + sizes["points"]
    work = np.empty(sizes["samples"] * (waves * (sizes["depth"] + 1) + 1) + 4 * sizes["points"] + sizes["terms"])

    def evaluate(taus: Array) -> Array:
        _ = tables  # C reads them, so that they must live as long as this
        out = np.empty((sizes["outputs"], len(taus)))
        count = ctypes.c_size_t(len(taus))
        where = [ctypes.c_void_p(address(array)) for array in (taus, out, work)]
        compiled.sample(ctypes.byref(grid), where[0], count, *where[1:])
        return out

    return evaluate


def _tables(order: int, problem: Problem, resolution: float) -> tuple[dict[str, int], dict[str, NDArray[np.generic]]]:
    """The sizes and tables of `struct grid` in its order, `resolution` steps in a unit of tau or more."""
    measure = float(problem.measure)
    cuts = sorted({0, 1} | {event.time / problem.measure % 1 for event in problem.events})
    lengths = measure * np.diff(np.array([float(cut) for cut in cuts]))
    steps = np.maximum(order, np.rint(lengths * resolution)).astype(np.uintp)
    lags = np.repeat([int(delay / problem.measure) for delay in problem.delays], 2)
    depth = int(max(lags)) + 1
    impedance, ends, ratios = np.repeat(problem.impedance, 2), problem.end_points, problem.end_ratios
    free = ~np.isin(np.arange(problem.points), problem.prescribed_points)
    before = np.append(problem.start_waves.ravel(), np.zeros(problem.points))
    gamma = np.where(free, np.diag(problem.damping) + problem.incidence**2 @ impedance, 1.0)
    massless = ~free | (problem.mass == 0)
    over = np.where(massless, gamma, 1.0)
    terms = _terms(problem)
    output, wave, integral, sign, lag = np.array(terms).reshape(-1, 5).T
    events = sorted(
        (int(when), bisect_right(cuts, when % 1) - 1, event.point, *event.coefficients)
        for event in problem.events
        for when in (event.time / problem.measure,)
    )
    window, panel, point, *loads = np.array(events).reshape(-1, 6).T
    by_point = np.argsort(ends, kind="stable")
    sizes = {
        "points": problem.points,
        "ends": len(ends),
        "panels": len(steps),
        "samples": int(np.sum(steps + 1)),
        "events": len(events),
        "terms": len(terms),
        "outputs": len(problem.readings),
        "windows": int(Fraction(problem.until) // problem.measure) + 1,
        "depth": depth,
    }
    numbers, doubles = np.uintp, np.float64
    tables = {
        "massless": (massless, numbers),
        "stencils": (np.stack([_stencils(problem.mass, gamma, step, order) for step in lengths / steps]), doubles),
        "velocity": (problem.velocity, doubles),
        "before": (before, doubles),
        "start": (np.append(0.0, np.cumsum(lengths))[:-1], doubles),
        "step": (lengths / steps, doubles),
        "steps": (steps, numbers),
        "first": (np.cumsum(steps + 1) - (steps + 1), numbers),
        "first_end": (np.searchsorted(ends[by_point], np.arange(problem.points + 1)), numbers),
        "end_of": (by_point, numbers),
        "lag": (lags, numbers),
        "ratio": (ratios, doubles),
        "weight": (np.where(free[ends], 2 * ratios * impedance, 0.0) / over[ends], doubles),
        "event_window": (window, numbers),
        "event_panel": (panel, numbers),
        "event_point": (point, numbers),
        "event_load": (np.array(loads).T / over[point.astype(int), np.newaxis], doubles),
        "term_output": (output, numbers),
        "term_wave": (wave, numbers),
        "term_integral": (integral, numbers),
        "term_first": (np.diff(output, prepend=-1), numbers),
        "term_sign": (sign, doubles),
        "term_lag": (lag, doubles),
        "term_base": (sign * (depth * measure - lag) * before[wave.astype(int)], doubles),
    }
    return sizes, {name: np.ascontiguousarray(table, dtype=kind) for name, (table, kind) in tables.items()}


def _terms(problem: Problem) -> list[tuple[int, int, bool, float, float]]:
    """(output, wave, whether its integral, sign, lag); waves are numbered as in `Problem.waves`."""
    return [
        (output, wave.end, reading.quantity == "displacement", wave.weight, float(wave.late))
        for output, reading in enumerate(problem.readings)
        for wave in sorted(problem.waves(reading), key=lambda wave: wave.late, reverse=True)
    ]


def _stencils(mass: Array, gamma: Array, step: float, order: int) -> Array:
    """For every point, and for plain integrals: the decay over a step, then gains at a first, inner and last step.

    Gains are step * integral over s in [0, 1] of exp(-rate step (1 - s)) times Lagrange's polynomials in s.
    """
    # what has no mass is not integrated; 1 keeps its line finite
    inertia = np.append(np.where(mass > 0, mass, 1.0), 1.0)
    z = np.append(gamma, 0.0)[:, np.newaxis] / inertia[:, np.newaxis] * step
    rule = gauss(_POINTS)
    s = rule.nodes
    kernel = np.exp(-z * (1 - s)) * rule.weights * step / inertia[:, np.newaxis]
    # the stencil starts at the step itself, so that it is inside the panel, or ends at its end
    firsts = (0, 1 - order // 2, 2 - order)
    return np.hstack([np.exp(-z), *(kernel @ lagrange(s, first, order) for first in firsts)])


# with divisors of the usual numbers of samples
_STEPS = (10, 25, 50, 125, 250, 500, 1000, 2000)

SECOND, FOURTH = (
    Method(
        f"characteristics, order {order}",
        "C",
        "steps per unit of tau",
        _STEPS,
        unlinked_problem,
        partial(_solve, order),
    )
    for order in (2, 4)
)
