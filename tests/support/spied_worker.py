"""Loaded by a worker of Dask when it starts: says which batches it computes, and does what a test asks for in one.

SPIED_LOG is a file that gets a line for each batch; SPIED_SECONDS is how long each takes at least; the batch
SPIED_CRASH kills the worker, and the batch SPIED_EAT fills its memory. SPIED_VERSION is that of its wavesym.
"""

from __future__ import annotations

import os
import signal
import time
from typing import Any

from wavesym.sweeps import worker

_COMPUTE, _COMPUTE_CASE = worker.compute, worker.compute_case


def _spied(batch: int, place: object) -> None:
    with open(os.environ["SPIED_LOG"], "a", encoding="ascii") as log:
        log.write(f"{batch} {place}\n")
    time.sleep(float(os.environ.get("SPIED_SECONDS", "0")))
    if os.environ.get("SPIED_CRASH") == str(batch):
        os.kill(os.getpid(), signal.SIGKILL)
    if os.environ.get("SPIED_EAT") == str(batch):
        eaten = []
        while True:
            eaten.append(bytearray(b"x" * 2**24))
            time.sleep(0.02)


def compute(plan: Any, batches: Any, batch: int) -> Any:
    _spied(batch, None)
    return _COMPUTE(plan, batches, batch)


def compute_case(plan: Any, batches: Any, batch: int, place: tuple[int, ...]) -> Any:
    _spied(batch, place)
    return _COMPUTE_CASE(plan, batches, batch, place)


def dask_setup(_: object) -> None:
    worker.compute, worker.compute_case = compute, compute_case
    worker.__version__ = os.environ.get("SPIED_VERSION", worker.__version__)
