"""What is irrational, rounded once to a decimal of 17 digits; what is rational after all stays exact."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt

from flint import arb, ctx

DIGITS = 17


def decimal(value: Fraction) -> Fraction:
    """The nearest decimal of 17 significant digits to a positive number, ties to even."""
    power = _magnitude(value)
    return round(value / power) * power


def root(square: Fraction) -> Fraction:
    """The square root of a positive number: exact where it is rational, else rounded as by `decimal`."""
    above, below = isqrt(square.numerator), isqrt(square.denominator)
    if above**2 == square.numerator and below**2 == square.denominator:
        return Fraction(above, below)
    return rounded_root(square)


def rounded_root(square: Fraction) -> Fraction:
    """The nearest decimal of 17 significant digits to the square root of a positive number.

    Floor in integers, then half a unit more or not: so it is right however near to a tie the root is.
    """
    power = _magnitude(square, 2)
    scaled = square / power**2
    low = isqrt(scaled.numerator // scaled.denominator)
    return (low + (scaled > (low + Fraction(1, 2)) ** 2)) * power


def polar_moment(diameter: Fraction, bore: Fraction) -> Fraction:
    """pi/32 (D^4 - d^4), rounded as by `decimal`: the pi in it is a ball of 300 bits."""
    with ctx.workprec(300):
        pi = arb.pi().mid()
        mantissa, exponent = (int(part) for part in pi.man_exp())
    return decimal(Fraction(mantissa) * Fraction(2) ** exponent / 32 * (diameter**4 - bore**4))


def _magnitude(value: Fraction, degree: int = 1) -> Fraction:
    """The power of ten that is one unit in the 17th digit of a number, or of its square root."""
    digits = len(str(value.numerator)) - len(str(value.denominator))
    power = Fraction(10) ** (digits // degree - DIGITS)
    while value >= (power * 10**DIGITS) ** degree:
        power *= 10
    while value < (power * 10 ** (DIGITS - 1)) ** degree:
        power /= 10
    return power
