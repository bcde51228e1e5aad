"""A network with finitely many unknowns, stepped exactly: masses on springs, or finite elements by their modes.

Modes are stepped one by one; where dashpots couple them all of it is stepped at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from wavesym.errors import UnservedError
from wavesym.mechanics.gauge import Gauge
from wavesym.methods.elements import Elements
from wavesym.methods.network_problem import linear_problem
from wavesym.methods.oscillators import DERIVATIVES, KEPT, condense
from wavesym.methods.problem import Evaluate, Method, Problem
from wavesym.methods.stepping import Systems, step_systems
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import fraction, nearest


@dataclass(frozen=True)
class DiscreteModel:
    """The elements of a network. Readings are strains, displacements, velocities and accelerations."""

    elements: Elements

    def readings(self, step: float) -> tuple[Array, Array]:
        """Step from tau = 0 to the horizon.

        Args:
            step: the largest distance of instants.

        Returns:
            Instants on [0, until], and the readings there (readings, instants).

        Raises:
            UnservedError: something without mass is held by no spring, or a mode is damped that there is not.
        """
        problem = self.elements.problem
        taus, values = step_systems(self.systems, self._event_times, problem.until, step)
        return taus, values + np.array([[problem.strain_at_start(each)] for each in problem.readings]).reshape(-1, 1)

    def outputs(self, step: float) -> tuple[Array, Array]:
        """The same for the outputs: instants, and (outputs, instants)."""
        taus, values = self.readings(step)
        return taus, self.elements.problem.outputs(values, taus)

    @cached_property
    def _event_times(self) -> tuple[Fraction, ...]:
        """0, and when loads change before the end."""
        problem = self.elements.problem
        return tuple(sorted({Fraction(0), *(e.time for e in problem.events if e.time < Fraction(problem.until))}))

    @cached_property
    def _loaded_points(self) -> list[int]:
        """The points that a load or the strain at the start acts on, or whose motion loads prescribe."""
        pulled = np.flatnonzero(self.elements.start_forces).tolist()
        return sorted({*(event.point for event in self.elements.problem.events), *pulled})

    @cached_property
    def _load_jumps(self) -> Array:
        """What the loads gain at events: (events, loads, KEPT)."""
        gained = np.zeros((len(self._event_times), len(self._loaded_points), KEPT))
        numbers = {time: k for k, time in enumerate(self._event_times)}
        for event in self.elements.problem.events:
            if event.time in numbers:
                c0, c1, c2 = event.coefficients
                gained[numbers[event.time], self._loaded_points.index(event.point), 1:] += (c0, c1, 2 * c2)
        gained[0, :, 1] += self.elements.start_forces[self._loaded_points]
        return gained

    @cached_property
    def systems(self) -> list[Systems]:
        """What is stepped: the modes, then what follows the loads at once."""
        elements, size = self.elements, self.elements.size
        mass, damping, stiffness = (each.toarray() for each in (elements.mass, elements.damping, elements.stiffness))
        prescribed = elements.problem.prescribed_points
        free = np.setdiff1d(np.arange(size), prescribed)
        influence, at_once = np.zeros((2, size, len(self._loaded_points), KEPT))
        dragged = np.zeros((size, len(self._loaded_points)))
        for load, point in enumerate(self._loaded_points):
            if point in prescribed:
                # unknowns count from what is dragged along: the ground may go far, and drifts are small
                shape = dragged[:, load] = elements.imposed_shape(point)
                influence[:, load, :3] = -np.stack([elements.forces(shape), damping @ shape, mass @ shape], axis=1)
            else:
                influence[point, load, 1] = 1.0
        inner = np.ix_(free, free)
        condensed = condense(mass[inner], damping[inner], stiffness[inner], influence[free])
        at_once[..., 0] = dragged
        # what a prescribed velocity gains at once is an impulse to what is dragged along
        momentum = -self._load_jumps[:, :, 1] @ (mass @ dragged).T[:, free]
        momentum[0] += elements.momentum[free]
        own = condensed.oscillators(self._load_jumps, momentum[:, condensed.heavy], self._ratios)
        at_once[free] += condensed.feedthrough + np.tensordot(condensed.follows, own.feedthrough, 1)
        shapes, inertial = np.zeros((2, size, *own.shapes.shape[1:]))
        shapes[free], inertial[free] = (np.tensordot(condensed.follows, each, 1) for each in (own.shapes, own.inertial))
        loads = np.broadcast_to(DERIVATIVES, (len(self._loaded_points), KEPT, KEPT))
        return [
            Systems(own.matrix, own.jumps, self._read(_with_derivatives(own.matrix, shapes), inertial)),
            Systems(loads, self._load_jumps, self._read(_with_derivatives(loads, at_once))),
        ]

    def _read(self, motion: list[Array], inertial: Array | None = None) -> Array:
        """What readings are of x: (readings, systems, size).

        `motion` is what displacements, velocities and accelerations of the unknowns are of x, each (unknowns, systems,
        size), and `inertial` what strains rods that have mass, where that is more than accelerations.
        """
        fields = [*motion, motion[-1] if inertial is None else inertial]
        parts = [np.tensordot(weights, each, 1) for weights, each in zip(self._weights, fields, strict=True)]
        return np.asarray(np.sum(parts, axis=0))

    def _ratios(self, w: Array) -> Array:
        """The damping ratios of modes of frequencies w."""
        modal, strained = self.elements.problem.modal, w > 0
        ratios, count = np.zeros(len(w)), int(np.count_nonzero(strained))
        if modal is None:
            return ratios
        stated = np.array([nearest(ratio) for ratio in modal.ratios])
        if modal.modes is None:
            ratios[strained] = stated[np.minimum(np.arange(count), len(stated) - 1)]
            return ratios
        if max(modal.modes) > count:
            raise UnservedError(
                f"system.damping: mode {max(modal.modes)} of only {count} masses; write at most {count}"
            )
        # (a/w + b w)/2 that is the same at two frequencies
        two = w[strained][[number - 1 for number in modal.modes]]
        a, b = np.linalg.solve(np.stack([1 / two, two], axis=1) / 2, np.repeat(stated, 2))
        ratios[strained] = (a / w[strained] + b * w[strained]) / 2
        return ratios

    @cached_property
    def _weights(self) -> Array:
        """What the unknowns count in readings, (4, readings, unknowns): displacements, velocities, accelerations, and
        what strains rods that have mass. There are no readings where all outputs are sure to be 0.
        """
        weights = [self._weights_of(reading) for reading in self.elements.problem.readings]
        return np.stack(weights, axis=1) if weights else np.zeros((4, 0, self.elements.size))

    def _weights_of(self, reading: Gauge) -> Array:
        """The same for one reading: (4, unknowns)."""
        weights = np.zeros((4, self.elements.size))
        derivative = {"velocity": 1, "acceleration": 2}.get(reading.quantity, 0)
        if reading.point is not None:
            weights[derivative, reading.point] = 1.0
            return weights
        problem, bar = self.elements.problem, reading.rod - 1
        place = float(fraction(reading.place)) * self.elements.cells[bar]
        first = min(int(place), int(self.elements.cells[bar]) - 1)
        part, length, speed = place - first, float(self.elements.length[bar]), float(problem.speed[bar])
        unknowns, factors = self.elements.bar_unknowns(bar)
        unknowns, factors = unknowns[first : first + 2], factors[first : first + 2]
        if reading.quantity == "strain":
            # as a spring, and what balances the element's mass, whose acceleration is a line between its ends
            balance = np.array([part - 1 / 3 - part**2 / 2, part**2 / 2 - 1 / 6])
            np.add.at(weights[0], unknowns, factors * (-1, 1) / (length * speed))
            np.add.at(weights[3], unknowns, self.elements.weight * factors * balance * (length / speed))
        else:
            np.add.at(weights[derivative], unknowns, factors * (1 - part, part))
        return weights


def _with_derivatives(matrix: Array, sums: Array) -> list[Array]:
    """Sums of x (..., systems, size), and their first and second derivatives."""
    found = [sums]
    for _ in range(2):
        found.append(np.einsum("ubs,bst->ubt", found[-1], matrix))
    return found


def _solve(problem: Problem, resolution: float) -> Evaluate:
    model = DiscreteModel(Elements(problem, np.maximum(np.rint(problem.delay * resolution), 1).astype(int)))
    _ = model.systems  # found once

    def evaluate(taus: Array) -> Array:
        instants, values = model.readings(1 / resolution)
        return np.array([np.interp(taus, instants, row) for row in values])

    return evaluate


MODAL = Method(
    "finite elements, modal", "NumPy", "elements in a unit of delay", (4, 10, 20, 50, 100), linear_problem, _solve
)
