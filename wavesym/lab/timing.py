"""How long calls take, compared fairly: in interleaved rounds, so that what slows the machine down hits them all."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Sequence
from statistics import median
from time import perf_counter
from typing import NamedTuple

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


class Ran(NamedTuple):
    """A command that has run: whether it did what it was asked for, wall time in s, peak memory in MB, and for how long
    it kept processors busy, in s."""

    well: bool
    seconds: float
    megabytes: float
    busy: float


def ran(command: Sequence[str]) -> Ran:
    """Run a command, start-up included. A small process starts it, as its peak counts from that of who does."""
    small = [sys.executable, "-S", "-c", _STARTER, *command]
    done = subprocess.run(small, stdout=subprocess.PIPE, encoding="ascii", check=True)
    status, seconds, kilobytes, busy = done.stdout.split()
    return Ran(status == "0", float(seconds), int(kilobytes) / 1000, float(busy))


_STARTER = """
import os, sys, time
quiet = [(os.POSIX_SPAWN_OPEN, out, os.devnull, os.O_WRONLY, 0) for out in (1, 2)]
start = time.perf_counter()
process = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ, file_actions=quiet)
_, status, usage = os.wait4(process, 0)
print(status, time.perf_counter() - start, usage.ru_maxrss, usage.ru_utime + usage.ru_stime)
"""
