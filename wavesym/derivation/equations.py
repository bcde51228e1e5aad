"""The derivation of a system as SymPy objects, in the paper's letters: delay equations and recurrences.

f(i, z) and g(i, z) are the wave functions of rod i on their clocks (Table 1). F_f[i, n, gamma, k] is the coefficient of
exp(-gamma w) w^k in the increment that f' gains at the start of interval n, and F_g that of g'. S_f[i, n] is the sum of
F_f[i, n, gamma, 0] over all rates gamma: how far f' jumps there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple, TypeVar

from sympy import Basic, Derivative, Eq, Expr, Function, Heaviside, IndexedBase, Integer, KroneckerDelta, Symbol

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS, DelayEquation, delay_equations
from wavesym.derivation.delay_terms import Operator, Source
from wavesym.derivation.recurrence import POWER, CoefficientLaw, SymbolicWeights, recurrence
from wavesym.derivation.recurrence import RATE as _RATE
from wavesym.mechanics.node import System

Z = Symbol("z", real=True)
INTERVAL = Symbol("n", integer=True, positive=True)
RATE = Symbol("gamma")
WAVES = {"f": Function("f"), "g": Function("g")}
COEFFICIENTS = {"f": IndexedBase("F_f"), "g": IndexedBase("F_g")}
JUMPS = {"f": IndexedBase("S_f"), "g": IndexedBase("S_g")}
LOADS = {"a": Symbol("a"), "b": Symbol("b"), "M": IndexedBase("M"), "impact": Symbol("impact")}
NAMES: dict[str, Basic] = {
    **{str(symbol): symbol for symbol in (INDEX, COUNT, Z, INTERVAL, RATE, POWER)},
    **{str(base): base for base in (SYMBOLS.kappa, SYMBOLS.inertia, SYMBOLS.velocity)},
    **LOADS,
    **WAVES,
    **{str(base): base for base in (*COEFFICIENTS.values(), *JUMPS.values())},
}
"""What stands in equations, by its name. A symbol with the same name and other assumptions is another symbol."""


class Relation(NamedTuple):
    """An equation, for rods i = first, first + step, ... last."""

    equation: Eq
    first: Expr
    last: Expr
    step: int


class Closure(NamedTuple):
    """What a recurrence leaves open where its own factor vanishes, at gamma = `rate` and k = 0: jumps, for its rods.

    F[i, n, rate, 0] is S[i, n] of this equation less the sum of F[i, n, gamma, 0] over all other rates.
    """

    equation: Eq
    first: Expr
    last: Expr
    step: int
    rate: Expr


R = TypeVar("R", Relation, Closure)


class Equations(NamedTuple):
    """Those of one system. An interval is `interval` long on the clock of every function.

    `closures` are of the recurrences whose functions belong to a body; `symbols` has what stands in any of them.
    """

    system: str
    delay_equations: tuple[Relation, ...]
    recurrences: tuple[Relation, ...]
    closures: tuple[Closure, ...]
    interval: int
    symbols: dict[str, Basic]


def equations(systems: Iterable[System], m: int | None = None) -> tuple[Equations, ...]:
    """The equations of systems for any m, or for one: then each rod has its own, with numbers in place of i and m."""
    made = []
    for system in systems:
        laws = recurrence(system)
        made.append(
            Equations(
                system.name,
                tuple(_write_out((_delay(each) for each in delay_equations(system)), m)),
                tuple(_write_out(map(_recurrence, laws.laws), m)),
                tuple(_write_out((_closure(law, q) for law in laws.laws if (q := law.own_rate) is not None), m)),
                laws.interval,
                dict(NAMES),
            )
        )
    return tuple(made)


def _write_out(relations: Iterable[R], m: int | None) -> Iterator[R]:
    """Each for every rod of m, unless there is none."""
    if m is None:
        yield from relations
        return
    for each in relations:
        first, last = (int(Integer(0) + end.subs(COUNT, m)) for end in (each.first, each.last))
        for rod in range(first, last + 1, each.step):
            place = {COUNT: Integer(m), INDEX: Integer(rod)}
            left, right = (side.subs(place) for side in (each.equation.lhs, each.equation.rhs))
            rate: dict[str, Expr] = {"rate": each.rate.subs(place)} if isinstance(each, Closure) else {}
            equation = Eq(left, right, evaluate=False)
            yield each._replace(equation=equation, first=place[INDEX], last=place[INDEX], step=1, **rate)


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
    return LOADS[kind] if number is None else LOADS[kind][number]


def _recurrence(law: CoefficientLaw) -> Relation:
    right = sum((_weighted_sum(t.function, t.rod, INTERVAL - t.back, t.weights) for t in law.terms), Z * 0)
    for load in law.loads:
        here = KroneckerDelta(INTERVAL, 1 + load.back) * KroneckerDelta(RATE, 0) * KroneckerDelta(POWER, load.power)
        right += load.value * _unit(load.kind, load.number) * here
    left = _weighted_sum(law.function, law.rod, INTERVAL, law.own)
    return Relation(Eq(left, right, evaluate=False), law.first, law.last, law.step)


def _closure(law: CoefficientLaw, rate: Expr) -> Closure:
    right = sum((t.weights.jump * JUMPS[t.function][t.rod, INTERVAL - t.back] for t in law.terms), Z * 0)
    left = law.own.jump * JUMPS[law.function][law.rod, INTERVAL]
    return Closure(Eq(left, right, evaluate=False), law.first, law.last, law.step, rate)


def _weighted_sum(function: str, rod: Expr, interval: Expr, w: SymbolicWeights) -> Expr:
    coefficient = COEFFICIENTS[function]
    same, next_power = w.same.subs(_RATE, RATE), w.next_power
    return same * coefficient[rod, interval, RATE, POWER] + next_power * coefficient[rod, interval, RATE, POWER + 1]
