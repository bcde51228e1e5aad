"""How many zeros a power series with real coefficients has in a disc about 0, in balls (Schur and Cohn).

Of a polynomial p of degree n let p* be the one with its coefficients in reverse. On the unit circle |p*| = |p|, so by
Rouche's theorem p - k p* has as many zeros inside as p where |k| < 1. With k the last coefficient over the first its
degree is less; where |k| > 1 p* takes the place of p, which has n less those of p. And |p| >= |p - k p*|/(1 + |k|) on
the circle: what a series has beyond its polynomial does not matter while it is less than that. (Henrici, Applied and
Computational Complex Analysis, volume I, 6.8.)
"""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb


def zeros_in_disc(coefficients: Sequence[arb], radius: arb, rest: arb) -> int | None:
    """The zeros z with |z| < radius, each as often as it is one; None where so many bits do not tell.

    Args:
        coefficients: the first ones of the series, of z^0 on.
        radius: of the disc.
        rest: what the others add on its circle is at most so much.
    """
    p = [c * radius**k for k, c in enumerate(coefficients)]
    inside, sign, least = 0, 1, arb(1)
    while len(p) > 1:
        if abs(p[0]) < abs(p[-1]):
            inside, sign = inside + sign * (len(p) - 1), -sign
            p.reverse()
        elif not abs(p[0]) > abs(p[-1]):
            return None
        k = p[-1] / p[0]
        p = [a - k * b for a, b in zip(p[:-1], p[:0:-1], strict=True)]
        least /= 1 + abs(k)
    return inside if least * abs(p[0]) > rest else None
