"""Mass, dashpots and springs as oscillators: mass x'' + damping x' + stiffness x = loads, made ready to be stepped.

A load is a polynomial f from event to event, kept as its integral, f, f' and f'': a prescribed motion acts on what it
is tied to by its displacement (the integral of f), its velocity f and its acceleration f'.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import UnservedError
from wavesym.rivals.problem import Array

KEPT = 4
"""What is kept of a load: its integral, itself, two derivatives."""

DERIVED = np.eye(KEPT, k=1)
"""From what is kept of a load to its derivatives."""

# of the largest entry, what counts as nothing
_NOTHING = 1e-12

Ratios = Callable[[Array], Array]
"""Frequencies, ascending, to the damping ratio of each; 0 is that of a motion without strain."""


@dataclass(frozen=True)
class Stepping:
    """x' = matrix x (batch, size, size), and the coordinates as sums of x: `places` (coordinates, batch, size).

    At event e x gains jumps[e], of shape (events, batch, size). Coordinates are `at_once` (coordinates, loads, KEPT)
    times what is kept of the loads besides. `resisted` (as `places`) is the acceleration of the sums of x, with what
    damps their modes in units of it: both are what strains a rod that has mass.
    """

    matrix: Array
    jumps: Array
    places: Array
    at_once: Array
    resisted: Array


@dataclass(frozen=True)
class Condensed:
    """What is left where all that has neither mass nor dashpot follows the rest at once.

    Coordinates are the unknowns with mass, then dashed ones without: `mass` (heavy, heavy), `damping` and `stiffness`
    (coordinates, coordinates), `acting` (coordinates, loads, KEPT). The unknowns are `follows` (unknowns, coordinates)
    times these, and `at_once` (unknowns, loads, KEPT) times what is kept of the loads; `heavy` says which have mass.
    """

    mass: Array
    damping: Array
    stiffness: Array
    acting: Array
    follows: Array
    at_once: Array
    heavy: NDArray[np.bool_]

    def oscillators(self, changes: Array, momentum: Array, ratios: Ratios) -> Stepping:
        """Stepped mode by mode, or all in one where dashpots tie the modes.

        `changes` (events, loads, KEPT) is what the loads gain at events, `momentum` (events, heavy) what masses do.
        """
        tied = np.any(self.damping)
        return self._tied(changes, momentum) if tied else self._modal(changes, momentum, ratios)

    def _modal(self, changes: Array, momentum: Array, ratios: Ratios) -> Stepping:
        """x is the displacement of a mode beside what all springs do as they follow what is told, its velocity over
        `speed`, and its load and three derivatives.
        """
        root = np.linalg.cholesky(self.mass)
        whitened = np.linalg.solve(root, np.linalg.solve(root, self.stiffness).T)
        squares, shapes = np.linalg.eigh((whitened + whitened.T) / 2)
        shapes = np.linalg.solve(root.T, shapes)
        strained = squares > len(squares) * np.finfo(float).eps * squares[-1:]
        frequency = np.sqrt(np.where(strained, squares, 0.0))
        damping = 2 * frequency * ratios(frequency)
        speed = np.maximum(frequency, 1.0)
        matrix = np.zeros((len(frequency), 2 + KEPT, 2 + KEPT))
        matrix[:, 0, 1], matrix[:, 1, 0], matrix[:, 1, 1], matrix[:, 1, 2] = (
            speed,
            -squares / speed,
            -damping,
            1 / speed,
        )
        matrix[:, 2:, 2:] = DERIVED
        felt = np.einsum("qn,qdk->ndk", shapes, self.acting)
        following = np.where(strained[:, np.newaxis], felt[..., 0] / np.where(strained, squares, 1.0)[:, np.newaxis], 0)
        felt[strained, :, 0] = 0.0
        felt[..., 2] -= following
        at_once = np.zeros_like(self.acting)
        at_once[..., 0] = shapes @ following
        jumps = np.empty((len(changes), len(frequency), 2 + KEPT))
        jumps[..., 0], jumps[..., 1] = 0.0, (momentum @ shapes - changes[..., 1] @ following.T) / speed
        for k in range(KEPT):
            jumps[..., 2 + k] = np.einsum("edj,ndj->en", changes[..., k:], felt[..., : KEPT - k])
        places, resisted = np.zeros((2, len(shapes), *matrix.shape[:2]))
        places[..., 0] = shapes
        resisted[..., 0], resisted[..., 2] = -squares * shapes, shapes
        return Stepping(matrix, jumps, places, at_once, resisted)

    def _tied(self, changes: Array, momentum: Array) -> Stepping:
        """x is the coordinates, the velocities of masses, and what is kept of the loads."""
        heavy, count, loads = len(self.mass), len(self.stiffness), changes.shape[1]
        forces = np.concatenate([-self.stiffness, -self.damping[:, :heavy], self.acting.reshape(count, -1)], axis=1)
        matrix = np.zeros((forces.shape[1], forces.shape[1]))
        moving = matrix[: count + heavy]
        moving[:heavy, count : count + heavy] = np.eye(heavy)
        moving[heavy:count] = np.linalg.solve(self.damping[heavy:, heavy:], forces[heavy:])
        moving[count:] = np.linalg.solve(self.mass, forces[:heavy] - self.damping[:heavy, heavy:] @ moving[heavy:count])
        matrix[count + heavy :, count + heavy :] = np.kron(np.eye(loads), DERIVED)
        jumps = np.zeros((len(changes), 1, len(matrix)))
        jumps[:, 0, count : count + heavy] = np.linalg.solve(self.mass, momentum.T).T
        jumps[:, 0, count + heavy :] = changes.reshape(len(changes), -1)
        accelerated = (matrix @ matrix)[:count, np.newaxis]
        return Stepping(
            matrix[np.newaxis],
            jumps,
            np.eye(count, len(matrix))[:, np.newaxis],
            np.zeros_like(self.acting),
            accelerated,
        )


def condensed(mass: Array, damping: Array, stiffness: Array, acting: Array) -> Condensed:
    """Unknowns that are free to move, and what acts on them (unknowns, loads, KEPT).

    UnservedError where something has neither mass nor dashpot, and no spring holds it.
    """
    heavy = np.diag(mass) > 0
    light = np.flatnonzero(~heavy)
    strength, turned = np.linalg.eigh(damping[np.ix_(light, light)])
    dashed = strength > _NOTHING * np.max(strength, initial=0.0)
    unit = np.eye(len(mass))
    kept = np.concatenate([unit[:, heavy], unit[:, light] @ turned[:, dashed]], axis=1)
    left = unit[:, light] @ turned[:, ~dashed]
    holding = left.T @ stiffness @ left
    if len(holding) and np.linalg.eigvalsh(holding)[0] <= _NOTHING * np.max(stiffness):
        raise UnservedError("system: parts without mass that nothing holds given, none expected where rods are springs")
    back = left @ np.linalg.solve(holding, left.T)
    follows = kept - back @ stiffness @ kept
    return Condensed(
        mass=mass[np.ix_(heavy, heavy)],
        damping=kept.T @ damping @ kept,
        stiffness=kept.T @ stiffness @ follows,
        acting=np.tensordot(follows.T, acting, 1),
        follows=follows,
        at_once=np.tensordot(back, acting, 1),
        heavy=heavy,
    )
