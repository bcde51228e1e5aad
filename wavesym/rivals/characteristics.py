"""Characteristics on a grid, exponential integration at the bodies, in C: what a careful engineer would write.

Waves are kept at grid points of tau; a body's velocity between two of them is exact for what arrives being a line
(order 2) or a cubic (order 4) between neighbouring points. The grid has a point wherever a load jumps, so that no
interpolation reaches over a front. `characteristics.c` has the loops, this file the weights.
"""

from __future__ import annotations

import ctypes
from functools import partial
from pathlib import Path

import numpy as np

from wavesym.rivals.line import stated
from wavesym.rivals.problem import Array, Evaluate, Problem, Rival
from wavesym.running.native import FAST, address, library

_SOURCE = Path(__file__).with_suffix(".c")
_GAUSS = np.polynomial.legendre.leggauss(24)
_LEFT, _RIGHT = 0, 1  # which way a wave goes

_COUNTS = ("nodes", "panels", "points", "events", "terms", "outputs", "windows")
_TABLES = (
    *("alpha", "beta", "instant", "stencils", "velocity", "before", "start", "step", "steps", "first"),
    *("event_window", "event_panel", "event_node", "event_load"),
    *("term_output", "term_wave", "term_integral", "term_first", "term_sign", "term_lag", "term_base"),
)


class _Grid(ctypes.Structure):
    """`struct grid`."""

    _fields_ = [
        *((name, ctypes.c_size_t) for name in _COUNTS),
        *((name, ctypes.c_void_p) for name in _TABLES),
    ]


def _prepare(points: int, problem: Problem, resolution: float) -> Evaluate:
    compiled = library(_SOURCE.read_text(encoding="utf-8"), (*FAST, f"-DPOINTS={points}"))
    cuts = np.array([float(cut) for cut in problem.cuts])
    lengths = np.diff(cuts)
    steps = np.maximum(points, np.rint(lengths * resolution)).astype(np.uintp)
    terms = _terms(problem)
    events = sorted((*problem.place(event), event.node, event.coefficients) for event in problem.events)
    sizes = {
        "nodes": problem.nodes,
        "panels": len(steps),
        "points": int(np.sum(steps + 1)),
        "events": len(events),
        "terms": len(terms),
        "outputs": len(problem.watches),
        "windows": int(problem.until) + 1,
    }
    doubles = {
        "alpha": problem.alpha,
        "beta": problem.beta,
        "instant": np.where(problem.inertia > 0, 0.0, 1.0) / problem.gamma,
        "stencils": np.stack([_stencils(problem, step, points) for step in lengths / steps]),
        "velocity": problem.velocity,
        "before": np.stack(problem.beside(problem.rods)) / 2,
        "start": cuts[:-1],
        "step": lengths / steps,
        "event_load": np.array([load for *_, load in events]),
        "term_sign": np.array([sign for *_, sign, _ in terms]),
        "term_lag": np.array([lag for *_, lag in terms]),
        "term_base": np.array([sign * _before(problem, wave) * (1 - lag) for _, wave, _, sign, lag in terms]),
    }
    integers = {
        "steps": steps,
        "first": np.cumsum(steps + 1) - (steps + 1),
        "event_window": np.array([window for window, *_ in events]),
        "event_panel": np.array([panel for _, panel, *_ in events]),
        "event_node": np.array([node for *_, node, _ in events]),
        "term_output": np.array([output for output, *_ in terms]),
        "term_wave": np.array([wave for _, wave, *_ in terms]),
        "term_integral": np.array([integral for _, _, integral, *_ in terms]),
        "term_first": np.arange(len(terms)) % 2 == 0,
    }
    tables = {name: np.ascontiguousarray(table, dtype=np.float64) for name, table in doubles.items()}
    tables |= {name: np.ascontiguousarray(table, dtype=np.uintp) for name, table in integers.items()}
    grid = _Grid(*sizes.values(), *(address(tables[name]) for name in _TABLES))
    work = np.empty(sizes["points"] * (6 * problem.nodes + 1) + 4 * problem.nodes + len(terms))

    def evaluate(taus: Array) -> Array:
        _ = tables  # C reads them, so that they must live as long as this
        out = np.empty((sizes["outputs"], len(taus)))
        count = ctypes.c_size_t(len(taus))
        where = [ctypes.c_void_p(address(array)) for array in (taus, out, work)]
        compiled.sample(ctypes.byref(grid), where[0], count, *where[1:])
        return out

    return evaluate


def _terms(problem: Problem) -> list[tuple[int, int, bool, float, float]]:
    """(output, wave, whether its integral, sign, lag): dU/dtau is the sum of the two waves, dU/dx left less right."""
    terms = []
    for output, watch in enumerate(problem.watches):
        integral = watch.quantity == "displacement"
        sign = -1.0 if watch.quantity == "strain" else 1.0
        to_right = (output, _RIGHT * problem.nodes + watch.rod - 1, integral, sign, watch.offset)
        to_left = (output, _LEFT * problem.nodes + watch.rod, integral, 1.0, 1.0 - watch.offset)
        terms += [to_right, to_left] if watch.offset > 0.5 else [to_left, to_right]
    return terms


def _before(problem: Problem, wave: int) -> float:
    """A wave before tau = 0."""
    return float(np.concatenate(problem.beside(problem.rods))[wave]) / 2


def _stencils(problem: Problem, step: float, points: int) -> Array:
    """For every node, and for plain integrals: the decay over a step, then gains at a first, inner and last step.

    Gains are step * integral over s in [0, 1] of exp(-rate step (1 - s)) times Lagrange's polynomials in s.
    """
    # what has no mass is not integrated; 1 keeps its line finite
    inertia = np.append(np.where(problem.inertia > 0, problem.inertia, 1.0), 1.0)
    z = np.append(problem.gamma, 0.0)[:, np.newaxis] / inertia[:, np.newaxis] * step
    s, weights = (_GAUSS[0] + 1) / 2, _GAUSS[1] / 2
    kernel = np.exp(-z * (1 - s)) * weights * step / inertia[:, np.newaxis]
    # the stencil starts at the step itself, so that it is inside the panel, or ends at its end
    firsts = (0, 1 - points // 2, 2 - points)
    return np.hstack([np.exp(-z), *(kernel @ lagrange(s, first, points) for first in firsts)])


def lagrange(s: Array, first: int, points: int) -> Array:
    """Lagrange's polynomials on the points first, first + 1, ... at s: shape (len(s), points)."""
    places = range(first, first + points)
    return np.stack(
        [np.prod([(s - other) / (place - other) for other in places if other != place], axis=0) for place in places],
        axis=1,
    )


# with divisors of the usual numbers of samples
_STEPS = (10, 25, 50, 125, 250, 500, 1000, 2000)

SECOND = Rival("characteristics, order 2", "C", "steps per unit of tau", _STEPS, stated, partial(_prepare, 2))
FOURTH = Rival("characteristics, order 4", "C", "steps per unit of tau", _STEPS, stated, partial(_prepare, 4))
