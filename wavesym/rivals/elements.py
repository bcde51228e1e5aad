"""Linear finite elements, consistent mass, and Newmark's average acceleration, over any network of rods.

A rod has N elements in a unit of its delay, at least 4, and a step is 1/N: as long as a wave takes through an element
where N elements make up the rod exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from wavesym.model.probe import Probe
from wavesym.numbers.doubles import fraction
from wavesym.rivals.network import NetworkProblem, network_problem
from wavesym.rivals.problem import Array, Evaluate, Rival

_FEWEST = 4

Matrix = Any  # a sparse one; SciPy has no types
Unknowns = NDArray[np.int_]


@dataclass(frozen=True)
class Elements:
    """The unknowns: displacements of the points, then of what is inside the bars, one bar after the other."""

    problem: NetworkProblem
    h: float

    @cached_property
    def cells(self) -> Unknowns:
        """How many elements each bar has."""
        return np.maximum(np.rint(self.problem.delay / self.h), _FEWEST).astype(int)

    @cached_property
    def firsts(self) -> Unknowns:
        """The first unknown inside each bar, and how many there are in all."""
        return np.append(0, np.cumsum(self.cells - 1)) + self.problem.points

    @property
    def size(self) -> int:
        """How many unknowns."""
        return int(self.firsts[-1])

    def along(self, bar: int) -> tuple[Unknowns, Array]:
        """The unknowns from one end of a bar to the other, and how many times as fast as these it moves there."""
        inside = np.arange(self.firsts[bar], self.firsts[bar + 1])
        left, right = self.problem.ends[bar]
        factors = np.ones(len(inside) + 2)
        factors[[0, -1]] = self.problem.ratios[bar]
        return np.concatenate([[left], inside, [right]]), factors

    def assembled(self) -> tuple[Matrix, Matrix, Matrix]:
        """Mass, damping and stiffness. Where the motion is told, the velocity is the load."""
        problem = self.problem
        own = np.zeros(self.size)
        own[: problem.points] = problem.mass
        mass: list[Matrix] = [diags_array(own)]
        stiffness: list[Matrix] = []
        for bar, impedance in enumerate(problem.impedance.tolist()):
            unknowns, factors = self.along(bar)
            length = problem.delay[bar] / self.cells[bar]
            for matrix, inner, across in (
                (mass, impedance * length / 3, impedance * length / 6),
                (stiffness, impedance / length, -impedance / length),
            ):
                pairs = np.stack([unknowns[:-1], unknowns[1:]])
                scales = np.stack([factors[:-1], factors[1:]])
                for one in (0, 1):
                    for other in (0, 1):
                        value = (inner if one == other else across) * scales[one] * scales[other]
                        matrix.append(coo_array((value, (pairs[one], pairs[other])), shape=(self.size, self.size)))
        free = np.ones(self.size)
        free[list(problem.told)] = 0.0
        keep = diags_array(free)
        damping = self._at_points(problem.damping)
        return (
            csc_array(keep @ sum(mass)),
            csc_array(keep @ damping + diags_array(1 - free)),
            csc_array(keep @ (sum(stiffness) + self._at_points(problem.stiffness))),
        )

    def _at_points(self, matrix: Array) -> Matrix:
        rows, columns = np.nonzero(matrix)
        return csc_array(coo_array((matrix[rows, columns], (rows, columns)), shape=(self.size, self.size)))

    @cached_property
    def pull(self) -> Array:
        """What the strain that the bars have at the start does to the points: (points,)."""
        forces = np.zeros(self.problem.points)
        for bar, side, point, ratio, impedance in self.problem.at_ends():
            if point not in self.problem.told:
                force = impedance * self.problem.speed[bar] * self.problem.strain[bar]
                forces[point] += ratio * (-force if side else force)
        return forces

    @cached_property
    def velocity(self) -> Array:
        """The velocities at tau = 0."""
        return np.append(self.problem.velocity, np.repeat(self.problem.moving, self.cells - 1))

    def stencil(self, probe: Probe) -> tuple[Unknowns, Array]:
        """What an output is read from, and the weights, of order 2 in the elements' length."""
        if probe.point is not None:
            return np.array([probe.point]), np.ones(1)
        bar, cells = probe.rod - 1, int(self.cells[probe.rod - 1])
        place = float(fraction(probe.place)) * cells
        unknowns, factors = self.along(bar)
        if probe.quantity == "strain":
            # a line through central differences at two points
            first = int(np.clip(np.floor(place), 1, cells - 2))
            u = place - first
            chosen = first - 1 + np.arange(4)
            length = self.problem.speed[bar] * self.problem.delay[bar] / cells
            weights = np.array([u - 1, -u, 1 - u, u]) / (2 * length)
        else:
            first = int(np.clip(np.floor(place), 0, cells - 1))
            chosen, weights = first + np.arange(2), np.array([1 + first - place, place - first])
        return unknowns[chosen], weights * factors[chosen]


def _prepare(problem: NetworkProblem, resolution: float) -> Evaluate:
    h = 1 / resolution
    elements = Elements(problem, h)
    mass, damping, stiffness = elements.assembled()
    solve = splu(csc_array(mass + h / 2 * damping + h * h / 4 * stiffness)).solve
    steps = int(np.ceil(problem.until * resolution)) + 1
    times: Array = h * np.arange(steps + 1, dtype=np.float64)
    loads = problem.load_mean(np.maximum(times - h / 2, 0.0), times + h / 2) + elements.pull
    # at tau = 0; what moves as it is told starts with what its velocity gains
    weightless = mass.diagonal() == 0
    begin = splu(csc_array(mass + diags_array(weightless.astype(float)))).solve
    push = np.append(loads[0], np.zeros(elements.size - problem.points)) - damping @ elements.velocity
    push[weightless] *= np.isin(np.flatnonzero(weightless), problem.told) * 4 / h
    stencils = [elements.stencil(probe) for probe in problem.probes]
    seen = np.unique(np.concatenate([where for where, _ in stencils]))
    held, braked = csr_array(stiffness), csr_array(damping) if damping.nnz else None

    def evaluate(taus: Array) -> Array:
        u, v = np.zeros(elements.size), elements.velocity.copy()
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


def _strained(problem: NetworkProblem, probe: Probe) -> float:
    """What an output has of the strain at the start."""
    return float(problem.strain[probe.rod - 1]) if probe.quantity == "strain" else 0.0


RIVAL = Rival(
    "finite elements, Newmark",
    "SciPy",
    "elements in a unit of delay",
    (10, 20, 50, 100, 200, 500, 1000),
    network_problem,
    _prepare,
)
