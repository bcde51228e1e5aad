"""Linear finite elements, consistent mass, and Newmark's average acceleration, over any network of rods.

A rod has N elements in a unit of its delay, at least 4, and a step is 1/N: as long as a wave takes through an element
where N elements make up the rod exactly.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import fraction
from wavesym.rivals.mass import Elements, Entries, Unknowns
from wavesym.rivals.network import NetworkProblem, network_problem
from wavesym.rivals.problem import Array, Evaluate, Rival

_FEWEST = 4

Matrix = Any  # a sparse one; SciPy has no types


def _prepare(problem: NetworkProblem, resolution: float) -> Evaluate:
    h = 1 / resolution
    elements = Elements(problem, np.maximum(np.rint(problem.delay / h), _FEWEST).astype(int))
    mass, damping, stiffness = _assembled(elements)
    start = np.append(problem.velocity, np.repeat(problem.moving, elements.cells - 1))
    solve = splu(csc_array(mass + h / 2 * damping + h * h / 4 * stiffness)).solve
    steps = int(np.ceil(problem.until * resolution)) + 1
    times: Array = h * np.arange(steps + 1, dtype=np.float64)
    loads = problem.load_mean(np.maximum(times - h / 2, 0.0), times + h / 2) + elements.pull
    # at tau = 0; what moves as it is told starts with what its velocity gains
    weightless = mass.diagonal() == 0
    begin = splu(csc_array(mass + diags_array(weightless.astype(float)))).solve
    push = np.append(loads[0], np.zeros(elements.size - problem.points)) - damping @ start
    push[weightless] *= np.isin(np.flatnonzero(weightless), problem.told) * 4 / h
    stencils = [_stencil(elements, probe) for probe in problem.probes]
    seen = np.unique(np.concatenate([where for where, _ in stencils]))
    held, braked = csr_array(stiffness), csr_array(damping) if damping.nnz else None

    def evaluate(taus: Array) -> Array:
        u, v = np.zeros(elements.size), start.copy()
        a = begin(push)
        displacement, velocity = np.empty((2, steps + 1, len(seen)))
        displacement[0], velocity[0] = u[seen], v[seen]
        for step in range(1, steps + 1):
            u += h * v + h * h / 4 * a
            v += h / 2 * a
            right = -(held @ u)
            if braked is not None:
                right -= braked @ v
            right[: problem.points] += loads[step]
            a = solve(right)
            u += h * h / 4 * a
            v += h / 2 * a
            displacement[step], velocity[step] = u[seen], v[seen]
        rows = []
        for probe, (where, weights) in zip(problem.probes, stencils, strict=True):
            field = velocity if probe.quantity == "velocity" else displacement
            row = np.interp(taus, times, field[:, np.searchsorted(seen, where)] @ weights)
            rows.append(row + _strained(problem, probe))
        return np.array(rows)

    return evaluate


def _assembled(elements: Elements) -> tuple[Matrix, Matrix, Matrix]:
    """Mass, damping and stiffness. Where the motion is told, the velocity is the load."""
    free = np.ones(elements.size)
    free[list(elements.problem.told)] = 0.0
    keep = diags_array(free)

    def matrix(entries: Entries) -> Matrix:
        return keep @ coo_array(entries, shape=(elements.size, elements.size))

    return (
        csc_array(matrix(elements.mass)),
        csc_array(matrix(elements.damping) + diags_array(1 - free)),
        csc_array(matrix(elements.stiffness)),
    )


def _strained(problem: NetworkProblem, probe: Probe) -> float:
    """What an output has of the strain at the start."""
    return float(problem.strain[probe.rod - 1]) if probe.quantity == "strain" else 0.0


def _stencil(elements: Elements, probe: Probe) -> tuple[Unknowns, Array]:
    """What an output is read from, and the weights, of order 2 in the elements' length."""
    if probe.point is not None:
        return np.array([probe.point]), np.ones(1)
    bar, cells = probe.rod - 1, int(elements.cells[probe.rod - 1])
    place = float(fraction(probe.place)) * cells
    unknowns, factors = elements.along(bar)
    if probe.quantity == "strain":
        # a line through central differences at two points
        first = int(np.clip(np.floor(place), 1, cells - 2))
        u = place - first
        chosen = first - 1 + np.arange(4)
        length = elements.problem.speed[bar] * elements.length(bar)
        weights = np.array([u - 1, -u, 1 - u, u]) / (2 * length)
    else:
        first = int(np.clip(np.floor(place), 0, cells - 1))
        chosen, weights = first + np.arange(2), np.array([1 + first - place, place - first])
    return unknowns[chosen], weights * factors[chosen]


RIVAL = Rival(
    "finite elements, Newmark",
    "SciPy",
    "elements in a unit of delay",
    (10, 20, 50, 100, 200, 500, 1000),
    network_problem,
    _prepare,
)
