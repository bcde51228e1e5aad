"""The derived laws in exact numbers: what tables, pieces and marches run.

The increment that a function gains at the start of an interval is sum_g exp(-g w) sum_k F[g,k] w**k. To apply a D + b
to it, D = d/dw, is to put, for every rate g and power k,

    same(g) F[g,k] + raised(k) F[g,k+1]         same(g) = b - a g,  raised(k) = a (k + 1)

in place of F[g,k]; `recurrence.weights` derives these two weights, linear in g and in k.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from flint import fmpq


class Linear(NamedTuple):
    """constant + slope * (a rate or a power)."""

    constant: fmpq
    slope: fmpq


class Weights(NamedTuple):
    """What an operator does to coefficients: `same(g)` F[g,k] + `raised(k)` F[g,k+1].

    `jump` is its factor on a function that jumps, where the equation is integrated across a front.
    """

    same: Linear
    next_power: Linear
    jump: fmpq


class Term(NamedTuple):
    """`weights` on the increment that a function gained `back` intervals ago."""

    function: str
    rod: int
    back: int
    weights: Weights


class LoadTerm(NamedTuple):
    """`value` * w**`power` at rate 0 from `source`, at the start of interval 1 + `back`."""

    source: str
    back: int
    power: int
    value: fmpq


@dataclass(frozen=True)
class Rule:
    """own F = sum of terms + loads, for every rate and power, and for the jump at the start of the interval."""

    function: str
    rod: int
    own: Weights
    terms: tuple[Term, ...]
    loads: tuple[LoadTerm, ...]


class JointRule(NamedTuple):
    """What points of a joint have from (2.4), as factors: `inertia` of M, `damping` of dashpots, `load` of what acts.

    A rod end of impedance Z that moves n times as fast as its point, and to which a wave a comes, is a dashpot
    `radiates` n^2 Z and a force `arrives` n Z a; the pairs are for rods on the left and on the right of the point.
    """

    inertia: fmpq
    damping: fmpq
    load: fmpq
    radiates: tuple[fmpq, fmpq]
    arrives: tuple[fmpq, fmpq]


DERIVATIVE = Weights(Linear(fmpq(0), fmpq(-1)), Linear(fmpq(1), fmpq(1)), fmpq(1))
"""The weights of D alone: with them on the left, a rule integrates."""
