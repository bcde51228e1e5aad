"""A line of equal rods, as the paper has them: what most rivals take, and what they say of any other chain."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from wavesym.errors import UnservedError
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.rivals.network import NetworkProblem, network_problem
from wavesym.rivals.problem import Array, Problem, Watch


def stated(model: Model) -> Problem:
    """The problem of a model. UnservedError where it is no line of equal rods between bodies that start as these do."""
    network = network_problem(model)
    for what in _beyond(network):
        raise UnservedError(f"system: {what} given, a line of equal rods expected")
    told = np.isin(np.arange(network.points), network.told)
    beside = np.append(0.0, network.impedance), np.append(network.impedance, 0.0)
    made = Problem(
        inertia=network.mass,
        alpha=np.where(told, 0.0, 2 * beside[0]),
        beta=np.where(told, 0.0, 2 * beside[1]),
        damping=np.where(told, 1.0, np.diag(network.damping)),
        rods=network.moving,
        events=network.events,
        watches=tuple(Watch(probe.quantity, probe.rod, nearest(probe.place)) for probe in network.probes),
        until=network.until,
    )
    if not _same(made.velocity[made.inertia > 0], network.velocity[made.inertia > 0]):
        raise UnservedError("system: a mass that is faster than its rods given, a line of equal rods expected")
    return made


def _beyond(network: NetworkProblem) -> Iterator[str]:
    """What a line of equal rods does not have."""
    if network.ends != tuple((x, x + 1) for x in range(network.points - 1)):
        yield "a branch or a link"
    if not (_same(network.delay, 1.0) and _same(network.speed, 1.0)):
        yield "a rod of another length or speed than 1"
    if np.any(network.stiffness) or np.any(network.damping - np.diag(np.diag(network.damping))):
        yield "a spring, or a dashpot between points,"
    if not _same(network.ratios, 1.0) or np.any(network.strain):
        yield "a gear, or a rod strained at the start,"


def _same(one: Array, other: Array | float) -> bool:
    return bool(np.all(one == other))
