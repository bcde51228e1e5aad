"""How near to a polynomial a true wave is on a panel, proved beforehand from how its derivatives jump.

The k-th derivative of a motion satisfies the equations of the nodes too, but at the instants n + (start of a panel) it
jumps. A body of rate g turns jumps that arrive, J(x) = sum J_k x**k with k the order, into jumps of its velocity,
[q^(k)] = alpha [a^(k-1)] + beta [b^(k-1)] - g [q^(k-1)] with alpha + beta = 2 g, so of at most
Q(x) = 2 g x/(1 - g x) J(x). It passes on J + Q: a factor G(x) = (1 + g x)/(1 - g x) per unit of time, where g may be
the largest rate. Nodes without inertia pass J on as it is. Hence after
n windows J_k <= r**-k G(r)**n s(r) for any r < 1/g, with s the jumps of the loads and of the start.

Between jumps the energy of the k-th derivative (k so high that no load has one) does not grow, and jumps add at most
(sum of M / 2)**0.5 Q_k each time. That bounds the derivative in L2, with the next one its largest value, and so
Chebyshev interpolation of degree K = k - 1: 2 (h/4)**k / k! times it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import lgamma, log, sqrt

import numpy as np

from wavesym.numbers.doubles import nearest
from wavesym.programs.march.plan import Plan

_SMALL = log(2.0**-80)
_HIGHEST = 100_000


@dataclass(frozen=True)
class Tail:
    """Every true wave on every panel is a polynomial of `degree` up to at most `size`."""

    degree: int
    size: float


def tail(plan: Plan, degree: int) -> Tail:
    """The tail of a plan's own motion, at no lower a degree than that of the computed waves."""
    return tail_after(plan, degree, plan.windows, _jumps(plan))


def tail_after(plan: Plan, degree: int, windows: int, jumps: Sequence[float]) -> Tail:
    """The lowest degree, `degree` at least, whose tail on the first `windows` is below 2**-80 of the jumps.

    `jumps[k]` is the sum of those of k-th derivatives; loads have no more of them.
    """
    rate = nearest(plan.rate)
    if rate == 0 or not any(jumps):
        return Tail(max(degree, len(jumps)), 0.0)  # without bodies waves are as the loads
    impedance = min(nearest(z) for node in plan.junctions for z in (node.left, node.right) if z)
    mass = sum(nearest(node.mass) for node in plan.junctions)
    added = sqrt(mass / 2 / impedance) * (windows + 2) * len(plan.panels)
    return tail_of(degree, jumps, rate, windows, added, [nearest(panel.length) for panel in plan.panels])


def tail_of(
    degree: int, jumps: Sequence[float], rate: float, crossings: int, added: float, lengths: Sequence[float]
) -> Tail:
    """The same for nodes whose rates are at most `rate` > 0, met by a front so often, on panels of these lengths.

    In the norm of energy jumps add so many times [x^k] of G(x) to the power of crossings.
    """
    longest, shortest = max(lengths), min(lengths)
    r = np.linspace(0.001, 0.999, 999) / rate
    growth = (crossings + 2) * np.log((1 + rate * r) / (1 - rate * r))
    start = np.logaddexp.reduce([log(jump) + order * np.log(r) for order, jump in enumerate(jumps) if jump])
    injected = log(added)

    def size(degree: int) -> float:
        """The logarithm of the tail."""
        k = degree + 1
        largest = np.logaddexp(-log(shortest) / 2 - k * np.log(r), log(longest) / 2 - (k + 1) * np.log(r))
        bound = float(np.min(largest + growth + start)) + injected
        return bound + log(2) + k * log(longest / 4) - lgamma(k + 1)

    wanted = _SMALL + log(sum(jumps))
    low = len(jumps) - 1
    high = 2 * low
    while size(high) > wanted and high < _HIGHEST:
        low, high = high, 2 * high
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if size(middle) <= wanted else (middle, high)
    return Tail(max(degree, high), float(np.exp(min(size(high), 700.0))))


def _jumps(plan: Plan) -> list[float]:
    """The jumps of order 0, 1, 2 that loads and start make, all added up."""
    jumps = [2 * sum(abs(nearest(v)) for v in plan.rods), 0.0, 0.0]
    for panel in range(len(plan.panels)):
        for _, _, powers in plan.changes(panel):
            for order, c in enumerate(powers):
                jumps[order] += abs(nearest(c)) * (2 if order == 2 else 1)
    return jumps
