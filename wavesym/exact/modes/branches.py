"""A network as a tree of branches, seen from one of its points, and which of these are equal in all parts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.network import Network


class Branch(NamedTuple):
    """What leads from one point to the next, outwards: a bar, whose near end is `side`, or None, and what is beside it.

    `ratios` say how far its near and its far end move when their points move by 1.
    """

    near_point: int
    far_point: int
    bar: int | None
    side: int
    ratios: tuple[fmpq, fmpq]
    stiffness: fmpq
    damping: fmpq


@dataclass(frozen=True)
class BranchTree:
    """The branches of a network that are reached from its point `root`. UnservedError for a ring of parts."""

    network: Network
    root: int

    @cached_property
    def branches(self) -> list[Branch]:
        """All of them, each after those nearer to the root."""
        beside: dict[int, list[Branch]] = {}
        for branch in _all_branches(self.network):
            beside.setdefault(branch.near_point, []).append(branch)
            back = branch._replace(
                near_point=branch.far_point,
                far_point=branch.near_point,
                side=1 - branch.side,
                ratios=(branch.ratios[1], branch.ratios[0]),
            )
            beside.setdefault(back.near_point, []).append(back)
        found: list[Branch] = []
        coming, met = [(self.root, -1)], {self.root}
        for point, before in coming:
            if point != self.root and self.network.points[point].motion is not None:
                continue
            for branch in beside.get(point, ()):
                if branch.far_point == before:
                    continue
                if branch.far_point in met and self.network.points[branch.far_point].motion is None:
                    raise UnservedError(
                        "system.parts: a ring of parts is not supported by modes (write a chain with branches)"
                    )
                met.add(branch.far_point)
                found.append(branch)
                coming.append((branch.far_point, point))
        return found

    @cached_property
    def kinds(self) -> dict[int, int]:
        """Of each branch, by its far point, a number that it shares with its equals."""
        children: dict[int, list[Branch]] = {}
        for branch in self.branches:
            children.setdefault(branch.near_point, []).append(branch)
        numbers: dict[tuple[object, ...], int] = {}
        found: dict[int, int] = {}
        for branch in reversed(self.branches):
            beyond = sorted(found[each.far_point] for each in children.get(branch.far_point, ()))
            found[branch.far_point] = numbers.setdefault((*self._kind(branch), *beyond), len(numbers))
        return found

    @cached_property
    def twins(self) -> dict[int, int]:
        """Of each branch, by its far point, the first one beside it that is its equal."""
        first = dict[tuple[int, int], int]()
        for branch in self.branches:
            first.setdefault((branch.near_point, self.kinds[branch.far_point]), branch.far_point)
        return {b.far_point: first[b.near_point, self.kinds[b.far_point]] for b in self.branches}

    @cached_property
    def equal_bars(self) -> list[int]:
        """Of each bar the first one with its delay."""
        first: dict[tuple[int, ...], int] = {}
        keys = ([int(n) for each in (bar.delay, bar.loss) for n in (each.p, each.q)] for bar in self.network.bars)
        return [first.setdefault(tuple(key), number) for number, key in enumerate(keys)]

    def _kind(self, branch: Branch) -> tuple[object, ...]:
        """All numbers of a branch and of its far point; balls are equal to nothing but themselves."""
        point, numbers = self.network.points[branch.far_point], [*branch.ratios, branch.stiffness, branch.damping]
        if branch.bar is not None:
            bar = self.network.bars[branch.bar]
            numbers += [bar.impedance, bar.delay, bar.loss]
        rests = point.motion is not None
        numbers += [] if rests else [point.mass, point.stiffness, point.damping]
        return (branch.bar is None, rests, *(each if isinstance(each, fmpq) else id(each) for each in numbers))


def _all_branches(network: Network) -> list[Branch]:
    """Those of a network, from left to right."""
    found: dict[tuple[int, int], Branch] = {}
    for number, bar in enumerate(network.bars):
        pair = bar.left, bar.right
        if pair in found or pair[::-1] in found:
            raise UnservedError("system.parts: two rods between the same nodes are not supported by modes (write one)")
        found[pair] = Branch(*pair, number, 0, bar.ratios, fmpq(0), fmpq(0))
    for link in network.links:
        if link.stiffness == 0 and link.damping == 0:
            continue
        pair, ratios = (link.left, link.right), (link.ratio, fmpq(1))
        if pair[::-1] in found:
            pair, ratios = pair[::-1], ratios[::-1]
        branch = found.get(pair, Branch(*pair, None, 0, ratios, fmpq(0), fmpq(0)))
        scale = ratios[1] / branch.ratios[1]  # a spring counted at the ends of the bar
        if ratios[0] != scale * branch.ratios[0]:
            raise UnservedError(
                "system.parts: a gear beside a rod is not supported by modes (write a spring or dashpot there)"
            )
        found[pair] = branch._replace(
            stiffness=branch.stiffness + scale**2 * link.stiffness, damping=branch.damping + scale**2 * link.damping
        )
    return list(found.values())
