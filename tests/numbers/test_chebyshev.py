"""Powers and Chebyshev polynomials are the same functions, and a ball stays around what it holds."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb, arb_poly, ctx, fmpq

from wavesym.numbers import chebyshev


@pytest.mark.parametrize("n", range(12))
def test_a_polynomial_is_that_of_numpy(n):
    expected = np.polynomial.chebyshev.cheb2poly([0] * n + [1])
    assert chebyshev.polynomial(n) == tuple(map(int, expected))


def test_a_series_and_its_powers_are_the_same_function():
    """At t = cos(x) it is the sum of c_n cos(n x)."""
    with ctx.workprec(200):
        series = [arb(fmpq(c, 7)) for c in (3, -1, 4, 1, -5, 9, 2)]
        powers = arb_poly(chebyshev.powers(series))
        for x in (arb(0), arb(1), arb(2)):
            expected = sum((c * (n * x).cos() for n, c in enumerate(series)), arb(0))
            assert abs(powers(x.cos()) - expected) < 1e-50


def test_of_several_polynomials_each_has_its_series():
    with ctx.workprec(200):
        given = [arb_poly([1, 2, 3, 4, 5]), arb_poly(), arb_poly([fmpq(1, 3)]), arb_poly([0] * 8 + [1])]
        found = chebyshev.coefficients(given, ctx.prec)
        assert [len(series) for series in found] == [9] * 4
        for polynomial, series in zip(given, found, strict=True):
            difference = arb_poly(chebyshev.powers(series)) - polynomial
            assert all(abs(c) < 1e-50 for c in difference.coeffs())
    assert chebyshev.coefficients([], ctx.prec) == []
    assert chebyshev.coefficients([arb_poly(), arb_poly()], ctx.prec) == [[], []]


def test_a_radius_is_not_lost():
    """Of a power, all of it is in the series."""
    for k in range(6):
        (series,) = chebyshev.coefficients([arb_poly([arb(0)] * k + [arb(0, 1)])], ctx.prec)
        assert 1 <= float(sum((c.rad() for c in series), arb(0))) < 1.001
        assert sum((c.rad() for c in chebyshev.powers([arb(0)] * k + [arb(0, 1)])), arb(0)) >= abs(
            sum(map(abs, chebyshev.polynomial(k)))
        )


def test_more_bits_are_not_forgotten():
    """What was used with few bits is made anew with more."""
    for bits in (64, 300):
        with ctx.workprec(bits):
            (series,) = chebyshev.coefficients([arb_poly([0] * 20 + [arb(1) / 3])], ctx.prec)
            assert max(c.rad() for c in series) < arb(2) ** (4 - bits)
