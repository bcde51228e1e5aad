"""A sweep carried out: what has no mark is computed, stored and marked. Starting and going on are the same."""

from __future__ import annotations

import hashlib
import os
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from filelock import FileLock, Timeout

from wavesym.errors import WavesymError
from wavesym.sweeps.batches import Batches, Place, Task, batches
from wavesym.sweeps.kinds import kind
from wavesym.sweeps.manifest import settle
from wavesym.sweeps.marks import BatchMark, FailedCase, Marks
from wavesym.sweeps.pace import Pace
from wavesym.sweeps.plan import SweepPlan, plan
from wavesym.sweeps.request import SweepRequest
from wavesym.sweeps.sealed_files import DamagedError, NoFileError
from wavesym.sweeps.status import status
from wavesym.sweeps.store import Store, require_packages
from wavesym.sweeps.values import BatchValues
from wavesym.sweeps.work import compute

Watch = Callable[[int, int, int], object]
"""Told of the cases: how many there are, are done, and were before this start."""
Tell = Callable[[str], object]
"""Told a line for whoever asked for the sweep."""


class Computing(NamedTuple):
    """Who computes: so many processes of this machine at most, a cluster at an address, or whoever is best."""

    workers: int | None = None
    scheduler: str | None = None


_WHOEVER = Computing()


def run(
    source: str | os.PathLike[str] | Mapping[str, Any],
    folder: str | os.PathLike[str],
    engine: Computing = _WHOEVER,
    retry_failed: bool = False,
    watch: Watch = lambda *_: None,
    tell: Tell = lambda _: None,
) -> int:
    """Compute what is left of a sweep into a folder; how many cases have failed.

    `tell` is told why fewer workers were started than `engine` asks for.

    WavesymError for a request that is wrong, a folder of another sweep, or one that another process works in.
    """
    file, request = SweepRequest.read(source)
    require_packages("zarr", *(("dask", "distributed") if (engine.workers or 1) > 1 else ()))
    planned = plan(request, file)
    parts = batches(planned, *kind(planned))
    place = Path(folder)
    with _lock_folder(place):
        store, marks = settle(place, planned, parts), Marks(place)
        todo = _remaining_batches(planned, store, marks, retry_failed)
        before = done = planned.cases - sum(len(places) if places else parts.count(batch) for batch, places in todo)
        watch(planned.cases, done, before)
        for batch, values in _compute(planned, parts, todo, engine, tell):
            keep(planned, store, marks, batch, values)
            done += len(values.places)
            watch(planned.cases, done, before)
        return status(place).failed


def _remaining_batches(planned: SweepPlan, store: Store, marks: Marks, retry_failed: bool) -> list[Task]:
    """The batches that have no mark, and what is left of those that are done in part. A mark whose chunks are not what
    it says is removed."""
    left: list[Task] = []
    for batch in range(len(store.batches)):
        name = store.batches.mark(planned.sha256, batch)
        try:
            mark = marks.get(name, store.batches, batch)
        except NoFileError:
            raise
        except DamagedError:
            mark = None  # as if there were none
        if mark and not store.damaged_chunks(batch, mark):
            if mark.coming:
                marks.put(name, mark.model_copy(update={"chunks": store.hashes(batch), "coming": {}}))
            if again := {*mark.left, *(failed.case for failed in mark.failed if retry_failed)}:
                every = store.batches.places(batch)
                left.append((batch, [place for place in every if planned.number(place) in again]))
            continue
        marks.remove(name)
        left.append((batch, None))
    return left


def keep(planned: SweepPlan, store: Store, marks: Marks, batch: int, values: BatchValues) -> None:
    """First the chunks, then the mark. What else is known of the batch stays, and holds while chunks are replaced."""
    parts, name = store.batches, store.batches.mark(planned.sha256, batch)
    before, left = marks.get(name, parts, batch), set[Place]()
    if len(values.places) < parts.count(batch):
        values, left = _join_marks(planned, store, before, batch, values)
    chunks = store.chunks(batch, values.arrays)
    hashes = {each: None if data is None else hashlib.sha256(data).hexdigest() for each, data in chunks.items()}
    if before:
        marks.put(name, before.model_copy(update={"coming": hashes}))
    store.write(batch, chunks)
    mark = BatchMark(
        batch=batch,
        cases=parts.count(batch),
        chunks=hashes,
        how=dict(sorted(values.how.items())),
        failed=[
            FailedCase(case=planned.number(place), values=planned.labels_at(place), reason=reason)
            for place, reason in sorted(values.failed.items())
        ],
        left=sorted(map(planned.number, left)),
    )
    marks.put(name, mark)


def _join_marks(
    planned: SweepPlan, store: Store, mark: BatchMark | None, batch: int, values: BatchValues
) -> tuple[BatchValues, set[Place]]:
    """A batch with what its mark has and what is new, and what is left of it."""
    whole = BatchValues.empty(planned, store.batches.places(batch))
    left = set(whole.places)
    if mark:
        place = {planned.number(each): each for each in whole.places}
        left = {place[case] for case in mark.left if case in place}
        shape = {name: (len(whole.places), *rest) for name, rest in store.arrays.items()}
        whole.arrays = {name: store.read(name, batch).reshape(each).copy() for name, each in shape.items()}
        whole.failed = {place[each.case]: each.reason for each in mark.failed if each.case in place}
        whole.how = dict(mark.how)
    whole.join(values)
    return whole, left - set(values.places)


def _compute(
    planned: SweepPlan, parts: Batches, todo: Iterable[Task], engine: Computing, tell: Tell
) -> Iterator[tuple[int, BatchValues]]:
    """The batches by whoever is to compute them: this process, as long as workers would not be done sooner."""
    left, workers = deque(todo), None
    if left and not engine.scheduler:
        pace = Pace(len(left))
        workers = yield from _compute_here(planned, parts, left, pace, engine.workers)
        if (asked := engine.workers or 1) not in (1, workers):
            tell(pace.explain(asked, workers))
    if left:
        from wavesym.sweeps.cluster import connect, on_workers

        with connect(workers, engine.scheduler) as client:
            yield from on_workers(client, planned, parts, left)


def _compute_here(
    planned: SweepPlan, parts: Batches, left: deque[Task], pace: Pace, most: int | None
) -> Generator[tuple[int, BatchValues], None, int]:
    """The batches taken from those left, until workers are worth it; how many workers."""
    while left:
        batch, places = left.popleft()
        yield batch, compute(planned, parts, batch, places)
        pace.tick()
        if workers := pace.useful_workers(most):
            return workers
    return 0


@contextmanager
def _lock_folder(folder: Path) -> Iterator[None]:
    """No other process works in the folder meanwhile."""
    folder.mkdir(parents=True, exist_ok=True)
    lock = FileLock(folder / ".lock", timeout=0, fallback_to_soft=False)
    try:
        lock.acquire()
    except Timeout:
        raise WavesymError(f"{folder}: another process computes into it; wait, or write another folder") from None
    try:
        yield
    finally:
        (folder / ".lock").unlink(missing_ok=True)
        lock.release()
