"""Momentum and energy of the whole chain: every right evaluator keeps them, and none is told of them.

The force in a rod is Z dU/dx, with a stiffness Z of its own. (2.4) times a weight w, such that w alpha/2 and w beta/2
are the Z of the rods to the left and right, is the balance of forces at a node; along the chain inner forces cancel:

    momentum = sum of w inertia q + sum of Z times the integral of U_t                  grows by the impulse of loads,
    energy = sum of w inertia q^2/2 + sum of Z/2 times the integral of U_t^2 + U_x^2    grows by their work.

A base that moves as it is told acts with the force of its rod. Z is 1 in the first rod. A rod is known from its ends:
what is in it came in during the last unit of tau, (U_t - U_x)/2 at the left end and (U_t + U_x)/2 at the right one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.mechanics.chain import Chain
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.mechanics.node import Quantity
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import UNIT_ROUNDOFF, nearest

Array = NDArray[np.float64]
Evaluate = Callable[[Array], Array]
"""tau, shape (n,), to the outputs, shape (outputs, n)."""

# of Gauss's rule between two fronts, where everything is an entire function; half as many say how much is missed
_POINTS = 32

# a sum rounds no more often than there are windows and points in one
_ROUNDINGS = 100


@dataclass(frozen=True)
class Balance:
    """By how much a balance fails at most at tau = 1, 2, ... and by how much it may.

    Energy relative to its largest value, momentum to the largest that all the mass can have with that energy.
    """

    name: str
    error: float
    allowed: float


class MomentumWeights(NamedTuple):
    """What stands before velocities in the momentum: of nodes with inertia and others, and of rods."""

    nodes: tuple[fmpq, ...]
    rods: tuple[fmpq, ...]


def weights(system: Chain) -> MomentumWeights:
    """The weights of nodes x = 0 ... m and rods i = 1 ... m; 0 for a node that no rod acts on."""
    rods = [fmpq(1)]
    first = system.nodes[0].beta
    nodes = [2 / first if first != 0 else fmpq(0)]
    for node in system.nodes[1:]:
        nodes.append(2 * rods[-1] / node.alpha if node.alpha != 0 else fmpq(0))
        rods.append(nodes[-1] * node.beta / 2)
    return MomentumWeights(tuple(nodes), tuple(rods[:-1]))


def watched(model: Model, until: int) -> Model:
    """The model as it is watched here: strains at the left ends of rods, then at their right ends, and all velocities.

    A contact has one strain.
    """
    left_ends, right_ends = _ends(model.named)
    strains = {probe.name: probe for probe in left_ends + right_ends}.values()
    return model.watching([*strains, *_velocities(model.named)]).shortened(fmpq(until))


def values_per_window(model: Model) -> tuple[int, int]:
    """How many outputs a model has when it is `watched`, and how many values of them a window of tau takes."""
    outputs = len(watched(model, 1).probes)
    panels = len(_cuts(model.loads)) - 1
    return outputs, outputs * panels * (_POINTS + _POINTS // 2)


def balances(model: Model, evaluate: Evaluate, errors: Sequence[float]) -> tuple[Balance, Balance]:
    """The balances of momentum and energy of a `watched` model, as `evaluate` has it.

    `errors` are the proved errors of the outputs, absolute: what they come to is allowed, and what quadrature misses.
    """
    fine, coarse = (_Books(model, evaluate, np.array(errors), points) for points in (_POINTS, _POINTS // 2))
    largest = float(np.max(fine.energy.value)) or 1.0
    unit = _ROUNDINGS * len(fine.energy.value) * float(UNIT_ROUNDOFF)

    def balance(name: str, scale: float) -> Balance:
        ours, theirs = getattr(fine, name), getattr(coarse, name)
        missed = float(np.max(np.abs(ours.failing - theirs.failing)))
        error, slack = float(np.max(np.abs(ours.failing))), float(np.max(ours.slack))
        return Balance(name, error / scale, (slack + missed) / scale + unit)

    return balance("momentum", (2 * largest * fine.mass) ** 0.5), balance("energy", largest)


class _Account(NamedTuple):
    """At tau = 0, 1, 2, ...: a sum, by how much it is not what was there and what came, and what errors come to."""

    value: Array
    failing: Array
    slack: Array


class _Books:
    """Momentum and energy from what happens at the nodes, with so many points between two fronts."""

    def __init__(self, model: Model, evaluate: Evaluate, errors: Array, points: int) -> None:
        self._chain = model.named
        self._windows = int(model.until.floor())
        self._loads = [load for load in model.loads if load.source != "impact"]
        times, self._gauss = _quadrature(_cuts(model.loads), self._windows, points)
        self._times = times
        values = evaluate(times.ravel()).reshape(-1, *times.shape)
        ends = evaluate(np.arange(1.0, self._windows + 1))
        names = [probe.name for probe in model.probes]
        left, right = ([names.index(probe.name) for probe in ends] for ends in _ends(self._chain))
        velocity = [names.index(probe.name) for probe in _velocities(self._chain)]
        self._q, self._q_error = values[velocity], errors[velocity]
        self._strains = (values[left], errors[left]), (values[right], errors[right])
        self._reached = ends[velocity]
        exact_weights = weights(self._chain)
        bodies = [w * node.inertia for w, node in zip(exact_weights.nodes, self._chain.nodes, strict=True)]
        self._bodies, self._rods = (np.array([nearest(w) for w in each]) for each in (bodies, exact_weights.rods))
        self._nodes = np.array([nearest(w) for w in exact_weights.nodes])
        self.mass = float(np.sum(self._bodies) + np.sum(self._rods))

    @cached_property
    def momentum(self) -> _Account:
        """Of bodies and rods, and the impulse of what acts from outside."""
        value = self._bodies @ self._reached
        slack = np.zeros(self._windows) + self._bodies @ self._q_error
        for came_in, error in self._came_in:
            value += self._rods @ (came_in @ self._gauss)
            slack += self._rods @ error
        came = np.zeros(self._windows)
        for _, force, force_error in self._forces:
            came += np.cumsum(force @ self._gauss)
            slack += force_error * np.arange(1, self._windows + 1)
        return self._account(value, came, slack, self._started(lambda v: v))

    @cached_property
    def energy(self) -> _Account:
        """Kinetic and elastic, and the work of what acts from outside."""
        value = self._bodies @ self._reached**2 / 2
        slack = np.zeros(self._windows) + self._bodies @ _square_error(self._reached, self._q_error) / 2
        for came_in, error in self._came_in:
            value += self._rods @ (came_in**2 @ self._gauss)
            slack += self._rods @ (_square_error(came_in, error) @ self._gauss)
        came = np.zeros(self._windows)
        for x, force, force_error in self._forces:
            q, q_error = self._q[x], self._q_error[x]
            came += np.cumsum((force * q) @ self._gauss)
            error_of_power = np.abs(force) * q_error + np.abs(q) * force_error + force_error * q_error
            slack += np.cumsum(error_of_power @ self._gauss)
        return self._account(value, came, slack, self._started(lambda v: v * v / 2))

    @cached_property
    def _came_in(self) -> list[tuple[Array, Array]]:
        """What enters the rods at their left and at their right ends, and its error."""
        (left, left_error), (right, right_error) = self._strains
        return [
            ((self._q[:-1] - left) / 2, (self._q_error[:-1] + left_error) / 2),
            ((self._q[1:] + right) / 2, (self._q_error[1:] + right_error) / 2),
        ]

    @cached_property
    def _forces(self) -> list[tuple[int, Array, float]]:
        """Where something acts from outside, its force and the error of that."""
        (left, left_error), (right, right_error) = self._strains
        forces = []
        for x, node in enumerate(self._chain.nodes):
            if node.alpha == 0 and node.beta == 0:  # it moves as it is told, by the force of its rod
                if node.right:
                    forces.append((x, -self._rods[x] * left[x], float(self._rods[x] * left_error[x])))
                else:
                    forces.append((x, self._rods[x - 1] * right[x - 1], float(self._rods[x - 1] * right_error[x - 1])))
            elif node.loads or node.damping != 0:
                units = {load.source: load.coefficients for load in node.loads}
                braked = nearest(node.damping)
                force = _acting(self._loads, units, self._times) - braked * self._q[x]
                forces.append((x, self._nodes[x] * force, float(self._nodes[x] * braked * self._q_error[x])))
        return forces

    def _started(self, counted: Callable[[Array], Array]) -> float:
        """What is there at tau = 0: bodies move with the rods that are fixed to them."""
        nodes, rods = self._chain.nodes, range(1, self._chain.m + 1)
        bodies = np.array([nearest(node.velocity) for node in nodes])
        moving = np.array([nearest(self._chain.rod(i).velocity) for i in rods])
        return float(self._bodies @ counted(bodies) + self._rods @ counted(moving))

    def _account(self, value: Array, came: Array, slack: Array, before: float) -> _Account:
        return _Account(np.append(before, value), np.append(0.0, value - before - came), np.append(0.0, slack))


def _ends(chain: Chain) -> tuple[list[Probe], list[Probe]]:
    """The strains at the left and at the right ends of the rods; both are one where rods only touch."""

    def name(x: int, side: str) -> str:
        divided = 0 < x < chain.m and chain.nodes[x].inertia
        return f"strain@{x}{side}" if divided else f"strain@{x}"

    rods = range(1, chain.m + 1)
    return (
        [Probe(name(i - 1, "+"), "strain", i, fmpq(0)) for i in rods],
        [Probe(name(i, "-"), "strain", i, fmpq(1)) for i in rods],
    )


def _velocities(chain: Chain) -> list[Probe]:
    """The velocities of the nodes."""
    first = Probe("velocity@0", "velocity", 1, fmpq(0))
    return [first, *(Probe(f"velocity@{i}", "velocity", i, fmpq(1)) for i in range(1, chain.m + 1))]


def _cuts(loads: Sequence[Applied]) -> list[float]:
    """Where in a unit of tau a front may pass a node."""
    parts = {load.time - load.time.floor() for load in loads}
    return [nearest(cut) for cut in sorted({fmpq(0), fmpq(1), *parts})]


def _quadrature(cuts: Sequence[float], windows: int, points: int) -> tuple[Array, Array]:
    """Gauss's points between the cuts in every window, (windows, n), and their weights."""
    nodes, rule = np.polynomial.legendre.leggauss(points)
    local = np.concatenate([low + (high - low) * (nodes + 1) / 2 for low, high in pairwise(cuts)])
    gauss = np.concatenate([(high - low) * rule / 2 for low, high in pairwise(cuts)])
    return np.add.outer(np.arange(windows), local), gauss


def _acting(loads: Sequence[Applied], units: Mapping[str, Sequence[Quantity]], times: Array) -> Array:
    """The sum of the loads at a node whose unit loads are polynomials."""
    total = np.zeros_like(times)
    for load in loads:
        since = np.maximum(times - nearest(load.time), 0.0)
        for power, coefficient in enumerate(units.get(load.source, ())):
            total += np.where(since > 0, nearest(coefficient * load.weight) * since**power, 0.0)
    return total


def _square_error(value: Array, error: Array) -> Array:
    error = error.reshape(-1, *[1] * (value.ndim - 1))
    return np.asarray(2 * np.abs(value) * error + error**2)
