"""Laws of coefficients, with symbolic rod, interval and power, and their numbers for one chain.

Two ansaetze lead to them. Exponentials times powers, put into the delay equations, give the recurrences of the paper,
which tables run. Powers alone, put into the law of a node on a stretch without fronts, give what pieces and marches
run: that is the first ansatz at the one rate 0.

The recurrences that `derive` prints are the ones that `tables` runs: `Recurrence.rule` evaluates them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, reduce
from math import gcd

from flint import fmpq
from sympy import Expr, Integer, Symbol, exp

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS, DelayEquation, delay_equations
from wavesym.derivation.delay_terms import Operator, exact
from wavesym.derivation.node_law import ALPHA, BETA, DAMPING, INERTIA, NodeLaw, node_law
from wavesym.derivation.numbers import number
from wavesym.derivation.rules import JointRule, Linear, LoadTerm, Rule, Term, Weights
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters, System

RATE = Symbol("g")
POWER = Symbol("k", integer=True, nonnegative=True)
W = Symbol("w", positive=True)
_OWN = Symbol("q")


@dataclass(frozen=True)
class SymbolicWeights:
    """(a D + b) on a coefficient: `same` times F[g,k] plus `next_power` times F[g,k+1]; `jump` at a front."""

    same: Expr
    next_power: Expr
    jump: Expr


@cache
def _derivative_weights() -> tuple[Expr, Expr]:
    """D on exp(-g w) (F_k w**k + F_(k+1) w**(k+1)), read off at exp(-g w) w**k."""
    this, following = Symbol("F_k"), Symbol("F_k1")
    ansatz = exp(-RATE * W) * (this * W**POWER + following * W ** (POWER + 1))
    bare = (ansatz.diff(W) / (exp(-RATE * W) * W**POWER)).expand().powsimp()
    at_power = bare.as_independent(W, as_Add=True)[0]
    return at_power.coeff(this), at_power.coeff(following).factor()


def weights(operator: Operator) -> SymbolicWeights:
    """What a D + b does to the coefficients of an increment."""
    same, raised = _derivative_weights()
    return SymbolicWeights(operator.b + operator.a * same, operator.a * raised, operator.a)


@dataclass(frozen=True)
class SymbolicTerm:
    """A function on the right of a recurrence, `back` intervals earlier."""

    function: str
    rod: Expr
    back: int
    weights: SymbolicWeights


@dataclass(frozen=True)
class SymbolicLoad:
    """A load on the right of a recurrence: `value` at rate 0 and `power`, in interval 1 + `back`."""

    kind: str
    number: Expr | None
    back: int
    power: int
    value: Expr


@dataclass(frozen=True)
class CoefficientLaw:
    """The recurrence of one kind of function, for i = first, first + step, ... last (see `DelayEquation`).

    With R[g,k] the sum of terms and loads, and for every rate g, powers k downwards from the highest:
        own.same(g) F[g,k] + own.raised(k) F[g,k+1] = R[g,k];
    at the rate where own.same vanishes, F[g,0] follows from own.jump sum_g F[g,0] = sum of term.jump sum_g G[g,0].
    """

    function: str
    rod: Expr
    own: SymbolicWeights
    terms: tuple[SymbolicTerm, ...]
    loads: tuple[SymbolicLoad, ...]
    first: Expr
    last: Expr
    step: int

    @property
    def own_rate(self) -> Expr | None:
        """The rate at which own.same vanishes; None for a function that follows without D."""
        if self.own.jump == 0:
            return None
        return exact(-self.own.same.subs(RATE, 0) / self.own.same.expand().coeff(RATE))


@dataclass(frozen=True)
class Recurrence:
    """All coefficient recurrences of a system; an interval is `interval` long on every function's own clock."""

    laws: tuple[CoefficientLaw, ...]
    interval: int

    def rule(self, chain: Chain, function: str, rod: int) -> Rule:
        """The recurrence of one function of a chain, in exact numbers. KeyError where there is none."""
        places = {COUNT.name: chain.m, INDEX.name: rod}
        for law in self.laws:
            rods = range(_place(law.first, places), _place(law.last, places) + 1, law.step)
            if law.function == function and rod in rods:
                return _rule(law, chain.parameters, places)
        raise KeyError((function, rod))


