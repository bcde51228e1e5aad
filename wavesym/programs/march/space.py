"""A joint as a system with a state: the velocities of its masses, and how long its springs have become; all exact.

With s what acts on its points (forces; of a point whose motion is prescribed its velocity), M, C and K of the joint and
the springs k, whose lengthening is B u,

    M q' + C q + B' k z = s,    z' = B q    become    x' = rates x + pushed s,    q = shown x + passed s,

x = (q of points with mass, z), once points without mass are put in terms of x and s. An end whose point moves with q
sends n q - a; what arrives acts with 2 n Z a. The energy of the state is sum of weights x**2 / 2.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from math import sqrt
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mat
from numpy.typing import NDArray

from wavesym.exact.joints.joint_law import JointLaw, joint_ends
from wavesym.exact.joints.state_space import ElasticState, Rows, state_space
from wavesym.mechanics.network import Joint, Network
from wavesym.numbers.doubles import nearest

SCATTERER, BODY, BLOCK = 0, 1, 2

_ZERO = fmpq(0)


@dataclass(frozen=True)
class Port:
    """An end of a bar at a point of a joint: the impedance and the ratio, and what a wave that arrives acts with."""

    point: int
    impedance: fmpq
    ratio: fmpq
    push: fmpq


@dataclass(frozen=True)
class JointSpace:
    """The laws of a joint; `weights` are masses and springs, `initial_state` is x at tau = 0.

    A state is the velocity of the point that it `moves_with`, or, where that is -1, how much longer a spring has
    become: x' = `lengthening` q, with rows of 0 for velocities. Laws that are functions of parameters are rows, and
    those of numbers exact matrices, of which all that follows is known.
    """

    points: int
    rates: Any
    input_rates: Any
    state_velocities: Any
    feedthrough: Any
    lengthening: Any
    moves_with: tuple[int, ...]
    weights: tuple[Any, ...]
    initial_state: tuple[Any, ...]
    ports: tuple[Port, ...]

    @property
    def states(self) -> int:
        """How many numbers x has."""
        return len(self.weights)

    @cached_property
    def is_body(self) -> bool:
        """Whether it is one mass between rods and dashpots, without springs."""
        alone = self.states == self.points == 1 and self.moves_with == (0,)
        return alone and (not isinstance(self.rates, fmpq_mat) or self.rates[0, 0] < 0)

    @property
    def law(self) -> int:
        """What its step is, in tables: `SCATTERER`, `BODY` or `BLOCK`, whatever parameters are."""
        return SCATTERER if not self.states else BODY if self.is_body else BLOCK

    @property
    def rate(self) -> fmpq:
        """That of a body: q'/rate + q = drive times what acts on it."""
        return fmpq(-self.rates[0, 0])

    @property
    def drive(self) -> fmpq:
        """What acts on a body counts so much; of other joints 0."""
        return self.input_rates[0, 0] / self.rate if self.law == BODY else _ZERO

    def speed_up(self, times: fmpq) -> JointSpace:
        """The same, so many times as fast."""
        changes = {name: times * getattr(self, name) for name in ("rates", "input_rates", "lengthening")}
        return replace(self, **changes)

    @cached_property
    def norm(self) -> float:
        """That of `rates` where the energy is |x|**2 / 2, at most: it bounds how fast anything in the joint is."""
        return _norm(self._balanced)

    @cached_property
    def swing(self) -> float:
        """How fast its bodies swing on their springs, at most, as if nothing took their energy."""
        return _norm((self._balanced - self._balanced.T) / 2)

    @cached_property
    def turning(self) -> float:
        """About how fast its bodies swing on their springs, where nothing takes their energy; 0 where that is more."""
        decay = float(np.max(-np.diag(self._balanced), initial=0.0))
        return sqrt(max(self.swing**2 - decay**2 / 4, 0.0))

    @cached_property
    def _balanced(self) -> NDArray[np.float64]:
        roots = [sqrt(nearest(weight)) for weight in self.weights]
        rows = [
            [nearest(self.rates[a, b]) * roots[a] / roots[b] for b in range(self.states)] for a in range(self.states)
        ]
        return np.array(rows).reshape(self.states, self.states)

    @cached_property
    def scattering(self) -> fmpq_mat:
        """Of a joint without state: what goes back into each end, from what arrives at each and acts on each point."""
        ends, points = len(self.ports), self.points
        rows = fmpq_mat(ends, ends + points)
        for i, port in enumerate(self.ports):
            for j, other in enumerate(self.ports):
                rows[i, j] = port.ratio * self.feedthrough[port.point, other.point] * other.push - (i == j)
            for k in range(points):
                rows[i, ends + k] = port.ratio * self.feedthrough[port.point, k]
        return rows

    @cached_property
    def key(self) -> tuple[object, ...]:
        """Joints with the same one answer alike."""
        matrices = (self.rates, self.input_rates, self.state_velocities, self.feedthrough)
        return tuple(tuple(map(str, each.entries())) for each in matrices)


