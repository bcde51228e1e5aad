"""The derivation of a system as SymPy objects, in the paper's letters: delay equations and recurrences.

f(i, z) and g(i, z) are the wave functions of rod i on their clocks (Table 1). F_f[i, n, g, k] is the coefficient of
exp(-g w) w^k in the increment that f' gains at the start of interval n, and F_g that of g'.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from sympy import Derivative, Eq, Expr, Function, Heaviside, IndexedBase, KroneckerDelta, Symbol

from wavesym.derivation.delay import DelayEquation, delay_equations
from wavesym.derivation.delay_terms import Operator, Source
from wavesym.derivation.recurrence import POWER, RATE, CoefficientLaw, SymbolicWeights, recurrence
from wavesym.mechanics.node import System

Z = Symbol("z", real=True)
INTERVAL = Symbol("n", integer=True, positive=True)
WAVES = {"f": Function("f"), "g": Function("g")}
COEFFICIENTS = {"f": IndexedBase("F_f"), "g": IndexedBase("F_g")}


class Relation(NamedTuple):
    """An equation, for rods i = first, first + step, ... last."""

    equation: Eq
    first: Expr
    last: Expr
    step: int


class Equations(NamedTuple):
    """Those of one system. An interval is `interval` long on the clock of every function."""

    system: str
    delay_equations: tuple[Relation, ...]
    recurrences: tuple[Relation, ...]
    interval: int


def equations(systems: Iterable[System]) -> tuple[Equations, ...]:
    """The equations of systems for any m."""
    made = []
    for system in systems:
        laws = recurrence(system)
        made.append(
            Equations(
                system.name,
                tuple(_delay(each) for each in delay_equations(system)),
                tuple(_recurrence(law) for law in laws.laws),
                laws.interval,
            )
        )
    return tuple(made)


def _delay(e: DelayEquation) -> Relation:
    right = sum((_moving(w.function, w.rod, w.lag, operator) for w, operator in e.right.waves.items()), Z * 0)
    right += sum((value * _load_power(source) for source, value in e.right.loads.items()), Z * 0)
    return Relation(Eq(_moving(e.function, e.rod, Z * 0, e.own), right, evaluate=False), e.first, e.last, e.step)


def _moving(function: str, rod: Expr, lag: Expr, operator: Operator) -> Expr:
    """a D + b on the derivative of a wave function, so much earlier."""
    wave = WAVES[function](rod, Z - lag)
    return operator.a * Derivative(wave, Z, 2) + operator.b * Derivative(wave, Z)


def _load_power(source: Source) -> Expr:
    """tau^power from the lag on, for a unit of a load."""
    return _unit(source.kind, source.number) * (Z - source.lag) ** source.power * Heaviside(Z - source.lag, 1)


def _unit(kind: str, number: Expr | None) -> Expr:
    return Symbol(kind) if number is None else IndexedBase(kind)[number]


def _recurrence(law: CoefficientLaw) -> Relation:
    right = sum((_weighted_sum(t.function, t.rod, INTERVAL - t.back, t.weights) for t in law.terms), Z * 0)
    for load in law.loads:
        here = KroneckerDelta(INTERVAL, 1 + load.back) * KroneckerDelta(RATE, 0) * KroneckerDelta(POWER, load.power)
        right += load.value * _unit(load.kind, load.number) * here
    left = _weighted_sum(law.function, law.rod, INTERVAL, law.own)
    return Relation(Eq(left, right, evaluate=False), law.first, law.last, law.step)


def _weighted_sum(function: str, rod: Expr, interval: Expr, w: SymbolicWeights) -> Expr:
    coefficient = COEFFICIENTS[function]
    return w.same * coefficient[rod, interval, RATE, POWER] + w.next_power * coefficient[rod, interval, RATE, POWER + 1]
