"""Outputs as integrators have them: sums of their own strains, velocities and displacements, and of loads.

    mass u'' + damping u' + stiffness u = sum over ends of ratio * force of the bar + loads + pushes of contacts

says how a mass is accelerated. What contacts hold together has no mass but that one: multiplied by how fast its points
would move together, and added up, their balances are without pushes, whether contacts are open or closed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import fmpq

from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import nearest
from wavesym.verification.graph import Array, Graph, graph

Share = tuple[float, Probe]
"""So many times a strain, a velocity or a displacement."""


@dataclass(frozen=True)
class Observed:
    """An output: `shares` of what integrators have, and times the loads on points."""

    graph: Graph
    shares: tuple[Share, ...]
    loads: tuple[tuple[float, int], ...] = ()

    def values(self, at: Callable[[Probe], Array], taus: Sequence[float]) -> Array:
        """The values at doubles tau, right-hand limits; `at` has those of strains, velocities and displacements."""
        total = np.zeros(len(taus))
        for weight, probe in self.shares:
            total += weight * at(probe)
        return total + self.loaded(taus)

    def loaded(self, taus: Sequence[float]) -> Array:
        """What loads add."""
        total = np.zeros(len(taus))
        for weight, point in self.loads:
            for event in self.graph.events:
                if event.point == point:
                    since = [Fraction(tau) - event.time for tau in taus]
                    total += weight * np.array([_value(event.coefficients, time) for time in since])
        return total

    def roundoff(self, of: Callable[[Probe], float]) -> float:
        """What rounding may have added, where it is known of strains, velocities and displacements."""
        return sum(abs(weight) * of(probe) for weight, probe in self.shares)


def _value(coefficients: Sequence[float], since: Fraction) -> float:
    return sum(c * float(since) ** k for k, c in enumerate(coefficients)) if since >= 0 else 0.0


def observed(model: Model) -> list[Observed]:
    """The outputs of a model."""
    made = graph(model)
    return [_scaled(_observed(made, probe), nearest(probe.factor)) for probe in model.probes]


def parted(model: Model) -> Model:
    """The same, watched for what its outputs are sums of."""
    return model.watching(dict.fromkeys(probe for each in observed(model) for _, probe in each.shares))


def _scaled(one: Observed, factor: float) -> Observed:
    shares = tuple((factor * weight, probe) for weight, probe in one.shares)
    return Observed(one.graph, shares, tuple((factor * weight, point) for weight, point in one.loads))


def _observed(made: Graph, probe: Probe) -> Observed:
    bar = probe.rod - 1
    match probe.quantity:
        case "acceleration":
            return _accelerated(made, probe)
        case "force":
            stiffness = float(made.impedance[bar] * made.speed[bar])
            return Observed(made, ((stiffness, _on("strain", probe.rod, probe.place)),))
        case "drift":
            far, near = (_on("displacement", probe.rod, fmpq(side)) for side in (1, 0))
            return Observed(made, ((1.0, far), (-1.0, near)))
        case "relative":
            told = [n for n, point in enumerate(made.network.points) if point.motion not in (None, "fixed")]
            base = _at_point("displacement", told[0] if told else 0)
            here = Probe("", "displacement", probe.rod, probe.place, probe.point)
            return Observed(made, ((1.0, here), (-1.0, base)))
        case _:
            return Observed(made, ((1.0, Probe("", probe.quantity, probe.rod, probe.place, probe.point)),))


def _accelerated(made: Graph, probe: Probe) -> Observed:
    point, times = probe.point, 1.0
    if point is None:
        end = 2 * (probe.rod - 1) + int(probe.place)
        point, times = int(made.ends[end]), float(made.ratios[end])
    together = _together(made, point) * (times / float(made.mass[point]))
    shares = list(_forces(made, together))
    return Observed(made, tuple(shares), tuple((float(together[n]), n) for n in np.flatnonzero(together).tolist()))


def _together(made: Graph, point: int) -> Array:
    """How fast all points would move with one, if all contacts were closed: no push does work then."""
    speeds = np.zeros(len(made.mass))
    speeds[point] = 1.0
    coming = [point]
    while coming:
        here = coming.pop()
        for row in made.parting:
            if row[here]:
                (other,) = (n for n in np.flatnonzero(row).tolist() if n != here)
                if speeds[other] == 0:
                    speeds[other] = -row[here] * speeds[here] / row[other]
                    coming.append(other)
    return speeds


def _forces(made: Graph, speeds: Array) -> Iterator[Share]:
    """What acts on points but loads and pushes, as they work where points are so fast."""
    for end, (point, ratio) in enumerate(zip(made.ends.tolist(), made.ratios.tolist(), strict=True)):
        if speeds[point]:
            bar, side = divmod(end, 2)
            tension = (1 - 2 * side) * float(made.impedance[bar] * made.speed[bar])
            yield float(speeds[point]) * ratio * tension, _on("strain", bar + 1, fmpq(side))
    for matrix, quantity in ((made.damping, "velocity"), (made.stiffness, "displacement")):
        held = -(speeds @ matrix)
        for point in np.flatnonzero(held).tolist():
            yield float(held[point]), _at_point(quantity, point)


def _on(quantity: str, rod: int, place: fmpq) -> Probe:
    return Probe("", quantity, rod, place)


def _at_point(quantity: str, point: int) -> Probe:
    return Probe("", quantity, 0, fmpq(0), point)
