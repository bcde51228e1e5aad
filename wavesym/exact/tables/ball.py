"""The reference: exact tables evaluated in ball arithmetic with as many bits as it takes, rounded once.

Between two arrivals an output is one polynomial per rate in the local variable u = tau - (last arrival); all earlier
increments are carried along into it, so that a value costs the same after many reflections as after few.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from flint import arb, arb_poly, ctx, fmpq

from wavesym.exact.tables.signal import Signal
from wavesym.numbers.balls import FIRST_BITS, precise
from wavesym.numbers.doubles import midpoint, not_below, rational, rounded_ball

# a quarter of the smallest double
NEGLIGIBLE = arb(2) ** -1076


@dataclass(frozen=True)
class Segment:
    """An output between two arrivals: sum over rates of exp(-rate u) * polynomial(u), u = tau - start.

    `from_zero`: it is exactly 0 at the start, whatever is not known of it later. `vague`: no double lies on it, and it
    is left open what contacts do, so that only its neighbours tell what it is.
    """

    start: fmpq
    families: dict[fmpq, arb_poly]
    from_zero: bool = False
    vague: bool = False

    def evaluate(self, u: fmpq | arb) -> arb:
        """The value, a ball, at a point or on an interval."""
        local = arb(u)
        if self.from_zero and local == 0:
            return arb(0)
        total = arb(0)
        for rate, polynomial in self.families.items():
            total += polynomial(local) * (-local * arb(rate)).exp() if rate else polynomial(local)
        return total


def shift(rates: Iterable[fmpq], polynomials: Iterable[arb_poly], by: fmpq) -> list[arb_poly]:
    """sum exp(-g (u + by)) P_g(u + by), as polynomials in u. Coefficients that are not negative stay so."""
    later = arb_poly([arb(by), 1])
    pairs = zip(rates, polynomials, strict=True)
    return [(-arb(rate) * arb(by)).exp() * polynomial(later) for rate, polynomial in pairs]


Source = Callable[[int], Sequence[Segment]]
"""An output as its segments, with so many bits."""


def segments(signal: Signal, bits: int) -> list[Segment]:
    """The segments of a signal, with so many bits."""
    with ctx.workprec(bits):
        return list(_segments(signal))


def _segments(signal: Signal) -> Iterator[Segment]:
    # dictionaries by rate are looked into as seldom as can be: exact numbers are hashed slowly
    places: dict[fmpq, int] = {}
    families: list[arb_poly] = []
    last = None
    for arrival in signal.arrivals:
        if last is not None:
            families = shift(places, families, arrival.time - last)
        for rate, powers in arrival.increment.items():
            if (place := places.setdefault(rate, len(places))) == len(families):
                families.append(arb_poly())
            families[place] += arb_poly([arb(value) for value in powers])
        last = arrival.time
        yield Segment(last, dict(zip(places, families, strict=True)))


def is_zero(segments: Sequence[Segment]) -> bool:
    """Whether an output is 0 throughout."""
    return all(polynomial.length() == 0 for segment in segments for polynomial in segment.families.values())


class Balls:
    """An output in balls, at the precision at which its segments are made."""

    def __init__(self, segments: Sequence[Segment]) -> None:
        self.segments = segments
        self.zero = is_zero(segments)
        self._starts = [segment.start for segment in self.segments]

    def largest(self, until: fmpq) -> arb:
        """A lower bound of the largest absolute value up to `until`, from the ends of segments and points between."""
        ends = [*self._starts[1:], until] if self._starts else []
        points = [
            segment.evaluate((end - segment.start) * fmpq(k, 4))
            for segment, end in zip(self.segments, ends, strict=True)
            for k in range(5)
        ]
        return max((abs(value).lower() for value in points), default=arb(0))

    def sizes(self, until: fmpq) -> Iterator[arb]:
        """Upper bounds of the absolute values on all segments that are not vague."""
        ends = [*self._starts[1:], until]
        for segment, end in zip(self.segments, ends, strict=True):
            if not segment.vague:
                yield abs(segment.evaluate(arb(0).union(arb(end - segment.start)))).upper()

    def polynomial_from(self, tau: fmpq) -> arb_poly:
        """Of an output without other rates than 0, what it is from tau on, as a polynomial in the time since then."""
        segment = self.segments[bisect_right(self._starts, tau) - 1]
        later = arb_poly([arb(tau - segment.start), 1])
        return sum((polynomial(later) for polynomial in segment.families.values()), arb_poly())

    def evaluate(self, tau: fmpq) -> arb:
        """The value at tau; at a jump the one to the right of it."""
        place = bisect_right(self._starts, tau) - 1
        return self.segments[place].evaluate(tau - self._starts[place]) if place >= 0 else arb(0)

    def evaluate_doubles(self, taus: Sequence[float], exact: Sequence[fmpq]) -> Iterator[arb]:
        """The same at doubles, each given as a ratio, too: doubles are compared sooner."""
        starts = [not_below(start) for start in self._starts]
        for double, tau in zip(taus, exact, strict=True):
            place = bisect_right(starts, double) - 1
            yield self.segments[place].evaluate(tau - self._starts[place]) if place >= 0 else arb(0)


def values(
    source: Source,
    taus: Sequence[float],
    bits: int = FIRST_BITS,
    negligible: arb = NEGLIGIBLE,
    most: int | None = None,
) -> list[float]:
    """The correctly rounded values of an output at doubles tau of its horizon; `source` gives its segments.

    Where a value is so near to the middle between two doubles that a ball smaller than all of them does not tell, it is
    rounded from the middle of the ball; where it may be 0 and the ball is `negligible`, it is 0. ArithmeticError where
    more than `most` bits are needed.
    """
    exact = [rational(tau) for tau in taus]

    def attempt(bits: int) -> list[float] | None:
        balls = Balls(source(bits))
        results = []
        for value in balls.evaluate_doubles(taus, exact):
            double = rounded_ball(value)
            if double is None:
                if not value.rad() < negligible:
                    return None
                double = 0.0 if value.contains(0) else midpoint(value)
            results.append(double + 0.0)  # no -0.0
        return results

    return precise(attempt, bits) if most is None else precise(attempt, bits, most)


def largest(
    source: Source,
    until: float,
    bits: int = FIRST_BITS,
    vanishes: Callable[[Iterable[arb]], bool] = lambda sizes: False,
) -> arb:
    """A lower bound, a ball, of an output's largest absolute value on [0, until].

    It is 0 where the output is 0 throughout, or `vanishes` as far as its largest values on segments tell.
    """

    def attempt(bits: int) -> arb | None:
        balls = Balls(source(bits))
        size = balls.largest(rational(until))
        return size if size > 0 or balls.zero or vanishes(balls.sizes(rational(until))) else None

    return precise(attempt, bits)
