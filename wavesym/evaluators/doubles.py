"""Between exact numbers, balls and IEEE doubles. Nothing is rounded here except where a name says so."""

from __future__ import annotations

import math
from fractions import Fraction

from flint import arb, fmpq

UNIT_ROUNDOFF = fmpq(1, 2**53)


def rational(value: float | Fraction) -> fmpq:
    """The exact value of a double or a fraction."""
    return fmpq(*value.as_integer_ratio())


def fraction(value: fmpq | Fraction) -> Fraction:
    """An exact number as Python's own."""
    return Fraction(int(value.numerator), int(value.denominator))


def nearest(value: fmpq) -> float:
    """The double nearest to an exact number, ties to even. OverflowError beyond the largest double."""
    return int(value.p) / int(value.q)


def not_below(value: fmpq) -> float:
    """The smallest double that is not below an exact number: from there on a breakpoint counts."""
    double = nearest(value)
    return double if rational(double) >= value else math.nextafter(double, math.inf)


def _exact(point: arb) -> fmpq:
    mantissa, exponent = (int(part) for part in point.man_exp())
    return fmpq(mantissa << exponent) if exponent >= 0 else fmpq(mantissa, 1 << -exponent)


def middle(ball: arb) -> fmpq:
    """The middle of a ball, exact."""
    return _exact(ball.mid())


def midpoint(ball: arb) -> float:
    """The double nearest to the middle of a ball."""
    return nearest(middle(ball))


def above(ball: arb) -> float:
    """A double that is not below anything in a ball."""
    return not_below(_exact(ball.upper()))


def bound(ball: arb) -> float:
    """An upper bound to print: a double that two digits write down and that is not below anything in a ball."""
    double = above(ball)
    if double == 0.0 or not math.isfinite(double):
        return double
    # half of the last digit more, so that rounding to two digits goes up
    shown = float(f"{double * 1.05:.1e}")
    return shown if shown >= double else float(f"{double * 1.1:.1e}")


def rounded(ball: arb) -> float | None:
    """The double that everything in the ball rounds to, None where there is not one."""
    low, high = nearest(_exact(ball.lower())), nearest(_exact(ball.upper()))
    return low if low == high else None