@cache
def recurrence(system: System, parameters: Parameters = SYMBOLS) -> Recurrence:
    """The recurrence of a system, for symbolic m and `parameters` as in `delay_equations`."""
    equations = delay_equations(system, parameters)
    lags = [wave.lag for e in equations for wave in e.right.waves]
    lags += [source.lag for e in equations for source in e.right.loads]
    interval = reduce(gcd, map(int, lags))
    return Recurrence(tuple(coefficient_law(e, interval) for e in equations), interval)


@dataclass(frozen=True)
class StretchLaw:
    """A node on a stretch without fronts: `own` of the velocity = left a + right b + load, power by power."""

    own: SymbolicWeights
    left: Expr
    right: Expr
    load: Expr


def stretch_law(law: NodeLaw) -> StretchLaw:
    """What a node's law makes of powers: the ansatz at rate 0."""
    own = weights(law.own)
    return StretchLaw(SymbolicWeights(own.same.subs(RATE, 0), own.next_power, own.jump), law.left, law.right, law.load)


@cache
def joint_rule() -> JointRule:
    """What rods and points bring to a joint: the law of a node with alpha = 2 Z_left, beta = 2 Z_right, taken apart.

    A rod end that moves n times as fast as its point has n of its velocity, and n of its force acts on the point.
    """
    law = node_law()

    def factor(expression: Expr, *symbols: Symbol) -> fmpq:
        for symbol in symbols:
            expression = expression.expand().coeff(symbol)
        return number(expression, {}, None)

    return JointRule(
        factor(law.own.a, INERTIA),
        factor(law.own.b, DAMPING),
        factor(law.load),
        (2 * factor(law.own.b, ALPHA), 2 * factor(law.own.b, BETA)),
        (2 * factor(law.left, ALPHA), 2 * factor(law.right, BETA)),
    )


@cache
def _factor() -> SymbolicWeights:
    return weights(Operator(Integer(1), _OWN))


def factor_weights(rate: fmpq) -> Weights:
    """What D + `rate`, a factor of a joint's polynomial, does to coefficients: the ansatz of all recurrences."""

    def value(expression: Expr) -> fmpq:
        return number(expression, {_OWN.name: rate}, None)

    law = _factor()
    return Weights(_linear(law.same, RATE, value), _linear(law.next_power, POWER, value), value(law.jump))


def coefficient_law(e: DelayEquation, interval: int) -> CoefficientLaw:
    """The recurrence that a delay equation is, all of whose lags are whole intervals."""
    return CoefficientLaw(
        e.function,
        e.rod,
        weights(e.own),
        tuple(
            SymbolicTerm(w.function, w.rod, int(w.lag) // interval, weights(operator))
            for w, operator in e.right.waves.items()
        ),
        tuple(
            SymbolicLoad(s.kind, s.number, int(s.lag) // interval, s.power, value) for s, value in e.right.loads.items()
        ),
        e.first,
        e.last,
        e.step,
    )


def _place(expression: Expr, places: Mapping[str, int]) -> int:
    return int(number(expression, places, None))


def _linear(expression: Expr, variable: Symbol, value: Callable[[Expr], fmpq]) -> Linear:
    return Linear(value(expression.subs(variable, 0)), value(expression.expand().coeff(variable)))


def _rule(law: CoefficientLaw, parameters: Parameters, places: Mapping[str, int]) -> Rule:
    def value(expression: Expr) -> fmpq:
        return number(expression, places, parameters)

    def in_numbers(w: SymbolicWeights) -> Weights:
        return Weights(_linear(w.same, RATE, value), _linear(w.next_power, POWER, value), value(w.jump))

    def source(kind: str, index: Expr | None) -> str:
        return kind if index is None else f"{kind}{_place(index, places)}"

    return Rule(
        law.function,
        places[INDEX.name],
        in_numbers(law.own),
        tuple(Term(t.function, _place(t.rod, places), t.back, in_numbers(t.weights)) for t in law.terms),
        tuple(LoadTerm(source(x.kind, x.number), x.back, x.power, value(x.value)) for x in law.loads),
    )
