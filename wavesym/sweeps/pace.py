"""How fast batches are computed here, and from that whether workers are worth their start."""

from __future__ import annotations

import os
from importlib.util import find_spec
from time import process_time

_START = 10.0  # seconds of a processor until a worker of this machine computes


class Pace:
    """The time of processors that batches have taken, of which `left` are left. Other programs do not change it."""

    def __init__(self, left: int) -> None:
        self.left = left
        self._times = [process_time()]

    def tick(self) -> None:
        """A batch is done."""
        self._times.append(process_time())
        self.left -= 1

    @property
    def seconds(self) -> float:
        """All that the batches done have taken."""
        return self._times[-1] - self._times[0]

    def useful_workers(self, most: int | None) -> int:
        """How many workers would be done sooner than this process, their start included; 0 where none would."""
        workers = min(most or processors(), processors(), self.left)
        if workers < 2 or find_spec("distributed") is None:
            return 0
        return workers if self._each() * self.left * (1 - 1 / workers) > _START else 0

    def _each(self) -> float:
        """Seconds for a batch. The first one tells nothing: most that it does, loading and compiling, is done once."""
        _, first, *rest = self._times
        return (rest[-1] - first) / len(rest) if rest else 0.0

    def explain(self, asked: int, workers: int) -> str:
        """Why so many workers compute, not as many as asked for."""
        there = f"this machine has {processors()} processor{'s' * (processors() > 1)}"
        if workers:
            return f"{workers} workers, not {asked}: {there if workers == processors() else 'a batch for each is left'}"
        if processors() < 2:
            return f"done without workers: {there}"
        if len(self._times) == 2:
            return "done without workers: what was left is one batch"
        return f"done without workers: {self.seconds:.0f} s of work, and they would take {_START:.0f} s to start"


def processors() -> int:
    """Of this machine."""
    return os.cpu_count() or 1
