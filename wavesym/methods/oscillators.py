"""Mass, dashpots and springs as oscillators: mass x'' + damping x' + stiffness x = loads, made ready to be stepped.

A load is a polynomial f from event to event, kept as its integral, f, f' and f'': a prescribed motion acts on what it
is tied to by its displacement (the integral of f), its velocity f and its acceleration f'.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from wavesym.errors import UnservedError
from wavesym.numbers.arrays import Array

KEPT = 4
"""What is kept of a load: its integral, itself, two derivatives."""

DERIVATIVES = np.eye(KEPT, k=1)
"""From what is kept of a load to its derivatives."""

# of the largest entry, what counts as nothing
_NOTHING = 1e-12

Ratios = Callable[[Array], Array]
"""Frequencies, ascending, to the damping ratio of each; 0 is that of a motion without strain."""


@dataclass(frozen=True)
class Oscillators:
    """x' = matrix x (batch, size, size), and coordinates as sums of x: `shapes` (coordinates, batch, size).

    At event e x gains jumps[e], of shape (events, batch, size). Coordinates are `feedthrough` (coordinates, loads,
    KEPT) times what is kept of the loads besides. `inertial` (as `shapes`) is the acceleration of the sums of x, with
    what damps their modes in units of it: both are what strains a rod that has mass.
    """

    matrix: Array
    jumps: Array
    shapes: Array
    feedthrough: Array
    inertial: Array


@dataclass(frozen=True)
class CondensedSystem:
    """What is left where all that has neither mass nor dashpot follows the rest at once.

    Coordinates are the unknowns with mass, then those with a dashpot alone: `mass` (heavy, heavy), `damping` and
    `stiffness` (coordinates, coordinates), `influence` (coordinates, loads, KEPT). The unknowns are `follows`
    (unknowns, coordinates) times these, and `feedthrough` (unknowns, loads, KEPT) times what is kept of the loads;
    `heavy` says which have mass.
    """

    mass: Array
    damping: Array
    stiffness: Array
    influence: Array
    follows: Array
    feedthrough: Array
    heavy: NDArray[np.bool_]

    def oscillators(self, changes: Array, momentum: Array, ratios: Ratios) -> Oscillators:
        """What is to be stepped: mode by mode, or all in one where dashpots couple the modes.

        Args:
            changes: what the loads gain at events, (events, loads, KEPT).
            momentum: what masses gain at events, (events, heavy).
            ratios: how modes are damped where no dashpot couples them.
        """
        coupled = np.any(self.damping)
        return self._coupled_oscillators(changes, momentum) if coupled else self._modal(changes, momentum, ratios)

    def _modal(self, changes: Array, momentum: Array, ratios: Ratios) -> Oscillators:
        """x is the displacement of a mode beside what springs do as they follow a prescribed motion, its velocity
        over `speed`, and its load and three derivatives.
        """
        squares, shapes = _modes(self.mass, self.stiffness)
        strained = squares > len(squares) * np.finfo(float).eps * squares[-1:]
        frequency = np.sqrt(np.where(strained, squares, 0.0))
        damping = 2 * frequency * ratios(frequency)
        speed = np.maximum(frequency, 1.0)
        matrix = np.zeros((len(frequency), 2 + KEPT, 2 + KEPT))
        matrix[:, 0, 1], matrix[:, 1, 0] = speed, -squares / speed
        matrix[:, 1, 1], matrix[:, 1, 2] = -damping, 1 / speed
        matrix[:, 2:, 2:] = DERIVATIVES
        forced = np.einsum("qn,qdk->ndk", shapes, self.influence)
        stiffness = np.where(strained, squares, np.inf)[:, np.newaxis]
        following = forced[..., 0] / stiffness
        forced[strained, :, 0] = 0.0
        forced[..., 2] -= following
        at_once = np.zeros_like(self.influence)
        at_once[..., 0] = shapes @ following
        jumps = np.empty((len(changes), len(frequency), 2 + KEPT))
        jumps[..., 0], jumps[..., 1] = 0.0, (momentum @ shapes - changes[..., 1] @ following.T) / speed
        for k in range(KEPT):
            jumps[..., 2 + k] = np.einsum("edj,ndj->en", changes[..., k:], forced[..., : KEPT - k])
        in_x, inertial = np.zeros((2, len(shapes), *matrix.shape[:2]))
        in_x[..., 0] = shapes
        inertial[..., 0], inertial[..., 2] = -squares * shapes, shapes
        return Oscillators(matrix, jumps, in_x, at_once, inertial)

    def _coupled_oscillators(self, changes: Array, momentum: Array) -> Oscillators:
        """x is the coordinates, the velocities of masses, and what is kept of the loads."""
        heavy, count, loads = len(self.mass), len(self.stiffness), changes.shape[1]
        forces = np.concatenate([-self.stiffness, -self.damping[:, :heavy], self.influence.reshape(count, -1)], axis=1)
        matrix = np.zeros((forces.shape[1], forces.shape[1]))
        moving = matrix[: count + heavy]
        moving[:heavy, count : count + heavy] = np.eye(heavy)
        moving[heavy:count] = np.linalg.solve(self.damping[heavy:, heavy:], forces[heavy:])
        moving[count:] = np.linalg.solve(self.mass, forces[:heavy] - self.damping[:heavy, heavy:] @ moving[heavy:count])
        matrix[count + heavy :, count + heavy :] = np.kron(np.eye(loads), DERIVATIVES)
        jumps = np.zeros((len(changes), 1, len(matrix)))
        jumps[:, 0, count : count + heavy] = np.linalg.solve(self.mass, momentum.T).T
        jumps[:, 0, count + heavy :] = changes.reshape(len(changes), -1)
        accelerations = (matrix @ matrix)[:count, np.newaxis]
        shapes = np.eye(count, len(matrix))[:, np.newaxis]
        return Oscillators(matrix[np.newaxis], jumps, shapes, np.zeros_like(self.influence), accelerations)


def _modes(mass: Array, stiffness: Array) -> tuple[Array, Array]:
    """The squares of the frequencies, ascending, and the shapes (coordinates, modes), of mass 1.

    What is solved has 1/(square + `slow`) for eigenvalues, of which rounding spares the large ones: else it leaves
    every square wrong by a part of the largest one, and of many elements the slow modes are those that count.
    """
    if not len(mass):
        return np.zeros(0), np.zeros((0, 0))
    # about the slowest of as many equal masses in a row
    slow = (np.max(np.diag(stiffness) / np.diag(mass)) or 1.0) / len(mass) ** 2
    inverses, shapes = eigh(mass, stiffness + slow * mass)
    inverses, shapes = inverses[::-1], shapes[:, ::-1]
    return 1 / inverses - slow, shapes / np.sqrt(inverses)


def condense(mass: Array, damping: Array, stiffness: Array, influence: Array) -> CondensedSystem:
    """Eliminate what has neither mass nor dashpot.

    Args:
        mass, damping, stiffness: of the unknowns that are free to move, (unknowns, unknowns) each.
        influence: what loads do to them, (unknowns, loads, KEPT).

    Raises:
        UnservedError: something has neither mass nor dashpot, and no spring holds it.
    """
    heavy = np.diag(mass) > 0
    light = np.flatnonzero(~heavy)
    strength, directions = np.linalg.eigh(damping[np.ix_(light, light)])
    braked = strength > _NOTHING * np.max(strength, initial=0.0)
    unit = np.eye(len(mass))
    kept = np.concatenate([unit[:, heavy], unit[:, light] @ directions[:, braked]], axis=1)
    left = unit[:, light] @ directions[:, ~braked]
    holding = left.T @ stiffness @ left
    if len(holding) and np.linalg.eigvalsh(holding)[0] <= _NOTHING * np.max(stiffness):
        raise UnservedError(
            "system: where rods are springs, nothing holds parts without mass; write a mass or a support"
        )
    back = left @ np.linalg.solve(holding, left.T)
    follows = kept - back @ stiffness @ kept
    return CondensedSystem(
        mass=mass[np.ix_(heavy, heavy)],
        damping=kept.T @ damping @ kept,
        stiffness=kept.T @ stiffness @ follows,
        influence=np.tensordot(follows.T, influence, 1),
        follows=follows,
        feedthrough=np.tensordot(back, influence, 1),
        heavy=heavy,
    )
