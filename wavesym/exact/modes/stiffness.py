"""How a chain resists a harmonic motion: its dynamic stiffness, and how many frequencies lie below one.

What moves harmonically with frequency w is held, seen from the points, by a symmetric matrix K(w). A bar of impedance Z
and delay T adds w Z cot(w T) at both its ends and -w Z/sin(w T) across, a mass M adds -w^2 M, a spring its stiffness.
A chain with branches is a tree of points: eliminated from the tips to the root, K has one pivot for each point.

Wittrick and Williams (1971): the frequencies below w are as many as the bars would have there if their ends were at
rest, floor(w T/pi) each, and the negative pivots. None can be missed.

A dashpot adds i w times what it resists. Then K is symmetric, and frequencies are complex.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any

import numpy as np
from flint import arb, fmpq
from numpy.typing import NDArray

from wavesym.errors import UnservedError
from wavesym.mechanics.network import Network
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest

# doubles (arrays of them), or balls
Quantity = Any

_ZERO = fmpq(0)


Weights = list[tuple[int, Quantity]]
"""Impedances of bars (with the gear ratios of their ends), those of one delay together, each with its number."""


@dataclass(frozen=True)
class HarmonicLaw:
    """The numbers of K in one arithmetic; rows run from the tips to the root.

    Of each row its `mass`, what springs and dashpots are of it (`stiffness`, `damping`) and the bars that end there
    (`ends`); of its coupling to its parent the same, and the `bars`. `counts` are the numbers of bars of each of the
    `delays`.
    """

    mass: list[Quantity]
    stiffness: list[Quantity]
    damping: list[Quantity]
    ends: list[Weights]
    coupling_stiffness: list[Quantity]
    coupling_damping: list[Quantity]
    bars: list[Weights]
    delays: list[Quantity]
    counts: list[int]

    def matrix(
        self, w: Quantity, cot: Sequence[Quantity], csc: Sequence[Quantity], rate: Quantity = None
    ) -> tuple[list[Any], list[Any]]:
        """The diagonal of K, and what couples each row to its parent, from cot and 1/sin of w times each delay.

        Where there are dashpots `rate` is i w.
        """
        return self.assemble(w * w, [w * value for value in cot], [-w * value for value in csc], rate)

    def assemble(
        self, square: Quantity, pulled: Sequence[Quantity], shared: Sequence[Quantity], rate: Quantity = None
    ) -> tuple[list[Any], list[Any]]:
        """The same from w^2, and for each delay from what a bar of impedance 1 adds at its ends, and across."""
        diagonal = [k - square * mass for k, mass in zip(self.stiffness, self.mass, strict=True)]
        for row, weights in enumerate(self.ends):
            for delay, weight in weights:
                diagonal[row] = diagonal[row] + weight * pulled[delay]
        up = list(self.coupling_stiffness)
        for row, weights in enumerate(self.bars):
            for delay, weight in weights:
                up[row] = up[row] + weight * shared[delay]
        if rate is not None:
            diagonal = [k + rate * c for k, c in zip(diagonal, self.damping, strict=True)]
            up = [k + rate * c for k, c in zip(up, self.coupling_damping, strict=True)]
        return diagonal, up


@dataclass(frozen=True)
class Stiffness:
    """K(w) of a network whose points are those of a tree."""

    network: Network

    @cached_property
    def points(self) -> tuple[int, ...]:
        """The point of each row: those that are free to move, tips first, each before its parent."""
        return tuple(point for point, _ in reversed(self._tree))

    @cached_property
    def rows(self) -> dict[int, int]:
        """The row of each of these points."""
        return {point: row for row, point in enumerate(self.points)}

    @cached_property
    def parents(self) -> tuple[int | None, ...]:
        """The row that each row hangs on."""
        return tuple(None if parent is None else self.rows[parent] for _, parent in reversed(self._tree))

    @cached_property
    def _tree(self) -> list[tuple[int, int | None]]:
        """Free points, each with the one that it was reached from."""
        network = self.network
        beside: dict[int, list[int]] = {n: [] for n, point in enumerate(network.points) if point.motion is None}
        pairs = [(bar.left, bar.right) for bar in network.bars]
        pairs += [(link.left, link.right) for link in network.links if link.stiffness != 0 or link.damping != 0]
        for one, other in pairs:
            if one in beside and other in beside:
                beside[one].append(other)
                beside[other].append(one)
        found: dict[int, int | None] = {}
        for root in beside:
            if root in found:
                continue
            found[root] = None
            coming = [root]
            while coming:
                point = coming.pop()
                for other in beside[point]:
                    if other not in found:
                        found[other] = point
                        coming.append(other)
                    elif found[point] != other and found[other] != point:
                        raise UnservedError(
                            "system.parts: a ring of parts is not supported by modes (write a chain with branches)"
                        )
        return list(found.items())

    @cached_property
    def delays(self) -> tuple[list[Any], list[int]]:
        """The different delays of bars in order, and the number of that of each bar."""
        found = sorted({bar.delay for bar in self.network.bars})
        return found, [found.index(bar.delay) for bar in self.network.bars]

    def law(self, number: Callable[[Any], Quantity]) -> HarmonicLaw:
        """Its numbers in one arithmetic."""
        network, rows = self.network, self.rows
        free = [network.points[point] for point in self.points]
        delays, delay_of = self.delays
        stiffness, coupling_stiffness = [point.stiffness for point in free], list[Quantity]([_ZERO] * len(free))
        damping, coupling_damping = [point.damping for point in free], list[Quantity]([_ZERO] * len(free))
        ends, bars = [dict[int, Quantity]() for _ in free], [dict[int, Quantity]() for _ in free]
        for link in network.links:
            pair = rows.get(link.left), rows.get(link.right)
            for row, ratio in zip(pair, (link.ratio, fmpq(1)), strict=True):
                if row is not None:
                    stiffness[row] = stiffness[row] + ratio**2 * link.stiffness
                    damping[row] = damping[row] + ratio**2 * link.damping
            if pair[0] is not None and pair[1] is not None:
                near = min(pair[0], pair[1])
                coupling_stiffness[near] = coupling_stiffness[near] - link.ratio * link.stiffness
                coupling_damping[near] = coupling_damping[near] - link.ratio * link.damping
        for bar, delay in zip(network.bars, delay_of, strict=True):
            pair = rows.get(bar.left), rows.get(bar.right)
            for row, ratio in zip(pair, bar.ratios, strict=True):
                if row is not None:
                    ends[row][delay] = ends[row].get(delay, _ZERO) + bar.impedance * ratio**2
            if pair[0] is not None and pair[1] is not None:
                shared = bars[min(pair[0], pair[1])]
                shared[delay] = shared.get(delay, _ZERO) + bar.impedance * bar.ratios[0] * bar.ratios[1]
        return HarmonicLaw(
            [number(point.mass) for point in free],
            [*map(number, stiffness)],
            [*map(number, damping)],
            [[(delay, number(weight)) for delay, weight in each.items()] for each in ends],
            [*map(number, coupling_stiffness)],
            [*map(number, coupling_damping)],
            [[(delay, number(weight)) for delay, weight in each.items()] for each in bars],
            [*map(number, delays)],
            [delay_of.count(number) for number in range(len(delays))],
        )

    def orders(self, root: int) -> list[tuple[int, int, int]]:
        """The rows from one row outwards, each with the row that it hangs by and the row that names their coupling."""
        return self._orders.get(root) or self._orders.setdefault(root, self._order(root))

    @cached_property
    def _orders(self) -> dict[int, list[tuple[int, int, int]]]:
        return {}

    def _order(self, root: int) -> list[tuple[int, int, int]]:
        beside: list[list[tuple[int, int]]] = [[] for _ in self.parents]
        for row, parent in enumerate(self.parents):
            if parent is not None:
                beside[row].append((parent, row))
                beside[parent].append((row, row))
        found = [(root, root, root)]
        for row, before, _ in found:
            found += [(other, row, edge) for other, edge in beside[row] if other != before]
        return found

    def pivots(self, diagonal: list[Quantity], up: Sequence[Quantity]) -> list[Quantity]:
        """The pivots of K, `diagonal` eliminated in place."""
        for row, parent in enumerate(self.parents):
            if parent is not None:
                diagonal[parent] = diagonal[parent] - up[row] * up[row] / diagonal[row]
        return diagonal

    def solve(self, diagonal: list[Quantity], up: Sequence[Quantity], forces: Sequence[Quantity]) -> list[Quantity]:
        """How far rows move under forces on them, `diagonal` eliminated in place."""
        return self.substitute(self.pivots(diagonal, up), up, forces)

    def substitute(
        self, pivots: Sequence[Quantity], up: Sequence[Quantity], forces: Sequence[Quantity], *, free: bool = False
    ) -> list[Quantity]:
        """The same once K is eliminated. Where nothing holds the chain (`free`) forces balance, and the root rests."""
        moved = list(forces)
        for row, parent in enumerate(self.parents):
            if parent is not None:
                moved[parent] = moved[parent] - up[row] * moved[row] / pivots[row]
        for row in reversed(range(len(pivots))):
            parent = self.parents[row]
            if parent is not None:
                moved[row] = (moved[row] - up[row] * moved[parent]) / pivots[row]
            else:
                moved[row] = moved[row] * 0 if free else moved[row] / pivots[row]
        return moved

    def point_motions(self, moved: Sequence[Quantity]) -> list[Quantity]:
        """How far points move where rows move so far; those that are not free do not."""
        points = [moved[0] * 0] * len(self.network.points)
        for point, each in zip(self.points, moved, strict=True):
            points[point] = each
        return points

    @cached_property
    def doubles(self) -> HarmonicLaw:
        """Its numbers in doubles."""
        return self.law(nearest)

    @cached_property
    def delay(self) -> fmpq:
        """That of all bars together: there are delay/pi frequencies to a unit of frequency."""
        return sum((bar.delay for bar in self.network.bars), fmpq(0))

    @property
    def modes(self) -> int | None:
        """How many modes there are without dashpots: as many as masses, where no bar has infinitely many."""
        if self.network.bars:
            return None
        return sum(self.network.points[point].mass != 0 for point in self.points)

    def upper_bounds(self, n: NDArray[np.int64]) -> Array:
        """Above each n-th frequency. Without bars the squares of all have the sum K_ii/m_i at most."""
        if self.modes is None:
            return np.asarray((n + len(self.network.bars)) * np.pi / nearest(self.delay))
        law = self.doubles
        pairs = zip(law.stiffness, law.mass, strict=True)
        return np.full(len(n), 2 * float(np.sqrt(sum(k / mass for k, mass in pairs if mass != 0)) or 1))

    def count_below(self, w: Array) -> NDArray[np.int64]:
        """How many frequencies lie below each w > 0, in doubles: right but for rounding.

        Beside a resonance of a bar digits cancel, and light masses between stiff bars may be off by 1e-3: guesses, of
        which each is proved, or sought by counting in balls (frequencies.py).
        """
        angles = [w * delay for delay in self.doubles.delays]
        sines = [np.sin(angle) for angle in angles]
        turns = [_turns(angle, sine) for angle, sine in zip(angles, sines, strict=True)]
        with np.errstate(all="ignore"):
            pivots, _ = self._eliminate(w, angles, sines)
            negative = [pivot < 0 for pivot in pivots]
        clamped = [count * turn for count, turn in zip(self.doubles.counts, turns, strict=True)]
        return np.asarray(sum(clamped, np.zeros(w.shape, np.int64)) + sum(negative, np.zeros(w.shape, np.int64)))

    def softest_rows(self, w: NDArray[Any], rate: NDArray[Any] | None = None) -> NDArray[np.int64]:
        """The row on which a force moves most at each w, in doubles: one that moves much in the mode that is near.

        Where there are dashpots `rate` is i w.
        """
        angles = [w * delay for delay in self.doubles.delays]
        with np.errstate(all="ignore"):
            left = self._left_of_rows(*self._eliminate(w, angles, [np.sin(angle) for angle in angles], rate))
        return np.asarray(np.argmin(np.nan_to_num(np.abs(left), nan=np.inf), axis=0))

    def softest_row(self, law: HarmonicLaw, w: Quantity, rate: Quantity) -> int:
        """The same at one w, in balls: for modes whose frequencies are one in doubles. `law` is in balls."""
        diagonal, up = law.matrix(w, *cot_csc(law, w), rate)
        sizes = [abs(left) for left in self._left_of_rows(self.pivots(diagonal, up), up)]
        return min(range(len(sizes)), key=lambda row: float(sizes[row]) if sizes[row].is_finite() else inf)

    def _left_of_rows(self, pivots: Sequence[Quantity], up: Sequence[Quantity]) -> list[Quantity]:
        """What is left of each row once all others are eliminated."""
        left = list(pivots)
        for row in reversed(range(len(left))):
            parent = self.parents[row]
            if parent is not None:
                left[row] = pivots[row] * left[parent] / (left[parent] + up[row] * up[row] / pivots[row])
        return left

    def _eliminate(
        self, w: Quantity, angles: Sequence[Quantity], sines: Sequence[Quantity], rate: Quantity = None
    ) -> tuple[list[Array], list[Any]]:
        csc = [1 / sine for sine in sines]
        cot = [np.cos(angle) / sine for angle, sine in zip(angles, sines, strict=True)]
        diagonal, up = self.doubles.matrix(w, cot, csc, rate)
        return self.pivots(diagonal, up), up

    def proved_count(self, law: HarmonicLaw, w: arb) -> int | None:
        """How many frequencies lie below w, proved; None where so many bits do not tell. `law` is in balls."""
        count = 0
        for delay, bars in zip(law.delays, law.counts, strict=True):
            turns = (w * delay / arb.pi()).floor().unique_fmpz()
            if turns is None:
                return None
            count += bars * int(turns)
        for pivot in self.pivots(*law.matrix(w, *cot_csc(law, w))):
            if not (pivot > 0 or pivot < 0):
                return None
            count += bool(pivot < 0)
        return count


def _turns(angle: Array, sine: Array) -> NDArray[np.int64]:
    """floor(angle/pi), such that the sine has the sign that goes with it: a jump of both is at one double."""
    nearest_turn = np.rint(angle / np.pi).astype(np.int64)
    return nearest_turn - (np.where(nearest_turn % 2, -sine, sine) < 0)


def cot_csc(law: HarmonicLaw, w: Quantity) -> tuple[list[Quantity], list[Quantity]]:
    """cot and 1/sin of w times each delay."""
    pairs = [(w * delay).sin_cos() for delay in law.delays]
    return [cosine / sine for sine, cosine in pairs], [1 / sine for sine, _ in pairs]
