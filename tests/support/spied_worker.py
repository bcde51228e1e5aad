"""Loaded by a worker of Dask when it starts: says which batches it computes, and does what a test asks for in one.

SPIED_LOG is a file that gets a line for each task, with its batch; SPIED_SECONDS is how long each takes at least. The
batch SPIED_CRASH, and more than SPIED_MOST cases, kill the worker; the batch SPIED_EAT fills its memory. SPIED_VERSION
is that of its wavesym; with SPIED_TOGETHER no task is done before so many have begun.
"""

from __future__ import annotations

import os
import signal
import time
from typing import Any

from wavesym.sweeps import worker

_COMPUTE = worker.compute


def _spied(batch: int, places: list[tuple[int, ...]]) -> None:
    with open(os.environ["SPIED_LOG"], "a", encoding="ascii") as log:
        log.write(f"{batch} {places}\n")
    time.sleep(float(os.environ.get("SPIED_SECONDS", "0")))
    while _begun() < int(os.environ.get("SPIED_TOGETHER", "0")):
        time.sleep(0.02)
    if os.environ.get("SPIED_CRASH") == str(batch) or len(places) > float(os.environ.get("SPIED_MOST", "inf")):
        os.kill(os.getpid(), signal.SIGKILL)
    if os.environ.get("SPIED_EAT") == str(batch):
        eaten = []
        while True:
            eaten.append(bytearray(b"x" * 2**24))
            time.sleep(0.02)


def _begun() -> int:
    with open(os.environ["SPIED_LOG"], encoding="ascii") as log:
        return len(log.readlines())


def compute(plan: Any, batches: Any, batch: int, places: list[tuple[int, ...]] | None = None) -> Any:
    _spied(batch, batches.places(batch) if places is None else places)
    return _COMPUTE(plan, batches, batch, places)


def dask_setup(_: object) -> None:
    worker.compute = compute
    worker.__version__ = os.environ.get("SPIED_VERSION", worker.__version__)
