"""The law of a node, derived once from (2.3) and (2.4) in physical time: its velocity from what arrives.

A rod that ends at a node brings a wave and takes one away, each counted as a velocity: a comes on the left and l leaves
there, b comes on the right and r leaves there. The node's velocity q is that of both rods, a + l = b + r = q, and the
strains there are l - a and b - r. Put into (2.4), that is the law from which everything is made:

    (inertia D + radiation) q = left a + right b + load,        l = q - a,        r = q - b.

With waves on the clocks of Table 1 it is the delay equations (4.6)-(4.8), whose coefficients are sought as exponentials
times powers; on a stretch without fronts coefficients are sought as powers alone (`recurrence`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from sympy import Expr, Rational, Symbol, expand, linsolve, symbols

from wavesym.derivation.delay_terms import Operator, exact
from wavesym.mechanics.node import Node

INERTIA, DAMPING, ALPHA, BETA = symbols("M c alpha beta")
_Q, _MOVED, _FORCE = symbols("q Dq S")
_A, _B, _L, _R = symbols("a b l r")


@dataclass(frozen=True)
class NodeLaw:
    """`own` q = `left` a + `right` b + `load` times what acts."""

    own: Operator
    left: Expr
    right: Expr
    load: Expr

    def with_numbers(self, node: Node) -> NodeLaw:
        """With a node's own numbers or symbols for inertia, damping, alpha and beta."""
        values = {
            INERTIA: exact(node.inertia),
            DAMPING: exact(node.damping),
            ALPHA: exact(node.alpha if node.left else 0),
            BETA: exact(node.beta if node.right else 0),
        }

        def substitute(expression: Expr) -> Expr:
            return expand(expression.subs(values, simultaneous=True))

        return NodeLaw(
            Operator(*map(substitute, self.own)), substitute(self.left), substitute(self.right), substitute(self.load)
        )


def _balance(strain_left: Expr, strain_right: Expr) -> Expr:
    """(2.4), dimensionless: what is 0 at a node."""
    pulled = Rational(1, 2) * (BETA * strain_right - ALPHA * strain_left)
    return INERTIA * _MOVED + DAMPING * _Q - pulled - _FORCE


@cache
def node_law() -> NodeLaw:
    """The law, in the symbols INERTIA, DAMPING, ALPHA and BETA."""
    ((left, right),) = linsolve([_A + _L - _Q, _B + _R - _Q], [_L, _R])  # (2.3)
    line = expand(_balance(left - _A, _B - right))

    def factor(symbol: Symbol) -> Expr:
        return exact(line.coeff(symbol))

    return NodeLaw(Operator(factor(_MOVED), factor(_Q)), -factor(_A), -factor(_B), -factor(_FORCE))
