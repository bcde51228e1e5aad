"""Outputs that are sums: rivals solve for strains, velocities and displacements, and these are added up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from flint import fmpq

from wavesym.mechanics.gauge import Gauge, Sum, Weighted
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Point
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import nearest
from wavesym.rivals.problem import Array, Evaluate, Rival

P = TypeVar("P")


@dataclass(frozen=True)
class Summed(Generic[P]):
    """A problem whose outputs are read, and what a scene's outputs are made of that: `weights` (outputs, read).

    `loads` are weights of polynomials (highest power first) from a time on, with the output that they are part of.
    """

    problem: P
    weights: Array
    loads: tuple[tuple[int, float, Array], ...]

    @property
    def plain(self) -> bool:
        """Whether nothing is added up."""
        return not self.loads and np.array_equal(self.weights, np.eye(*self.weights.shape))

    def added(self, values: Array, taus: Array) -> Array:
        """The scene's outputs, (outputs, n), from what is read."""
        total = self.weights @ values
        for output, time, powers in self.loads:
            since = taus - time
            total[output] += np.where(since >= 0, np.polyval(powers, since), 0.0)
        return np.asarray(total)


def summing(rival: Rival[P]) -> Rival[Summed[P]]:
    """The same method for any outputs."""

    def states(model: Model) -> Summed[P]:
        sums = [_terms(model, probe) for probe in model.probes]
        read = list(dict.fromkeys(each for terms in sums for _, each in terms if each.quantity != "load"))
        weights, loads = np.zeros((len(model.probes), len(read))), []
        for output, terms in enumerate(sums):
            for weight, each in terms:
                if each.quantity != "load":
                    weights[output, read.index(each)] = nearest(weight)
                elif each.point is not None:
                    loads += [(output, *acts) for acts in _acting(model, model.network.points[each.point], weight)]
        probes = [Probe(str(k), each.quantity, each.rod, each.place, each.point) for k, each in enumerate(read)]
        return Summed(rival.states(model.watching(probes)), weights, tuple(loads))

    def prepare(stated: Summed[P], resolution: float) -> Evaluate:
        evaluate = rival.prepare(stated.problem, resolution)
        return evaluate if stated.plain else lambda taus: stated.added(evaluate(taus), taus)

    return Rival(rival.name, rival.language, rival.unit, rival.resolutions, states, prepare)


def _terms(model: Model, probe: Probe) -> Sum:
    """What an output is the sum of. Where modes are damped more acts on a mass than rods and loads."""
    if probe.quantity == "acceleration" and model.damping is not None:
        return (Weighted(probe.factor, Gauge(probe.quantity, probe.rod, probe.place, probe.point)),)
    return model.sums[probe]


def _acting(model: Model, point: Point, weight: fmpq) -> list[tuple[float, Array]]:
    units = {unit.source: unit.coefficients for unit in point.loads}
    return [
        (nearest(load.time), np.array([nearest(weight * load.weight * c) for c in reversed(units[load.source])]))
        for load in model.loads
        if load.source in units
    ]
