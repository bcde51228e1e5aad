"""Loads of a given shape as polynomials, piece by piece, each through points of the shape that Chebyshev chose.

On a piece of length e a polynomial of degree n through its extreme points of Chebyshev is off by at most

    max |f^(n+1)| e^(n+1) / ((n+1)! 4^n),

as (t - t_0) ... (t - t_n) is nowhere larger there than 4 (e/4)^(n+1). Pieces meet where they end, and coefficients
are rounded to far less than what they are off by. Times are counted in periods of the shape, values in its amplitude.
"""

from __future__ import annotations

from fractions import Fraction
from math import factorial

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from wavesym.numbers.doubles import fraction, middle

DEGREE = 16
RICKER = 2
"""Periods from the start of Ricker's pulse to its top, and from there to its end."""
CLOSE = Fraction(1, 10**17)
"""How far the polynomials of a piece that is as long as it may be are from the shape."""
BITS, DIGITS = 256, 96  # of values, in balls and behind the point

_CRAMER = Fraction(10865, 10000)  # |H_n(a)| exp(-a^2/2) is at most so many times sqrt(2^n n!)


def value(shape: str, t: arb) -> arb:
    """The shape after t periods."""
    match shape:
        case "sine":
            return (2 * t).sin_pi()
        case "half-sine":
            return (t if t < arb(0.5) else 1 - t).sin_pi()  # exactly 0 at its end
        case "exponential":
            return (-t).exp()
    a = (arb.pi() * (t - RICKER)) ** 2
    return (1 - 2 * a) * (-a).exp()


def derivative_bound(shape: str, order: int) -> arb:
    """What no derivative of this order is larger than.

    Ricker's pulse is -1/2 of the second derivative of exp(-a^2), a = pi (t - 2), whose derivatives are Hermite's
    polynomials times itself (Cramer's inequality).
    """
    pi = arb.pi()
    match shape:
        case "sine":
            return (2 * pi) ** order
        case "half-sine":
            return pi**order
        case "exponential":
            return arb(1)
    n = order + 2
    return arb(_CRAMER.numerator) / _CRAMER.denominator / 2 * (arb(2) ** n * factorial(n)).sqrt() * pi**order


def longest_piece(shape: str) -> Fraction:
    """The longest that a piece may be for its polynomial to be as `CLOSE`."""
    with ctx.workprec(BITS):
        bound = derivative_bound(shape, DEGREE + 1) / (factorial(DEGREE + 1) * arb(4) ** DEGREE)
        longest = ((arb(CLOSE.numerator) / CLOSE.denominator / bound).log() / (DEGREE + 1)).exp()
        return fraction(middle(longest)) * Fraction(2**20 - 1, 2**20)


def interpolate(shape: str, start: fmpq, length: fmpq, ends: tuple[fmpq, fmpq]) -> fmpq_poly:
    """The polynomial of a piece, in parts of its length: on [0, 1], with the values at its `ends`."""
    with ctx.workprec(BITS):
        nodes = [(1 - (arb(k) / DEGREE).cos_pi()) / 2 for k in range(DEGREE + 1)]
        through = arb_poly.interpolate(nodes, [value(shape, start + length * node) for node in nodes])
        made = fmpq_poly([nearest_dyadic(through[k]) for k in range(DEGREE + 1)])
    first, last = ends
    left, right = first - made(fmpq(0)), last - made(fmpq(1))
    return made + fmpq_poly([left, right - left])


def nearest_dyadic(number: arb) -> fmpq:
    """The nearest fraction of so many binary digits."""
    return fmpq(int((number.mid() * 2**DIGITS + fmpq(1, 2)).floor().unique_fmpz()), 2**DIGITS)
