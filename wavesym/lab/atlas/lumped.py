"""The chain without waves: every rod a spring without mass, which is what is left as kappa goes to 0.

Where (2.4) holds at the nodes and U is a line along each rod, inertia U'' + damping U' = (beta/2) (U_(x+1) - U_x)
- (alpha/2) (U_x - U_(x-1)) + load. A node without inertia follows its neighbours at once, or moves as it is told.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from wavesym.rivals.problem import FORCE_TERMS, Problem

Array = NDArray[np.float64]

_TERMS = FORCE_TERMS + 1  # powers of tau: a told velocity is integrated once


def strains(problem: Problem, step: float, count: int) -> Array:
    """The strains of the rods at k * step, k = 0 ... count, loads from tau = 0 on: shape (rods, count + 1)."""
    body = np.flatnonzero(problem.inertia > 0)
    told = np.flatnonzero((problem.inertia == 0) & (problem.damping > 0))
    light = np.flatnonzero((problem.inertia == 0) & (problem.damping == 0))
    spring, load = _springs(problem), _loads(problem)
    # every displacement from those of the bodies and the powers of tau
    place = np.zeros((problem.nodes, len(body) + _TERMS))
    place[body, np.arange(len(body))] = 1.0
    powers = place[:, len(body) :]
    for k in range(FORCE_TERMS):
        powers[told, k + 1] = load[told, k] / (k + 1) / problem.damping[told]
    pushed = spring[light] @ place
    pushed[:, len(body) :] += load[light]
    place[light] = -np.linalg.solve(spring[np.ix_(light, light)], pushed)
    pull = spring[body] @ place
    pull[:, len(body) :] += load[body]
    # y = (displacements, velocities, powers of tau)
    size = len(body)
    matrix = np.zeros((2 * size + _TERMS, 2 * size + _TERMS))
    matrix[:size, size : 2 * size] = np.eye(size)
    matrix[size : 2 * size, :size] = pull[:, :size] / problem.inertia[body, np.newaxis]
    matrix[size : 2 * size, 2 * size :] = pull[:, size:] / problem.inertia[body, np.newaxis]
    for k in range(1, _TERMS):
        matrix[2 * size + k, 2 * size + k - 1] = k
    onward = expm(matrix * step)
    y = np.concatenate([np.zeros(size), problem.velocity[body], np.eye(_TERMS)[0]])
    history = np.empty((count + 1, len(y)))
    for k in range(count + 1):
        history[k] = y
        y = onward @ y
    read = np.hstack([place[:, :size], np.zeros((problem.nodes, size)), place[:, size:]])
    return np.asarray(np.diff(read @ history.T, axis=0))


def _springs(problem: Problem) -> Array:
    """What displacements (nodes,) do at the nodes."""
    to_left, to_right = problem.alpha[1:] / 2, problem.beta[:-1] / 2
    return np.diag(to_left, -1) + np.diag(to_right, 1) - np.diag(np.append(0.0, to_left) + np.append(to_right, 0.0))


def _loads(problem: Problem) -> Array:
    """The loads as powers of tau: (nodes, _TERMS)."""
    loads = np.zeros((problem.nodes, _TERMS))
    for event in problem.events:
        assert event.time == 0
        loads[event.node, :FORCE_TERMS] += event.coefficients
    return loads
