"""The rule for coefficients against differentiation by SymPy, and what it does where rates meet."""

from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st
from sympy import Rational, Symbol, exp, expand

from wavesym.derivation.increments import add, apply, combine, integrate, solve, start
from wavesym.derivation.rules import DERIVATIVE, Linear, Weights

W = Symbol("w")
ONE, ZERO = fmpq(1), fmpq(0)
rationals = st.fractions(min_value=-5, max_value=5, max_denominator=20).map(lambda f: fmpq(f.numerator, f.denominator))
# few rates, so that equal and neighbouring ones are always among them
rates = st.sampled_from([fmpq(0), fmpq(1), fmpq(2), fmpq(1) + fmpq(1, 10**6), fmpq(3, 2)])
increments = st.dictionaries(rates, st.lists(rationals, min_size=1, max_size=4), max_size=3)


def weights(a: fmpq, b: fmpq) -> Weights:
    return Weights(Linear(b, -a), Linear(a, a), a)


def expression(increment):
    return sum(
        Rational(int(c.p), int(c.q)) * exp(-Rational(int(g.p), int(g.q)) * W) * W**k
        for g, powers in increment.items()
        for k, c in enumerate(powers)
    )


def rational(number):
    return Rational(int(number.p), int(number.q))


@given(increments, rationals, rationals)
def test_apply_is_the_operator(increment, a, b):
    function = expression(increment)
    expected = rational(a) * function.diff(W) + rational(b) * function if increment else 0
    applied: dict = {}
    apply(weights(a, b), increment, applied)
    assert expand(expression(applied) - expected) == 0


@given(increments, rates, rationals)
def test_solve_solves_and_starts_right(right, rate, jump):
    found = solve(weights(ONE, rate), right, jump)
    difference: dict = {}
    apply(weights(ONE, rate), found, difference)
    add(difference, right, fmpq(-1))
    assert combine([(ONE, difference)]) == {}
    assert start(found) == jump


@given(increments)
def test_integral_starts_at_zero_and_differentiates_back(increment):
    whole = integrate(increment)
    assert start(whole) == 0
    difference: dict = {}
    apply(DERIVATIVE, whole, difference)
    add(difference, increment, fmpq(-1))
    assert combine([(ONE, difference)]) == {}


def test_solve_without_derivative_divides():
    assert solve(weights(ZERO, fmpq(2)), {ONE: [fmpq(4), fmpq(6)]}, ZERO) == {ONE: [fmpq(2), fmpq(3)]}
