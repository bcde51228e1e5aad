"""A proof for symbolic i, m, k and rates that what is printed family by family solves the delay equations.

An operator a D + b is applied to exp(-g w) sum_k F_k w^k term by term, and to a function that starts with a jump; what
a delay equation then leaves at exp(-g w) w^k, and at the front, is a rational function in the coefficients, and 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial

from sympy import DiracDelta, Dummy, Expr, Function, Heaviside, Integer, Symbol, cancel, exp, together

from wavesym.derivation.delay import DelayEquation
from wavesym.derivation.delay_terms import Operator
from wavesym.derivation.recurrence import POWER, RATE
from wavesym.documents.derivation.families import Coefficient, Recursion

A, B, W = Dummy("a"), Dummy("b"), Symbol("w", positive=True)


@cache
def operator_coefficient() -> Expr:
    """(a D + b) exp(-g w) sum F(j) w^j at exp(-g w) w^k, in terms of F(k), F(k + 1). Four terms stand for all of them.

    ValueError where another of the four terms takes part.
    """
    coefficient = Function("F")
    around = [POWER + shift for shift in (-1, 0, 1, 2)]
    ansatz = sum(coefficient(j) * W**j for j in around) * exp(-RATE * W)
    image = ((A * ansatz.diff(W) + B * ansatz) / (exp(-RATE * W) * W**POWER)).expand().powsimp()
    at_power = image.as_independent(W, as_Add=True)[0]
    if at_power.atoms(coefficient) != {coefficient(POWER), coefficient(POWER + 1)}:
        raise ValueError(f"other terms than k and k + 1: {at_power}")
    return at_power


@cache
def at_front() -> Expr:
    """The factor of the delta function in (a D + b) of a function phi that starts at w = 0, in terms of phi(0)."""
    w, phi = Symbol("w", real=True), Function("phi")
    image = (A * (Heaviside(w) * phi(w)).diff(w) + B * Heaviside(w) * phi(w)).expand()
    return image.coeff(DiracDelta(w)).subs(w, 0)


def _apply_operator(operator: Operator, value: Callable[[Expr], Expr], rate: Expr) -> Expr:
    """What an operator leaves at a rate and power k of a function with coefficients `value`(power)."""
    (above,) = (f for f in operator_coefficient().atoms(Function("F")) if f.args[0] == POWER + 1)
    (same,) = (f for f in operator_coefficient().atoms(Function("F")) if f.args[0] == POWER)
    image = operator_coefficient().subs({A: operator.a, B: operator.b, RATE: rate})
    return image.subs({above: value(POWER + 1), same: value(POWER)})


def _coefficient_symbol(c: Coefficient) -> Symbol:
    """A coefficient as a symbol of its own."""
    return Symbol(f"{c.function}({c.rod})^{c.back}[{c.sum_range}{c.rate},{c.power}]")


def _symbol(place: tuple[str, Expr, int, Expr], power: Expr) -> Symbol:
    return _coefficient_symbol(Coefficient(*place, power))


def residuals(e: DelayEquation, lines: Sequence[Recursion], interval: int) -> Iterator[Expr]:
    """What a delay equation leaves at every rate and power of its solved `lines`, at its loads, and at the front.

    All of them are 0 where the lines solve it. A function whose equation has no D has no front to look at.
    """
    rates = [line.left.rate for line in lines if line.left.power != 0]
    for line in lines:
        yield _front(e, line, interval, rates) if line.left.power == 0 else _substitute_line(e, line, interval)
    given = {(s.kind, s.number, int(s.lag) // interval, s.power): value for s, value in e.right.loads.items()}
    taken = [(load, (load.kind, load.number, load.back, load.power)) for line in lines for load in line.loads]
    for place in {**given, **{place: None for _, place in taken}}:
        total = sum((load.value for load, at in taken if at == place), Integer(0))
        yield cancel(together(e.own.b * total - given.get(place, Integer(0))))  # a load is at rate 0


def _right(line: Recursion) -> Expr:
    return sum((factor * _coefficient_symbol(c) for factor, c in line.parts), Integer(0)) / line.divisor


def _substitute_line(e: DelayEquation, line: Recursion, interval: int) -> Expr:
    """At the line's rate and power k, with the line for the coefficient that it gives."""
    rate = line.left.rate

    def own(power: Expr) -> Expr:
        plain = _coefficient_symbol(line.left._replace(power=power))
        return _shift_power(line, power) if power == POWER + line.least else plain

    left = _apply_operator(e.own, own, rate)
    for wave, operator in e.right.waves.items():
        place = (wave.function, wave.rod, int(wave.lag) // interval, rate)
        left -= _apply_operator(operator, partial(_symbol, place), rate)
    return cancel(together(left))


def _shift_power(line: Recursion, power: Expr) -> Expr:
    """What the line gives at another power than k."""

    def replace_power(expression: Expr) -> Expr:
        return expression.subs(POWER, power)

    moved = Recursion(
        line.left,
        tuple((replace_power(factor), c._replace(power=replace_power(c.power))) for factor, c in line.parts),
        replace_power(line.divisor),
    )
    return _right(moved)


def _front(e: DelayEquation, line: Recursion, interval: int, rates: Sequence[Expr]) -> Expr:
    """The delta function at w = 0, with the line for [q,0]; a function starts there with sum_g F[g,0]."""

    def start(function: str, rod: Expr, back: int, but: Expr | None = None) -> Expr:
        if RATE in rates:  # any rate: the sum itself is a symbol
            over = "all" if but is None else "other"
            return _coefficient_symbol(Coefficient(function, rod, back, RATE, Integer(0), over))
        at_zero = (
            _coefficient_symbol(Coefficient(function, rod, back, rate, Integer(0))) for rate in rates if rate != but
        )
        return sum(at_zero, Integer(0))

    def delta(operator: Operator, phi: Expr) -> Expr:
        (unknown,) = at_front().atoms(Function("phi"))
        return at_front().subs({A: operator.a, B: operator.b}).subs(unknown, phi)

    own = line.left
    left = delta(e.own, _right(line) + start(own.function, own.rod, 0, own.rate))
    for wave, operator in e.right.waves.items():
        left -= delta(operator, start(wave.function, wave.rod, int(wave.lag) // interval))
    return cancel(together(left))
