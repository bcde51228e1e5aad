"""Numbers are exact however they are written, and nothing that is no number passes for one."""

import tomllib
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic_core import PydanticCustomError

from wavesym.fields.numbers import exact
from wavesym.fields.table import WrittenDecimal, show


def from_toml(text: str) -> object:
    return tomllib.loads(f"x = {text}", parse_float=WrittenDecimal)["x"]


@given(st.decimals(allow_nan=False, allow_infinity=False, min_value=-(10**20), max_value=10**20, places=30))
def test_a_toml_decimal_is_its_decimal_digits(number: Decimal) -> None:
    text = f"{number:f}"
    assert exact(from_toml(text)) == exact(text) == exact(number) == Fraction(text)


@given(st.fractions(max_denominator=10**30, min_value=-(10**20), max_value=10**20))
def test_a_ratio_is_itself(ratio: Fraction) -> None:
    assert exact(ratio) == exact(f"{ratio.numerator}/{ratio.denominator}") == ratio


@given(st.floats(min_value=1e-290, max_value=1e290))
def test_a_float_is_the_decimal_it_is_printed_as(number: float) -> None:
    assert exact(number) == exact(np.float64(number)) == Fraction(repr(number))
    assert float(exact(number)) == number


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("0.1", Fraction(1, 10)),
        ("1_000.2_5", Fraction(4001, 4)),
        ("-2.5e-3", Fraction(-1, 400)),
        ("+7", Fraction(7)),
        ("0x10", Fraction(16)),
        ("-0.0", Fraction(0)),
        ("0e300", Fraction(0)),
        ('"0.5"', Fraction(1, 2)),
        ('"3"', Fraction(3)),
        ('"-6/4"', Fraction(-3, 2)),
        ("1e300", Fraction(10**300)),
    ],
)
def test_what_toml_can_write(given: str, expected: Fraction) -> None:
    assert exact(from_toml(given)) == expected


def test_python_numbers() -> None:
    assert exact(np.int64(3)) == 3
    assert exact(Decimal("0.10")) == Fraction(1, 10)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (WrittenDecimal("nan"), "is not a number"),
        (WrittenDecimal("-inf"), "is not a number"),
        (float("nan"), "is not a number"),
        (float("inf"), "is not a number"),
        (Decimal("sNaN"), "is not a number"),
        (WrittenDecimal("1e400"), "an exponent from -300 to 300"),
        (WrittenDecimal("1e-400"), "an exponent from -300 to 300"),
        ("1e999999999", "an exponent from -300 to 300"),
        (WrittenDecimal("99e300"), "a size from 1e-300 to 1e300"),
        (WrittenDecimal("0.01e-300"), "a size from 1e-300 to 1e300"),
        (5e-324, "an exponent from -300 to 300"),
        (10**400, "a size from 1e-300 to 1e300"),
        (10**4000, "a number of about 4000 digits has too many digits"),
        (Fraction(1, 10**4000), "a number of about 4000 digits has too many digits"),
        ("1" * 101, "write a number of at most 100 characters"),
        ("9" * 10**6, "write a number of at most 100 characters"),
        ("1/0", "divides by 0; write another denominator"),
        ("-1/000", "divides by 0; write another denominator"),
        ("1/-2", "is not a number"),
        ("1//2", "is not a number"),
        ("1 / 2", "is not a number"),
        (" 1", "is not a number"),
        ("1\n", "is not a number"),
        ("", "is not a number"),
        (".5", "is not a number"),
        ("0.5/2", "is not a number"),
        ("1_0", "is not a number"),
        ("__import__('os')", "is not a number"),
        ("\u0661", "is not a number"),  # the Arabic digit 1
        ("\uff11", "is not a number"),  # a full-width 1
        ("\u00bd", "is not a number"),  # one half
        (True, "is not a number"),
        (None, "is not a number"),
        ([1], "is not a number"),
        (1j, "is not a number"),
    ],
)
def test_what_is_no_number(value: object, expected: str) -> None:
    with pytest.raises(PydanticCustomError) as refused:
        exact(value)
    line = str(refused.value)
    assert line.endswith(expected) or expected in line
    assert line.isascii()
    assert "\n" not in line
    assert len(line) < 200


def test_an_integer_too_long_to_print_can_be_refused() -> None:
    with pytest.raises(PydanticCustomError, match="about 5000 digits has too many digits"):
        exact(10**5000)


@given(st.text())
def test_text_is_a_fraction_or_refused(text: str) -> None:
    try:
        number = exact(text)
    except PydanticCustomError:
        return
    assert number == Fraction(text)


@settings(max_examples=40)
@given(st.recursive(st.none() | st.integers() | st.text() | st.floats(), st.lists))
def test_any_value_can_be_shown_on_a_line(value: object) -> None:
    assert show(value).isprintable()
    assert len(show(value)) < 80
