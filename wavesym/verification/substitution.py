"""Tables put back into the delay equations, in exact arithmetic, and the start of every interval looked at.

A delay equation (a D + b) F = sum of (a D + b) G, G some intervals earlier, + loads holds increment by increment. It
does not see a wrong multiple of its own homogeneous solution; there the body's velocity shows it, by a jump.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from flint import fmpq, fmpq_poly
from sympy import Expr

from wavesym.derivation.delay import COUNT, INDEX, DelayEquation, delay_equations
from wavesym.derivation.delay_terms import Operator
from wavesym.derivation.numbers import number
from wavesym.exact.tables.table import Function, Table
from wavesym.mechanics.chain import Chain

Change = dict[fmpq, fmpq_poly]
"""sum over rates g of exp(-g w) * polynomial(w); what is 0 is left out."""


@dataclass(frozen=True)
class Residual:
    """Left less right side of the delay equation of `function` in interval `interval` = 1, 2, ..."""

    source: str
    function: Function
    interval: int
    value: Change


@dataclass(frozen=True)
class Jump:
    """How much the velocity of the body at x, as its rod `rod` has it, jumps at physical time tau."""

    source: str
    x: int
    rod: int
    tau: int
    value: fmpq


def residuals(chain: Chain, table: Table) -> Iterator[Residual]:
    """What is left of the delay equations of a chain, wherever that is not identically 0.

    The table holds all functions of the chain, all equally far. KeyError where one is missing.
    """
    for equation in delay_equations(chain.system):
        first, last = (_place(end, chain, 0) for end in (equation.first, equation.last))
        for i in range(first, last + 1, equation.step):
            function = Function(equation.function, i)
            for source, response in table.responses.items():
                for n in range(len(response.get(function, ()))):
                    value = _residual(chain, table, equation, i, source, n)
                    if value:
                        yield Residual(source, function, n + 1, value)


def jumps(chain: Chain, table: Table) -> Iterator[Jump]:
    """Every jump of the velocity f' + g' + v of a rigid body, as either of its rods has it; none where all is right."""
    for x, node in enumerate(chain.nodes):
        if not node.inertia:
            continue
        for rod in [i for i, held in ((x, node.left), (x + 1, node.right)) if held]:
            for source, response in table.responses.items():
                for tau, value in _starts(chain, table.interval, response, rod, x):
                    if value != 0:
                        yield Jump(source, x, rod, tau, value)


def _residual(chain: Chain, table: Table, equation: DelayEquation, i: int, source: str, n: int) -> Change:
    response = table.responses[source]
    result: Change = {}
    _apply(chain, equation.own, i, response[Function(equation.function, i)][n], 1, result)
    for wave, operator in equation.right.waves.items():
        back = _back(wave.lag, table.interval)
        if back <= n:
            earlier = response[Function(wave.function, _place(wave.rod, chain, i))][n - back]
            _apply(chain, operator, i, earlier, -1, result)
    for load, value in equation.right.loads.items():
        name = load.kind if load.number is None else f"{load.kind}{_place(load.number, chain, i)}"
        if name == source and _back(load.lag, table.interval) == n:
            unit = fmpq_poly([0] * load.power + [1])
            result[fmpq(0)] = result.get(fmpq(0), fmpq_poly()) - _value(value, chain, i) * unit
    return {rate: polynomial for rate, polynomial in result.items() if polynomial}


def _apply(
    chain: Chain, operator: Operator, i: int, increment: Mapping[fmpq, list[fmpq]], sign: int, total: Change
) -> None:
    """Add sign * (a D + b) of an increment: D exp(-g w) P = exp(-g w) (P' - g P)."""
    a, b = _value(operator.a, chain, i), _value(operator.b, chain, i)
    for rate, powers in increment.items():
        polynomial = fmpq_poly(powers)
        applied = a * (polynomial.derivative() - rate * polynomial) + b * polynomial
        total[rate] = total.get(rate, fmpq_poly()) + sign * applied


def _starts(
    chain: Chain, interval: int, response: Mapping[Function, list[dict[fmpq, list[fmpq]]]], rod: int, x: int
) -> Iterator[tuple[int, fmpq]]:
    """The sum of what f' and g' of a rod gain at x, at once, for every physical time that both cover."""
    clock = chain.rod(rod)
    total: dict[int, fmpq] = defaultdict(fmpq)
    covered = []
    for function, distance in (("f", x - clock.x0), ("g", clock.x0 - x)):
        increments = response.get(Function(function, rod), [])
        first = int(clock.tau0 + distance)
        covered.append(first + interval * len(increments))
        for n, increment in enumerate(increments):
            total[first + interval * n] += sum((powers[0] for powers in increment.values()), fmpq(0))
    return ((tau, total[tau]) for tau in sorted(total) if tau < min(covered))


def _back(lag: Expr, interval: int) -> int:
    intervals, rest = divmod(int(lag), interval)
    assert rest == 0  # all lags of a system are whole intervals
    return intervals


def _value(expression: Expr, chain: Chain, i: int) -> fmpq:
    return number(expression, {INDEX.name: i, COUNT.name: chain.m}, chain.parameters)


def _place(expression: Expr, chain: Chain, i: int) -> int:
    return int(number(expression, {INDEX.name: i, COUNT.name: chain.m}, None))
