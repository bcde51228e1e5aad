"""Rods as linear finite elements, and Newmark's average acceleration, over any network.

A rod has N elements in a unit of its delay, at least 4, and a step is 1/N: as long as a wave takes through an element
where N elements make up the rod exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from wavesym.mechanics.gauge import Gauge
from wavesym.methods.network_problem import undamped_problem
from wavesym.methods.problem import Evaluate, Method, Problem
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import fraction

FEWEST = 4
"""Elements or cells of a rod, at least: a strain is read from so many points."""

Unknowns = NDArray[np.int_]
Matrix = Any
"""A sparse matrix; SciPy has no types."""


@dataclass(frozen=True)
class Elements:
    """The unknowns: displacements of the points, then of what is inside the bars, one bar after the other.

    `cells` is how many elements each bar has, (bars,); `weight` is 1 where they have their consistent mass, 0 where
    they are springs alone.
    """

    problem: Problem
    cells: Unknowns
    weight: float = 1.0

    @cached_property
    def firsts(self) -> Unknowns:
        """The first unknown inside each bar, and the number of unknowns: (bars + 1,)."""
        return np.append(0, np.cumsum(self.cells - 1)) + self.problem.points

    @property
    def size(self) -> int:
        """The number of unknowns."""
        return int(self.firsts[-1])

    def bar_unknowns(self, bar: int) -> tuple[Unknowns, Array]:
        """The unknowns from one end of a bar to the other, and how many times as fast as these it moves there."""
        inside = np.arange(self.firsts[bar], self.firsts[bar + 1])
        left, right = self.problem.ends[bar]
        factors = np.ones(len(inside) + 2)
        factors[[0, -1]] = self.problem.ratios[bar]
        return np.concatenate([[left], inside, [right]]), factors

    @cached_property
    def length(self) -> Array:
        """How long a wave takes through an element of each bar: (bars,)."""
        return np.asarray(self.problem.delay / self.cells)

    @cached_property
    def _sides(self) -> tuple[Matrix, Matrix]:
        """What moves the left and the right side of each element: (elements, unknowns)."""
        bars = [self.bar_unknowns(bar) for bar in range(len(self.cells))]
        rows, shape = np.arange(np.sum(self.cells)), (int(np.sum(self.cells)), self.size)
        sides = []
        for part in (slice(None, -1), slice(1, None)):
            unknowns = np.concatenate([np.zeros(0, int), *(unknowns[part] for unknowns, _ in bars)])
            factors = np.concatenate([np.zeros(0), *(factors[part] for _, factors in bars)])
            sides.append(csr_array((factors, (rows, unknowns)), shape=shape))
        return sides[0], sides[1]

    @cached_property
    def stretch(self) -> Matrix:
        """By how much elements become longer: (elements, unknowns)."""
        return self._sides[1] - self._sides[0]

    @cached_property
    def mean(self) -> Matrix:
        """How elements move in the mean: (elements, unknowns)."""
        return (self._sides[0] + self._sides[1]) / 2

    def each(self, values: Array) -> Array:
        """A value of each bar, as that of each element."""
        return np.repeat(values, self.cells)

    @cached_property
    def _masses(self) -> Array:
        return self.each(self.weight * self.problem.impedance * self.length)

    @cached_property
    def mass(self) -> Matrix:
        """The mass of points and rods; the consistent one of an element is 1/3 at its ends and 1/6 across."""
        mean = self.mean.T @ diags_array(self._masses) @ self.mean
        return (
            mean
            + self.stretch.T @ diags_array(self._masses / 12) @ self.stretch
            + self._at_points(np.diag(self.problem.mass))
        )

    @cached_property
    def stiffness(self) -> Matrix:
        """The stiffness of rods and springs."""
        return self.stretch.T @ diags_array(self._springs) @ self.stretch + self._at_points(self.problem.stiffness)

    @cached_property
    def _springs(self) -> Array:
        return self.each(self.problem.impedance / self.length)

    @cached_property
    def damping(self) -> Matrix:
        """The dashpots."""
        return self._at_points(self.problem.damping)

    def _at_points(self, matrix: Array) -> Matrix:
        rows, columns = np.nonzero(matrix)
        return csr_array((matrix[rows, columns], (rows, columns)), shape=(self.size, self.size))

    @cached_property
    def start_forces(self) -> Array:
        """What the strain that the bars have at the start does to the points: (points,)."""
        pull = self.each(self.problem.impedance * self.problem.speed * self.problem.start_strain)
        forces = -(self.stretch.T @ pull)[: self.problem.points]
        forces[list(self.problem.prescribed_points)] = 0.0
        return np.asarray(forces)

    @cached_property
    def momentum(self) -> Array:
        """The momentum of points and rods at tau = 0, as each unknown has a share in it: (size,)."""
        shares = self.mean.T @ (self._masses * self.each(self.problem.start_velocity))
        shares[: self.problem.points] += self.problem.mass * self.problem.velocity
        return np.asarray(shares)

    def imposed_shape(self, point: int) -> Array:
        """How all moves with a prescribed point that moves by 1 where no rod is strained: (size,).

        What no rod ties to it stays, and other prescribed points do.
        """
        points, rods = self.problem.rigid_motion(point, bars=True, held=self.problem.prescribed_points)
        return np.concatenate([points, np.repeat(rods, self.cells - 1)])

    def forces(self, shape: Array) -> Array:
        """The forces that displacements (size,) need: exactly 0 for what strains no rod."""
        held = self._at_points(self.problem.stiffness) @ shape
        return np.asarray(held + self.stretch.T @ (self._springs * (self.stretch @ shape)))


def stencil(reading: Gauge, cells: int) -> tuple[Unknowns, Array]:
    """What a reading inside a bar is interpolated from, of order 2 in the length of a cell.

    Args:
        reading: a strain, or any other quantity.
        cells: how many the bar has.

    Returns:
        Numbers of points of the bar, 0 to `cells`, and their weights. Those of a strain are for the slope over a cell:
        a line through central differences at two points, as every second point may be a solution of its own.
    """
    place = float(fraction(reading.place)) * cells
    if reading.quantity == "strain":
        first = int(np.clip(np.floor(place), 1, cells - 2))
        u = place - first
        return first - 1 + np.arange(4), np.array([u - 1, -u, 1 - u, u]) / 2
    first = int(np.clip(np.floor(place), 0, cells - 1))
    return first + np.arange(2), np.array([1 + first - place, place - first])


Stencils = list[tuple[Unknowns, Array]]
"""Of each reading the places of a field that it is interpolated from, and their weights."""


def keep_places(stencils: Stencils) -> tuple[Unknowns, Stencils]:
    """The places that stencils read, each once, and the same stencils on what is kept of a field there."""
    kept = np.unique(np.concatenate([places for places, _ in stencils]))
    return kept, [(np.searchsorted(kept, places), weights) for places, weights in stencils]


def interpolate_readings(
    problem: Problem, stencils: Stencils, times: Array, fields: tuple[Array, Array], taus: Array
) -> Array:
    """The readings at `taus`, (readings, n), by lines between `times` (k,).

    `fields` are displacements and velocities (k, places).
    """
    rows = []
    for reading, (places, weights) in zip(problem.readings, stencils, strict=True):
        field = fields[reading.quantity == "velocity"]
        rows.append(np.interp(taus, times, field[:, places] @ weights) + problem.strain_at_start(reading))
    return np.array(rows)


def _solve(problem: Problem, resolution: float) -> Evaluate:
    h = 1 / resolution
    elements = Elements(problem, np.maximum(np.rint(problem.delay / h), FEWEST).astype(int))
    mass, damping, stiffness = _prescribe_motion(elements)
    start = np.append(problem.velocity, np.repeat(problem.start_velocity, elements.cells - 1))
    solve = splu(csc_array(mass + h / 2 * damping + h * h / 4 * stiffness)).solve
    steps = int(np.ceil(problem.until * resolution)) + 1
    times: Array = h * np.arange(steps + 1, dtype=np.float64)
    loads = problem.load_means(np.maximum(times - h / 2, 0.0), times + h / 2) + elements.start_forces
    # at tau = 0; what moves as prescribed starts with what its velocity gains
    massless = mass.diagonal() == 0
    begin = splu(csc_array(mass + diags_array(massless.astype(float)))).solve
    force = np.append(loads[0], np.zeros(elements.size - problem.points)) - damping @ start
    force[massless] *= np.isin(np.flatnonzero(massless), problem.prescribed_points) * 4 / h
    kept, stencils = keep_places([_unknowns(elements, reading) for reading in problem.readings])
    has_damping = bool(damping.nnz)

    def evaluate(taus: Array) -> Array:
        u, v = np.zeros(elements.size), start.copy()
        a = begin(force)
        displacement, velocity = np.empty((2, steps + 1, len(kept)))
        displacement[0], velocity[0] = u[kept], v[kept]
        for step in range(1, steps + 1):
            u += h * v + h * h / 4 * a
            v += h / 2 * a
            right = -(stiffness @ u)
            if has_damping:
                right -= damping @ v
            right[: problem.points] += loads[step]
            a = solve(right)
            u += h * h / 4 * a
            v += h / 2 * a
            displacement[step], velocity[step] = u[kept], v[kept]
        return interpolate_readings(problem, stencils, times, (displacement, velocity), taus)

    return evaluate


def _prescribe_motion(elements: Elements) -> tuple[Matrix, Matrix, Matrix]:
    """Mass, damping and stiffness; where the motion is prescribed the velocity is the load."""
    free = np.ones(elements.size)
    free[list(elements.problem.prescribed_points)] = 0.0
    mass, damping, stiffness = (
        diags_array(free) @ each for each in (elements.mass, elements.damping, elements.stiffness)
    )
    own = csr_array(diags_array(1 - free))
    own.eliminate_zeros()
    return mass, csr_array(damping + own), csr_array(stiffness)


def _unknowns(elements: Elements, reading: Gauge) -> tuple[Unknowns, Array]:
    """The unknowns that a reading is interpolated from, and their weights."""
    if reading.point is not None:
        return np.array([reading.point]), np.ones(1)
    bar = reading.rod - 1
    unknowns, factors = elements.bar_unknowns(bar)
    places, weights = stencil(reading, int(elements.cells[bar]))
    if reading.quantity == "strain":
        weights = weights / (elements.problem.speed[bar] * elements.length[bar])
    return unknowns[places], weights * factors[places]


NEWMARK = Method(
    "finite elements, Newmark",
    "SciPy",
    "elements in a unit of delay",
    (10, 20, 50, 100, 200, 500, 1000),
    undamped_problem,
    _solve,
)
