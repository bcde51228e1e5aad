"""How long whole commands take, and how much memory."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from typing import NamedTuple


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
