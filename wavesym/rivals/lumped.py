"""A network with finitely many unknowns, stepped exactly: what springs and masses make of it."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from wavesym.errors import UnservedError
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import fraction, nearest
from wavesym.rivals.mass import Elements, dense
from wavesym.rivals.oscillators import DERIVED, KEPT, condensed
from wavesym.rivals.problem import Array
from wavesym.rivals.stepping import Batch, stepped


@dataclass(frozen=True)
class DiscreteModel:
    """The elements of a network. Outputs are strains, displacements, velocities and accelerations."""

    elements: Elements

    def history(self, step: float) -> tuple[Array, Array]:
        """Instants on [0, until], at most `step` apart, and the outputs there (outputs, instants).

        UnservedError where something without mass is held by no spring, and for the damping of modes that it has not.
        """
        problem = self.elements.problem
        taus, values = stepped(self.parts, self._events, problem.until, step)
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
    def parts(self) -> list[Batch]:
        """What is stepped: the modes, then what follows the loads at once."""
        elements, size = self.elements, self.elements.size
        mass, damping, stiffness = (dense(e, size) for e in (elements.mass, elements.damping, elements.stiffness))
        told = elements.problem.told
        free = np.setdiff1d(np.arange(size), elements.problem.told)
        acting, at_once = np.zeros((2, size, len(self._driven), KEPT))
        dragged = np.zeros((size, len(self._driven)))
        for d, node in enumerate(self._driven):
            if node in told:
                # unknowns count from what is dragged along: the ground may go far, and drifts are small
                shape = dragged[:, d] = elements.dragged(node)
                acting[:, d, :3] = -np.stack([elements.pulling(shape), damping @ shape, mass @ shape], axis=1)
            else:
                acting[node, d, 1] = 1.0
        inner = np.ix_(free, free)
        left = condensed(mass[inner], damping[inner], stiffness[inner], acting[free])
        at_once[..., 0] = dragged
        # what a told velocity gains at once is a blow to what is dragged along
        momentum = -self._changes[:, :, 1] @ (mass @ dragged).T[:, free]
        momentum[0] += elements.momentum[free]
        own = left.oscillators(self._changes, momentum[:, left.heavy], self._ratios)
        at_once[free] += left.at_once + np.tensordot(left.follows, own.at_once, 1)
        places, resisted = np.zeros((2, size, *own.places.shape[1:]))
        places[free], resisted[free] = (np.tensordot(left.follows, each, 1) for each in (own.places, own.resisted))
        loads = np.broadcast_to(DERIVED, (len(self._driven), KEPT, KEPT))
        return [
            Batch(own.matrix, own.jumps, self._shown(_derived(own.matrix, places), resisted)),
            Batch(loads, self._changes, self._shown(_derived(loads, at_once))),
        ]

    def _shown(self, motion: list[Array], resisted: Array | None = None) -> Array:
        """What outputs are of x (outputs, batch, size).

        `motion` is what displacements, velocities and accelerations of the unknowns are of x, each (unknowns, batch,
        size), and `resisted` what strains rods that have mass, where that is more than accelerations.
        """
        fields = [*motion, motion[-1] if resisted is None else resisted]
        shown = [np.tensordot(weights, each, 1) for weights, each in zip(self._weights, fields, strict=True)]
        return np.asarray(np.sum(shown, axis=0))

    def _ratios(self, w: Array) -> Array:
        """How modes of frequencies w are damped."""
        modal, strained = self.elements.problem.modal, w > 0
        ratios, count = np.zeros(len(w)), int(np.count_nonzero(strained))
        if modal is None:
            return ratios
        given = np.array([nearest(ratio) for ratio in modal.ratios])
        if modal.modes is None:
            ratios[strained] = given[np.minimum(np.arange(count), len(given) - 1)]
            return ratios
        if max(modal.modes) > count:
            raise UnservedError(
                f"system.damping: mode {max(modal.modes)} given, at most {count} expected of so few masses"
            )
        # (a/w + b w)/2 that is the same at two frequencies
        two = w[strained][[number - 1 for number in modal.modes]]
        a, b = np.linalg.solve(np.stack([1 / two, two], axis=1) / 2, np.repeat(given, 2))
        ratios[strained] = (a / w[strained] + b * w[strained]) / 2
        return ratios

    @cached_property
    def _weights(self) -> Array:
        """What the unknowns count in outputs, (4, outputs, unknowns): displacements, velocities, accelerations, and
        what strains rods that have mass. There are no outputs where all are sure to be 0.
        """
        read = [self._read(probe) for probe in self.elements.problem.probes]
        return np.stack(read, axis=1) if read else np.zeros((4, 0, self.elements.size))

    def _read(self, probe: Probe) -> Array:
        """The same for one output: (4, unknowns)."""
        weights = np.zeros((4, self.elements.size))
        derivative = {"velocity": 1, "acceleration": 2}.get(probe.quantity, 0)
        if probe.point is not None:
            weights[derivative, probe.point] = 1.0
            return weights
        problem, bar = self.elements.problem, probe.rod - 1
        place = float(fraction(probe.place)) * self.elements.cells[bar]
        first = min(int(place), int(self.elements.cells[bar]) - 1)
        part, length, speed = place - first, self.elements.length(bar), float(problem.speed[bar])
        unknowns, factors = self.elements.along(bar)
        unknowns, factors = unknowns[first : first + 2], factors[first : first + 2]
        if probe.quantity == "strain":
            # as a spring, and what balances the element's mass, whose acceleration is a line between its ends
            balance = np.array([part - 1 / 3 - part**2 / 2, part**2 / 2 - 1 / 6])
            np.add.at(weights[0], unknowns, factors * (-1, 1) / (length * speed))
            np.add.at(weights[3], unknowns, self.elements.weight * factors * balance * (length / speed))
        else:
            np.add.at(weights[derivative], unknowns, factors * (1 - part, part))
        return weights


def _derived(matrix: Array, places: Array) -> list[Array]:
    """Sums of x (..., batch, size), and their first and second derivatives."""
    found = [places]
    for _ in range(2):
        found.append(np.einsum("ubs,bst->ubt", found[-1], matrix))
    return found
