"""Batches computed by the workers of a Dask cluster: its own processes on this machine, or one at an address.

The store is the truth, not the scheduler: few batches are under way at a time, and what has come is let go at once, so
that neither the scheduler nor this process grows with the sweep, and nothing that is done is done again when a worker
dies. A batch whose worker died is tried again by the scheduler; one that it gave up, in parts, when all else is sent.
"""

from __future__ import annotations

import logging
import sys
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from math import ceil, inf
from queue import Empty, SimpleQueue
from time import monotonic
from types import ModuleType
from typing import Any
from uuid import uuid4

from wavesym import __version__
from wavesym.errors import WavesymError
from wavesym.sweeps.batches import Batches, Task
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.store import require_packages
from wavesym.sweeps.values import BatchValues

_AHEAD = 3  # batches under way for each thread, so that none waits for this process
_DEATHS = 1  # of workers on this machine that a batch may survive, before it is given up
_PARTS = 16  # of what is given up
_WAIT = 30  # seconds for a scheduler to answer, and for a worker of it
_LOOK = 1.0  # seconds after which it is asked how many threads there are now
_DIED = "the worker that computed it died, again and again (a crash, or out of memory)"
Done = tuple[int, BatchValues]


class ClusterError(WavesymError):
    """A cluster that is not there, or is no longer; what is done is done."""

    status = 1


@contextmanager
def connect(workers: int | None, address: str | None) -> Iterator[Any]:
    """A client of the cluster at an address, or of so many processes on this machine. ClusterError."""
    require_packages("dask", "distributed")
    import dask
    from distributed import Client, LocalCluster

    with ExitStack() as stack:
        stack.enter_context(_quiet())
        if not address:
            # a worker that starts again takes long on a busy machine, and one that is given up never comes back
            patience = {"distributed.deploy.lost-worker-timeout": "1 hour"}
            stack.enter_context(dask.config.set({"distributed.scheduler.allowed-failures": _DEATHS, **patience}))
            stack.enter_context(_without_script())
            alone = {"threads_per_worker": 1, "dashboard_address": None, "silence_logs": logging.CRITICAL}
            try:
                address = stack.enter_context(LocalCluster(n_workers=workers, **alone))
            except (OSError, RuntimeError, TimeoutError) as error:
                raise ClusterError(
                    f"the workers of this machine do not start ({error}); started again, the sweep goes on where it was"
                ) from None
        try:
            client = Client(address, timeout=_WAIT, set_as_default=False)
        except (OSError, ValueError) as error:
            raise ClusterError(
                f"--scheduler: no Dask scheduler answers at {address} ({error}); write the address of one that does"
            ) from None
        yield stack.enter_context(client)


