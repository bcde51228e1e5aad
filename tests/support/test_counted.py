"""What is counted is known by hand, is reached where every rounding is the worst one, and is never exceeded."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.counted import Counted

U = 2.0**-53
SMALLEST = 2.0**-1074


@pytest.mark.parametrize(
    ("number", "size", "rounding", "underflow"),
    [
        (Counted.nearest(3), 3, 3, 0.5),
        (Counted.exact(3) + 2, 5, 5, 0),
        (2 - Counted.exact(-3), 5, 5, 0),
        (-Counted.nearest(3) * 2, 6, 12, 1.5),
        (4 * (Counted.exact(1) + 1), 8, 16, 0.5),
        (Counted.nearest(3) * Counted.nearest(5), 15, 45, 0.5 * 3 + 0.5 * 5 + 0.5),
        (Counted.nearest(3) / -2, 1.5, 3, 0.75),
        (Counted.nearest(3).through(0.5, -2, 1), 0.5, 2 * 3 + 2 * 0.5, 2 * 0.5 + 1),
        (np.array([Counted.nearest(1), Counted.exact(2)]) @ np.array([2.0, 1.0]), 4, 2 + 2 + 2 + 4, 2),
    ],
)
def test_what_is_counted_by_hand(number, size, rounding, underflow):
    assert (float(number.size), float(number.rounding), float(number.underflow)) == (size, rounding, underflow)


@pytest.mark.parametrize("operation", [lambda x: x + 0, lambda x: x * 1, lambda x: x / 1])
def test_with_a_unit_nothing_of_higher_order_is_left_out(operation):
    u = Fraction(1, 2**10)
    found = Counted.nearest(1, u)
    for _ in range(2):
        found = operation(found)
    assert float(found.rounding) == pytest.approx(float(((1 + u) ** 3 - 1) / u), rel=1e-14)
    squared = Counted.nearest(1, u) * Counted.nearest(1, u)
    assert float(squared.rounding) == pytest.approx(float(found.rounding), rel=1e-14)


def horner(powers, w):
    value = powers[-1]
    for c in powers[-2::-1]:
        value = value * w + c
    return value


_numbers = st.floats(-4, 4) | st.floats(-1e-160, 1e-160) | st.floats(-1e-310, 1e-310)


@given(st.lists(_numbers, min_size=1, max_size=6), _numbers)
def test_no_error_is_larger_than_counted(powers, w):
    found = Fraction(horner(powers, w))
    exact = horner([Fraction(c) for c in powers], Fraction(w))
    allowed = horner([Counted.exact(c, U) for c in powers], Counted.exact(w, U)).error(U, SMALLEST)
    error = found - exact
    assert error == 0 or abs(float(error)) <= float(allowed) * (1 + 1e-12)


def test_the_worst_case_is_one():
    """Every one of 1000 additions loses half a last place, and a product half the smallest number."""
    value, exact, count = 1.0, Fraction(1), Counted.exact(1)
    for _ in range(1000):
        value, exact, count = value + U, exact + Fraction(U), count + U
    assert value == 1.0
    assert float(exact - 1) == pytest.approx(float(count.error(U, SMALLEST)), rel=1e-12)
    product = Counted.exact(SMALLEST) * 0.5
    assert SMALLEST * 0.5 == 0.0
    assert product.underflow == 0.5
