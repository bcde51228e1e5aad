"""The least and the greatest value of an output, and when: true ones, proved, wherever they lie.

Between two breakpoints an output is one polynomial in balls, here in t on [-1, 1]. Its greatest value is at an end of
such a piece or inside it, and is found in two steps:

- In doubles, all pieces at once. With values at points that lie d apart, and m >= |f''|, no value of a piece is more
  than m d^2 / 8 above the largest of them. Rounding, (terms + 40) units of 2^-52 of |c_0| + |c_1| + ..., and the radii
  of the balls are added. Pieces that cannot hold the greatest value are left out.
- In balls, those that are left. A part of a piece, its middle moved to 0, is left out where c_0 + |c_1| + |c_2| + ...
  is too small. Else it certainly rises or falls, or is convex (an end is greatest), or is concave (Newton's method
  leads to t, and no value is more than 2 |f'(t)| above f(t)), or it is halved.

An output may come up to a value, jump, and never take it: its greatest value is that limit then, at the instant of the
jump. Values that differ by less than 2^-60 of the largest count as equal, and the first instant is told. An extreme
that is 0 to within `BOUND` of the largest value is 0: at the start where the output is that near to 0 there, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import nextafter

import numpy as np
from flint import arb, arb_poly, ctx, fmpq
from numpy.typing import NDArray

from wavesym.errors import CostError, UnservedError
from wavesym.exact.arrivals import identically_zero
from wavesym.exact.motion import Motion
from wavesym.exact.output_piece import NO_AVERAGES, Averages, Piece, averages, split
from wavesym.exact.tables.ball import is_zero
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.arrays import Array
from wavesym.numbers.balls import precise
from wavesym.numbers.doubles import middle, midpoint, nearest, not_below, rational

BOUND = 1.2e-16
"""Of an extreme, relative to the output's largest value: two roundings to double, and what counts as equal."""

# of the largest value: what counts as equal, as constant, how well it must be known, and what is left out of series
_EQUAL, _FLAT, _KNOWN, _NEGLIGIBLE = arb(2) ** -60, arb(2) ** -64, arb(2) ** -70, arb(2) ** -90
# points of a piece in doubles: of all pieces, then of those that are left
_POINTS = (33, 513)
_ROUNDING = 2.0**-52
_SPARE = 96  # bits of what is far below what counts as constant
_NEWTON = 200  # steps at most; a dozen do
_MOST_SECONDS = 5  # of composing; what else is done took 3 more
# times the bits that there are to begin with: what needs more is not told from 0
_MORE_BITS = 8
_AVERAGED = arb(2) ** -56  # of the largest value: how well averages must be known
_ZERO, _ONE = fmpq(0), fmpq(1)


@dataclass(frozen=True)
class TrueExtreme:
    """A `value`, right to 2^-52 of the output's largest, and the first `tau` at which it is taken.

    Where it is not `reached` the output comes up to it, or takes it between two doubles, and jumps at tau.
    """

    value: float
    tau: float
    reached: bool = True


Range = tuple[TrueExtreme, TrueExtreme]
NOTHING: Range = (TrueExtreme(0.0, 0.0), TrueExtreme(0.0, 0.0))


def extremes(model: Model) -> list[Range]:
    """The least and the greatest value of each output; errors as of `extremes_and_averages`."""
    return [extreme for extreme, _ in extremes_and_averages(model)]


