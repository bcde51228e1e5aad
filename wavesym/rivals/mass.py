"""Rods as linear finite elements between points: what they weigh, hold and carry, over any network.

A rod may count as a spring alone: its elements then have no mass.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wavesym.rivals.network import NetworkProblem
from wavesym.rivals.problem import Array

Unknowns = NDArray[np.int_]
Entries = tuple[Array, tuple[Unknowns, Unknowns]]
"""Values at rows and columns, those at the same place to be added."""


@dataclass(frozen=True)
class Elements:
    """The unknowns: displacements of the points, then of what is inside the bars, one bar after the other.

    `cells` is how many elements each bar has, (bars,); `weight` is 1 where they have their consistent mass, or 0.
    """

    problem: NetworkProblem
    cells: Unknowns
    weight: float = 1.0

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

    def length(self, bar: int) -> float:
        """How long a wave takes through one of a bar's elements."""
        return float(self.problem.delay[bar] / self.cells[bar])

    @cached_property
    def mass(self) -> Entries:
        """The mass of points and rods."""
        points = np.arange(self.problem.points)
        own = (self.problem.mass, (points, points))
        thirds = (self._pairs(bar, self._heavy(bar) / 3, self._heavy(bar) / 6) for bar in range(len(self.cells)))
        return _joined([own, *thirds])

    @cached_property
    def stiffness(self) -> Entries:
        """The stiffness of rods and springs."""
        rows, columns = np.nonzero(self.problem.stiffness)
        springs = (self.problem.stiffness[rows, columns], (rows, columns))
        rods = (self.problem.impedance[bar] / self.length(bar) for bar in range(len(self.cells)))
        return _joined([springs, *(self._pairs(bar, k, -k) for bar, k in enumerate(rods))])

    @cached_property
    def damping(self) -> Entries:
        """The dashpots."""
        rows, columns = np.nonzero(self.problem.damping)
        return self.problem.damping[rows, columns], (rows, columns)

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
    def momentum(self) -> Array:
        """That of points and rods at tau = 0, as each unknown has a share in it: (size,)."""
        shares = np.zeros(self.size)
        shares[: self.problem.points] = self.problem.mass * self.problem.velocity
        for bar, moving in enumerate(self.problem.moving.tolist()):
            unknowns, factors = self.along(bar)
            for ends in (slice(None, -1), slice(1, None)):
                np.add.at(shares, unknowns[ends], self._heavy(bar) * moving / 2 * factors[ends])
        return shares

    def dragged(self, point: int) -> Array:
        """How all moves with a point that moves by 1 where no rod is strained, as far as no other told one: (size,).

        What no rod ties to it stays.
        """
        shape, coming = np.zeros(self.size), [point]
        shape[point] = 1.0
        while coming:
            here = coming.pop()
            for bar, side, at, ratio, _ in self.problem.at_ends():
                if at == here:
                    far, speed = self.problem.ends[bar][1 - side], ratio * shape[here]
                    shape[self.firsts[bar] : self.firsts[bar + 1]] = speed
                    if shape[far] == 0 and far not in self.problem.told:
                        shape[far] = speed / self.problem.ratios[bar, 1 - side]
                        coming.append(far)
        return shape

    def pulling(self, shape: Array) -> Array:
        """The forces that displacements (size,) ask for: exactly 0 for what strains no rod."""
        forces = np.zeros(self.size)
        forces[: self.problem.points] = self.problem.stiffness @ shape[: self.problem.points]
        for bar in range(len(self.cells)):
            unknowns, factors = self.along(bar)
            pull = self.problem.impedance[bar] / self.length(bar) * np.diff(factors * shape[unknowns])
            np.add.at(forces, unknowns, factors * (np.append(0.0, pull) - np.append(pull, 0.0)))
        return forces

    def _heavy(self, bar: int) -> float:
        """The mass of one element."""
        return float(self.weight * self.problem.impedance[bar] * self.length(bar))

    def _pairs(self, bar: int, inner: float, across: float) -> Entries:
        """A matrix with `inner` on the diagonal of each element of a bar, and `across` beside it."""
        unknowns, factors = self.along(bar)

        def entries() -> Iterator[Entries]:
            for one, other in ((0, 0), (0, 1), (1, 0), (1, 1)):
                rows, columns = (slice(side, len(unknowns) - 1 + side) for side in (one, other))
                values = (inner if one == other else across) * factors[rows] * factors[columns]
                yield values, (unknowns[rows], unknowns[columns])

        return _joined(list(entries()))


def dense(entries: Entries, size: int) -> Array:
    """A matrix of its entries: (size, size)."""
    values, places = entries
    matrix = np.zeros((size, size))
    np.add.at(matrix, places, values)
    return matrix


def _joined(parts: list[Entries]) -> Entries:
    values, places = zip(*parts, strict=True)
    rows, columns = zip(*places, strict=True)
    return np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
