"""System III: a building of m storeys under base acceleration; (4.5), and with a base that moves with the ground.

The paper's base ("force") balances the foundation's inertia M_0 a against the columns. It is not a foundation that
moves with the ground ("ground"), whose velocity is the integral of the acceleration.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from wavesym.model.node import Family, Load, Node, Parameters, Quantity, Rod, System, single


def _force(storey: Rod, p: Parameters) -> Node:
    loads = (Load("a", None, (-1 / p.kappa[0],)), Load("b", None, (0, -1 / p.kappa[0])))
    return Node(None, storey, inertia=0, alpha=0, beta=2, loads=loads)


def _ground(storey: Rod, p: Parameters) -> Node:
    loads = (Load("a", None, (0, 1)), Load("b", None, (0, 0, Fraction(1, 2))))
    return Node(None, storey, inertia=0, alpha=0, beta=0, damping=1, loads=loads)


def _building(base: Callable[[Rod, Parameters], Node]) -> Callable[[Quantity, Parameters], tuple[Family, ...]]:
    def families(m: Quantity, p: Parameters) -> tuple[Family, ...]:
        def storey(i: Quantity) -> Rod:
            return Rod(tau0=i - 1, x0=i - 1)

        def floor(i: Quantity) -> Node:
            return Node(storey(i), storey(i + 1), inertia=1, alpha=2 * p.kappa[i], beta=2 * p.kappa[i])

        return (
            single(0, lambda: base(storey(1), p)),
            Family(1, m - 1, 1, floor),
            single(m, lambda: Node(storey(m), None, inertia=1, alpha=2 * p.kappa[m], beta=0)),
        )

    return families


BUILDING_FORCE = System("building-force", _building(_force), smallest=2)
BUILDING_GROUND = System("building-ground", _building(_ground), smallest=2)