def extremes_and_averages(model: Model) -> list[tuple[Range, Averages]]:
    """The least and the greatest value of each output on the horizon of doubles, and its averages there.

    Averages are known to `BOUND` of the output's largest value, as extremes are. CostError where that would take
    minutes, or where contacts open and close and more is needed than is known of them; UnservedError where modes are
    damped.
    """
    if model.damping is not None:
        raise UnservedError("system.damping: supported by modes only (leave it out, or take modes)")
    motion = Motion(model, rational(model.horizon()))
    pieces = motion.stretches + sum(len(motion.starts(probe)) for probe in motion.probes)
    if (seconds := motion.composing_time(pieces)) > _MOST_SECONDS:
        raise CostError(
            f"output.until: true extremes of {len(motion.probes)} outputs, with their waves {pieces} polynomials "
            f"in {motion.first_bits} bits, would take about {seconds:.0f} s, the limit is {_MOST_SECONDS} (a "
            "shorter horizon or fewer outputs help)"
        )
    zero = identically_zero(model, motion.until)
    return [
        (NOTHING, NO_AVERAGES) if nothing else _of_output(motion, probe)
        for probe, nothing in zip(motion.probes, zero, strict=True)
    ]


def _of_output(motion: Motion, probe: Probe) -> tuple[Range, Averages]:
    def attempt(bits: int) -> tuple[Range, Averages] | None:
        segments = motion.segments(probe, bits)
        if is_zero(segments):
            return NOTHING, NO_AVERAGES
        ends = [*(segment.start for segment in segments[1:]), motion.until]
        stretches = list(zip(segments, ends, strict=True))
        at_ends = (abs(segment.evaluate(u)).lower() for segment, end in stretches for u in (_ZERO, end - segment.start))
        negligible = max(at_ends) * _NEGLIGIBLE
        pieces = [
            Piece.from_segment(segment, end, segment is segments[-1], negligible)
            for segment, end in stretches
            if not segment.vague
        ]
        sizes = [piece.largest for piece in pieces]
        if motion.vanishes(sizes):
            return NOTHING, NO_AVERAGES
        if (found := _extremes_of(pieces, max(sizes))) is None:
            return None
        largest = max(abs(extreme.value) for extreme in found)
        averaged = averages(pieces, motion.until) if largest else NO_AVERAGES
        return (found, averaged) if averaged.radius <= arb(largest) * _AVERAGED else None

    try:
        return precise(attempt, motion.first_bits, _MORE_BITS * motion.first_bits)
    except ArithmeticError as error:
        raise CostError(f"output.until: for extremes of {probe.name}, {error} (a shorter horizon helps)") from None


@dataclass(frozen=True)
class _Candidate:
    """A value that an output takes, or comes up to, at tau."""

    value: arb
    tau: fmpq
    double: float
    reached: bool

    @classmethod
    def from_piece(cls, piece: Piece, t: fmpq, value: arb) -> _Candidate:
        """A value at t, at a double in the piece; where none is, or it is the limit at its end, at the jump behind."""
        tau = piece.start + piece.length * (1 + t) / 2
        exact = piece.begin if piece.from_zero and t == -1 else value
        first, after = not_below(piece.start), not_below(piece.end)
        if piece.last:
            return cls(exact, tau, max(nearest(tau), first), True)
        if t < 1 and first < after:
            return cls(exact, tau, min(max(nearest(tau), first), nextafter(after, 0.0)), True)
        return cls(exact, tau, after, False)

    @property
    def order(self) -> tuple[float, bool, fmpq]:
        return self.double, not self.reached, self.tau


def _extremes_of(pieces: Sequence[Piece], size: arb) -> Range | None:
    """The least and the greatest value; None where the balls are too large to tell. No value is beyond `size`."""
    screen = _Screen(pieces, size)
    scale = screen.scale
    if not scale > 0 or not max(piece.radius for piece in pieces) < scale * _KNOWN:
        return None
    greatest = _first(screen.candidates(1), 1, screen.greatest, scale)
    least = _first(screen.candidates(-1), -1, -screen.least, scale)
    rests = abs(pieces[0].begin) <= scale * BOUND
    return _extreme(least, -1, scale, rests), _extreme(greatest, 1, scale, rests)


