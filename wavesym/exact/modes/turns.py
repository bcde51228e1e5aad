"""How many complex frequencies a circle about 0 has inside, in balls.

From the tips of the tree of points to its root each branch resists by a ratio A/B of functions of w without poles, as
in harmonic.py. The last A is det K times sin(w T)/w of all bars, so its zeros are the frequencies, each as often as it
is one.

As a power series in s = i w no coefficient of A is negative: s^2 m, s c, k, sinh(s T)/s and cosh(s T) are added and
multiplied, and nothing is taken off. So those of s^n and beyond add A(r) (R/r)^n/(1 - R/r) at most where |s| = R < r,
and zeros of the others are counted by numbers/zero_counts.py. That takes n^2 operations and one sum over the tree,
and n is about 7 R times the delay of all bars.

Where that would be more than to go around the circle, how often A turns is counted (argument principle): A(-conj w) is
the conjugate of A(w), so half a circle is enough, and where A is nowhere on an arc so far from its value in the middle
as that is from 0, what it turns by from end to end is the angle between its values there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from math import inf, pi, prod
from typing import Any, NamedTuple

import numpy as np
from flint import acb, acb_series, arb, arb_series, ctx, fmpq, fmpq_poly

from wavesym.exact.modes.branches import BranchTree
from wavesym.exact.modes.harmonic import Frequency, Quantity, Resistances, Turn, ball_frequency
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.mechanics.network import Network
from wavesym.numbers.arrays import Complex
from wavesym.numbers.doubles import nearest
from wavesym.numbers.zero_counts import zeros_in_disc

_BITS = 96
_ARCS, _ARCS_A_RADIAN = 8, 1  # at first
_MOST_WORK = 40_000  # arcs times rows, of all circles
_SPARE = 8  # times as many arcs as at first may be needed where there are many rows
_BESIDE = 1e-9  # between frequencies of nearly one absolute value is no circle
_BEYOND_LAST = {True: 1e3, False: 1.5}  # times the last one, where there are finitely many and where not
_POWERS = 12  # of A on an arc
_LONG = 900  # terms of A's power series: beyond, arcs take less
_TERMS, _TERMS_A_RADIAN, _TERMS_A_ROW = 48, 7, 2  # of a series, a row being one with a mass or a spring
_BITS_A_RADIAN = 22
_SLOW_TERMS, _SLOW_BITS = 24, 768  # where a radian is turned at most
_AGAIN = 3  # with twice as many bits and half as many terms more
MOST_ROOTS = 120
"""Of a polynomial whose roots are taken: of twice as many that takes ten seconds."""
_I = acb(0, 1)


def absorb(network: Network) -> Network:
    """The same network without rods that lead to nothing but a dashpot as large as their impedance.

    From there nothing returns: such a rod is that dashpot at its other end, and has no frequencies of its own.
    """
    while (end := next((end for end in bare_ends(network) if end.impedance == end.damping), None)) is not None:
        number, side = end.bar, end.side
        bar = network.bars[number]
        near = bar.right if side == 0 else bar.left
        points = list(network.points)
        points[near] = replace(points[near], damping=points[near].damping + bar.ratios[1 - side] ** 2 * bar.impedance)
        far = bar.left if side == 0 else bar.right
        points[far] = replace(points[far], damping=fmpq(0), motion="fixed")
        bars = tuple(other for k, other in enumerate(network.bars) if k != number)
        network = replace(network, points=tuple(points), bars=bars)
    return network


class BareEnd(NamedTuple):
    """A bar's end at a point that has a dashpot at most: its impedance there and what the dashpot is."""

    bar: int
    side: int
    impedance: fmpq
    damping: fmpq


def bare_ends(network: Network) -> Iterator[BareEnd]:
    """Those of a network."""
    held = Counter(end for bar in network.bars for end in (bar.left, bar.right))
    held.update(end for link in network.links for end in (link.left, link.right))
    for number, bar in enumerate(network.bars):
        for side, at in enumerate((bar.left, bar.right)):
            point = network.points[at]
            if point.mass == 0 and point.stiffness == 0 and point.motion is None and held[at] == 1:
                yield BareEnd(number, side, bar.ratios[side] ** 2 * bar.impedance, point.damping)


