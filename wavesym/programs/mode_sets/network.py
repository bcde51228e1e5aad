"""Networks that differ in their numbers alone, side by side: each number is a column of doubles, a row for each set."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import count
from typing import Any, NamedTuple

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.exact.modes.frequencies import refuse_damped
from wavesym.exact.modes.shape import Mode, moved_mass
from wavesym.exact.modes.stiffness import HarmonicLaw, Stiffness
from wavesym.mechanics.network import End, Network
from wavesym.numbers.doubles import nearest

Columns = Any
"""Doubles in the place of exact numbers: arrays (sets, 1), or (sets, modes)."""

_EPS = 2.0**-53
_ROUNDINGS = 8.0  # of each entry of K


def double(value: Any) -> Any:
    """An exact number as a double; a column as it is."""
    return value if isinstance(value, np.ndarray | float) else float(value)


def column(values: Iterable[fmpq]) -> Columns:
    """One number of each set."""
    return np.array([[nearest(value)] for value in values])


def pattern(network: Network) -> object:
    """What networks that can stand side by side have in common: all but the sizes of their numbers."""
    return (
        [(p.mass != 0, p.stiffness != 0, p.motion, [u.source for u in p.loads]) for p in network.points],
        [(bar.left, bar.right, bar.ratios, bar.velocity != 0, bar.strain != 0) for bar in network.bars],
        [(link.left, link.right, link.ratio, link.stiffness != 0) for link in network.links],
    )


def stack_networks(networks: Sequence[Network]) -> Network:
    """Networks of one pattern as one. UnservedError where modes are not real: for dashpots and contacts."""
    for network in networks:
        refuse_damped(network)
    first = networks[0]
    return Network(
        tuple(
            replace(
                point,
                mass=column(network.points[k].mass for network in networks),
                stiffness=column(network.points[k].stiffness for network in networks),
                damping=double(0),
            )
            for k, point in enumerate(first.points)
        ),
        tuple(
            replace(
                bar,
                length=column(network.bars[k].length for network in networks),
                speed=column(network.bars[k].speed for network in networks),
                impedance=column(network.bars[k].impedance for network in networks),
                ratios=(double(bar.ratios[0]), double(bar.ratios[1])),
            )
            for k, bar in enumerate(first.bars)
        ),
        tuple(
            replace(
                link,
                stiffness=column(network.links[k].stiffness for network in networks),
                damping=double(0),
                ratio=double(link.ratio),
            )
            for k, link in enumerate(first.links)
        ),
    )


def drawn(network: Network) -> Network:
    """A network of the same pattern with other numbers, which do not fit one another."""
    numbers = (fmpq(10 * k * k + 3, 7 * k + 1) for k in count(1))

    def changed(value: fmpq) -> fmpq:
        return value * next(numbers)

    return Network(
        tuple(replace(p, mass=changed(p.mass), stiffness=changed(p.stiffness)) for p in network.points),
        tuple(replace(b, impedance=changed(b.impedance), speed=changed(b.speed)) for b in network.bars),
        tuple(replace(link, stiffness=changed(link.stiffness)) for link in network.links),
    )


class Shapes(NamedTuple):
    """How far each row moves in modes of mass 1; by rounding about how `wrong` their w^2 are, and how `blurred` they
    themselves, relative to their size."""

    rows: list[Columns]
    wrong: Columns
    blurred: Columns


class StiffnessSets(Stiffness):
    """K of networks side by side, whose pattern is that of an exact one, `like`."""

    ZERO = 0.0

    def __init__(self, network: Network, like: Network) -> None:
        super().__init__(network)
        self.__dict__["_like"] = Stiffness(like)

    @property
    def like(self) -> Stiffness:
        """K of the exact network."""
        exact: Stiffness = self.__dict__["_like"]
        return exact

    @cached_property
    def _found(self) -> list[tuple[int, int | None]]:
        return self.like._found

    @property
    def modes(self) -> int | None:
        return self.like.modes

    @cached_property
    def delays(self) -> tuple[list[Any], list[int]]:
        found: dict[bytes, Columns] = {}
        keys = []
        for bar in self.network.bars:
            delay: Columns = bar.delay
            keys.append(delay.tobytes())
            found.setdefault(keys[-1], delay)
        order = {key: number for number, key in enumerate(found)}
        return list(found.values()), [order[key] for key in keys]

    @cached_property
    def doubles(self) -> HarmonicLaw:
        return self.law(double)

    def upper_bounds(self, n: NDArray[np.int64]) -> Columns:
        if self.modes is None:
            delay: Columns = sum(bar.delay for bar in self.network.bars)
            return np.asarray((n + len(self.network.bars)) * np.pi / delay)
        pairs = zip(self.doubles.held, self.doubles.mass, strict=True)
        total = sum(held / mass for held, mass in pairs if mass.any())
        return np.asarray(2 * np.sqrt(total) * np.ones(len(n)))

    def shapes(self, w: Columns) -> Shapes:
        """The modes with frequencies w.

        K is eliminated from the tips and from the root. Where both meet, in the row on which the least is left, a mode
        needs no force; from there its shape is what each branch does (Parlett and Dhillon).
        """
        law, parents = self.doubles, self.parents
        with np.errstate(all="ignore"):
            angles = [w * delay for delay in law.delays]
            csc = [1 / np.sin(angle) for angle in angles]
            cot = [np.cos(angle) * each for angle, each in zip(angles, csc, strict=True)]
            diagonal, up = law.matrix(w, cot, csc)
            pivots = self.pivots(list(diagonal), up)
            beyond = self._beyond(diagonal, pivots, up)
            left = [
                pivot if parent is None else pivot - k * k / other
                for pivot, parent, k, other in zip(pivots, parents, up, beyond, strict=True)
            ]
            root = np.argmin(np.nan_to_num(np.abs(left), nan=np.inf), axis=0)
            towards = [root == row for row in range(len(left))]
            moved = [np.where(at, 1.0, 0.0) for at in towards]
            for row, parent in enumerate(parents):
                if parent is not None:
                    moved[parent] = np.where(towards[row], -up[row] * moved[row] / beyond[row], moved[parent])
                    towards[parent] = towards[parent] | towards[row]
            for row in reversed(range(len(parents))):
                if (parent := parents[row]) is not None:
                    moved[row] = np.where(towards[row], moved[row], -up[row] * moved[parent] / pivots[row])
            scale = moved_mass(law, w, moved, parents, cot, csc) ** -0.5
            moved = [scale * q for q in moved]
            # an angle is as wrong as its last digit: near a resonance of a bar that counts
            near = [(angle, abs(c), abs(s)) for angle, c, s in zip(angles, cot, csc, strict=True)]
            pulled, shared = [w * (c + a * s * s) for a, c, s in near], [w * s * (1 + a * c) for a, c, s in near]
            wrong = self._energy(moved, *law.assemble(-w * w, pulled, shared))
            # so do terms of the mass of bars, which nearly cancel where points are nearly at rest
            squares = [delay * s * s * (1 + a * s) for delay, (a, _, s) in zip(law.delays, near, strict=True)]
            blurred = self._energy(moved, *law.assemble(0.0, squares, squares))
        return Shapes(moved, _ROUNDINGS * _EPS * wrong, _ROUNDINGS * _EPS * blurred)

    def _energy(self, moved: list[Columns], sizes: list[Columns], across: list[Columns]) -> Columns:
        """Absolute values of the terms of q^T K q."""
        total = sum(size * q * q for size, q in zip(sizes, moved, strict=True))
        for k, q, parent in zip(across, moved, self.parents, strict=True):
            total = total + (0.0 if parent is None else 2 * abs(k * q * moved[parent]))
        return total

    def _beyond(self, diagonal: list[Columns], pivots: list[Columns], up: list[Any]) -> list[Columns]:
        """Of each row what is left of its parent once all but the row's own branch is eliminated."""
        branches: dict[int, list[int]] = {}
        for row, parent in enumerate(self.parents):
            if parent is not None:
                branches.setdefault(parent, []).append(row)
        beyond = list(pivots)
        for row in reversed(range(len(pivots))):
            if (parent := self.parents[row]) is not None:
                beyond[row] = diagonal[parent]
                for other in branches[parent]:
                    if other != row:
                        beyond[row] = beyond[row] - up[other] * up[other] / pivots[other]
                if self.parents[parent] is not None:
                    beyond[row] = beyond[row] - up[parent] * up[parent] / beyond[parent]
        return beyond


class ModeColumns(Mode):
    """Modes of sets, (sets, modes) each."""

    def slope(self, end: End) -> Columns:
        bar, w = self.stiffness.network.bars[end.bar], self.frequency
        here, there = self.displacement(end), self.displacement(End(end.bar, 1 - end.side))
        with np.errstate(all="ignore"):
            slope = w * (there - here * np.cos(w * bar.delay)) / np.sin(w * bar.delay)
        return np.where(w == 0, 0.0, -slope if end.side else slope)
