"""How a network answers a harmonic force or motion exp(i w tau) of one of its points: complex amplitudes, in balls.

Seen from that point outwards the network is a tree. Each branch resists by a ratio N/D of functions of w that have no
poles, found from its tip to its root. At the far end of a bar of impedance Z and delay T let what lies beyond resist
by A/B, and a spring and a dashpot beside the bar by k. With c = cos w T and S = sin(w T)/w both ends move as

    near : far = D : B (Z + k S),   D = A S + B (Z c + k S),   N = A (Z c + k S) + B (2 Z k (c - 1) - Z^2 w^2 S)

So w = 0 is no exception, and the whole tree is divided by one number alone, which is 0 at its natural frequencies.
Branches of one point that are equal in all parts share one D: what they do against each other no force on that point
or before it moves, and their frequencies are not among those that the tree is divided by.

The arithmetic is that of a `Frequency`: balls, power series of them about one frequency, or polynomials
(lowest_terms.py). Masses, springs and dashpots may be balls, too, that reach down to 0: what is not exactly 0 is there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import prod
from typing import Any, NamedTuple

from flint import acb, acb_series, arb, fmpq

from wavesym.exact.modes.branches import Branch, BranchTree
from wavesym.mechanics.network import Point

# balls, complex balls, power series of them, or polynomials
Quantity = Any

_I, UNKNOWN = acb(0, 1), acb(arb("nan"), arb("nan"))


class Turn(NamedTuple):
    """sin(w T)/w and cos(w T)."""

    sine: Quantity
    cosine: Quantity


@dataclass(frozen=True)
class Frequency:
    """A frequency w in one arithmetic.

    Attributes:
        square: w^2.
        rate: i w.
        turn: sin(w T)/w and cos(w T) of a delay T.
        number: an exact number in this arithmetic.
    """

    square: Quantity
    rate: Quantity
    turn: Callable[[Quantity], Turn]
    number: Callable[[Any], Quantity] = arb


def ball_frequency(w: Quantity) -> Frequency:
    """A frequency that is a ball, or a power series of complex ones that does not begin with 0."""

    def turn(delay: Quantity) -> Turn:
        angle = w * delay
        sine = angle.sin() * inverse(w) if isinstance(angle, acb_series) else angle.sinc() * delay
        return Turn(sine, angle.cos())

    return Frequency(w * w, w * _I, turn)


class _Medium(NamedTuple):
    """What waves feel of a bar: `root` is that of 1 + i loss."""

    impedance: Quantity
    delay: Quantity
    root: Quantity


class Resistances:
    """What the points and branches of a tree resist by, each with all that is beyond it; `zero` is 0 there."""

    def __init__(self, tree: BranchTree, w: Frequency) -> None:
        self._network, self._root, self._w, self._equals = tree.network, tree.root, w, tree.equal_bars
        self._branches, self._twins = tree.branches, tree.twins
        self.zero, self._one = w.number(0), w.number(1)
        self._turns: dict[int, Turn] = {}
        # of each point the branches that differ, by their far points, and how many there are of each
        self._children: dict[int, dict[int, int]] = {}
        for branch in self._branches:
            beside, far = self._children.setdefault(branch.near_point, {}), self._twins[branch.far_point]
            beside[far] = beside.get(far, 0) + 1
        # of each point what it and all beyond resist by, A/B; of each branch N and D, by its far point
        self._beyond: dict[int, tuple[Quantity, Quantity]] = {}
        self._resistance: dict[int, tuple[Quantity, Quantity]] = {}
        for branch in reversed(self._branches):
            self._beyond[branch.far_point] = self._sum_subtree(branch.far_point)
            self._resistance[branch.far_point] = self._branch_fraction(branch)

    @property
    def determinant(self) -> Quantity:
        """That of the dynamic stiffness times all sin(w T)/w: A of the root were no D shared by equal branches."""
        shared = [far for far, first in self._twins.items() if far != first]
        whole, _ = self._sum_subtree(self._root)
        return prod((self._resistance[far][1] for far in shared), start=whole)

    def _sum_subtree(self, number: int) -> tuple[Quantity, Quantity]:
        """A and B of a point with all that hangs on it."""
        point = self._network.points[number]
        if point.motion is not None:
            return self._one, self.zero
        own, b = self._own(point), self._product(number)
        a = self.zero if own is None else own * b
        for far, count in self._children.get(number, {}).items():
            a = a + self._resistance[far][0] * self._product(number, but=far) * count
        return a, b

    def _product(self, number: int, but: int | None = None) -> Quantity:
        """Of all D of the branches of a point that differ, but for one."""
        found = [self._resistance[far][1] for far in self._children.get(number, ()) if far != but]
        return prod(found[1:], start=found[0]) if found else self._one

    def _own(self, point: Point) -> Quantity:
        """How a point resists by itself; None where it does not."""
        if point.mass == point.damping == point.stiffness == 0:
            return None
        own = self._w.number(point.stiffness)
        if not _is_zero(point.mass):
            own = own - self._w.square * point.mass
        return own if point.damping == 0 else own + self._w.rate * point.damping

    def _branch_fraction(self, branch: Branch) -> tuple[Quantity, Quantity]:
        """N and D of a branch, seen from its near point."""
        (a, b), beside = self._at_far_end(branch), self._parallel_resistance(branch)
        if branch.bar is None:
            return self._scale_by_gear(branch, a * beside), a + b * beside
        z, (sine, cosine) = self._medium(branch.bar).impedance, self._whole_turn(branch.bar)
        across = z * cosine if beside is None else z * cosine + beside * sine
        held = sine * (-z * z) * self._w.square
        if beside is not None:
            held = held + 2 * z * beside * (cosine - 1)
        return self._scale_by_gear(branch, a * across + b * held), a * sine + b * across

    def _scale_by_gear(self, branch: Branch, resistance: Quantity) -> Quantity:
        return resistance if branch.ratios[0] == 1 else resistance * branch.ratios[0] ** 2

    def _at_far_end(self, branch: Branch) -> tuple[Quantity, Quantity]:
        """A and B of what lies beyond it, seen by its far end."""
        a, b = self._beyond[branch.far_point]
        return a, b if branch.ratios[1] == 1 else b * branch.ratios[1] ** 2

    def _parallel_resistance(self, branch: Branch) -> Quantity:
        """How a spring and a dashpot resist; None where there are none."""
        if not _is_zero(branch.damping):
            return self._w.rate * branch.damping + branch.stiffness
        return None if _is_zero(branch.stiffness) else self._w.number(branch.stiffness)

    def _whole_turn(self, bar: int) -> Turn:
        first = self._equals[bar]
        if first not in self._turns:
            self._turns[first] = self._w.turn(self._medium(first).delay)
        return self._turns[first]

    def _medium(self, bar: int) -> _Medium:
        """A bar's impedance and delay, complex where it has a loss."""
        z, delay, loss = (getattr(self._network.bars[bar], key) for key in ("impedance", "delay", "loss"))
        if loss == 0:
            return _Medium(z, delay, 1)
        root = acb(1, arb(loss)).sqrt()
        return _Medium(root * z, delay / root, root)


