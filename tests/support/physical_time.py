"""Unit responses by the node law in physical time, in exact arithmetic: another way to the tables.

At a node with velocity q, waves a and b arrive from the left and right rod, q - a and q - b leave (see
`characteristics` for how (2.1)-(2.4) come to that), and

    inertia q' + (damping + (alpha + beta)/2) q = alpha a + beta b + load,      q continuous where inertia is not 0.

A unit load acts from tau = 0, a rod's initial waves v/2 arrive from tau = 0, and a rod delays by 1: everything changes
at integer tau only. What changes there is an exponential polynomial in w = tau - n, kept as one polynomial per rate.
No clocks, no lags, no recurrences, no coefficients one by one: nothing here is shared with the derivation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from flint import fmpq, fmpq_poly

from wavesym.derivation.table import Function, Table
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Node

Change = dict[fmpq, fmpq_poly]
"""sum over rates g of exp(-g w) * polynomial(w); what is 0 is left out."""


class SentWaves(NamedTuple):
    """What the wave that a node sends to the left and to the right gains at tau = 0, 1, 2, ..."""

    left: list[Change]
    right: list[Change]


class WaveDifference(NamedTuple):
    """Where a table and the node law differ: the increment of `function` at physical time tau."""

    source: str
    function: Function
    tau: int
    table: Change
    node_law: Change


def unit_waves(chain: Chain, source: str, times: int) -> tuple[SentWaves, ...]:
    """What the nodes at x = 0, 1, ... send at tau = 0, 1, ... times - 1 for a unit of `source`.

    The waves v/2 that are in the rods before do not count as gained: these are the f', g' of (4.2). ValueError where
    the chain has no such source.
    """
    if source not in chain.sources:
        raise ValueError(f"{source}: not among {', '.join(chain.sources)}")
    nodes = chain.nodes
    sent = tuple(SentWaves([], []) for _ in nodes)
    for n in range(times):
        for x, node in enumerate(nodes):
            a = _arrived(sent[x - 1].right, node.left.velocity, n) if node.left else {}
            b = _arrived(sent[x + 1].left, node.right.velocity, n) if node.right else {}
            q = _velocity(node, a, b, _load(node, source) if n == 0 else {}, n)
            for waves, arrived, rod in ((sent[x].left, a, node.left), (sent[x].right, b, node.right)):
                before = _constant(rod.velocity / 2) if n == 0 and rod else {}
                waves.append(_sum([(1, q), (-1, arrived), (-1, before)]))
    return sent


def differences(chain: Chain, table: Table) -> Iterator[WaveDifference]:
    """Every increment in which a table of the chain differs from the node law; none where both are right."""
    last = max(
        (
            chain.leaves(*function, table.interval * len(increments))
            for response in table.responses.values()
            for function, increments in response.items()
        ),
        default=0,
    )
    for source, response in table.responses.items():
        sent = unit_waves(chain, source, last)
        for function, increments in response.items():
            gained = {
                chain.leaves(*function, table.interval * n): {rate: fmpq_poly(powers) for rate, powers in gain.items()}
                for n, gain in enumerate(increments)
            }
            node = sent[function.rod - 1].right if function.function == "f" else sent[function.rod].left
            for tau in range(min(gained, default=0), chain.leaves(*function, table.interval * len(increments))):
                ours, theirs = node[tau] if tau >= 0 else {}, gained.get(tau, {})
                if ours != theirs:
                    yield WaveDifference(source, function, tau, theirs, ours)


def _arrived(sent: list[Change], v: fmpq, n: int) -> Change:
    return sent[n - 1] if n else _constant(v / 2)


def _load(node: Node, source: str) -> Change:
    loads = [load for load in node.loads if load.source == source]
    return _sum([(1, {fmpq(0): fmpq_poly(list(load.coefficients))}) for load in loads])


def _velocity(node: Node, a: Change, b: Change, load: Change, n: int) -> Change:
    right = _sum([(node.alpha, a), (node.beta, b), (1, load)])
    gamma = node.damping + (node.alpha + node.beta) / 2
    if not node.inertia:
        return _sum([(1 / gamma, right)])
    # a body moves at first with the rod that is fixed to it; afterwards what it gains starts from 0
    jump = node.velocity if n == 0 else fmpq(0)
    return _solution(gamma / node.inertia, _sum([(fmpq(1, node.inertia), right)]), jump)


def _solution(gamma: fmpq, right: Change, initial: fmpq) -> Change:
    """q' + gamma q = right with q = initial at w = 0.

    With q = exp(-g w) Q the equation is Q' + (gamma - g) Q = R for each rate g; for a polynomial R that is
    Q = R/d - R'/d**2 + R''/d**3 - ..., d = gamma - g, or an integral where d = 0. exp(-gamma w) makes up for the start.
    """
    particular: Change = {}
    for rate, polynomial in right.items():
        d = gamma - rate
        if d == 0:
            particular[rate] = polynomial.integral()
            continue
        total, term = fmpq_poly(), polynomial / d
        while term:
            total, term = total + term, -term.derivative() / d
        particular[rate] = total
    missing = initial - sum((polynomial(fmpq(0)) for polynomial in particular.values()), fmpq(0))
    return _sum([(1, particular), (1, {gamma: fmpq_poly([missing])})])


def _constant(value: fmpq) -> Change:
    return _sum([(1, {fmpq(0): fmpq_poly([value])})])


def _sum(parts: Iterable[tuple[fmpq | int, Change]]) -> Change:
    total: Change = {}
    for factor, part in parts:
        for rate, polynomial in part.items():
            total[rate] = total.get(rate, fmpq_poly()) + factor * polynomial
    return {rate: polynomial for rate, polynomial in total.items() if polynomial}
