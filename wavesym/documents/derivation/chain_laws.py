"""The laws of one chain whose numbers are symbols: what its tables run, with functions of one law together."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from flint import fmpq
from sympy import Expr, Indexed, Integer, Symbol

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS
from wavesym.derivation.delay_terms import exact
from wavesym.derivation.numbers import expression, number, symbol
from wavesym.derivation.recurrence import POWER, RATE, CoefficientLaw, SymbolicWeights, recurrence
from wavesym.derivation.rules import Linear, Rule, Weights
from wavesym.documents.derivation.families import substitute
from wavesym.mechanics.chain import Chain

if TYPE_CHECKING:
    from wavesym.derivation.symbolic import SymbolicChain
    from wavesym.numbers.ratio import Ratio


@dataclass(frozen=True)
class Meaning:
    """A symbol, what it stands for among the parameters of section 4, and its value, a number or in other symbols."""

    symbol: Expr
    stands_for: Expr
    value: Expr


def meanings(symbols: SymbolicChain) -> tuple[Meaning, ...]:
    """The symbols that are left, with their numbers."""
    used = {part for ratio in symbols.meaning.values() for part in expression(ratio).atoms(Indexed)}
    return tuple(_meaning(name, value) for name, value in symbols.values.items() if symbol(name) in used)


def merged_parameters(symbols: SymbolicChain) -> tuple[Meaning, ...]:
    """The parameters that are told by the symbols that are left."""
    meanings = (_meaning(name, ratio) for name, ratio in symbols.meaning.items())
    return tuple(meaning for meaning in meanings if meaning.value != meaning.symbol)


def _meaning(name: str, value: Ratio | fmpq) -> Meaning:
    return Meaning(symbol(name), _stands_for(symbol(name)), expression(value))


def _stands_for(name: Indexed) -> Expr:
    (i,) = name.indices
    match str(name.base):
        case "r":
            return SYMBOLS.inertia[i] / SYMBOLS.inertia[i + 1]
        case "u":
            return SYMBOLS.velocity[i - 1] - SYMBOLS.velocity[i + 1]
    return name


def own_laws(chain: Chain) -> tuple[CoefficientLaw, ...]:
    """The laws of a chain of symbols, from the rules that its tables run.

    Functions next to each other that have one law stand together: its rod is the symbol i.
    """
    laws: list[CoefficientLaw] = []
    places = {COUNT.name: chain.m}
    system = recurrence(chain.system)
    for law in system.laws:
        first, last = (int(number(end, places, None)) for end in (law.first, law.last))
        alike: list[CoefficientLaw] = []
        for rod in range(first, last + 1, law.step):
            own = _relative(law, system.rule(chain, law.function, rod), rod, chain.m)
            if alike and replace(own, first=alike[-1].first, last=alike[-1].last) == alike[-1]:
                alike[-1] = replace(own, first=alike[-1].first)
            else:
                alike.append(own)
        laws += [
            substitute(own, partial(_substitute_rod, own.first)) if own.first == own.last else own for own in alike
        ]
    return tuple(laws)


def _substitute_rod(rod: Expr, place: Expr) -> Expr:
    return place.subs(INDEX, rod)


def _relative(law: CoefficientLaw, rule: Rule, rod: int, m: int) -> CoefficientLaw:
    """The law of one rod, with i for its number."""

    def relative_index(place: Expr) -> Expr:
        return INDEX + int(number(place, {COUNT.name: m, INDEX.name: rod}, None)) - rod

    return CoefficientLaw(
        law.function,
        INDEX,
        _weights(rule.own),
        tuple(
            replace(t, rod=relative_index(t.rod), weights=_weights(r.weights))
            for t, r in zip(law.terms, rule.terms, strict=True)
        ),
        tuple(
            replace(
                x, number=x.number if x.number is None else relative_index(x.number), value=exact(expression(r.value))
            )
            for x, r in zip(law.loads, rule.loads, strict=True)
        ),
        Integer(rod),
        Integer(rod),
        law.step,
    )


def _weights(w: Weights) -> SymbolicWeights:
    def linear(part: Linear, variable: Symbol) -> Expr:
        return expression(part.constant) + expression(part.slope) * variable

    raised = linear(w.next_power, POWER).factor()  # k + 1 as one
    return SymbolicWeights(exact(linear(w.same, RATE)), raised, expression(w.jump))
