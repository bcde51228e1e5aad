"""A sweep carried out: what has no mark is computed, stored and marked. Starting and going on are the same."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from time import monotonic
from typing import Any, NamedTuple

from filelock import FileLock, Timeout

from wavesym.errors import WavesymError
from wavesym.sweeps.batches import Batches, batches
from wavesym.sweeps.kinds import kind
from wavesym.sweeps.manifest import settle
from wavesym.sweeps.marks import Marks
from wavesym.sweeps.plan import SweepPlan, plan
from wavesym.sweeps.request import SweepRequest
from wavesym.sweeps.store import Store, needed
from wavesym.sweeps.values import BatchValues
from wavesym.sweeps.work import compute

_PATIENCE = 10.0  # seconds that a sweep may take, as far as can be seen, before more processes are started

Watch = Callable[[int, int, int], object]
"""Told of the cases: how many there are, are done, and were before this start."""


class Computing(NamedTuple):
    """Who computes: so many processes of this machine, a cluster at an address, or whoever is best."""

    workers: int | None = None
    scheduler: str | None = None


_WHOEVER = Computing()


def run(
    source: str | os.PathLike[str] | Mapping[str, Any],
    folder: str | os.PathLike[str],
    engine: Computing = _WHOEVER,
    retry_failed: bool = False,
    watch: Watch = lambda *_: None,
) -> int:
    """Compute what is left of a sweep into a folder; how many cases have failed.

    WavesymError for a request that is wrong, a folder of another sweep, or one that another process works in.
    """
    file, request = SweepRequest.read(source)
    needed("zarr")
    planned = plan(request, file)
    parts = batches(planned, *kind(planned))
    place = Path(folder)
    with _alone(place):
        store, marks = settle(place, planned, parts), Marks(place)
        todo = _left(store, marks, retry_failed)
        before = planned.cases - sum(len(parts.places(batch)) for batch in todo)
        done = before
        watch(planned.cases, done, before)
        for batch, values in _computed(planned, parts, todo, engine):
            keep(store, marks, batch, values)
            done += len(parts.places(batch))
            watch(planned.cases, done, before)
        return sum(len(mark["failed"]) for mark in marks.every())


def _left(store: Store, marks: Marks, retry_failed: bool) -> list[int]:
    """The batches that have no mark, or whose chunks are not what the mark says."""
    names = marks.names()
    left = []
    for batch in range(len(store.batches)):
        name = store.batches.mark(store.plan, batch)
        mark = marks.get(name) if name in names else None
        if mark and mark["chunks"] == store.hashes(batch) and not (retry_failed and mark["failed"]):
            continue
        left.append(batch)
    return left


def keep(store: Store, marks: Marks, batch: int, values: BatchValues) -> None:
    """First the chunks, then the mark."""
    parts, planned = store.batches, store.plan
    numbers = {place: planned.number(place) for place in values.failed}
    marks.put(
        parts.mark(planned, batch),
        {
            "batch": batch,
            "cases": len(parts.places(batch)),
            "chunks": store.write(batch, values),
            "how": dict(sorted(values.how.items())),
            "failed": [
                {"case": numbers[place], "values": planned.told(place), "reason": reason}
                for place, reason in sorted(values.failed.items())
            ],
        },
    )


def _computed(
    planned: SweepPlan, parts: Batches, todo: Iterable[int], engine: Computing
) -> Iterator[tuple[int, BatchValues]]:
    """The batches by whoever is to compute them: this process, as long as that does not take long."""
    left = deque(todo)
    if not (engine.workers or engine.scheduler):
        times = [monotonic()]
        while left:
            batch = left.popleft()
            yield batch, compute(planned, parts, batch)
            times.append(monotonic())
            if _estimate(times) * len(left) > _PATIENCE and _several():
                break
    if left:
        from wavesym.sweeps.cluster import connected, on_workers

        with connected(engine.workers or os.cpu_count(), engine.scheduler) as client:
            yield from on_workers(client, planned, parts, left)


def _estimate(times: list[float]) -> float:
    """Seconds for a batch, from when each was done. The first one has much to do that is done once."""
    first, rest = times[1] - times[0], times[-1] - times[1]
    return rest / (len(times) - 2) if len(times) > 2 else first / _PATIENCE


def _several() -> bool:
    """Whether more than one process would be faster, and there is what starts them."""
    return (os.cpu_count() or 1) > 1 and find_spec("distributed") is not None


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """No other process works in the folder meanwhile."""
    folder.mkdir(parents=True, exist_ok=True)
    lock = FileLock(folder / ".lock", timeout=0, fallback_to_soft=False)
    try:
        lock.acquire()
    except Timeout:
        raise WavesymError(f"{folder}: another process computes into it, one at a time expected") from None
    try:
        yield
    finally:
        (folder / ".lock").unlink(missing_ok=True)
        lock.release()
