"""Linear finite elements, consistent mass, and Newmark's average acceleration with steps as long as an element."""

from __future__ import annotations

import numpy as np
from scipy.linalg.lapack import dgttrf, dgttrs

from wavesym.rivals.mesh import Mesh
from wavesym.rivals.problem import Array, Evaluate, Problem, Rival

Bands = tuple[Array, Array, Array]
"""A tridiagonal matrix: below, on and above the diagonal."""


def assembled(mesh: Mesh) -> tuple[Bands, Array, Bands]:
    """Mass, damping (a diagonal) and stiffness. A node's row has the scale of its own condition, (2.4)."""
    problem, h = mesh.problem, mesh.h
    left, right = mesh.at_points(1.0, problem.alpha / 2), mesh.at_points(1.0, problem.beta / 2)
    both = left + right
    mass = left[1:] * h / 6, mesh.at_points(0.0, problem.inertia) + both * h / 3, right[:-1] * h / 6
    stiffness = -left[1:] / h, both / h, -right[:-1] / h
    return mass, mesh.at_points(0.0, problem.damping), stiffness


def product(matrix: Bands, vector: Array) -> Array:
    """A tridiagonal matrix times a vector."""
    below, on, above = matrix
    result = on * vector
    result[1:] += below * vector[:-1]
    result[:-1] += above * vector[1:]
    return np.asarray(result)


def _prepare(problem: Problem, resolution: float) -> Evaluate:
    mesh = Mesh(problem, int(resolution))
    h = mesh.h
    mass, damping, stiffness = assembled(mesh)
    below, on, above = (m + h * h / 4 * k for m, k in zip(mass, stiffness, strict=True))
    factors = dgttrf(below, on + h / 2 * damping, above)[:5]
    # at tau = 0; a node that has no mass at all, a ground that moves as told, starts with what its load gains
    start_on = np.where(mass[1] > 0, mass[1], 1.0)
    start = dgttrf(mass[0], start_on, mass[2])[:5]
    push = np.zeros(mesh.size)
    push[mesh.nodes] = np.where(mass[1][mesh.nodes] > 0, mesh.loads[0], 2 * mesh.loads[0] / (h / 2))
    damped = np.where(mass[1] > 0, damping, 0.0)

    def evaluate(taus: Array) -> Array:
        seen = mesh.seen
        u, v = np.zeros(mesh.size), mesh.velocity.copy()
        a = dgttrs(*start, push - damped * v)[0]
        displacement, velocity = np.empty((2, mesh.steps + 1, len(seen)))
        displacement[0], velocity[0] = u[seen], v[seen]
        for step in range(1, mesh.steps + 1):
            u += h * v + h * h / 4 * a
            v += h / 2 * a
            right = -product(stiffness, u) - damping * v
            right[mesh.nodes] += mesh.loads[step]
            a = dgttrs(*factors, right)[0]
            u += h * h / 4 * a
            v += h / 2 * a
            displacement[step], velocity[step] = u[seen], v[seen]
        return mesh.outputs(displacement, velocity, taus)

    return evaluate


RIVAL = Rival("finite elements, Newmark", "SciPy", "elements per rod", (10, 20, 50, 100, 200, 500, 1000), _prepare)
