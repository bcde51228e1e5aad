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
from wavesym.methods.problem import Array
from wavesym.numbers.doubles import nearest
from wavesym.verification.problem import ContactProblem, problem_of

Term = tuple[float, Probe]
"""So many times a strain, a velocity, a displacement, or the load on a point."""


@dataclass(frozen=True)
class Observed:
    """An output: `terms` of what integrators have, and times the loads on points."""

    problem: ContactProblem
    terms: tuple[Term, ...]
    loads: tuple[Term, ...]

    def values(self, read: Callable[[Probe], Array], taus: Sequence[float]) -> Array:
        """The values at doubles tau, right-hand limits; `read` has those of strains, velocities and displacements."""
        total = np.zeros(len(taus))
        for weight, reading in self.terms:
            total += weight * read(reading)
        for weight, load in self.loads:
            for event in (event for event in self.problem.events if event.point == load.point):
                since = [Fraction(tau) - event.time for tau in taus]
                total += weight * np.array([_polynomial(event.coefficients, time) for time in since])
        return total

    def roundoff(self, of: Callable[[Probe], float]) -> float:
        """What rounding may have added, where it is known of strains, velocities and displacements."""
        return sum(abs(weight) * of(reading) for weight, reading in self.terms)


def _polynomial(coefficients: Sequence[float], since: Fraction) -> float:
    return sum(c * float(since) ** k for k, c in enumerate(coefficients)) if since >= 0 else 0.0


def observed(model: Model) -> list[Observed]:
    """The outputs of a model."""
    problem = problem_of(model)
    found = []
    for probe in model.probes:
        terms = [(nearest(probe.factor) * weight, reading) for weight, reading in _terms(model, problem, probe)]
        loads = [term for term in terms if term[1].quantity == "load"]
        found.append(Observed(problem, tuple(term for term in terms if term not in loads), tuple(loads)))
    return found


def read_by(model: Model) -> tuple[Probe, ...]:
    """All strains, velocities and displacements that the outputs of a model are sums of."""
    return tuple(dict.fromkeys(reading for each in observed(model) for _, reading in each.terms))


def _terms(model: Model, problem: ContactProblem, probe: Probe) -> Iterator[Term]:
    bar, here = probe.rod - 1, Probe("", probe.quantity, probe.rod, probe.place, probe.point)
    match probe.quantity:
        case "acceleration":
            yield from _acceleration(problem, probe)
        case "force":
            yield float(problem.impedance[bar] * problem.speed[bar]), _on("strain", probe.rod, probe.place)
        case "drift":
            yield 1.0, _on("displacement", probe.rod, fmpq(1))
            yield -1.0, _on("displacement", probe.rod, fmpq(0))
        case "relative":
            moved = [n for n, point in enumerate(model.network.points) if point.motion not in (None, "fixed")]
            yield 1.0, Probe("", "displacement", probe.rod, probe.place, probe.point)
            yield -1.0, _at_point("displacement", moved[0] if moved else 0)
        case _:
            yield 1.0, here


def _acceleration(problem: ContactProblem, probe: Probe) -> Iterator[Term]:
    """All that acts on a mass, and on what touches it, but loads and pushes as they work where points are so fast."""
    point, ratio = probe.point, 1.0
    if point is None:
        end = 2 * (probe.rod - 1) + int(probe.place)
        point, ratio = int(problem.end_points[end]), float(problem.end_ratios[end])
    speeds = problem.carried(point)[0] * (ratio / float(problem.mass[point]))
    unit = np.eye(problem.points)
    stiffness = np.repeat(problem.impedance * problem.speed, 2) * np.tile([1.0, -1.0], len(problem.speed))
    for end, force in enumerate((speeds @ problem.onto * stiffness).tolist()):
        if speeds[problem.end_points[end]]:
            yield force, _on("strain", end // 2 + 1, fmpq(end % 2))
    for matrix, quantity in ((-problem.damping, "velocity"), (-problem.stiffness, "displacement"), (unit, "load")):
        held = speeds @ matrix
        for number in np.flatnonzero(held).tolist():
            yield float(held[number]), _at_point(quantity, number)


def _on(quantity: str, rod: int, place: fmpq) -> Probe:
    return Probe("", quantity, rod, place)


def _at_point(quantity: str, point: int) -> Probe:
    return Probe("", quantity, 0, fmpq(0), point)
