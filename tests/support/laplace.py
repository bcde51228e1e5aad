"""Any chain by Laplace transform, from the text of its scene alone: the truth that explicit chains are held against.

Nothing of the package is used. In the variable s a rod is a line with the delay e^(-s T), and the points of the chain
have velocities Q with

    (M s + C + K/s) Q = M q(0) + F + sum over rod ends of 2 n Z A,    sent into an end: n Q - A.

Everything is a sum of e^(-s d) R(s), expanded in powers of the delays; R is a ratio of polynomials with rational
coefficients, and its residues (of poles of any order) are the value, in balls. Only small chains: the terms are many.
"""

from __future__ import annotations

import heapq
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial
from typing import Any

from flint import acb, acb_poly, arb, ctx, fmpq, fmpq_poly, fmpz_poly

from tests.support.assembly import Assembly, exact, jumps

_S = fmpq_poly([0, 1])


class Ratio:
    """A ratio of polynomials in s, without common factors."""

    def __init__(self, above: fmpq_poly | fmpq | int, below: fmpq_poly | int = 1) -> None:
        above, below = fmpq_poly([1]) * above, fmpq_poly([1]) * below
        common = above.gcd(below) * below.leading_coefficient()
        # monic below, so that equal ones are equal
        self.above, self.below = divmod(above, common)[0], divmod(below, common)[0]

    def __bool__(self) -> bool:
        return bool(self.above)

    def __add__(self, other: Ratio) -> Ratio:
        if self.below == other.below:
            return Ratio(self.above + other.above, self.below)
        return Ratio(self.above * other.below + other.above * self.below, self.below * other.below)

    def __sub__(self, other: Ratio) -> Ratio:
        return self + other * Ratio(-1)

    def __mul__(self, other: Ratio) -> Ratio:
        return Ratio(self.above * other.above, self.below * other.below)

    def __truediv__(self, other: Ratio) -> Ratio:
        return Ratio(self.above * other.below, self.below * other.above)


_NOTHING = Ratio(0)
Series = dict[Fraction, Ratio]
"""sum of e^(-s delay) ratio."""


def _add(series: Series, delay: Fraction, gain: Ratio) -> None:
    series[delay] = series.get(delay, _NOTHING) + gain


def _inverse(matrix: list[list[Ratio]]) -> list[list[Ratio]]:
    """By elimination."""
    size = len(matrix)
    rows = [[*row, *(Ratio(int(i == j)) for j in range(size))] for i, row in enumerate(matrix)]
    for k in range(size):
        pivot = next(i for i in range(k, size) if rows[i][k])
        rows[k], rows[pivot] = rows[pivot], rows[k]
        one = Ratio(1) / rows[k][k]
        rows[k] = [each * one if each else each for each in rows[k]]
        for i in range(size):
            if i != k and (factor := rows[i][k]):
                rows[i] = [
                    each - factor * other if other else each for each, other in zip(rows[i], rows[k], strict=True)
                ]
    return [row[size:] for row in rows]