def _extreme(found: _Candidate, sign: int, scale: arb, rests: bool) -> TrueExtreme:
    """An extreme; of an output that is 0 at the start, and of `scale`, where it `rests`."""
    if abs(found.value) <= scale * BOUND:
        return NOTHING[0] if rests else TrueExtreme(0.0, found.double, found.reached)
    return TrueExtreme(midpoint(sign * found.value) + 0.0, found.double, found.reached)  # no -0.0


class _Screen:
    """All pieces in doubles, divided by a power of 2 that makes them moderate."""

    def __init__(self, pieces: Sequence[Piece], size: arb) -> None:
        self._pieces = pieces
        mantissa, exponent = (int(part) for part in size.man_exp())
        self._unit = arb(2) ** (mantissa.bit_length() + exponent)
        widest = max(len(piece.coefficients) for piece in pieces)
        self._powers = np.zeros((len(pieces), widest))
        for row, piece in zip(self._powers, pieces, strict=True):
            row[: len(piece.coefficients)] = [float(c / self._unit) for c in piece.coefficients]
        radii = np.array([float((piece.radius / self._unit).upper()) for piece in pieces])
        self._slack = radii * (1 + 2 * _ROUNDING) + (widest + 40) * _ROUNDING * np.abs(self._powers).sum(axis=1)
        self._slack += 2.0**-1000  # what may underflow
        k = np.arange(widest)
        self._bend = np.abs(self._powers) @ (k * (k - 1.0))
        self._low, self._high = self._values(np.arange(len(pieces)), _POINTS[0])

    def _values(self, chosen: NDArray[np.intp], points: int) -> tuple[Array, Array]:
        """The least and the greatest value of pieces at so many points."""
        t = np.linspace(-1.0, 1.0, points)
        values = self._powers[chosen] @ np.vander(t, self._powers.shape[1], increasing=True).T
        return values.min(axis=1), values.max(axis=1)

    @property
    def greatest(self) -> arb:
        """A lower bound of the greatest value."""
        return arb(float((self._high - self._slack).max())) * self._unit

    @property
    def least(self) -> arb:
        """An upper bound of the least value."""
        return arb(float((self._low + self._slack).min())) * self._unit

    @property
    def scale(self) -> arb:
        """A lower bound of the largest absolute value."""
        return self.greatest.max(-self.least)

    def candidates(self, sign: int) -> list[Piece]:
        """The pieces, in order, that may hold the greatest (`sign` 1) or the least (-1) value."""
        chosen = np.arange(len(self._pieces))
        for points in _POINTS:
            low, high = self._values(chosen, points)
            top = high if sign > 0 else -low
            slack = self._slack[chosen]
            beyond = self._bend[chosen] * ((2.0 / (points - 1)) ** 2 / 8 * (1 + 8 * _ROUNDING))
            chosen = chosen[top + slack + beyond >= (top - slack).max()]
        return [self._pieces[k] for k in chosen.tolist()]


def _first(pieces: Sequence[Piece], sign: int, low: arb, scale: arb) -> _Candidate:
    """The greatest value of pieces (of their negatives: `sign` -1), at least `low`, where it first is taken."""
    found: list[_Candidate] = []
    for piece in pieces:
        for value, t in _tops([sign * c for c in piece.coefficients], piece.radius, low, scale * _FLAT):
            found.append(_Candidate.from_piece(piece, t, value))
            low = low.max(found[-1].value.lower())
    equal = low - scale * _EQUAL
    return min((each for each in found if each.value.upper() >= equal), key=lambda each: each.order)


