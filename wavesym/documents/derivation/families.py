"""A coefficient law solved family by family: exp(-g w) for every rate g that occurs, 0 among them.

Where own.same(g) is not 0, a law gives [g,k] from the powers above it. At its own rate q, where it is 0, it gives
[q,k] from [q,k-1], and the jump gives [q,0]: integrated across a front, the equation leaves own.jump sum_g F[g,0].
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from sympy import Expr, Integer, cancel

from wavesym.derivation.delay import COUNT, INDEX
from wavesym.derivation.delay_terms import Operator, exact
from wavesym.derivation.recurrence import (
    POWER,
    RATE,
    CoefficientLaw,
    SymbolicLoad,
    SymbolicTerm,
    SymbolicWeights,
    weights,
)


class Coefficient(NamedTuple):
    """[rate, power] of what a function gained `back` intervals ago; summed over all rates, or over all but q.

    Where `sum_range` is "all" or "other" `rate` is the symbol g.
    """

    function: str
    rod: Expr
    back: int
    rate: Expr
    power: Expr
    sum_range: str = ""


@dataclass(frozen=True)
class Recursion:
    """left = (sum of factor * coefficient) / divisor + loads, for powers k = least, ... where `left` has a k.

    A load adds its `value` to the left side itself, at its own power and at rate 0. Powers go down at every rate but
    the law's own.
    """

    left: Coefficient
    parts: tuple[tuple[Expr, Coefficient], ...]
    divisor: Expr
    loads: tuple[SymbolicLoad, ...] = ()
    least: int = 0


def substitute(law: CoefficientLaw, at: Callable[[Expr], Expr]) -> CoefficientLaw:
    """A law with `at` of every expression in it; of a law that stands for several, the one that `at` is for."""

    def weights_at(w: SymbolicWeights) -> SymbolicWeights:
        return SymbolicWeights(at(w.same), at(w.next_power), at(w.jump))

    rod = at(law.rod)
    first, last = (law.first, law.last) if rod.has(INDEX) else (rod, rod)
    return replace(
        law,
        rod=rod,
        own=weights_at(law.own),
        terms=tuple(replace(t, rod=at(t.rod), weights=weights_at(t.weights)) for t in law.terms),
        loads=tuple(
            replace(x, number=x.number if x.number is None else at(x.number), value=at(x.value)) for x in law.loads
        ),
        first=first,
        last=last,
    )


def solve_at_rates(law: CoefficientLaw, rates: Sequence[Expr] | None) -> tuple[Recursion, ...]:
    """A law at every one of `rates`, which are all there are; None: at q, and at any other rate g, as a symbol."""
    q = law.own_rate
    if q is None:
        return (_foreign(law, RATE),)
    others = (RATE,) if rates is None else tuple(rate for rate in rates if cancel(rate - q) != 0)
    return (*(_foreign(law, rate) for rate in others), _own(law, q), _closure(law, q, rates))


def _operator_value(
    w: SymbolicWeights, function: str, rod: Expr, back: int, rate: Expr, power: Expr
) -> Iterator[tuple[Expr, Coefficient]]:
    """What an operator gives at [rate, power]."""
    yield exact(w.same.subs(RATE, rate)), Coefficient(function, rod, back, rate, power)
    yield w.next_power.subs(POWER, power), Coefficient(function, rod, back, rate, power + 1)


def _right(law: CoefficientLaw, rate: Expr, power: Expr) -> Iterator[tuple[Expr, Coefficient]]:
    for term in law.terms:
        yield from _operator_value(term.weights, term.function, term.rod, term.back, rate, power)


def _foreign(law: CoefficientLaw, rate: Expr) -> Recursion:
    (divisor, left), (above, following) = _operator_value(law.own, law.function, law.rod, 0, rate, POWER)
    parts = [*_right(law, rate, POWER), (-above, following)]
    constant = law.own.same.subs(RATE, 0)  # loads are at rate 0
    at_zero = rate in (0, RATE)
    loads = (replace(x, value=cancel(x.value / constant)) for x in law.loads) if at_zero else ()
    return Recursion(left, tuple((f, c) for f, c in parts if f != 0), divisor, tuple(loads))


def _own(law: CoefficientLaw, q: Expr) -> Recursion:
    assert not law.loads or q != 0  # a load at its own rate would raise its power: no body has rate 0
    before = POWER - 1
    _, (divisor, left) = _operator_value(law.own, law.function, law.rod, 0, q, before)
    parts = tuple((exact(f), c) for f, c in _right(law, q, before) if f != 0)
    return Recursion(left, parts, exact(divisor), (), 1)


def _closure(law: CoefficientLaw, q: Expr, rates: Sequence[Expr] | None) -> Recursion:
    zero = Integer(0)

    def jump(of: CoefficientLaw | SymbolicTerm, back: int, rate: Expr, over: str = "") -> Coefficient:
        return Coefficient(of.function, of.rod, back, rate, zero, over)

    jumping = [term for term in law.terms if term.weights.jump != 0]
    if rates is None:
        parts = [(t.weights.jump, jump(t, t.back, RATE, "all")) for t in jumping]
        parts.append((-law.own.jump, jump(law, 0, RATE, "other")))
    else:
        parts = [(t.weights.jump, jump(t, t.back, rate)) for t in jumping for rate in rates]
        others = (rate for rate in rates if cancel(rate - q) != 0)
        parts += [(-law.own.jump, jump(law, 0, rate)) for rate in others]
    return Recursion(jump(law, 0, q), tuple(parts), law.own.jump)


def integral(function: str, name: str) -> CoefficientLaw:
    """What the integral `name` of a wave function gains: D of it is what the function gains, and it does not jump."""
    integrand = SymbolicTerm(function, INDEX, 0, weights(Operator(Integer(0), Integer(1))))
    return CoefficientLaw(
        name, INDEX, weights(Operator(Integer(1), Integer(0))), (integrand,), (), Integer(1), COUNT, 1
    )
