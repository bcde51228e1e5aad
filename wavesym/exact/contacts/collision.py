"""When the contacts of a collision end: the first return of a contact's strain to zero, from its exact form."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import factorial

from flint import arb, arb_poly, fmpq

from wavesym.derivation.exact_rule import DERIVATIVE
from wavesym.errors import CostError
from wavesym.exact.tables.ball import Segment, polynomials, segments
from wavesym.exact.tables.increments import Increment, apply, start, trimmed
from wavesym.exact.tables.signal import RuledChain, Signal, observed
from wavesym.mechanics.event import KnownInstant
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.balls import precise
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, Real

# a zero is known to this width, and a strain that only touches zero counts from there
_WIDTH = fmpq(1, 2**80)
# a strain at a front that is 0 to as many bits is 0
_BITS_FOR_ZERO = 2048
# at so many a search takes seconds
_MOST_BITS = 1 << 14
# of one contact's table, a second or two
_MOST_COEFFICIENTS = 100_000
# how far is looked at first
_FIRST = fmpq(16)


@dataclass(frozen=True)
class ContactEnd(KnownInstant):
    """The contact at `x` opens at `tau`, a ball; what is computed at its neighbours later than that is formal."""

    x: int
    tau: arb


def contact_ends(model: Model, real: Real = DOUBLE) -> tuple[ContactEnd, ...]:
    """The contacts whose opening can reach an output within the horizon in `real` numbers, from left to right.

    CostError where that takes more than some seconds to know.
    """
    if model.chain is None:
        return ()
    until = rational(model.horizon(real))
    contacts = [x for x in model.light_cone(until) if model.named.nodes[x].contact]
    if not contacts:
        return ()
    ruled = RuledChain(model.named)
    ends = []
    for x in contacts:
        # to matter, the opening must have the time to reach the nearest output
        latest = until - min(abs(reading.x - x) for reading in model.watched)
        place = Probe(f"strain@{x}", "strain", x, fmpq(1))
        tau, reached = arb.pos_inf(), fmpq(0)
        while not tau.is_finite() and reached < latest:
            # most open early, and tables grow like the cube of the time
            reached = min(latest, max(_FIRST, 2 * reached))
            (strain,) = observed(ruled, (place,), model.loads, reached, _MOST_COEFFICIENTS)
            try:
                tau = precise(partial(_first_return, strain, reached), most=_MOST_BITS)
            except ArithmeticError as error:
                raise CostError(
                    f"output.until: to know when the contact at x = {x} opens, {error} (a shorter horizon helps)"
                ) from None
        if tau.is_finite():
            ends.append(ContactEnd(x, tau))
    return tuple(ends)


def _first_return(strain: Signal, until: fmpq, bits: int) -> arb | None:
    """The first tau at which a compressed contact is compressed no more; infinite where it stays closed.

    A contact that is pulled before it was compressed opens then. None where so many bits do not tell.
    """
    if not strain.arrivals:
        return arb.pos_inf()
    first = strain.arrivals[0]
    calm = _compressed_at_first(first.increment)
    if calm is None:
        return arb(first.time)
    pieces = segments(strain, bits)
    ends = [piece.start for piece in pieces[1:]] + [until]
    for piece, end in zip(pieces, ends, strict=True):
        if piece.start != first.time:
            calm = fmpq(0)
            start = piece.at(calm)
            if start.contains(0) and bits < _BITS_FOR_ZERO:
                return None
            if not start < 0:  # over zero by a jump, or on it
                return arb(piece.start)
        length = end - piece.start
        opening = _not_compressed(piece, min(calm, length), length, bits)
        if opening is None or opening.is_finite():
            return None if opening is None else arb(piece.start) + opening
    return arb.pos_inf()


def _compressed_at_first(increment: Increment) -> fmpq | None:
    """A w > 0 up to which the first increment of a strain is negative (0 where it jumps there), None where it pulls."""
    order = 0
    while start(increment) == 0:  # strain starts without a jump: its first derivative that is not 0 tells
        derivative: Increment = {}
        apply(DERIVATIVE, increment, derivative)
        increment = trimmed(derivative)
        order += 1
    if start(increment) > 0:
        return None
    if order == 0:
        return fmpq(0)
    slope = Segment(fmpq(0), polynomials(increment))
    width = fmpq(1)
    while not slope.at(arb(0).union(arb(width))) < 0:
        width /= 2
    return width


def _not_compressed(piece: Segment, low: fmpq, high: fmpq, bits: int) -> arb | None:
    """The first interval of width `_WIDTH`, a ball in u, where the strain is not certainly negative; infinite for none.

    Where families cancel, as for nearly equal rates, only their sum tells: it is searched as a power series as soon as
    an interval is short for the fastest of them. None where the working precision does not tell.
    """
    fastest = max(piece.families, default=fmpq(0))
    stack = [(low, high)]
    while stack:
        low, high = stack.pop()
        if piece.at(arb(low).union(arb(high))) < 0:
            continue
        if fastest * (high - low) <= 1:
            opening = _zero(_Series.of(piece.shifted(low), high - low, bits), high - low)
            if opening is None or opening.is_finite():
                return None if opening is None else arb(low) + opening
            continue
        middle = (low + high) / 2
        stack += [(middle, high), (low, middle)]
    return arb.pos_inf()


@dataclass(frozen=True)
class _Series:
    """A strain on a short interval: |strain - polynomial| <= error."""

    polynomial: arb_poly
    error: arb

    @staticmethod
    def of(families: dict[fmpq, arb_poly], length: fmpq, bits: int) -> _Series:
        """sum exp(-g u) P_g(u) on [0, length], with g length <= 1, cut off where that is beyond so many bits."""
        terms = 2
        while factorial(terms) >> bits == 0:
            terms += 1
        total, error = arb_poly(), arb(0)
        for rate, polynomial in families.items():
            g = arb(rate)
            total += polynomial * arb_poly([(-g) ** k / factorial(k) for k in range(terms)])
            cut = (g * arb(length)) ** terms / factorial(terms)  # the exponential series alternates
            error += cut * sum((abs(c) * arb(length) ** k for k, c in enumerate(polynomial.coeffs())), arb(0))
        return _Series(total, error.upper())

    def at(self, u: arb) -> arb:
        """An enclosure of the strain at a point."""
        return self.polynomial(u) + arb(0, self.error)

    def negative(self, low: fmpq, high: fmpq) -> bool:
        """Whether the strain is certainly negative on an interval.

        In powers of t in [-1, 1] from its middle: near a double zero the interval need be no shorter than the distance.
        """
        local = self.polynomial(arb_poly([arb((low + high) / 2), arb((high - low) / 2)])).coeffs()
        upper = sum((c.max(arb(0)) if k % 2 == 0 else abs(c) for k, c in enumerate(local) if k), arb(0))
        return bool((local[0] if local else arb(0)) + upper + self.error < 0)

    @property
    def vague(self) -> arb:
        """A radius beyond which a value at a point tells nothing: the size of the series at a width below `_WIDTH`.

        Of each coefficient only what is certain counts: where families cancel, all of it may be radius.
        """
        return sum((abs(c).lower() for c in self.polynomial.coeffs()), arb(0)) * arb(_WIDTH) / 2**10


def _zero(series: _Series, length: fmpq) -> arb | None:
    """The first interval of width `_WIDTH` where a series is not certainly negative; infinite or None as above."""
    stack = [(fmpq(0), length)]
    while stack:
        low, high = stack.pop()
        if series.negative(low, high):
            continue
        if high - low < _WIDTH:
            return None if series.at(arb(low)).rad() > series.vague else arb(low).union(arb(high))
        middle = (low + high) / 2
        stack += [(middle, high), (low, middle)]
    return arb.pos_inf()
