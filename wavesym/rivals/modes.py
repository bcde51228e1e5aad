"""Modal superposition with the exact modes of the chain.

At frequency w the shape on a rod is rho sin(theta + w x). Across a rod theta gains w; at a node U stays and, from
(2.4), U'/w goes from c to (alpha c - 2 w inertia U)/beta, which keeps theta within its multiple of pi. So theta at the
right end grows with w, and less the angle that the last node asks for it is k pi at the k-th frequency: no mode is
ever missed, and bisection finds all of them at once. Each mode is an oscillator, solved exactly for the loads.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wavesym.errors import UnservedError
from wavesym.mechanics.model import Model
from wavesym.rivals.line import stated
from wavesym.rivals.problem import Array, Evaluate, Problem, Rival

_BISECTIONS = 60


@dataclass(frozen=True)
class Modes:
    """Frequencies (n,), and shapes rho sin(theta + w x) in every rod, rho and theta of shape (m, n)."""

    w: Array
    rho: Array
    theta: Array

    def at(self, rod: int, offset: float, slope: bool) -> Array:
        """The shapes, or their slopes, at a place: (n,)."""
        angle = self.theta[rod - 1] + self.w * offset
        return np.asarray(self.rho[rod - 1] * (self.w * np.cos(angle) if slope else np.sin(angle)))


def modes(problem: Problem, count: int) -> Modes:
    """The first modes of a chain; a base that moves as it is told is at rest in them."""
    k = np.arange(count)
    low, high = np.zeros(count), (k + problem.nodes + 1) * np.pi / (problem.nodes - 1)
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        below = _angle(problem, middle)[0] < k * np.pi
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    free = not _told(problem)
    w = np.where(free & (k == 0), 0.0, (low + high) / 2)
    return Modes(w, *_angle(problem, w)[1:])


def _told(problem: Problem) -> bool:
    """Whether the velocity of the first node is its load."""
    return bool(problem.damping[0] > 0)


def _angle(problem: Problem, w: Array) -> tuple[Array, Array, Array]:
    """By how much theta passes what the last node asks for; rho and theta at the left ends of the rods."""
    ratio = 2 * problem.inertia
    start = np.zeros_like(w) if _told(problem) else np.arctan2(1.0, -ratio[0] * w / problem.beta[0])
    rho, theta = [np.ones_like(w)], [start]
    for x in range(1, problem.nodes - 1):
        arrived = theta[-1] + w
        turns = np.floor(arrived / np.pi)
        sine, cosine = np.sin(arrived - turns * np.pi), np.cos(arrived - turns * np.pi)
        cosine = (problem.alpha[x] * cosine - ratio[x] * w * sine) / problem.beta[x]
        theta.append(turns * np.pi + np.arctan2(sine, cosine))
        rho.append(rho[-1] * np.hypot(sine, cosine))
    end = theta[-1] + w - np.arctan2(1.0, ratio[-1] * w / problem.alpha[-1])
    return end, np.array(rho), np.array(theta)


def _prepare(problem: Problem, resolution: float) -> Evaluate:
    found = modes(problem, int(resolution))
    # impedances of rods, and what turns a node's own condition into a force in their units
    stiffness = np.cumprod(np.append(1.0, problem.beta[1:-1] / problem.alpha[1:-1]))
    scale = np.append(2 * stiffness[:1] / (problem.beta[:1] or 1.0), 2 * stiffness / problem.alpha[1:])
    w = found.w
    at_nodes = np.array([found.at(1, 0.0, False), *(found.at(i, 1.0, False) for i in range(1, problem.nodes))])
    bodies = (problem.inertia * scale)[:, np.newaxis] * at_nodes
    safe = np.where(w > 0, w, 1.0)
    ends = found.theta + w
    squares = np.where(w > 0, 0.5 - (np.sin(2 * ends) - np.sin(2 * found.theta)) / (4 * safe), np.sin(found.theta) ** 2)
    means = np.where(w > 0, (np.cos(found.theta) - np.cos(ends)) / safe, np.sin(found.theta))
    mass = stiffness @ (found.rho**2 * squares) + np.sum(bodies * at_nodes, axis=0)
    momentum = (stiffness * problem.rods) @ (found.rho * means) + problem.velocity @ bodies
    whole = stiffness @ (found.rho * means) + np.sum(bodies, axis=0)  # what a base that moves as told drags along
    slope = np.array([found.at(watch.rod, watch.offset, True) for watch in problem.watches])
    shape = np.array([found.at(watch.rod, watch.offset, False) for watch in problem.watches])

    def evaluate(taus: Array) -> Array:
        position, speed = _started(w, taus)
        position, speed = (momentum / mass)[:, np.newaxis] * position, (momentum / mass)[:, np.newaxis] * speed
        ground = np.zeros((2, len(taus)))  # displacement and velocity of a base that moves as told
        for event in problem.events:
            first = int(np.searchsorted(taus, float(event.time)))
            t = taus[first:] - float(event.time)
            force: Array = np.array(event.coefficients)
            pushed = scale[event.node] * at_nodes[event.node] / mass
            if event.node == 0 and _told(problem):
                ground[0, first:] += t * np.polyval((force / [1, 2, 3])[::-1], t)
                ground[1, first:] += np.polyval(force[::-1], t)
                force, pushed = np.array([force[1], 2 * force[2], 0.0]), -whole / mass
            moved = _pushed(w, t, force)
            position[:, first:] += pushed[:, np.newaxis] * moved[0]
            speed[:, first:] += pushed[:, np.newaxis] * moved[1]
        rows = []
        for watch, bent, shown in zip(problem.watches, slope, shape, strict=True):
            if watch.quantity == "strain":
                rows.append(bent @ position)
            else:
                velocity = watch.quantity == "velocity"
                rows.append(shown @ (speed if velocity else position) + ground[int(velocity)])
        return np.array(rows)

    return evaluate


def _started(w: Array, t: Array) -> tuple[Array, Array]:
    """The motion of oscillators that start with velocity 1, and its velocity: (n, len(t))."""
    angle = np.multiply.outer(w, t)
    safe = np.where(w > 0, w, 1.0)[:, np.newaxis]
    return np.where(w[:, np.newaxis] > 0, np.sin(angle) / safe, t), np.cos(angle)


def _pushed(w: Array, t: Array, force: Array) -> tuple[Array, Array]:
    """The motion of oscillators at rest under sum_k force[k] t**k, and its velocity: (n, len(t))."""
    f0, f1, f2 = force
    free = w[:, np.newaxis] > 0
    safe = np.where(w > 0, w, 1.0)[:, np.newaxis]
    sine = _started(w, t)[0]
    cosine = 2 * np.sin(np.multiply.outer(w / 2, t)) ** 2 / safe**2  # (1 - cos w t)/w^2
    position = f0 * cosine + f1 * (t - sine) / safe**2 + f2 * (t * t - 2 * cosine) / safe**2
    speed = f0 * sine + f1 * cosine + 2 * f2 * (t - sine) / safe**2
    drift = t * t * (f0 / 2 + t * (f1 / 6 + t * f2 / 12)), t * (f0 + t * (f1 / 2 + t * f2 / 3))
    return np.where(free, position, drift[0]), np.where(free, speed, drift[1])


def _undamped(model: Model) -> Problem:
    """The problem of a model. UnservedError where its modes are not those found here, or not enough."""
    problem = stated(model)
    told = problem.alpha + problem.beta == 0
    if np.any(problem.damping[~told]):
        raise UnservedError("system: a dashpot given, a chain without them expected")
    jumps = any(told[event.node] and event.coefficients[0] for event in problem.events)
    if np.any(told[1:]) or jumps:
        raise UnservedError("system: an end that moves as told given, none but a first that starts smoothly expected")
    return problem


RIVAL = Rival("modal superposition", "NumPy", "modes", (10, 30, 100, 300, 1000), _undamped, _prepare)
