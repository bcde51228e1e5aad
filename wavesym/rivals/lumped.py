"""A network with finitely many unknowns, stepped exactly: what springs and masses make of it."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from wavesym.model.probe import Probe
from wavesym.numbers.doubles import fraction
from wavesym.rivals.mass import Elements, dense
from wavesym.rivals.oscillators import DERIVED, KEPT, Ratios, condensed
from wavesym.rivals.problem import Array
from wavesym.rivals.stepping import Part, stepped


@dataclass(frozen=True)
class Lumped:
    """The elements of a network; `ratios` says how its modes are damped."""

    elements: Elements
    ratios: Ratios | None = None

    def history(self, step: float) -> tuple[Array, Array]:
        """Instants on [0, until], at most `step` apart, and the outputs there (outputs, instants).

        UnservedError where rods are springs, and something without mass is held by none.
        """
        problem = self.elements.problem
        taus, values = stepped(self._parts, self._events, problem.until, step)
        strained = [problem.strain[p.rod - 1] if p.quantity == "strain" else 0.0 for p in problem.probes]
        return taus, values + np.array(strained)[:, np.newaxis]

    @cached_property
    def _events(self) -> tuple[Fraction, ...]:
        """0, and when loads change before the end."""
        problem = self.elements.problem
        return tuple(sorted({Fraction(0), *(e.time for e in problem.events if e.time < Fraction(problem.until))}))

    @cached_property
    def _driven(self) -> list[int]:
        """The points that a load or the strain at the start acts on, or that move as told."""
        pulled = np.flatnonzero(self.elements.pull).tolist()
        return sorted({*(event.node for event in self.elements.problem.events), *pulled})

    @cached_property
    def _changes(self) -> Array:
        """What the loads gain at events: (events, loads, KEPT)."""
        gained = np.zeros((len(self._events), len(self._driven), KEPT))
        places = {time: k for k, time in enumerate(self._events)}
        for event in self.elements.problem.events:
            if event.time in places:
                c0, c1, c2 = event.coefficients
                gained[places[event.time], self._driven.index(event.node), 1:] += (c0, c1, 2 * c2)
        gained[0, :, 1] += self.elements.pull[self._driven]
        return gained

    @cached_property
    def _parts(self) -> list[Part]:
        elements, size = self.elements, self.elements.size
        mass, damping, stiffness = (dense(e, size) for e in (elements.mass, elements.damping, elements.stiffness))
        told = {node: d for d, node in enumerate(self._driven) if node in elements.problem.told}
        free = np.setdiff1d(np.arange(size), elements.problem.told)
        acting, at_once = np.zeros((2, size, len(self._driven), KEPT))
        for d, node in enumerate(self._driven):
            if node in told:
                acting[:, d, :3] = -np.stack([stiffness[:, node], damping[:, node], mass[:, node]], axis=1)
                at_once[node, d, 0] = 1.0
            else:
                acting[node, d, 1] = 1.0
        left = condensed(*(matrix[np.ix_(free, free)] for matrix in (mass, damping, stiffness)), acting[free])
        at_once[free] = left.at_once
        # what a told velocity gains at once is a blow to what has a share in its mass
        momentum = -self._changes[:, list(told.values()), 1] @ mass[list(told)][:, free]
        momentum[0] += elements.momentum[free]
        own = left.oscillators(self._changes, momentum[:, left.heavy], self.ratios)
        places = np.zeros((size, *own.places.shape[1:]))
        places[free] = np.tensordot(left.follows, own.places, 1)
        loads = np.broadcast_to(DERIVED, (len(self._driven), KEPT, KEPT))
        return [
            Part(own.matrix, own.jumps, self._shown(own.matrix, places)),
            Part(loads, self._changes, self._shown(loads, at_once)),
        ]

    def _shown(self, matrix: Array, places: Array) -> Array:
        """What outputs are of x (outputs, batch, size), from what the unknowns are (unknowns, batch, size)."""
        total = np.zeros((len(self._weights[0]), *places.shape[1:]))
        for weights in self._weights:  # of displacement, velocity, acceleration
            total += np.tensordot(weights, places, 1)
            places = np.einsum("ubs,bst->ubt", places, matrix)
        return total

    @cached_property
    def _weights(self) -> Array:
        """What displacements, velocities and accelerations of the unknowns count in outputs: (3, outputs, unknowns)."""
        weights = np.zeros((3, len(self.elements.problem.probes), self.elements.size))
        for row, probe in enumerate(self.elements.problem.probes):
            if probe.quantity == "strain":
                weights[:, row] = self._strain(probe)
            else:
                weights[_DERIVATIVE[probe.quantity], row] = self._moved(probe)
        return weights

    def _moved(self, probe: Probe) -> Array:
        """How much the unknowns move a place: along a line from one end of its element to the other."""
        weights = np.zeros(self.elements.size)
        if probe.point is not None:
            weights[probe.point] = 1.0
            return weights
        ends, factors, part, _ = self._element(probe)
        np.add.at(weights, ends, factors * (1 - part, part))
        return weights

    def _strain(self, probe: Probe) -> Array:
        """What strains a place: its element as a spring, and its mass, which moves along a line between its ends."""
        weights = np.zeros((3, self.elements.size))
        ends, factors, part, length = self._element(probe)
        problem, bar = self.elements.problem, probe.rod - 1
        np.add.at(weights[0], ends, factors * (-1, 1) / (length * problem.speed[bar]))
        balance = np.array([part - 1 / 3 - part**2 / 2, part**2 / 2 - 1 / 6])
        np.add.at(weights[2], ends, self.elements.weight * factors * balance * (length / problem.speed[bar]))
        return weights

    def _element(self, probe: Probe) -> tuple[Array, Array, float, float]:
        """The unknowns at the ends of an output's element, how fast these move there, the place in it, its delay."""
        bar = probe.rod - 1
        place = float(fraction(probe.place)) * self.elements.cells[bar]
        first = min(int(place), int(self.elements.cells[bar]) - 1)
        unknowns, factors = self.elements.along(bar)
        return unknowns[first : first + 2], factors[first : first + 2], place - first, self.elements.length(bar)


_DERIVATIVE = {"displacement": 0, "velocity": 1}