class Circles:
    """Circles about 0, and how many frequencies of a network with dashpots are inside.

    UnservedError for a ring of parts.

    Attributes:
        is_exhausted: whether a circle would have taken too long.
        is_finite: whether there are finitely many frequencies, as without rods.
    """

    def __init__(self, network: Network) -> None:
        network = absorb(network)
        self._stiffness = stiffness = Stiffness(network)
        self._count = len(stiffness.points)
        self._series, self._series_bits = list[arb](), 0
        self._left, self.is_exhausted, self.is_finite = _MOST_WORK, False, not network.bars
        rows = list(zip(stiffness.points, stiffness.parents, strict=True))
        self._trees = [BranchTree(network, point) for point, parent in rows if parent is None]
        tied = {end for link in network.links for end in (link.left, link.right)}
        points = ((number in tied or parent is None, network.points[number]) for number, parent in rows)
        self._able = sum(is_able or point.mass != 0 or point.stiffness != 0 for is_able, point in points)

    def largest_complete(self, found: Sequence[complex], count: int) -> float:
        """Up to which absolute value `found` has all frequencies but 0: beyond its first `count`, if it has those.

        Args:
            found: frequencies of modes by their absolute values, in rad per tau, with real parts of at least 0.
            count: how many of them are wanted.
        """
        if not self._stiffness.points:
            return inf
        sizes = [abs(w) for w in found] or [1.0]
        gaps = [k for k in range(1, len(sizes)) if sizes[k] > sizes[k - 1] * (1 + _BESIDE)]
        radii: list[float] = [(sizes[k - 1] * sizes[k]) ** 0.5 for k in gaps]
        if len(found) <= count:
            if self.determinant is not None and self.determinant.degree() == self._zeros(found, inf):
                return inf
            gaps.append(len(sizes))
            radii.append(_BEYOND_LAST[self.is_finite] * sizes[-1])
        # the widest gap beyond those that are wanted, and where that fails nearer ones
        widest = max(
            (k for k in range(len(gaps)) if gaps[k] >= count), key=lambda k: radii[k] / sizes[gaps[k] - 1], default=None
        )
        low, high = 0, len(gaps)
        if widest is not None:
            if self._is_complete(found, radii[widest]):
                return radii[widest]
            high = widest
        while low < high:
            middle = (low + high) // 2
            low, high = (middle + 1, high) if self._is_complete(found, radii[middle]) else (low, middle)
        return radii[low - 1] if low else 0.0

    def _is_complete(self, found: Sequence[complex], radius: float) -> bool:
        return self.count(radius) == self._zeros(found, radius)

    def _zeros(self, found: Sequence[complex], radius: float) -> int:
        """How many A has below a radius, if modes there are all found."""
        return self._at_rest + sum(2 if w.real else 1 for w in found if abs(w) < radius)

    @cached_property
    def _at_rest(self) -> int:
        """As how many frequencies w = 0 counts: its power series begins with so many zeros, which are exact."""
        terms = _TERMS
        while not (found := [k for k, c in enumerate(self._coefficients(terms, _BITS)) if c != 0]):
            terms *= 2
        return found[0]

    @cached_property
    def determinant(self) -> fmpq_poly | None:
        """A as a polynomial of s; None where there are rods."""
        if not self.is_finite:
            return None
        s = fmpq_poly([0, 1])
        found: fmpq_poly = self._determinant(
            Frequency(-s * s, s, lambda delay: Turn(delay, delay), lambda x: fmpq_poly([x]))
        )
        return found

    def count(self, radius: float) -> int | None:
        """How many frequencies have absolute values below a radius, 0 among them; None where that takes too long."""
        turned = radius * nearest(self._stiffness.delay)
        terms = _TERMS + int(_TERMS_A_RADIAN * turned) + _TERMS_A_ROW * self._able
        bits = _BITS + int(_BITS_A_RADIAN * turned)
        if terms > _LONG:
            return self._count_turns(radius)
        for _ in range(_AGAIN):
            with ctx.workprec(bits):
                found = zeros_in_disc(self._coefficients(terms, bits), arb(radius), self._rest(terms, arb(radius)))
            if found is not None:
                return found
            terms, bits = terms * 3 // 2, 2 * bits
        return self._count_turns(radius)

    def slow_frequencies(self) -> Complex:
        """Those beside 0 that are less than 1/(delay of all rods), w with Re w >= 0, in doubles: all, but for rounding.

        They are zeros of the first terms of the power series; however far apart they are, none is searched for.
        """
        terms = _SLOW_TERMS + _TERMS_A_ROW * self._count
        if terms > MOST_ROOTS or self.is_finite:
            return np.zeros(0, complex)
        with ctx.workprec(_SLOW_BITS):
            first = self._coefficients(terms, _SLOW_BITS)[self._at_rest : terms]
            exact = fmpq_poly(
                [mantissa * fmpq(2) ** int(power) for mantissa, power in (c.man_exp() for c in map(arb.mid, first))]
            )
        roots: Any = exact.numer().complex_roots()
        w = -1j * np.array([complex(s) for s, _ in roots])
        return np.asarray(w[(w.real >= 0) & (np.abs(w) * nearest(self._stiffness.delay) < 1)])

    def _coefficients(self, terms: int, bits: int) -> Sequence[arb]:
        """Those of A, the first ones, as a power series in s = i w."""
        if len(self._series) < terms or self._series_bits < bits:
            self._series, self._series_bits = self._power_series(terms, bits), bits
        return self._series

    def _power_series(self, terms: int, bits: int) -> list[arb]:
        def turn(delay: fmpq) -> Turn:
            """sinh(s T)/s and cosh(s T)."""
            powers = [arb(1)]
            for k in range(1, terms + 1):
                powers.append(powers[-1] * delay / k)
            odd, even = ([c * (k % 2 == parity) for k, c in enumerate(powers)] for parity in (1, 0))
            return Turn(arb_series(odd[1:], prec=terms), arb_series(even[:terms], prec=terms))

        cap = ctx.cap
        try:
            ctx.cap = terms
            with ctx.workprec(bits):
                s = arb_series([0, 1], prec=terms)
                found = arb_series(self._determinant(Frequency(-s * s, s, turn)), prec=terms).coeffs()
        finally:
            ctx.cap = cap
        return [*found, *[arb(0)] * (terms - len(found))]

    def _rest(self, terms: int, radius: arb) -> arb:
        """What terms beyond so many add at most where |s| is a radius."""
        if self.is_finite and terms > 2 * self._count:
            return arb(0)
        far = radius + terms / (self._stiffness.delay or 1)

        def turn(delay: fmpq) -> Turn:
            return Turn((far * delay).sinh() / far, (far * delay).cosh())

        whole = arb(self._determinant(Frequency(-far * far, far, turn)))
        return whole * (radius / far) ** terms / (1 - radius / far)

    def _count_turns(self, radius: float) -> int | None:
        """The same by the turns of A: half a turn of the right half of the circle is one."""
        arcs = _ARCS + int(_ARCS_A_RADIAN * radius * nearest(self._stiffness.delay))
        if _SPARE * arcs * self._count > self._left:
            self.is_exhausted = True
            return None
        with ctx.workprec(_BITS):
            total, first = 0.0, self._value(_on_circle(radius, arb(-1) / 2))
            coming = [(fmpq(2 * k - arcs, 2 * arcs), fmpq(2 * k + 2 - arcs, 2 * arcs)) for k in reversed(range(arcs))]
            while coming:
                low, high = coming.pop()
                middle = (low + high) / 2
                centre, size = _on_circle(radius, arb(middle)), (arb(2 * (high - low)) * radius).upper()  # pi/2 < 2
                if self._stays_beside(centre, size):
                    last = self._value(_on_circle(radius, arb(high)))
                    total += float((last / first).arg())
                    first = last
                elif self._left < 0:
                    self.is_exhausted = True
                    return None
                else:
                    coming += [(middle, high), (low, middle)]
                self._left -= self._count
        return round(total / pi)

    def _stays_beside(self, centre: acb, size: arb) -> bool:
        """Whether A is nowhere so far from A(centre) as that is from 0, where |w - centre| <= size.

        By its Taylor polynomial there, and the next coefficient on a ball.
        """
        ball = centre + acb(arb(0, size), arb(0, size))
        near = self._value(acb_series([centre, 1], prec=_POWERS)).coeffs()
        around = self._value(acb_series([ball, 1], prec=_POWERS + 1)).coeffs()
        powers = [*near, *[acb(0)] * (_POWERS - len(near)), around[_POWERS] if len(around) > _POWERS else acb(0)]
        others = sum((abs(c) * size**k for k, c in enumerate(powers[1:], 1)), start=arb(0))
        return bool(others < abs(powers[0]))

    def _value(self, w: Quantity) -> Quantity:
        return self._determinant(ball_frequency(w))

    def _determinant(self, w: Frequency) -> Quantity:
        """A of all trees."""
        return prod((Resistances(tree, w).determinant for tree in self._trees), start=w.number(fmpq(1)))


def _on_circle(radius: float, part: arb) -> acb:
    """At an angle of so many times pi."""
    return (acb(part) * _I * arb.pi()).exp() * radius
