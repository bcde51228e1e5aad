"""Fronts on their way through a network: when what leaves which end of a bar, in the order of time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from heapq import heapify, heappop, heappush
from itertools import count
from typing import Any, TypeVar

from flint import fmpq

from wavesym.mechanics.network import End, Network

T = TypeVar("T")
Answer = Callable[[int, fmpq, Mapping[End, T]], Iterator[tuple[End, T]]]
"""What a joint sends into ends of bars at an instant, from what arrives there: of ends that get nothing, nothing."""


def departures(
    network: Network, starts: Iterable[int], answer: Answer[T], last: Mapping[int, fmpq] | None
) -> Iterator[tuple[fmpq, End, T]]:
    """All that leaves the ends of bars after something began at some joints at 0; without end where `last` is None.

    `last` has the joints that matter, each with the tau until which it does.
    """
    # in the order of time, joints and what came first: an fmpq is slow to hash
    order = count()
    coming: list[tuple[fmpq, int, int, End | None, Any]] = [
        (fmpq(0), number, next(order), None, None) for number in starts
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
