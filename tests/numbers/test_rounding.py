"""Exact numbers become floating-point numbers by the rule: to the nearest, ties to even, or not below."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx, fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from wavesym.errors import RangeError
from wavesym.numbers.doubles import (
    UNIT_ROUNDOFF,
    bound,
    fraction,
    midpoint,
    nearest,
    not_below,
    rational,
    rounded_ball,
    upper_double,
)
from wavesym.numbers.reals import DOUBLE, SINGLE

FORMATS = {DOUBLE: np.float64, SINGLE: np.float32}
LARGEST = {real: rational(float(np.finfo(kind).max)) for real, kind in FORMATS.items()}
both = pytest.mark.parametrize("real", FORMATS, ids=lambda real: real.name)


def numbers(real):
    """Numbers of a format, subnormal ones often among them."""
    width = 64 if real is DOUBLE else 32
    largest = float(real.largest / 2)
    tiny = float(real.smallest) * 2 ** (10 if real is SINGLE else 40)
    return st.floats(-largest, largest, width=width) | st.floats(-tiny, tiny, width=width)


def even(real, number):
    """Whether the last bit of a number is 0: its integer pattern is even."""
    kind = FORMATS[real]
    return int(kind(number).view(np.uint64 if real is DOUBLE else np.uint32)) % 2 == 0


@both
@settings(max_examples=50)
@given(st.data())
def test_between_two_numbers_the_nearer_is_taken(real, data):
    """Up to the middle the lower one, after it the upper one, in the middle the even one; and none is below itself."""
    low = data.draw(numbers(real))
    high = real.next_after(low, math.inf)
    assert float(np.nextafter(FORMATS[real](low), FORMATS[real](math.inf))) == high
    gap = rational(high) - rational(low)
    part = fmpq(1, 3) ** data.draw(st.integers(1, 40))
    assert real.nearest(rational(low) + gap * part) == (low if part < fmpq(1, 2) else high)
    middle = (rational(low) + rational(high)) / 2
    assert real.nearest(middle - gap * part / 4) == low
    assert real.nearest(middle + gap * part / 4) == high
    assert real.nearest(middle) == (low if even(real, low) else high)
    assert real.nearest(rational(low)) == real.not_below(rational(low)) == low
    for between in (gap * part, gap / 2, gap * (1 - part)):
        assert real.not_below(rational(low) + between) == high


@pytest.mark.parametrize("sign", [1, -1])
def test_single_is_not_rounded_twice(sign):
    """Just above the middle of two singles, where the nearest double is that middle."""
    one, ulp = fmpq(1), fmpq(1, 2**23)
    value = one + ulp / 2 + fmpq(1, 2**80)
    assert np.float32(float(fraction(value))) == 1
    assert SINGLE.nearest(sign * value) == sign * float(1 + Fraction(1, 2**23))
    assert SINGLE.nearest(sign * (one + 3 * ulp / 2 - fmpq(1, 2**80))) == sign * float(1 + Fraction(1, 2**23))


@both
def test_what_is_below_half_the_smallest_number_is_nothing(real):
    assert real.nearest(real.smallest / 2) == 0.0
    assert real.nearest(real.smallest * fmpq(51, 100)) == float(real.smallest)
    assert real.not_below(real.smallest / 10**9) == float(real.smallest)
    assert real.not_below(-real.smallest / 10**9) == 0.0


@both
def test_a_format_is_what_numpy_says(real):
    info = np.finfo(FORMATS[real])
    assert float(real.smallest) == float(info.smallest_subnormal)
    assert float(2 * real.roundoff) == float(info.eps)
    assert float(real.least) >= float(info.tiny) / float(info.eps)
    assert real.largest * (2 - 2 * real.roundoff) == rational(float(info.max))
    assert real.bytes == np.dtype(FORMATS[real]).itemsize
    assert real.reach * 1000 * 1000 < real.largest


def test_the_unit_roundoff_is_that_of_doubles():
    assert 1.0 + float(UNIT_ROUNDOFF) == 1.0 < 1.0 + 1.001 * float(UNIT_ROUNDOFF)
    assert DOUBLE.roundoff == UNIT_ROUNDOFF


def test_beyond_the_largest_number_there_is_none():
    with pytest.raises(RangeError, match=r"1\.8e308"):
        nearest(fmpq(2) ** 1024)
    assert nearest(LARGEST[DOUBLE]) == float(LARGEST[DOUBLE])
    with pytest.raises(OverflowError):
        SINGLE.nearest(LARGEST[SINGLE])  # its programs keep to powers of 2
    assert SINGLE.nearest(SINGLE.largest) == 2.0**127
    assert SINGLE.nearest(-SINGLE.largest) == -(2.0**127)


@settings(max_examples=50)
@given(st.floats(1e-300, 1e300), st.floats(0, 1))
def test_a_printed_bound_is_above_in_two_digits(low, width):
    ball = arb(low, low * width * 1e-3)
    shown = bound(ball)
    assert arb(shown) >= ball.upper()
    assert float(f"{shown:.1e}") == shown
    assert shown <= float(upper_double(ball)) * 1.11


@pytest.mark.parametrize("digits", ["1.0", "1.1", "4.9", "5.0", "9.5", "9.9"])
@pytest.mark.parametrize("exponent", [-300, -17, 0, 5])
def test_just_above_two_digits_the_next_ones_are_printed(digits, exponent):
    double = float(f"{digits}e{exponent}")
    for value in (double, math.nextafter(double, math.inf), math.nextafter(double, 0)):
        shown = bound(arb(value))
        assert value <= shown <= value * 1.11


def test_nothing_and_infinity_are_printed_as_they_are():
    assert bound(arb(0)) == 0.0
    assert bound(arb(fmpq(1, 10**400))) == 5e-324
    with pytest.raises(RangeError):
        bound(arb(fmpq(10**400)))


def test_a_ball_is_rounded_where_all_of_it_rounds_to_one():
    third = fmpq(1, 3)
    with ctx.workprec(200):
        assert rounded_ball(arb(third)) == 1 / 3
        assert rounded_ball(arb(1, 2.0**-60)) == 1.0
        assert rounded_ball(arb(1, 2.0**-52)) is None
        # the middle between 1 and the next double
        tie = arb(1) + arb(2) ** -53
        assert rounded_ball(tie) == 1.0
        assert rounded_ball(arb(tie, arb(2) ** -100)) is None
        assert rounded_ball(arb("nan")) is None
        assert rounded_ball(arb(0, 1e-320)) is None
        assert rounded_ball(arb(0, arb(2) ** -1076)) == 0.0


def test_what_is_far_beyond_all_doubles_costs_no_memory():
    with ctx.workprec(64):
        gone = arb(2) ** -(10**12)
        assert rounded_ball(gone) == midpoint(gone) == 0.0
        assert upper_double(gone) == 5e-324
        assert upper_double(-gone) == 0.0
        for far in (arb(2) ** 10**6, -(arb(2) ** 10**6), arb(2) ** 1024):
            with pytest.raises(RangeError):
                rounded_ball(far)


def test_a_ball_may_lie_on_both_sides_of_the_largest_double():
    with ctx.workprec(64):
        assert rounded_ball(arb(2**1024 - 2**971)) == float(LARGEST[DOUBLE])
        with pytest.raises(RangeError):
            rounded_ball(arb(2**1024 - 2**970))
        for width in (0.1, 0.5):
            assert rounded_ball(arb(2) ** 1024 * arb(1, width)) is None


@given(st.fractions())
def test_fractions_and_exact_numbers_are_the_same(value):
    assert fraction(rational(value)) == value
    assert nearest(rational(value)) == float(value)
    assert not_below(rational(value)) == (
        float(value) if float(value) >= value else math.nextafter(float(value), math.inf)
    )
