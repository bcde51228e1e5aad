"""Modes of which all points rest: rods swing between them, and what they pull at each point cancels.

Then sin w T = 0 in each rod that swings, so w/pi is a fraction q, and u = a sin w s along it, s the delay from its left
end. A point that is free feels r Z a of a rod that begins there, and -r Z a cos w T of one that ends there, r being how
fast the end moves. Their sums are 0: amplitudes a are a null space of fractions. No mass, spring or dashpot takes part:
such modes never die away.

Beside dashpots rods with a free end are among them, too: cos w T = 0 there, and s counts from the end that rests.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import floor, pi

from flint import arb, fmpq, fmpq_mat

from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.exact.modes.turns import bare_ends
from wavesym.mechanics.network import Bar, Network
from wavesym.numbers.doubles import nearest

_ZERO = fmpq(0)


@dataclass(frozen=True)
class _Swinging:
    """A bar that may swing alone; `free_end` is the side of its free end, None where both ends rest."""

    number: int
    bar: Bar
    free_end: int | None

    @property
    def resting_ends(self) -> tuple[tuple[int, fmpq], ...]:
        """The points that rest, and how fast the bar's end moves with each."""
        ends = ((self.bar.left, self.bar.ratios[0]), (self.bar.right, self.bar.ratios[1]))
        return ends if self.free_end is None else (ends[1 - self.free_end],)

    def swings(self, q: fmpq) -> bool:
        """Whether it does at w = pi q."""
        return int((q * self.bar.delay).q) == (1 if self.free_end is None else 2)

    def turns(self, limit: float) -> Iterator[fmpq]:
        """All these q up to a limit."""
        late = 0 if self.free_end is None else 1
        halves = floor(2 * limit * nearest(self.bar.delay))
        return (fmpq(k) / (2 * self.bar.delay) for k in range(2 - late, halves + 1, 2))


def resting_modes(stiffness: Stiffness, limit: float, *, free_ends: bool = False) -> list[Mode]:
    """Those with frequencies up to a limit in rad per tau, ascending; of mass 1, and at right angles.

    With `free_ends` rods with one swing, too.
    """
    network = stiffness.network
    free = [(end.bar, end.side) for end in bare_ends(network) if free_ends and end.damping == 0]
    sides = {bar: side for bar, side in free if (bar, 1 - side) not in free}
    bars = [_Swinging(n, bar, sides.get(n)) for n, bar in enumerate(network.bars)]
    able = _strip_lone_bars(network, bars)
    turns = {str(q): q for each in able for q in each.turns(limit / pi)}
    found: list[Mode] = []
    for q in sorted(turns.values()):
        swinging = _strip_lone_bars(network, [each for each in able if each.swings(q)])
        if swinging:
            found += [
                _mode(stiffness, swinging, q, _of_mass_1(network, amplitudes))
                for amplitudes in _amplitudes(network, swinging, q)
            ]
    return found


def _mode(stiffness: Stiffness, bars: Sequence[_Swinging], q: fmpq, amplitudes: dict[int, arb]) -> Mode:
    """The mode of amplitudes of bars: of one with a free end that end's point has it."""
    points = [arb(0)] * len(stiffness.network.points)
    for each in bars:
        if each.free_end is not None:
            end = each.bar.right if each.free_end else each.bar.left
            sign = 1 if int((q * each.bar.delay).p) % 4 == 1 else -1
            points[end] = amplitudes.pop(each.number, arb(0)) * sign / each.bar.ratios[each.free_end]
    return Mode(stiffness, arb.pi() * q, points, amplitudes)


def _strip_lone_bars(network: Network, bars: Sequence[_Swinging]) -> list[_Swinging]:
    """Those of some bars that need not rest: at a point that is free no bar pulls alone."""
    left = list(bars)
    while True:
        ends = Counter(end for each in left for end, _ in each.resting_ends)
        alone = {end for end, count in ends.items() if count == 1 and network.points[end].motion is None}
        kept = [each for each in left if not alone & {end for end, _ in each.resting_ends}]
        if len(kept) == len(left):
            return kept
        left = kept


def _amplitudes(network: Network, swinging: Sequence[_Swinging], q: fmpq) -> list[dict[int, fmpq]]:
    """Amplitudes of some bars at w = pi q, all that balance, at right angles to each other."""
    bars = [each.number for each in swinging]
    ends = {end for each in swinging for end, _ in each.resting_ends}
    rows = {end: row for row, end in enumerate(end for end in sorted(ends) if network.points[end].motion is None)}
    pulls = fmpq_mat(max(len(rows), 1), len(bars))
    for column, each in enumerate(swinging):
        last = 1 if int((q * each.bar.delay).p) % 2 else -1
        for (end, ratio), sign in zip(each.resting_ends, (1, last), strict=False):
            if end in rows:
                pulls[rows[end], column] += sign * ratio * each.bar.impedance
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
