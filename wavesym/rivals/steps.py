"""The method of steps in its linear form, by SciPy's DOP853, restarted wherever something jumps or bends.

On window n what arrives at the nodes was sent on window n - 1, so that with s = tau - n in [0, 1) the velocities of
the bodies on all windows so far are one linear system in s, with constant coefficients and loads that are polynomials.
It is solved over one window after the other: each time one window longer, and each window starts where the one before
it ended. Nothing is interpolated; but n windows cost n^2 at least.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp

from wavesym.rivals.line import stated
from wavesym.rivals.problem import FORCE_TERMS, Array, Evaluate, Problem, Rival


@dataclass(frozen=True)
class _System:
    """y' = matrix (y, 1, s, s^2) on a panel, y the bodies' velocities by window.

    `sent[n, direction, x]` is what node x sends to its left (0) or right (1) on window n, as a row for (y, 1, s, s^2).
    """

    start: float
    end: float
    matrix: Array
    sent: Array

    def rate(self, size: int) -> Callable[[float, Array], Array]:
        """The right side for the first `size` unknowns."""
        linear, force = self.matrix[:size, :size].copy(), self.matrix[:size, -FORCE_TERMS:].copy()
        return lambda s, y: linear @ y + force @ np.array([1.0, s, s * s])


def _systems(problem: Problem, windows: int) -> list[_System]:
    bodies = np.flatnonzero(problem.inertia).tolist()
    size = windows * len(bodies)
    systems = []
    for panel, (start, end) in enumerate(pairwise(map(float, problem.cuts))):
        sent = np.zeros((windows + 1, 2, problem.nodes, size + FORCE_TERMS))
        sent[0, :, :, size] = np.stack(problem.beside(problem.rods)) / 2  # before tau = 0
        matrix = np.zeros((size, size + FORCE_TERMS))
        for n in range(windows):
            a, b = np.zeros((2, problem.nodes, size + FORCE_TERMS))
            a[1:], b[:-1] = sent[n, 1, :-1], sent[n, 0, 1:]
            right = problem.alpha[:, np.newaxis] * a + problem.beta[:, np.newaxis] * b
            right[:, size:] += _loads(problem, n, panel)
            q = right / problem.gamma[:, np.newaxis]
            for body, x in enumerate(bodies):
                place = n * len(bodies) + body
                matrix[place] = right[x] / problem.inertia[x]
                matrix[place, place] -= problem.gamma[x] / problem.inertia[x]
                q[x] = 0.0
                q[x, place] = 1.0
            sent[n + 1, 0], sent[n + 1, 1] = q - a, q - b
        systems.append(_System(start, end, matrix, sent[1:]))
    return systems


def _loads(problem: Problem, window: int, panel: int) -> Array:
    """The loads on a panel of a window, as polynomials in s: (nodes, FORCE_TERMS)."""
    loads = np.zeros((problem.nodes, FORCE_TERMS))
    for event in problem.events:
        if problem.place(event) <= (window, panel):
            f0, f1, f2 = event.coefficients
            t = window - float(event.time)
            loads[event.node] += f0 + t * (f1 + t * f2), f1 + 2 * t * f2, f2
    return loads


def _prepare(problem: Problem, resolution: float) -> Evaluate:
    windows = int(problem.until) + 1
    systems = _systems(problem, windows)
    bodies = np.flatnonzero(problem.inertia)

    def over(window: int, y: Array) -> tuple[Array, list[OdeSolution]]:
        """All unknowns up to `window` at s = 1, and their courses."""
        courses = []
        for system in systems:
            span = system.start, system.end
            options = {"method": "DOP853", "rtol": resolution, "atol": resolution / 10, "dense_output": True}
            solved = solve_ivp(system.rate(len(y)), span, y, **options)
            courses.append(solved.sol)
            y = solved.y[:, -1]
        return y, courses

    def evaluate(taus: Array) -> Array:
        starts = problem.velocity[bodies]
        for window in range(windows):
            ends, courses = over(window, starts)
            starts = np.concatenate([problem.velocity[bodies], ends])
        return _read(problem, systems, courses, taus)

    return evaluate


def _read(problem: Problem, systems: list[_System], courses: list[OdeSolution], taus: Array) -> Array:
    """The outputs: the waves that arrive at their places, or the integrals of these."""
    out = np.zeros((len(problem.watches), len(taus)))
    for row, watch in zip(out, problem.watches, strict=True):
        sign = -1.0 if watch.quantity == "strain" else 1.0
        for direction, node, lag, factor in (
            (1, watch.rod - 1, watch.offset, sign),
            (0, watch.rod, 1 - watch.offset, 1.0),
        ):
            before = float(problem.beside(problem.rods)[direction][node]) / 2
            wave = _Wave(systems, courses, direction, node, before)
            row += factor * (
                wave.moved(taus - lag) - wave.moved(np.array([-lag]))
                if watch.quantity == "displacement"
                else wave.sent(taus - lag)
            )
    return out


@dataclass(frozen=True)
class _Wave:
    """What a node sends in one direction."""

    systems: list[_System]
    courses: list[OdeSolution]
    direction: int
    node: int
    before: float

    def sent(self, times: Array) -> Array:
        """The wave at times >= -1."""
        values = np.full(len(times), self.before)
        windows = np.floor(times)
        for system, course in zip(self.systems, self.courses, strict=True):
            s = times - windows
            here = np.flatnonzero((windows >= 0) & (s >= system.start) & (s < system.end))
            if len(here):
                s = s[here]
                basis = np.vstack([course(s), np.ones_like(s), s, s * s])
                rows = system.sent[windows[here].astype(int), self.direction, self.node]
                values[here] = np.einsum("ij,ji->i", rows, basis)
        return values

    def moved(self, times: Array) -> Array:
        """The integral of the wave from -1 to times, by Gauss's rule over parts of panels that it is smooth on."""
        nodes, weights = np.polynomial.legendre.leggauss(12)
        nodes, weights = (nodes + 1) / 2, weights / 2
        cuts = np.array([system.start for system in self.systems])
        edges = np.concatenate([[-1.0], *(n + cuts for n in range(int(np.max(times, initial=0.0)) + 1))])
        edges = edges[edges <= max(float(np.max(times)), -1.0)]
        lengths = np.diff(edges)
        panels = self.sent((edges[:-1, np.newaxis] + lengths[:, np.newaxis] * nodes).ravel()).reshape(-1, len(nodes))
        sums = np.append(0.0, np.cumsum(panels @ weights * lengths))
        at = np.searchsorted(edges, times, side="right") - 1
        rest = times - edges[at]
        inner = self.sent((edges[at][:, np.newaxis] + rest[:, np.newaxis] * nodes).ravel()).reshape(-1, len(nodes))
        return np.asarray(sums[at] + inner @ weights * rest)


RIVAL = Rival(
    "solve_ivp, linear steps", "SciPy", "relative tolerance", (1e-4, 1e-6, 1e-8, 1e-10, 1e-12), stated, _prepare
)