@contextmanager
def _without_script() -> Iterator[None]:
    """New processes do not run again the script that this one was started with, which may have no guard against it."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


@contextmanager
def _quiet() -> Iterator[None]:
    """What goes wrong is told in a line of our own, not in the log of Dask."""
    loggers = [logging.getLogger(name) for name in ("distributed", "distributed.client", "tornado")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def on_workers(client: Any, plan: SweepPlan, batches: Batches, todo: Iterable[Task]) -> Iterator[Done]:
    """The batches, or parts of them, as they are done, in any order.

    What its workers died of comes again in parts, side by side, one on each thread; a case that is left of these comes
    alone, so that no other one is blamed for it. ClusterError where the scheduler goes, or workers cannot do it.
    """
    from distributed import KilledWorker

    _send(client, plan, batches)
    sent = _TaskQueue(client, plan)
    waiting = _Waiting(batches, todo)
    last: Task | None = None
    while waiting or sent:
        while len(sent) < sent.threads * (_AHEAD if waiting.are_whole else 1) and (task := waiting.next_task()):
            sent.add(task)
        if not sent:
            sent.add(last := waiting.alone.popleft())
        if (found := sent.next_result()) is None:
            continue
        task, future = found
        try:
            values = _result(future)
            waiting.come(task)
            yield task[0], values
        except KilledWorker:
            if not waiting.give_up(task, last):
                yield task[0], _death(plan, task)
        future.release()


def _death(plan: SweepPlan, task: Task) -> BatchValues:
    """What comes of a case that kills its worker, alone."""
    _, places = task
    assert places
    values = BatchValues.empty(plan, places)
    values.failed[places[0]] = _DIED
    return values


class _Waiting:
    """Tasks that are not sent: whole batches first, then parts of what was given up, then cases `alone`.

    Workers may live too short for a batch. Where tasks are given up one after the other that are larger than any that
    came back, none so large is sent any more: each would have to be given up by itself, after several deaths.
    """

    def __init__(self, batches: Batches, todo: Iterable[Task]) -> None:
        self._batches = batches
        self._left, self._parts, self.alone = deque(todo), deque[Task](), deque[Task]()
        self._largest = 0  # of tasks that came back, in cases
        self._strikes = 0  # tasks larger than that, given up since one came back
        self._limit = inf

    def __bool__(self) -> bool:
        return bool(self._left or self._parts or self.alone)

    @property
    def are_whole(self) -> bool:
        """Whether the next one is a batch that nothing is known against: several of these are under way at a time."""
        return bool(self._left) and self._limit == inf

    def next_task(self) -> Task | None:
        """The next one that may go beside others; None where there is none."""
        first, second = (self._left, self._parts) if self._limit == inf else (self._parts, self._left)
        if not (queue := first or second):
            return None
        task = queue.popleft()
        most = max(self._limit, self._largest)
        while self._count(task) > most:
            queue.extendleft(reversed(self._in_parts(task, ceil(self._count(task) / most))))
            task = queue.popleft()
        return task

    def come(self, task: Task) -> None:
        """A task has come back."""
        self._largest, self._strikes = max(self._largest, self._count(task)), 0

    def give_up(self, task: Task, last: Task | None) -> bool:
        """Take again what workers died of; False for a case that was the `last` one alone."""
        if task == last:
            return False
        count, parts = self._count(task), self._in_parts(task, _PARTS)
        if count == 1:
            self.alone.extend(parts)
            return True
        self._parts.extend(parts)
        if count > self._largest:
            self._strikes += 1
            if self._strikes > 1:
                self._limit = min(self._limit, max(map(self._count, parts)))
        return True

    def _count(self, task: Task) -> int:
        batch, places = task
        return self._batches.count(batch) if places is None else len(places)

    def _in_parts(self, task: Task, count: int) -> list[Task]:
        batch, places = task
        places = self._batches.places(batch) if places is None else places
        return [(batch, part) for part in self._batches.cut(batch, places, count)]


class _TaskQueue:
    """Tasks that are under way; their futures are let go as they are done."""

    def __init__(self, client: Any, plan: SweepPlan) -> None:
        self._client, self._plan = client, plan
        self._tasks: dict[str, tuple[Task, Any]] = {}
        self._done = SimpleQueue[Any]()
        self._threads, self._asked = 0, -inf
        self._late = monotonic() + _WAIT  # when there has to be a worker

    def __len__(self) -> int:
        return len(self._tasks)

    @property
    def threads(self) -> int:
        """Of all workers, as many as there are now; 1 where there is none: a cluster may start one for a task."""
        self._count_threads()
        return max(self._threads, 1)

    def _count_threads(self) -> None:
        if monotonic() > self._asked + _LOOK:
            with suppress(OSError, TimeoutError):  # where the scheduler is gone, futures say so
                self._threads = sum(self._client.nthreads().values())
            self._asked = monotonic()
            self._late = inf if self._threads else self._late

    def add(self, task: Task) -> None:
        """Send a task."""
        from wavesym.sweeps.worker import compute_batch

        # a name of its own: what another client asked for is another task
        name = f"wavesym-{self._plan.sha256[:12]}-{task[0]}-{uuid4().hex[:12]}"
        future = self._client.submit(compute_batch, __version__, self._plan.sha256, *task, key=name, pure=False)
        self._tasks[name] = task, future
        future.add_done_callback(self._done.put)

    def next_result(self) -> tuple[Task, Any] | None:
        """A task and its future; None where there is none for a while. ClusterError where no worker ever came."""
        try:
            return self._tasks.pop(self._done.get(timeout=_LOOK).key)
        except Empty:
            self._count_threads()
            if monotonic() > self._late:
                raise ClusterError(f"no worker at the Dask scheduler for {_WAIT} s; start at least 1") from None
            return None


def _result(future: Any) -> BatchValues:
    """What came of it. KilledWorker where that killed its workers; ClusterError where there is nobody left to tell."""
    from distributed import KilledWorker

    try:
        values: BatchValues = future.result()
    except KilledWorker:
        raise
    except CancelledError:
        raise ClusterError("the Dask scheduler is gone; started again, the sweep goes on where it was") from None
    except WavesymError:
        raise
    except Exception as error:
        raise ClusterError(f"the workers cannot compute a batch: {type(error).__name__}: {error}") from None
    return values


def _send(client: Any, plan: SweepPlan, batches: Batches) -> None:
    """The plan to every worker there is, and to those that come, once."""
    from wavesym.sweeps.worker import SentPlan

    try:
        client.register_plugin(SentPlan(plan, batches))
    except Exception as error:  # of the worker's side: wavesym is missing there, or another version
        raise ClusterError(f"the workers cannot take the sweep: {type(error).__name__}: {error}") from None
