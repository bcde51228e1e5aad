"""A chain with equal branches taken apart into chains without: the modes of all parts are all of the whole.

n equal branches of one point move alike, which is one branch n times as heavy and as stiff, or against each other, with
the point at rest, in n - 1 ways at right angles. So the determinant of the whole is that of the chain with one branch
in place of n, times that of a branch held at the point, to the power n - 1. Parts may have equal branches, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from flint import acb, arb

from wavesym.errors import UnservedError
from wavesym.exact.modes.branches import Branch, BranchTree
from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.stiffness import Quantity, Stiffness
from wavesym.mechanics.network import Network

_FORK = 3  # parts of which a point has equal ones; halves of a chain that is no more than that need not be taken apart

Shares = Sequence[Sequence[tuple[int, arb]]]
"""Of each point, or bar, of a part those of the whole that move with it, and how much."""


@dataclass(frozen=True)
class Part:
    """A network whose modes are some of the whole's, once for each of its `ways`: shares of points and of bars."""

    network: Network
    ways: tuple[tuple[Shares, Shares], ...]

    def modes_of_whole(self, mode: Mode, whole: Stiffness) -> Iterator[Mode]:
        """Those that a mode of this part is of."""
        for points, bars in self.ways:
            moved = _spread(enumerate(mode.points), points)
            swung = _spread(mode.amplitudes.items(), bars)
            every = [moved.get(number, acb(0)) for number in range(len(whole.network.points))]
            yield Mode(whole, mode.frequency, every, swung, mode.stays)


def take_apart(network: Network) -> list[Part]:
    """The parts of a network whose own branches differ; itself where it has no equal ones, or is no tree."""
    itself = tuple([[(number, arb(1))] for number in range(len(each))] for each in (network.points, network.bars))
    left, found = [Part(network, ((itself[0], itself[1]),))], list[Part]()
    while left:
        part = left.pop()
        parts = _first_split(part.network)
        if not parts:
            found.append(part)
        for inner in parts:
            ways = [
                (_compose(points, outer_points), _compose(bars, outer_bars))
                for points, bars in inner.ways
                for outer_points, outer_bars in part.ways
            ]
            left.append(Part(inner.network, tuple(ways)))
    return found


def _spread(moved: Iterable[tuple[int, Quantity]], shares: Shares) -> dict[int, Quantity]:
    return {other: value * share for number, value in moved for other, share in shares[number]}


def _compose(inner: Shares, outer: Shares) -> Shares:
    return [[(far, a * b) for number, a in each for far, b in outer[number]] for each in inner]


def _first_split(network: Network) -> list[Part]:
    """The parts by the first point that has equal branches; none where there is none."""
    beside: dict[int, set[int]] = {n: set() for n in range(len(network.points))}
    pairs = [(bar.left, bar.right) for bar in network.bars] + [(link.left, link.right) for link in network.links]
    for left, right in pairs:
        beside[left].add(right)
        beside[right].add(left)
    if any(point.motion is not None and len(beside[n]) > 1 for n, point in enumerate(network.points)):
        return []
    for root in (n for n, others in beside.items() if len(others) >= _FORK):
        try:
            tree = BranchTree(network, root)
            branches, kinds = tree.branches, tree.kinds
        except UnservedError:
            return []
        equal: dict[int, list[Branch]] = {}
        for branch in branches:
            if branch.near_point == root:
                equal.setdefault(kinds[branch.far_point], []).append(branch)
        alike = next((each for each in equal.values() if len(each) > 1), None)
        if alike is not None:
            copies = [_walk(branch, branches, kinds) for branch in alike]
            return [_in_step(network, root, copies), _against_each_other(network, root, copies)]
    return []


def _walk(first: Branch, branches: Sequence[Branch], kinds: Mapping[int, int]) -> list[Branch]:
    """A branch and all beyond it, equal ones of equal branches at equal places."""
    found = [first]
    for each in found:
        beyond = (b for b in branches if b.near_point == each.far_point)
        found += sorted(beyond, key=lambda b: kinds[b.far_point])
    return found


def _in_step(network: Network, root: int, copies: Sequence[Sequence[Branch]]) -> Part:
    """One branch in place of all, as heavy and as stiff as they are together."""
    count, first = len(copies), [each.far_point for each in copies[0]]
    gone = {each.far_point for copy in copies[1:] for each in copy}
    own, kept = set(first), [n for n in range(len(network.points)) if n not in gone]
    points = tuple(
        replace(p, mass=p.mass * count, damping=p.damping * count, stiffness=p.stiffness * count) if n in own else p
        for n, p in enumerate(network.points)
    )
    bars = tuple(
        replace(bar, impedance=bar.impedance * count) if own & {bar.left, bar.right} else bar for bar in network.bars
    )
    links = tuple(
        replace(link, stiffness=link.stiffness * count, damping=link.damping * count)
        if own & {link.left, link.right}
        else link
        for link in network.links
    )
    part, numbers = _subnetwork(replace(network, points=points, bars=bars, links=links), kept)
    alike = {each.far_point: [c[k].far_point for c in copies] for k, each in enumerate(copies[0])}
    swing = {each.bar: [c[k].bar for c in copies] for k, each in enumerate(copies[0])}
    one = arb(1)
    moved = [[(other, one) for other in alike.get(n, [n])] for n in kept]
    swung = [[(other, one) for other in swing.get(n, [n]) if other is not None] for n in numbers]
    return Part(part, ((moved, swung),))


def _against_each_other(network: Network, root: int, copies: Sequence[Sequence[Branch]]) -> Part:
    """One branch held at its point: the k-th against the k - 1 before it, so that all are at right angles."""
    held = tuple(replace(p, motion="fixed") if n == root else p for n, p in enumerate(network.points))
    places = {each.far_point: k for k, each in enumerate(copies[0])}
    kept = [root, *places]
    part, numbers = _subnetwork(replace(network, points=held), kept)
    bars = {each.bar: k for k, each in enumerate(copies[0])}
    ways: list[tuple[Shares, Shares]] = []
    for last in range(1, len(copies)):
        size = arb(last * (last + 1)).rsqrt()
        shares = [(copy, size * (-last if k == last else 1)) for k, copy in enumerate(copies[: last + 1])]
        moved = [[(copy[places[n]].far_point, share) for copy, share in shares] if n in places else [] for n in kept]
        swung = [[(number, s) for copy, s in shares if (number := copy[bars[n]].bar) is not None] for n in numbers]
        ways.append((moved, swung))
    return Part(part, tuple(ways))


def _subnetwork(network: Network, kept: Sequence[int]) -> tuple[Network, list[int]]:
    """What is between some points, and the numbers of its bars."""
    number = {point: k for k, point in enumerate(kept)}
    bars = [n for n, bar in enumerate(network.bars) if bar.left in number and bar.right in number]
    made = [network.bars[n] for n in bars]
    part = replace(
        network,
        points=tuple(network.points[point] for point in kept),
        bars=tuple(replace(bar, left=number[bar.left], right=number[bar.right]) for bar in made),
        links=tuple(
            replace(link, left=number[link.left], right=number[link.right])
            for link in network.links
            if link.left in number and link.right in number
        ),
    )
    return part, bars
