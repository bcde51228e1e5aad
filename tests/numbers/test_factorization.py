"""Factors as a general factoring gives them, and the shortcut that never takes a product for irreducible."""

import pytest
from flint import Ordering, fmpq, fmpq_mpoly_ctx
from hypothesis import given
from hypothesis import strategies as st

from wavesym.derivation.symbolic import generic, in_rates
from wavesym.derivation.table import full_table
from wavesym.numbers import factorization as module
from wavesym.numbers.factorization import irreducible
from wavesym.systems.building import BUILDING_FORCE
from wavesym.systems.drive import DRIVE

CONTEXT = fmpq_mpoly_ctx.get(["x", "y", "z"], Ordering.lex)
X, Y, Z = CONTEXT.gens()

terms = st.dictionaries(st.tuples(*[st.integers(0, 2)] * 3), st.integers(-3, 3).filter(bool), min_size=1, max_size=4)
polynomials = terms.map(CONTEXT.from_dict).filter(lambda p: not p.is_constant())


@given(polynomials, polynomials)
def test_no_product_is_taken_for_irreducible(p, q):
    assert not irreducible(p * q)


@given(polynomials)
def test_what_is_taken_for_irreducible_is(p):
    _, factors = p.factor()
    assert not irreducible(p) or (len(factors) == 1 and factors[0][1] == 1)


@pytest.mark.parametrize(
    ("polynomial", "expected"),
    [
        (X**2 + X * Y + 3 * Y * Z + 1, True),
        ((Y + Z) * (X**3 + X * Y + 3), False),  # irreducible in x alone: the other factor has no x
        ((Y + Z) ** 2, False),
        ((X - Y) * (X + Y), False),
    ],
)
def test_irreducible(polynomial, expected):
    assert irreducible(polynomial) is expected


def wrong(symbols, intervals):
    """The coefficients of a table whose factors are not those of their numerators and denominators."""
    found = []
    for row in full_table(symbols.chain, intervals, fmpq(0)).rows():
        if not hasattr(row.value, "ring"):
            continue
        told = row.value.factorization
        again = [factor.factor()[1] for factor, _ in (*told.numerator, *told.denominator)]
        itself = all(len(one) == 1 and one[0][1] == 1 for one in again)
        shared = any(above == below for above, _ in told.numerator for below, _ in told.denominator)
        if (
            not itself
            or shared
            or any(one[0][0] != f for one, (f, _) in zip(again, (*told.numerator, *told.denominator), strict=True))
        ):
            found.append(row)
    return found


@pytest.mark.parametrize(("system", "m", "intervals"), [(DRIVE, 2, 8), (DRIVE, 3, 5), (BUILDING_FORCE, 3, 5)])
def test_factors_are_irreducible_and_in_lowest_terms(system, m, intervals):
    assert not wrong(in_rates(generic(system, m)), intervals)


def test_a_product_left_together_is_seen(monkeypatch):
    monkeypatch.setattr(module, "irreducible", lambda _: True)
    assert wrong(in_rates(generic(DRIVE, 2)), 8)
