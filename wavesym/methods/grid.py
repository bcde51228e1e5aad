"""Waves on a grid: a step divides all delays, so that what an end of a rod sends comes to the other a few steps later.

Waves are known by their means over steps, and inside a rod that is exact. With q and u at the start of a step, v the
mean velocity in it and a the means of what arrives, points follow the midpoint rule:

    (2 mass/h + damping + sum of ratio^2 impedance + stiffness h/2) v
        = 2 mass/h q - stiffness u + sum of 2 ratio impedance a + loads + what links with corners pull,

q goes on to 2 v - q and u to u + h v. Displacements at instants are those of central differences in space and time at
Courant number 1, where a point takes half a cell of each of its rods along: the same, of order 2.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.problem import Problem
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import UNIT_ROUNDOFF

Places = NDArray[np.int_]

# so many roundings of a step are kept for good
_ROUNDINGS = 8

PointRule = Callable[[int, Array], Array]
"""What the ends send in a step and the velocities of points behind that, all means, from what arrives at the ends."""


class Links(Protocol):
    """What links with corners do in a step of the midpoint rule."""

    def settle(self, free: Array, q: Array, u: Array, step: int) -> Array:
        """The mean velocities of points in a step, from those without links, `free`, and their state before it."""

    def stop(self, after: Array, v: Array) -> Array:
        """The velocities of points at the end of a step, from what these are without stops and the mean ones."""


class WaveMotion:
    """What is sent from the ends of bars, with the velocities of points behind that, step by step: (steps, waves)."""

    def __init__(self, problem: Problem, lags: Places, h: float, steps: int, rule: PointRule) -> None:
        """March.

        Args:
            problem: what moves.
            lags: how many steps a wave takes through each bar: (bars,).
            h: the step.
            steps: how many.
            rule: how points move.
        """
        self._problem, self._h = problem, h
        self._instants: Array = h * np.arange(steps + 1, dtype=np.float64)
        lags = np.repeat(lags, 2)
        late, slopes = np.repeat(problem.delay, 2), np.repeat(problem.start_slope, 2)
        ends, beyond = len(lags), np.arange(len(lags)) ^ 1
        at_first = problem.start_waves.ravel()[beyond]
        self._sent = np.zeros((steps, ends + problem.points))
        width, flat = ends + problem.points, self._sent.ravel()
        places, slowest = beyond - lags * width, int(max(lags, default=0))
        for step in range(steps):
            place = places + step * width
            came: Array = flat[place if step >= slowest else np.maximum(place, 0)]
            if step < slowest:
                came = np.where(step < lags, at_first + slopes * ((step + 0.5) * h - late / 2), came)
            self._sent[step] = rule(step, came)

    def evaluate(self, reading: Gauge, taus: Array) -> Array:
        """A strain, a velocity, a displacement or an acceleration at instants."""
        waves = self._problem.waves(reading)
        parts = [weight * self.wave(end, taus, float(late), reading.order) for end, weight, late in waves]
        return np.asarray(np.sum(parts, axis=0))

    def roundoff(self, reading: Gauge) -> float:
        """What rounding may have added to a reading: it adds up over steps, and no point amplifies it."""
        largest = float(np.max(np.abs(self._sent), initial=0.0))
        scale = {-1: float(self._instants[-1]), 0: 1.0, 1: 2 / self._h}[reading.order]
        slow = float(self._problem.speed[reading.rod - 1]) if reading.quantity == "strain" else 1.0
        return _ROUNDINGS * float(UNIT_ROUNDOFF) * len(self._sent) * largest * scale / slow

    def wave(self, end: int, taus: Array, late: float, order: int) -> Array:
        """What was sent from an end so long ago, its derivative (`order` 1), or its integral from tau = 0 (-1)."""
        times = {-1: self._instants, 0: self._instants[:-1] + self._h / 2, 1: self._instants[1:-1]}[order]
        known = {-1: self._sums, 0: self._sent, 1: np.diff(self._sent, axis=0) / self._h}[order]
        found, held = np.interp(taus - late, times, known[:, end]), self._problem.held_part(end, taus, late, order)
        return held + found if order < 0 else np.where(taus < late, held, found)

    @cached_property
    def _sums(self) -> Array:
        """The integrals of what is sent, at the ends of steps."""
        return np.concatenate([np.zeros((1, self._sent.shape[1])), self._h * np.cumsum(self._sent, axis=0)])


class MidpointRule:
    """The midpoint rule at points."""

    def __init__(self, problem: Problem, h: float, steps: int) -> None:
        self._problem, self._h = problem, h
        times: Array = h * np.arange(steps + 1, dtype=np.float64)
        loads, self._at_start = problem.load_means(times[:-1], times[1:]), problem.loads(times[:-1])
        impedance = np.repeat(problem.impedance, 2)
        matrix: Array = np.diag(2 * problem.mass / h + problem.incidence**2 @ impedance)
        matrix += problem.damping + h / 2 * problem.stiffness
        prescribed = self._prescribed = list(problem.prescribed_points)
        matrix[prescribed] = np.eye(problem.points)[prescribed]
        self.inverse: Array = np.linalg.inv(matrix).astype(np.float64)
        forces = np.hstack([np.diag(2 * problem.mass / h), -problem.stiffness, 2 * problem.incidence * impedance])
        forces[prescribed] = 0.0
        # velocities of q, u and what arrives, and of loads; what is sent is their sum, and the opposite of what arrives
        self._velocities, self._by_loads = self.inverse @ forces, loads @ self.inverse.T
        self._spread = np.vstack([problem.incidence.T, np.eye(problem.points)])

    def linear(self) -> PointRule:
        """The rule from tau = 0 on, without links: what is sent, q and u follow at once."""
        size, ends = self._problem.points, self._problem.ends.size
        onto = np.vstack([self._spread, 2 * np.eye(size), self._h * np.eye(size)])
        before = np.zeros((len(onto), 2 * size + ends))
        before[:ends, 2 * size :] = -np.eye(ends)
        before[-2 * size :, : 2 * size] = np.diag(np.repeat([-1.0, 1.0], size))
        step_on, loads = onto @ self._velocities + before, self._by_loads @ onto.T
        state = np.concatenate([self._problem.velocity, np.zeros(size + ends)])

        def move(step: int, came: Array) -> Array:
            state[2 * size :] = came
            after: Array = step_on @ state + loads[step]
            state[: 2 * size] = after[-2 * size :]
            return after[: -2 * size]

        return move

    def nonlinear(self, links: Links) -> PointRule:
        """The rule from tau = 0 on, with links."""
        u, q, prescribed = np.zeros(self._problem.points), self._problem.velocity.copy(), self._prescribed

        def move(step: int, came: Array) -> Array:
            nonlocal u, q
            if prescribed:
                q[prescribed] = self._at_start[prescribed, step]  # it may jump there
            v = self._velocities @ np.concatenate([q, u, came]) + self._by_loads[step]
            v = links.settle(v, q, u, step)
            q = links.stop(2 * v - q, v)
            u = u + self._h * v
            sent: Array = self._spread @ v
            sent[: len(came)] -= came
            return sent

        return move
