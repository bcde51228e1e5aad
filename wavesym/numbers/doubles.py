"""Between exact numbers, balls and IEEE doubles. Nothing is rounded here except where a name says so."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from functools import reduce
from itertools import zip_longest

from flint import arb, fmpq

from wavesym.errors import RangeError

UNIT_ROUNDOFF = fmpq(1, 2**53)
_FAR = 4096  # no double has an exponent like this
_OVERFLOW = arb(2**1024 - 2**970)  # and all beyond round to no double


def rational(value: float | Fraction | fmpq) -> fmpq:
    """The exact value of an integer, a double or a fraction."""
    return value if isinstance(value, fmpq) else fmpq(*value.as_integer_ratio())


def fraction(value: fmpq | Fraction) -> Fraction:
    """An exact number as Python's own."""
    return Fraction(int(value.numerator), int(value.denominator))


def common_measure(values: Iterable[fmpq]) -> fmpq:
    """The largest number that all are multiples of; 0 of none."""
    return reduce(fmpq.gcd, values, fmpq(0))


def in_order(values: Iterable[fmpq]) -> list[fmpq]:
    """All of these, each once. (Not as a set: exact numbers are hashed slowly.)"""
    every = sorted(values)
    return [one for one, after in zip_longest(every, every[1:]) if one != after]


def nearest(value: fmpq) -> float:
    """The double nearest to an exact number, ties to even. RangeError beyond the largest double."""
    try:
        return float(value)
    except OverflowError:
        raise RangeError("output: a number beyond the largest double, about 1.8e308, would be needed") from None


def not_below(value: fmpq) -> float:
    """The smallest double that is not below an exact number: from there on a breakpoint counts."""
    double = nearest(value)
    return double if rational(double) >= value else math.nextafter(double, math.inf)


def _exact(point: arb) -> fmpq:
    """The number itself; far beyond the doubles another that is too large or too small for them as well."""
    mantissa, exponent = (int(part) for part in point.man_exp())
    if abs(exponent) > _FAR and mantissa:  # exp(-1e300) has more digits than there is memory
        sign, size = (1 if mantissa > 0 else -1), mantissa.bit_length() + exponent
        if abs(size) > _FAR:
            return fmpq(sign << _FAR) if size > 0 else fmpq(sign, 1 << _FAR)
    return fmpq(mantissa << exponent) if exponent >= 0 else fmpq(mantissa, 1 << -exponent)


def middle(ball: arb) -> fmpq:
    """The middle of a ball, exact."""
    return _exact(ball.mid())


def midpoint(ball: arb) -> float:
    """The double nearest to the middle of a ball, ties to even. RangeError beyond the largest double."""
    double = float(ball)  # flint rounds as IEEE 754 says
    return double if math.isfinite(double) else nearest(middle(ball))


def upper_double(ball: arb) -> float:
    """A double that is not below anything in a ball."""
    upper = ball.upper()
    double = midpoint(upper)
    return double if upper <= arb(double) else math.nextafter(double, math.inf)


def bound(ball: arb) -> float:
    """An upper bound to print: a double that two digits write down and that is not below anything in a ball."""
    double = upper_double(ball)
    if double == 0.0 or not math.isfinite(double):
        return double
    # half of the last digit more, so that rounding to two digits goes up
    shown = float(f"{double * 1.05:.1e}")
    return shown if shown >= double else float(f"{double * 1.1:.1e}")


def relative(error: float, size: float) -> float:
    """A bound of an error in parts of a size, to print; infinite where nothing is known of the size."""
    if error == 0:
        return 0.0
    return bound(arb(error) / arb(size)) if size else math.inf


def rounded_ball(ball: arb) -> float | None:
    """The double that everything in the ball rounds to, None where there is not one.

    RangeError where all of it is beyond the largest double.
    """
    if not ball.is_finite():
        return None
    try:
        low, high = midpoint(ball.lower()), midpoint(ball.upper())
    except RangeError:
        if abs(ball).lower() < _OVERFLOW:  # some of it is not
            return None
        raise
    return low if low == high else None