class Amplitudes(Resistances):
    """The complex amplitudes of a network under a unit force on the root of a tree, or, where its motion is prescribed,
    a unit displacement; whatever no branch leads to is at rest. They are not finite where w may be a natural frequency.

    `divisor` is what they are to be divided by where they are `undivided`, else 1: of both w is no pole anywhere.
    """

    def __init__(self, tree: BranchTree, w: Frequency, *, undivided: bool = False) -> None:
        super().__init__(tree, w)
        self._moved: dict[int, Quantity] = {}
        self._scales: dict[int, tuple[Branch, Quantity]] = {}
        self.divisor: Quantity = self._one
        self._drive(tree.root, undivided)

    def point(self, number: int) -> Quantity:
        """How far a point moves."""
        return self._moved.get(number, self.zero)

    def displacement(self, bar: int, place: fmpq) -> Quantity:
        """How far a place of a bar moves, counted in lengths of the bar from its left end."""
        if bar not in self._scales:
            return self.zero
        branch, scale = self._scales[bar]
        if branch.near_point == self._root and place == branch.side:  # as it is driven, whatever the rest does
            return self._moved[self._root] * branch.ratios[0]
        a, b = self._at_far_end(branch)
        near, far = self._turns_to_ends(branch, place)
        moved = a * far.sine + b * self._medium(bar).impedance * far.cosine
        beside = self._parallel_resistance(branch)
        return scale * (moved if beside is None else moved + b * beside * (near.sine + far.sine))

    def slope(self, bar: int, place: fmpq) -> Quantity:
        """The strain of a place of a bar times the bar's speed."""
        if bar not in self._scales:
            return self.zero
        branch, scale = self._scales[bar]
        a, b = self._at_far_end(branch)
        near, far = self._turns_to_ends(branch, place)
        medium = self._medium(bar)
        slope = a * far.cosine - b * medium.impedance * self._w.square * far.sine
        beside = self._parallel_resistance(branch)
        if beside is not None:
            slope = slope + b * beside * (far.cosine - near.cosine)
        return scale * slope * (1 if branch.side else -1) / medium.root

    def _drive(self, root: int, undivided: bool) -> None:
        """Find how far each point moves, and what the amplitudes on each branch are scaled by."""
        force = self._one
        moved = self._network.points[root].motion is not None
        if moved and undivided:
            self.divisor = self._product(root)
            self._moved[root] = self.divisor
        elif moved:
            self._moved[root] = force
        else:
            a, b = self._sum_subtree(root)
            if undivided:
                self.divisor = a
            else:
                force = inverse(a)
            self._moved[root] = force * b
        share = {root: force}
        for branch in self._branches:
            if branch.near_point == root and moved and not undivided:
                scale = inverse(self._resistance[branch.far_point][1])
            else:
                scale = share[branch.near_point] * self._product(branch.near_point, but=self._twins[branch.far_point])
            if branch.ratios[0] != 1:
                scale = scale * branch.ratios[0]
            if branch.bar is not None:
                self._scales[branch.bar] = branch, scale
            share[branch.far_point] = scale * branch.ratios[1] * self._coupling(branch)
            if self._network.points[branch.far_point].motion is None:
                self._moved[branch.far_point] = share[branch.far_point] * self._beyond[branch.far_point][1]

    def _coupling(self, branch: Branch) -> Quantity:
        """What the far end moves by, times D and over B, when the near end does."""
        beside = self._parallel_resistance(branch)
        if branch.bar is None:
            return beside
        z = self._medium(branch.bar).impedance
        return self._one * z if beside is None else z + beside * self._whole_turn(branch.bar).sine

    def _turns_to_ends(self, branch: Branch, place: fmpq) -> tuple[Turn, Turn]:
        """From a place of its bar to the near and to the far end."""
        assert branch.bar is not None  # which the place lies on
        delay = self._medium(branch.bar).delay
        part = 1 - place if branch.side else place
        return self._w.turn(delay * part), self._w.turn(delay * (1 - part))


def _is_zero(number: Quantity) -> bool:
    """Whether a number is 0: a ball with 0 in it is neither equal to 0 nor different from it."""
    return bool(number == 0)


def inverse(value: Quantity) -> Quantity:
    """1 over a value: not finite where that may be 0."""
    if isinstance(value, acb_series) and acb(value[0]).contains(0):
        return acb_series([UNKNOWN, UNKNOWN, UNKNOWN], prec=value.prec)
    return 1 / value
