"""Fronts on their way through a network: each that leaves a joint comes to the next after the delay of the bar between
them. When they meet joints, and what they carry, in the order of time.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from heapq import heapify, heappop, heappush
from itertools import count, islice
from math import lcm
from operator import itemgetter
from typing import Any, TypeVar

from flint import fmpq

from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End, Network

T = TypeVar("T")
Answer = Callable[[int, fmpq, Mapping[End, T]], Iterator[tuple[End, T]]]
"""What a joint sends into ends of bars at an instant, from what arrives there: of ends that get nothing, nothing."""


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
    network: Network,
    sources: Iterable[tuple[fmpq, int]],
    last: Mapping[int, fmpq],
    cuts: Mapping[int, fmpq] | None = None,
    rests: Mapping[int, Sequence[tuple[fmpq, fmpq]]] | None = None,
) -> Iterator[tuple[fmpq, int]]:
    """All meetings of fronts with joints, in order of time, each instant of a joint once.

    Args:
        network: The bars, whose contacts all fronts pass.
        sources: When something begins at joints (by number).
        last: The joints that matter, each with the tau until which it does.
        cuts: Joints from which a front sets out so long after the last one they met, if they have met none since.
        rests: Between which instants, in order, joints send no such fronts.
    """
    coming, cuts = list(sources), cuts or {}
    values = [*(bar.delay for bar in network.bars), *(time for time, _ in coming), *cuts.values()]
    unit = lcm(*(int(value.q) for value in values))  # whole numbers: they are compared sooner than fractions
    delays = [int(bar.delay * unit) for bar in network.bars]
    reaches = {number: int(reach * unit) for number, reach in cuts.items()}
    resting = {
        number: [(int((start * unit).ceil()), int((end * unit).ceil())) for start, end in each]
        for number, each in (rests or {}).items()
    }
    latest = {number: int((tau * unit).floor()) for number, tau in last.items()}
    beside = {
        number: [
            (delays[end.bar], network.joint_of[network.point_at(network.opposite_end(end))]) for end, _ in joint.ends
        ]
        for number, joint in enumerate(network.joints)
        if number in last
    }
    heap = [(int(time * unit), number, False) for time, number in coming]
    heapify(heap)
    met: dict[int, int] = {}
    while heap:
        time, number, is_cut = heappop(heap)
        if number not in latest or time > latest[number] or met.get(number) == time:
            continue
        if is_cut and (time - met[number] < reaches[number] or _is_within(time, resting.get(number, ()))):
            continue  # something has come since, or all that is fast has died away
        met[number] = time
        yield fmpq(time, unit), number
        if number in reaches:
            heappush(heap, (time + reaches[number], number, True))
        for delay, other in beside[number]:
            heappush(heap, (time + delay, other, False))


def _is_within(time: int, spans: Sequence[tuple[int, int]]) -> bool:
    place = bisect_right(spans, time, key=itemgetter(0))
    return place > 0 and time < spans[place - 1][1]


def has_more_fronts(model: Model, most: int) -> bool:
    """Whether fronts would meet the joints that can be felt more often than so, were all contacts closed."""
    last = model.joints_in_reach(model.until)
    sources = front_sources(model.network, model.loads_until(model.until), last)
    return next(islice(front_times(model.network, sources, last), most, None), None) is not None


def departures(
    network: Network, starts: Iterable[tuple[fmpq, int]], answer: Answer[T], last: Mapping[int, fmpq] | None
) -> Iterator[tuple[fmpq, End, T]]:
    """All that leaves the ends of bars after something began at instants at joints; without end where `last` is None.

    `last` has the joints that matter, each with the tau until which it does.
    """
    # in the order of time, joints and what came first: an fmpq is slow to hash
    order = count()
    coming: list[tuple[fmpq, int, int, End | None, Any]] = [
        (time, number, next(order), None, None) for time, number in starts
    ]
    heapify(coming)
    while coming:
        time, number, *_ = coming[0]
        arriving: dict[End, T] = {}
        while coming and coming[0][1] == number and coming[0][0] == time:
            *_, arrived, wave = heappop(coming)
            if arrived is not None:
                arriving[arrived] = wave
        for end, wave in answer(number, time, arriving):
            yield time, end, wave
            there = network.opposite_end(end)
            other = network.joint_of[network.point_at(there)]
            late = time + network.bars[end.bar].delay
            if last is None or (other in last and late <= last[other]):
                heappush(coming, (late, other, next(order), there, wave))


def reachable(
    network: Network, starts: Iterable[End], passes: Callable[[int], Mapping[End, Iterable[End]]]
) -> set[End]:
    """The ends that something leaves at some time; `passes` tells of a joint where what arrives at an end goes."""
    found: set[End] = set()
    coming = list(starts)
    while coming:
        end = coming.pop()
        if end not in found:
            found.add(end)
            there = network.opposite_end(end)
            coming += passes(network.joint_of[network.point_at(there)])[there]
    return found