class Laplace:
    """A chain of a scene, given as the table that its text is, for 0 <= tau <= until."""

    def __init__(self, scene: Mapping[str, Any], until: Fraction | int) -> None:
        self.until = Fraction(until)
        self._made = made = Assembly.of(scene)
        assert not made.corners, "corners are not linear"
        self._velocity: list[Series] = [{} for _ in made.mass]
        """Of each point."""
        self._sent: dict[tuple[int, int], Series] = {(k, side): {} for k in range(len(made.rods)) for side in (0, 1)}
        """Into each end of each rod."""
        self._expand(self._sources(scene.get("load", ())))

    def terms(self, quantity: str, place: object) -> Terms:
        """A velocity, displacement or strain at a place, as it is written in a scene."""
        where = self._made.shown(quantity, place)
        return self._finished(
            self._velocity[where] if isinstance(where, int) else self._inside(*where, quantity), quantity
        )

    def _finished(self, series: Series, quantity: str) -> Terms:
        over = Ratio(1, _S) if quantity == "displacement" else Ratio(1)
        return Terms({delay: gain * over for delay, gain in sorted(series.items()) if gain})

    def _inside(self, number: int, x: Fraction, quantity: str) -> Series:
        """The velocity or strain in a rod, at x from its left end."""
        rod, series = self._made.rods[number], {}
        strain = quantity == "strain"
        for side, far, sign in ((0, x, -1 if strain else 1), (1, rod.length - x, 1)):
            size = Ratio(fmpq(sign) / (exact(rod.speed) if strain else 1))
            late = far / rod.speed
            begun = size * Ratio(rod.begun[1 - side], _S)
            _add(series, Fraction(0), begun)
            _add(series, late, begun * Ratio(-1))
            for delay, sent in self._sent[number, side].items():
                _add(series, delay + late, sent * size)
        return {delay: gain for delay, gain in series.items() if delay <= self.until}

    def _sources(self, loads: Sequence[Mapping[str, Any]]) -> dict[Fraction, dict[int, Ratio]]:
        """The right-hand sides of points, by delay: what they begin with, and what loads do."""
        made = self._made
        found: dict[Fraction, dict[int, Ratio]] = {Fraction(0): {}}
        for point, (mass, velocity) in enumerate(zip(made.mass, made.velocity, strict=True)):
            kind = made.motion.get(point)
            # times s, as all rows are; a motion "acceleration" begins with its velocity, "velocity" goes on with it
            begun = Ratio(velocity, _S) if kind in ("velocity", "acceleration") else Ratio(mass * velocity)
            if begun:
                found[Fraction(0)][point] = begun
        for load in loads:
            point = made.loaded(str(load["at"]))
            over = Ratio(1, _S) if made.motion.get(point) == "acceleration" else Ratio(1)
            for time, power, size in jumps(load):
                row = found.setdefault(time, {})
                row[point] = row.get(point, _NOTHING) + Ratio(size, _S ** (power + 1)) * over
        return found

    def _response(self) -> list[list[Ratio]]:
        """The velocities of points by what stands on the right of their rows."""
        made, size = self._made, len(self._made.mass)
        rows = [[_NOTHING] * size for _ in range(size)]
        for i in range(size):
            if i in made.motion:
                rows[i][i] = Ratio(1)
                continue
            for j in range(size):
                inertia = made.mass[i] if i == j else 0
                damping, stiffness = (matrix.get((i, j), fmpq(0)) for matrix in (made.damping, made.stiffness))
                rows[i][j] = Ratio(fmpq_poly([stiffness, damping, inertia]), _S)
        return _inverse(rows)

    def _expand(self, sources: dict[Fraction, dict[int, Ratio]]) -> None:
        """In powers of the delays."""
        made, response = self._made, self._response()
        arriving: dict[Fraction, dict[tuple[int, int], Ratio]] = {}
        for number, rod in enumerate(made.rods):
            for side, begun in enumerate(rod.begun):
                if begun:
                    arriving.setdefault(Fraction(0), {})[number, side] = Ratio(begun, _S)
                    arriving.setdefault(rod.delay, {})[number, side] = Ratio(-begun, _S)
        delays = [*{*arriving, *sources}]
        heapq.heapify(delays)
        while delays and (delay := heapq.heappop(delays)) <= self.until:
            right = dict(sources.get(delay, {}))
            waves = {end: wave for end, wave in arriving.pop(delay, {}).items() if wave}
            for (number, side), wave in waves.items():
                rod = made.rods[number]
                point = rod.ends[side]
                if point not in made.motion:
                    pushed = wave * Ratio(2 * rod.ratios[side] * rod.impedance)
                    right[point] = right.get(point, _NOTHING) + pushed
            moved: dict[int, Ratio] = {}
            for point, row in enumerate(response):
                gain = _NOTHING
                for other, each in right.items():
                    if row[other] and each:
                        gain = gain + row[other] * each
                if gain:
                    moved[point] = gain
                    _add(self._velocity[point], delay, gain)
            for number, rod in enumerate(made.rods):
                for side in (0, 1):
                    gain = moved.get(rod.ends[side], _NOTHING) * Ratio(rod.ratios[side])
                    gain = gain - waves.get((number, side), _NOTHING)
                    if not gain:
                        continue
                    _add(self._sent[number, side], delay, gain)
                    late = delay + rod.delay
                    if late not in arriving:
                        if late not in sources:
                            heapq.heappush(delays, late)
                        arriving[late] = {}
                    ends = arriving[late]
                    ends[number, 1 - side] = ends.get((number, 1 - side), _NOTHING) + gain


