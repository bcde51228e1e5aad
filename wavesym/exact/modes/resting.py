"""Modes of which all points rest: rods swing between them, and what they pull at each point cancels.

Then sin w T = 0 in each rod that swings, so w/pi is a fraction q, and u = a sin w s along it, s the delay from its left
end. A point that is free feels r Z a of a rod that begins there, and -r Z a cos w T of one that ends there, r being how
fast the end moves. Their sums are 0: amplitudes a are a null space of fractions. No mass, spring or dashpot takes part:
such modes never die away.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import floor, pi

from flint import arb, fmpq, fmpq_mat

from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import nearest

_ZERO = fmpq(0)


def resting_modes(stiffness: Stiffness, limit: float) -> list[Mode]:
    """Those with frequencies up to a limit in rad per tau, ascending; of mass 1, and at right angles."""
    network = stiffness.network
    able = _strip_lone_bars(network, range(len(network.bars)))
    delays = {str(bar.delay): bar.delay for bar in (network.bars[n] for n in able)}
    turns = {k / delay for delay in delays.values() for k in range(1, floor(limit / pi * nearest(delay)) + 1)}
    found: list[Mode] = []
    for q in sorted(turns):
        swinging = _strip_lone_bars(network, [n for n in able if (q * network.bars[n].delay).q == 1])
        if swinging:
            found += [
                Mode(stiffness, arb.pi() * q, [arb(0)] * len(network.points), _of_mass_1(network, amplitudes))
                for amplitudes in _amplitudes(network, swinging, q)
            ]
    return found


def _strip_lone_bars(network: Network, bars: Sequence[int]) -> list[int]:
    """Those of some bars that need not rest: at a point that is free no bar pulls alone."""
    left = list(bars)
    while True:
        ends = Counter(end for n in left for end in (network.bars[n].left, network.bars[n].right))
        alone = {end for end, count in ends.items() if count == 1 and network.points[end].motion is None}
        kept = [n for n in left if not alone & {network.bars[n].left, network.bars[n].right}]
        if len(kept) == len(left):
            return kept
        left = kept


def _amplitudes(network: Network, bars: Sequence[int], q: fmpq) -> list[dict[int, fmpq]]:
    """Amplitudes of some bars at w = pi q, all that balance, at right angles to each other."""
    ends = {end for n in bars for end in (network.bars[n].left, network.bars[n].right)}
    rows = {end: row for row, end in enumerate(end for end in sorted(ends) if network.points[end].motion is None)}
    pulls = fmpq_mat(max(len(rows), 1), len(bars))
    for column, n in enumerate(bars):
        bar = network.bars[n]
        last = 1 if int((q * bar.delay).p) % 2 else -1
        for end, ratio, sign in ((bar.left, bar.ratios[0], 1), (bar.right, bar.ratios[1], last)):
            if end in rows:
                pulls[rows[end], column] += sign * ratio * bar.impedance
    reduced, rank = pulls.rref()
    pivots = [next(k for k in range(len(bars)) if reduced[row, k] != 0) for row in range(rank)]
    found: list[dict[int, fmpq]] = []
    for free in (k for k in range(len(bars)) if k not in pivots):
        made = {bars[k]: -reduced[row, free] for row, k in enumerate(pivots)} | {bars[free]: fmpq(1)}
        for other in found:
            share = _product(network, made, other) / _product(network, other, other)
            made = {n: made.get(n, _ZERO) - share * other.get(n, _ZERO) for n in {**made, **other}}
        found.append({n: a for n, a in sorted(made.items()) if a != 0})
    return found


def _product(network: Network, one: dict[int, fmpq], other: dict[int, fmpq]) -> fmpq:
    """The mass that two shapes have in common: sums of the integrals of Z u v over the delays of bars."""
    bars = network.bars
    return sum((bars[n].impedance * bars[n].delay * a * other.get(n, _ZERO) / 2 for n, a in one.items()), _ZERO)


def _of_mass_1(network: Network, amplitudes: dict[int, fmpq]) -> dict[int, arb]:
    scale = arb(_product(network, amplitudes, amplitudes)).rsqrt()
    return {n: scale * a for n, a in amplitudes.items()}
