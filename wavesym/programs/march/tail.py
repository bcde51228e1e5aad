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
from math import lgamma, log

import numpy as np

_SMALL = log(2.0**-80)
_HIGHEST = 100_000


@dataclass(frozen=True)
class Tail:
    """Every true wave on every panel is a polynomial of `degree` up to at most `size`."""

    degree: int
    size: float


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
