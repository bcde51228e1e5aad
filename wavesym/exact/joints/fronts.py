"""When fronts meet joints: each that leaves one comes to the next after the delay of the bar between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from heapq import heapify, heappop, heappush
from math import lcm

from flint import fmpq

from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import Network


def front_sources(network: Network, loads: Iterable[AppliedLoad], joints: Iterable[int]) -> list[tuple[fmpq, int]]:
    """The instants at which something begins at joints: a load, and at 0 what does not stay as it is."""
    acting, found = list(loads), []
    for number in joints:
        if not network.at_rest(network.joints[number]):
            found.append((fmpq(0), number))
        sources = {unit.source for point in network.joints[number].points for unit in network.points[point].loads}
        found += [(load.time, number) for load in acting if load.source in sources]
    return found


def front_times(
    network: Network, sources: Iterable[tuple[fmpq, int]], last: Mapping[int, fmpq]
) -> Iterator[tuple[fmpq, int]]:
    """All meetings of fronts with joints, in order of time, each instant of a joint once.

    Args:
        network: The bars, whose contacts all fronts pass.
        sources: When something begins at joints (by number).
        last: The joints that matter, each with the tau until which it does.
    """
    coming = list(sources)
    values = [*(bar.delay for bar in network.bars), *(time for time, _ in coming)]
    unit = lcm(*(int(value.q) for value in values))  # whole numbers: they are compared sooner than fractions
    delays = [int(bar.delay * unit) for bar in network.bars]
    latest = {number: int((tau * unit).floor()) for number, tau in last.items()}
    beside = {
        number: [
            (delays[end.bar], network.joint_of[network.point_at(network.opposite_end(end))]) for end, _ in joint.ends
        ]
        for number, joint in enumerate(network.joints)
        if number in last
    }
    heap = [(int(time * unit), number) for time, number in coming]
    heapify(heap)
    before = (-1, -1)
    while heap:
        time, number = here = heappop(heap)
        if here == before or number not in latest or time > latest[number]:
            continue
        before = here
        yield fmpq(time, unit), number
        for delay, other in beside[number]:
            heappush(heap, (time + delay, other))
