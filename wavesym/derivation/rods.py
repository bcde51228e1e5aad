"""The kinds of rods of a system, each with its constants of Table 1, as the nodes have them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from sympy import Expr

from wavesym.derivation.delay import COUNT, INDEX, SYMBOLS
from wavesym.derivation.delay_terms import exact
from wavesym.mechanics.node import Rod, System


@dataclass(frozen=True)
class RodKind:
    """Rod `number` with its clock and start, for i = first, first + step, ... last."""

    number: Expr
    rod: Rod
    first: Expr
    last: Expr
    step: int


def rod_kinds(system: System) -> tuple[RodKind, ...]:
    """Every rod once, from left to right, rods of one description together."""
    kinds: list[RodKind] = []
    for family in system.families(COUNT, SYMBOLS):
        alone = exact(family.first - family.last) == 0
        x = exact(family.first) if alone else INDEX - 1
        rod = family.node_at(x).right
        if rod is not None:
            rod = Rod(exact(rod.tau0), exact(rod.x0), exact(rod.velocity))
            number = exact(x + 1)
            kinds.append(RodKind(number, rod, exact(family.first + 1), exact(family.last + 1), family.step))
    some = 2 * system.smallest  # an m for which every kind has a rod
    return tuple(sorted(_join_range(kinds), key=lambda kind: int(kind.first.subs(COUNT, some))))


def _join_range(kinds: list[RodKind]) -> list[RodKind]:
    """A rod that is described alone, but as the others of a range next to it, belongs to them."""
    for alone in kinds:
        for many in kinds:
            next_to = exact(many.first - alone.last) == many.step or exact(alone.first - many.last) == many.step
            if alone is not many and alone.number != INDEX and next_to and _rod_at(many.rod, alone.number) == alone.rod:
                first = alone.first if exact(many.first - alone.last) == many.step else many.first
                last = alone.last if exact(alone.first - many.last) == many.step else many.last
                rest = [kind for kind in kinds if kind is not alone]
                return _join_range([replace(k, first=first, last=last) if k is many else k for k in rest])
    return kinds


def _rod_at(rod: Rod, i: Expr) -> Rod:
    return Rod(*(exact(value.subs(INDEX, i)) for value in (rod.tau0, rod.x0, rod.velocity)))
