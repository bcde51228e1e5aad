"""What formulas are worth: exact, by the scope alone, and nothing where they mean nothing."""

from __future__ import annotations

import pytest
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st

from wavesym.papers.evaluation import MeaninglessError, Scope, holds, span
from wavesym.papers.exact_numbers import Exponentials, exponential
from wavesym.papers.reader import read_formula, read_range

RATIONALS = st.fractions(-5, 5, max_denominator=12).map(lambda x: fmpq(x.numerator, x.denominator))


def _value(text, **bound):
    return Scope(bound).value(read_formula(text))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2n-1", 5),
        (r"\frac{n}{2}", fmpq(3, 2)),
        (r"E(\frac{n}{2})", 1),
        ("H(n-3)", 1),
        ("H(n-4)", 0),
        (r"\sum_{k=0}^n k", 6),
        (r"\sum_{k=1}^0 k", 0),
        ("(n-1)^2", 4),
        ("n^{-1}", fmpq(1, 3)),
        ("0.25 n", fmpq(3, 4)),
        (r"\begin{cases} 7 & n = 2, 4, \dots, 6 \\ 8 & n = 1, 3, \dots, 5 \end{cases}", 8),
    ],
)
def test_values(text, value):
    assert _value(text, n=3) == value


def test_what_H_switches_off_need_not_exist():
    assert _value("H(n-4) f_9", n=3) == 0
    with pytest.raises(MeaninglessError):
        _value("H(n-3) f_9", n=3)


@pytest.mark.parametrize(
    "text", ["x", r"\frac{1}{n-3}", r"\sum_{k=0}^{n/2} k", "—", "a = b", r"(n-3)^{-1}", r"\sum_{k=0}^{(9)^9} k"]
)
def test_what_has_no_value(text):
    with pytest.raises(MeaninglessError):
        _value(text, n=3)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        (r"i = 1, 2, \dots, m", (1, 2, 3, 4)),
        (r"i = 2, 4, \dots, m", (2, 4)),
        (r"i = m, m-1, \dots, 2", (4, 3, 2)),
        (r"i = 5, 6, \dots, m", ()),
        (r"i = 1, m", (1, 4)),
        (r"i = 0, 1, \dots", (0, 1, 2)),
    ],
)
def test_spans(text, values):
    assert span(read_range(text), Scope({"m": 4}), most=2) == values


def test_a_range_that_misses_its_end_is_none():
    with pytest.raises(MeaninglessError):
        span(read_range(r"i = 2, 4, \dots, m"), Scope({"m": 5}))


def test_brackets_of_intervals():
    z = Scope({"z": 2})
    assert [
        holds(read_range(rf"z \in {text}"), z) for text in (r"\langle 0, 2 \rangle", r"\langle 0, 2 )", r"( 2, 3 )")
    ] == [
        True,
        False,
        False,
    ]


@given(RATIONALS, RATIONALS, RATIONALS)
def test_exponentials_are_a_ring(p, q, c):
    a, b = exponential(p) + c, exponential(q)
    assert a * b == exponential(p + q) + c * b
    assert (a - a) == 0
    assert (a == b) == (c == 0 and p == q)


def test_nearly_equal_is_not_equal():
    close = exponential(fmpq(1, 10**30))
    assert float(close) == 1
    assert close != 1
    assert Exponentials.from_number(fmpq(1, 2)) == fmpq(1, 2)