def _tops(coefficients: Sequence[arb], radius: arb, low: arb, flat: arb) -> Iterator[tuple[arb, fmpq]]:
    """What may be the greatest value of a polynomial on [-1, 1], and where: both ends, and tops that reach `low`.

    Coefficients are exact; the output is within `radius` of it.
    """
    whole = arb_poly(list(coefficients))
    for t in (-_ONE, _ONE):
        value = whole(arb(t)) + arb(0, radius)
        yield value, t
        low = low.max(value.lower())
    parts = [(*_trim(whole, radius, flat), _ZERO, _ONE)]
    while parts:
        polynomial, radius, centre, half = parts.pop()
        c = polynomial.coeffs() or [arb(0)]
        rest = sum(map(abs, c[1:]), arb(0))
        if not (c[0] + rest + radius).upper() >= low:
            continue
        if rest <= flat:
            value = c[0] + arb(0, (rest + radius).upper())
            yield value, centre - half
            low = low.max(value.lower())
        elif len(c) > 2 and _has_one_sign(c, 2) and c[2] < 0:
            with ctx.workprec(_bits(c, flat)):
                value, t = _top(polynomial)
            yield value + arb(0, radius), centre + half * t
            low = low.max((value - radius).lower())
        elif not _has_one_sign(c, 1) and not (len(c) > 2 and _has_one_sign(c, 2)):
            for side in (1, -1):
                with ctx.workprec(_bits(c, flat)):
                    shorter = _trim(polynomial(arb_poly([arb(side) / 2, arb(1) / 2])), radius, flat)
                parts.append((*shorter, centre + half * side / 2, half / 2))
        elif half < 1:  # an end is greatest, where another part may meet it
            for t in (-_ONE, _ONE):
                yield polynomial(arb(t)) + arb(0, radius), centre + half * t


def _bits(c: Sequence[arb], flat: arb) -> int:
    """Enough to know sums of these numbers far below `flat`: some, or all of those that there are."""
    mantissa, exponent = (int(part) for part in (max(map(abs, c)) / flat).upper().man_exp())
    return min(max(mantissa.bit_length() + exponent, 0) + _SPARE, ctx.prec)


def _trim(polynomial: arb_poly, radius: arb, flat: arb) -> tuple[arb_poly, arb]:
    """Exact numbers with as many bits as they need, without the highest powers as far as they are far below `flat`, and
    how far from them the output may be.
    """
    powers, rest, least = polynomial.coeffs() or [arb(0)], arb(0), flat * 2**-30
    while len(powers) > 1 and (more := (rest + abs(powers[-1])).upper()) <= least:
        rest = more
        powers.pop()
    with ctx.workprec(_bits(powers, flat)):
        middles, lost = split(arb_poly([+c for c in powers]))
    return arb_poly(list(middles)), (radius + rest + lost).upper()


def _has_one_sign(c: Sequence[arb], order: int) -> bool:
    """Whether the first or second derivative has one sign on [-1, 1]: its first coefficient outweighs the others."""
    factors = (k if order == 1 else k * (k - 1) for k in range(order + 1, len(c)))
    others = sum((factor * abs(each) for factor, each in zip(factors, c[order + 1 :], strict=True)), arb(0))
    return bool(order * abs(c[order]) > others)


def _top(polynomial: arb_poly) -> tuple[arb, fmpq]:
    """The greatest value of a concave polynomial on [-1, 1], and where: a tangent is above all of it."""
    slope = polynomial.derivative()
    for end, rises in ((-_ONE, 1), (_ONE, -1)):
        if not (inward := rises * slope(arb(end))) > 0:
            return _bound_above(polynomial, end, inward.max(arb(0))), end
    bend = slope.derivative()
    low, high, t, near = arb(-1), arb(1), arb(0), arb(2) ** (8 - ctx.prec)
    for _ in range(_NEWTON):
        at = slope(t)
        low, high = (t, high) if at > 0 else (low, t)
        step = (t - at / bend(t)).mid()
        if not low < step < high:
            step = ((low + high) / 2).mid()
        t, before = step, t
        if abs(t - before) < near:
            break
    place = middle(t)
    return _bound_above(polynomial, place, abs(slope(arb(place)))), place


def _bound_above(polynomial: arb_poly, place: fmpq, slope: arb) -> arb:
    """From the value there to what a line with this slope comes to on [-1, 1]."""
    value = polynomial(arb(place))
    return value.union(value + 2 * slope.upper())
