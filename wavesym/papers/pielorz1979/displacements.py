"""The exact motion of a chain at a place and an instant, without dimensions, and what acts on its nodes."""

from __future__ import annotations

from typing import Any

from flint import fmpq

from wavesym.model.node import Node
from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.jets import Jet
from wavesym.papers.pielorz1979.truth import Driven


def displacement(motion: Driven, rod: int, x: Jet, tau: Jet) -> Jet:
    """The exact motion of a rod, without dimensions; MeaninglessError outside the rod and before the start."""
    if not rod - 1 <= x.value <= rod or not 1 <= rod <= motion.exact.m:
        raise MeaninglessError(f"rod {rod} does not reach to {x.value} l")
    if tau.value < 0:
        raise MeaninglessError("the motion begins at t = 0")
    clock = motion.exact.chain.rod(rod)
    f = wave(motion, "f", rod, tau - x + (clock.x0 - clock.tau0))
    g = wave(motion, "g", rod, tau + x - (clock.x0 + clock.tau0))
    moved: Jet = f + g + tau * clock.velocity
    return moved


def wave(motion: Driven, letter: str, rod: int, z: Jet) -> Jet:
    """f or g of a rod."""
    return z.of_function(lambda order: motion.wave(letter, rod, z.value, order))


def force(node: Node, left: tuple[Jet, Jet] | None, right: tuple[Jet, Jet] | None) -> Any:
    """What has to act on a node, where its rods move so: displacements there, along time and along place."""
    moving, _ = left or right or (Jet(0), Jet(0))
    total = node.inertia * moving.second + node.damping * moving.first
    if left:
        total = total + node.alpha / 2 * left[1].first
    if right:
        total = total - node.beta / 2 * right[1].first
    return total


def acting(motion: Driven, x: int, tau: fmpq) -> Any:
    """What acts on the node at x, by the exact motion."""
    place, time = Jet(fmpq(x), 1), Jet(tau, 1)

    def end(rod: int) -> tuple[Jet, Jet]:
        return displacement(motion, rod, Jet(place.value), time), displacement(motion, rod, place, Jet(tau))

    m = motion.exact.m
    return force(motion.exact.chain.nodes[x], end(x) if x > 0 else None, end(x + 1) if x < m else None)
