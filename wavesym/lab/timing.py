"""How long calls take, compared fairly: in interleaved rounds, so that what slows the machine down hits them all."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import median
from time import perf_counter

Call = Callable[[], object]


def medians(calls: Sequence[Call], rounds: int = 9, shortest: float = 2e-3, patience: float = 1.0) -> tuple[float, ...]:
    """Seconds a call of each, the medians over rounds in each of which every call has its turn.

    A turn repeats its call for at least about `shortest` seconds; a call that would take more than `patience` seconds
    over all rounds takes part in fewer, but in one at least.
    """
    repeats, turns = [], []
    for call in calls:
        call()  # what only the first call has to do
        once = _turn(call, 1)
        repeats.append(max(1, round(shortest / max(once, 1e-9))))
        turns.append(max(1, min(rounds, int(patience / max(once * repeats[-1], 1e-9)))))
    seconds: list[list[float]] = [[] for _ in calls]
    for turn in range(rounds):
        for call, times, count, most in zip(calls, seconds, repeats, turns, strict=True):
            if turn < most:
                times.append(_turn(call, count) / count)
    return tuple(map(median, seconds))


def least(calls: Sequence[Call], rounds: int = 50) -> tuple[float, ...]:
    """Seconds a call of each, the least over rounds: of short calls on a machine that does other things, too."""
    for call in calls:
        call()
    return tuple(map(min, zip(*([_turn(call, 1) for call in calls] for _ in range(rounds)), strict=True)))


def _turn(call: Call, count: int) -> float:
    start = perf_counter()
    for _ in range(count):
        call()
    return perf_counter() - start
