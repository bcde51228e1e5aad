"""The laws of nodes and joints in exact numbers, each derived when it is first asked for."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from flint import fmpq

from wavesym.derivation.exact_rule import JointRule, NodeRule, Weights
from wavesym.mechanics.node import Node
from wavesym.numbers.ratio import Ratio


def node_rule(node: Node) -> NodeRule:
    """The law of a node on powers of time; what acts on it is no part of that."""
    bare = replace(node, loads=())
    # functions of different rings may look alike, so what has symbols is not kept
    symbolic = any(isinstance(value, Ratio) for value in (node.alpha, node.beta, node.damping))
    return _derive(bare) if symbolic else _derived(bare)


@cache
def _derived(node: Node) -> NodeRule:
    return _derive(node)


def _derive(node: Node) -> NodeRule:
    # SymPy is needed only here, where laws are made
    from wavesym.derivation.recurrence import node_rule

    return node_rule(node)


def joint_rule() -> JointRule:
    """What rods and points bring to a joint."""
    from wavesym.derivation.recurrence import joint_rule

    return joint_rule()


def factor_weights(rate: fmpq) -> Weights:
    """What D + `rate` does to the coefficients of exponentials times powers."""
    from wavesym.derivation.recurrence import factor_weights

    return factor_weights(rate)
