"""Zeros of polynomials in discs, against zeros that are known."""

from __future__ import annotations

from math import factorial

import numpy as np
import pytest
from flint import arb, ctx, fmpq, fmpq_poly
from hypothesis import given
from hypothesis import strategies as st

from wavesym.numbers.zero_counts import zeros_in_disc

ZEROS = st.tuples(st.integers(-9, 9), st.integers(0, 9))


@given(st.lists(ZEROS, min_size=1, max_size=8), st.integers(0, 12))
def test_as_many_as_are_put_there(zeros: list[tuple[int, int]], size: int) -> None:
    """Of products of s - x and s^2 - 2 x s + x^2 + y^2, double ones and 0 among them."""
    product, inside = fmpq_poly([1]), 0
    for x, y in zeros:
        product *= fmpq_poly([x * x + y * y, -2 * x, 1]) if y else fmpq_poly([-x, 1])
        inside += (2 if y else 1) * (x * x + y * y < (size + fmpq(1, 7)) ** 2)
    with ctx.workprec(2000):
        found = zeros_in_disc([arb(c) for c in product.coeffs()], arb(size + fmpq(1, 7)), arb(0))
    assert found in (inside, None)
    assert found is not None or len(zeros) > 1, "one pair is told"


@pytest.mark.parametrize(("terms", "told"), [(12, False), (60, True)])
def test_of_a_series_what_is_left_out_has_to_be_little(terms: int, told: bool) -> None:
    """cosh s = 0 at (k + 1/2) pi i: four zeros where |s| < 6."""
    with ctx.workprec(400):
        coefficients = [arb(fmpq(k % 2 == 0, factorial(k))) for k in range(terms)]
        rest = arb(12).cosh() * arb(0.5) ** terms / (1 - arb(0.5))
        assert zeros_in_disc(coefficients, arb(6), rest) == (4 if told else None)


def test_a_zero_on_the_circle_is_not_told() -> None:
    with ctx.workprec(300):
        assert zeros_in_disc([arb(-2), arb(1)], arb(2), arb(0)) is None
        assert zeros_in_disc([arb(-2), arb(1)], arb(2) + arb(2) ** -99, arb(0)) == 1


def test_many_random_ones_are_those_of_numpy() -> None:
    draw = np.random.default_rng(3)
    for size in range(2, 30):
        given = draw.normal(size=size + 1)
        radius = float(np.sort(np.abs(np.roots(given[::-1])))[size // 2]) * 1.001
        with ctx.workprec(3000):
            found = zeros_in_disc([arb(c) for c in given.tolist()], arb(radius), arb(0))
        assert found == np.count_nonzero(np.abs(np.roots(given[::-1])) < radius)