@dataclass
class _Pole:
    """sum of factors[k] t^k times e^(at t)."""

    at: acb
    factors: list[acb]


class Terms:
    """sum of e^(-s delay) ratio, as a function of tau."""

    def __init__(self, series: Series) -> None:
        self.series = series
        self._poles: dict[tuple[Fraction, int], list[_Pole]] = {}

    @property
    def arrivals(self) -> list[Fraction]:
        """When something arrives."""
        return list(self.series)

    def value(self, tau: Fraction, digits: int = 20) -> arb:
        """At tau (at a jump: after it), to so many digits of the largest term of it."""
        bits = 128
        with_bits = ctx.prec
        try:
            while True:
                ctx.prec = bits
                total = self._sum(tau, bits)
                if total.rad() < arb(10) ** -(digits + 5) * (1 + abs(total)):
                    return total
                bits *= 2
                assert bits <= 2**14, "no digits"
        finally:
            ctx.prec = with_bits

    def _sum(self, tau: Fraction, bits: int) -> arb:
        """As it is with so many bits; anything where they do not part the poles."""
        total = arb(0)
        for delay in self.series:
            if delay <= tau:
                try:
                    total += self._inverted(delay, tau - delay, bits)
                except ValueError:
                    return arb(0, 1)
        return total

    def _inverted(self, delay: Fraction, after: Fraction, bits: int) -> arb:
        if (delay, bits) not in self._poles:
            self._poles[delay, bits] = _residues(self.series[delay])
        t, total = arb(fmpq(*after.as_integer_ratio())), acb(0)
        for pole in self._poles[delay, bits]:
            shape = acb(0)
            for factor in reversed(pole.factors):
                shape = shape * t + factor
            total += shape * (pole.at * t).exp()
        return total.real


def _residues(ratio: Ratio) -> list[_Pole]:
    """What the poles of a ratio leave of it in time."""
    assert ratio.above.degree() < ratio.below.degree(), "an impulse"
    found = []
    _, factors = fmpz_poly(ratio.below.numer()).factor()
    below = acb_poly(fmpz_poly(ratio.below.numer()))
    above = acb_poly(ratio.above * ratio.below.denom())
    for factor, order in factors:
        for root, _ in factor.complex_roots():
            near = acb_poly([root, 1])
            # the first `order` coefficients of what is below are 0 there
            quotient = _divided(above(near).coeffs(), below(near).coeffs()[order:], order)
            found.append(_Pole(acb(root), [quotient[order - 1 - k] / factorial(k) for k in range(order)]))
    return found


def _divided(above: list[acb], below: list[acb], count: int) -> list[acb]:
    """The first coefficients of the quotient of two series."""
    if below[0].contains(0):
        raise ValueError("poles that are not apart")
    quotient: list[acb] = []
    for k in range(count):
        rest = above[k] if k < len(above) else acb(0)
        for n in range(1, min(k, len(below) - 1) + 1):
            rest -= below[n] * quotient[k - n]
        quotient.append(rest / below[0])
    return quotient