SHOWN = JointSpace(
    points=1,
    rates=fmpq_mat(0, 0),
    input_rates=fmpq_mat(0, 1),
    state_velocities=fmpq_mat(1, 0),
    feedthrough=fmpq_mat(1, 1, [1]),
    lengthening=fmpq_mat(0, 1),
    moves_with=(),
    weights=(),
    initial_state=(),
    ports=(Port(0, _ZERO, fmpq(1), _ZERO),),
)
"""A point that moves as a load says, and does nothing: where that load is read."""


def joint_space(network: Network, joint: Joint) -> JointSpace:
    """The laws of one joint of a network, in numbers."""
    rows = joint_rows(network, joint)
    return replace(
        rows,
        rates=_matrix(rows.rates, rows.states),
        input_rates=_matrix(rows.input_rates, rows.points),
        state_velocities=_matrix(rows.state_velocities, rows.states),
        feedthrough=_matrix(rows.feedthrough, rows.points),
        lengthening=_matrix(rows.lengthening, rows.points),
    )


def _matrix(rows: Rows, width: int) -> fmpq_mat:
    return fmpq_mat(len(rows), width, list(chain.from_iterable(rows)))


def joint_rows(network: Network, joint: Joint) -> JointSpace:
    """The same, also where numbers of the network are functions."""
    law = JointLaw.assemble(network, joint)
    springs = list(_springs(network, joint, law))
    elastic = [ElasticState(row, {k: factor * stiffness for k, factor in row.items()}) for stiffness, row in springs]
    space = state_space(law, elastic)
    growth: list[dict[int, fmpq]] = [*({} for _ in law.heavy), *(row for _, row in springs)]
    return JointSpace(
        len(joint.points),
        space.rates,
        space.input_rates,
        space.state_velocities,
        space.feedthrough,
        [[row.get(k, _ZERO) for k in range(len(joint.points))] for row in growth],
        (*law.heavy, *(-1 for _ in springs)),
        (*(law.mass[k] for k in law.heavy), *(stiffness for stiffness, _ in springs)),
        (*(network.points[joint.points[k]].velocity for k in law.heavy), *(_ZERO for _ in springs)),
        tuple(_ports(network, joint)),
    )


def _springs(network: Network, joint: Joint, law: JointLaw) -> Iterator[tuple[fmpq, dict[int, fmpq]]]:
    """Each spring that a free point feels, and how much longer it becomes with each point."""
    place = {point: k for k, point in enumerate(joint.points)}
    for point, k in place.items():
        if (stiffness := network.points[point].stiffness) != 0 and law.motions[k] is None:
            yield stiffness, {k: fmpq(1)}
    for link in network.links:
        if link.left in place and link.stiffness != 0:
            a, b = place[link.left], place[link.right]
            if a != b and any(law.motions[k] is None for k in (a, b)):
                yield link.stiffness, {a: -link.ratio, b: fmpq(1)}


def _ports(network: Network, joint: Joint) -> Iterator[Port]:
    for each in joint_ends(network, joint):
        free = network.points[joint.points[each.place]].motion is None
        yield Port(each.place, network.bars[each.end.bar].impedance, each.ratio, each.force if free else _ZERO)


def _norm(matrix: NDArray[np.float64]) -> float:
    """An upper bound of the 2-norm: the root of those of the largest sums of rows and of columns, rounded up."""
    size = np.abs(matrix)
    rows, columns = (float(np.max(np.sum(size, axis=axis), initial=0.0)) for axis in (0, 1))
    return sqrt(rows * columns) * (1 + 1e-12)
