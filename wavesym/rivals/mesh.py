"""What methods on a mesh share: N equal cells a rod, time steps as long as a cell, and how outputs are read off."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wavesym.rivals.problem import Array, Problem


@dataclass(frozen=True)
class Mesh:
    """Points k = 0 ... m cells at x = k / cells; every `cells`-th is a node of the chain. Steps of tau: 1 / cells."""

    problem: Problem
    cells: int

    @property
    def h(self) -> float:
        """The length of a cell and of a step."""
        return 1.0 / self.cells

    @property
    def size(self) -> int:
        """How many points."""
        return (self.problem.nodes - 1) * self.cells + 1

    @property
    def steps(self) -> int:
        """How many steps reach the end and one beyond."""
        return int(np.ceil(self.problem.until * self.cells)) + 1

    @property
    def nodes(self) -> slice:
        """The chain's nodes among the points."""
        return slice(0, None, self.cells)

    @cached_property
    def velocity(self) -> Array:
        """The velocity of the points at tau = 0."""
        field = np.append(np.repeat(self.problem.rods, self.cells), 0.0)
        field[self.nodes] = self.problem.velocity
        return field

    @cached_property
    def loads(self) -> Array:
        """The loads' means over half a step before and after k h, for k = 0 only after: (steps + 1, nodes)."""
        times = self._times
        return self.problem.load_mean(np.maximum(times - self.h / 2, 0.0), times + self.h / 2)

    @cached_property
    def moved(self) -> Array:
        """The loads' integrals up to k h, which move a node whose velocity is its load: (steps + 1, nodes)."""
        times = self._times
        means = self.problem.load_mean(np.zeros(self.steps), times[1:])
        return np.vstack([np.zeros(self.problem.nodes), means * times[1:, np.newaxis]])

    @property
    def _times(self) -> Array:
        return np.asarray(np.arange(self.steps + 1) * self.h, dtype=np.float64)

    @cached_property
    def _stencils(self) -> tuple[tuple[NDArray[np.intp], Array], ...]:
        """For every output the points that it is read from, and their weights: order 2 in the cells' length."""
        found: list[tuple[NDArray[np.intp], Array]] = []
        for watch in self.problem.watches:
            place = watch.offset * self.cells
            start = (watch.rod - 1) * self.cells
            if watch.quantity == "strain":
                # a line through central differences at two points: neighbours are not subtracted from each other, as
                # odd and even points are two solutions at Courant number 1, which a jump sets a little apart
                first = int(np.clip(np.floor(place), 1, self.cells - 2))
                u = place - first
                weights = np.array([u - 1, -u, 1 - u, u]) * (self.cells / 2)
                found.append((start + first - 1 + np.arange(4), weights))
            else:
                first = int(np.clip(np.floor(place), 0, self.cells - 1))
                u = place - first
                found.append((start + first + np.arange(2), np.array([1 - u, u])))
        return tuple(found)

    @cached_property
    def seen(self) -> Array:
        """The points that outputs are read from."""
        return np.unique(np.concatenate([points for points, _ in self._stencils]))

    def outputs(self, displacement: Array, velocity: Array, taus: Array) -> Array:
        """The outputs at taus from the two fields at the points `seen`, (steps + 1, len(seen)); lines between steps."""
        rows = []
        times = np.arange(len(displacement)) * self.h
        for watch, (points, weights) in zip(self.problem.watches, self._stencils, strict=True):
            field = velocity if watch.quantity == "velocity" else displacement
            rows.append(np.interp(taus, times, field[:, np.searchsorted(self.seen, points)] @ weights))
        return np.array(rows)
