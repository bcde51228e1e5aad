"""Batches computed by the workers of a Dask cluster: its own processes on this machine, or one at an address.

The store is the truth, not the scheduler: few batches are under way at a time, and what has come is let go at once, so
that neither the scheduler nor this process grows with the sweep, and nothing that is done is done again when a worker
dies. A batch whose worker died is tried again by the scheduler; one that it gave up, case by case, when all else is
done.
"""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager
from itertools import islice
from types import ModuleType
from typing import Any
from uuid import uuid4

from wavesym import __version__
from wavesym.errors import WavesymError
from wavesym.sweeps.batches import Batches
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.store import needed
from wavesym.sweeps.values import BatchValues

_AHEAD = 3  # batches under way for each thread, so that none waits for this process
_DEATHS = 1  # of workers on this machine that a batch may survive, before it is given up
_WAIT = 30  # seconds for a scheduler to answer, and for a worker of it
Done = tuple[int, BatchValues]


class ClusterError(WavesymError):
    """A cluster that is not there, or is no longer; what is done is done."""

    status = 1


@contextmanager
def connected(workers: int | None, address: str | None) -> Iterator[Any]:
    """A client of the cluster at an address, or of so many processes on this machine. ClusterError."""
    needed("dask", "distributed")
    import dask
    from distributed import Client, LocalCluster

    with ExitStack() as stack:
        stack.enter_context(_quiet())
        if not address:
            stack.enter_context(dask.config.set({"distributed.scheduler.allowed-failures": _DEATHS}))
            stack.enter_context(_without_script())
            alone = {"threads_per_worker": 1, "dashboard_address": None, "silence_logs": logging.CRITICAL}
            address = stack.enter_context(LocalCluster(n_workers=workers, **alone))
        try:
            client = Client(address, timeout=_WAIT, set_as_default=False)
        except (OSError, ValueError) as error:
            expected = "the address of a Dask scheduler that answers expected"
            raise ClusterError(f"--scheduler: {address} given, {expected} ({error})") from None
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


def on_workers(client: Any, plan: SweepPlan, batches: Batches, todo: Iterable[int]) -> Iterator[Done]:
    """The batches as they are done, in any order. ClusterError where the scheduler goes, or workers cannot do it."""
    from distributed import KilledWorker

    _send(client, plan, batches)
    given_up = []
    for batch, future in _done(client, plan, ((batch,) for batch in todo)):
        try:
            yield batch[0], _result(future)
        except KilledWorker:
            given_up.append(batch[0])
    for batch in given_up:
        yield batch, _one_by_one(client, plan, batches, batch)


def _one_by_one(client: Any, plan: SweepPlan, batches: Batches, batch: int) -> BatchValues:
    """A batch that killed its workers: each case alone, so that only what does it fails."""
    from distributed import KilledWorker

    whole = BatchValues.empty(plan, batches.region(batch))
    for place in batches.places(batch):
        for _, future in _done(client, plan, [(batch, place)], ahead=1):
            try:
                whole.join(batches.region(batch), place, _result(future))
            except KilledWorker:
                whole.failed[place] = "the worker that computed it died, again and again (a crash, or out of memory)"
    return whole


def _done(
    client: Any, plan: SweepPlan, tasks: Iterable[tuple[Any, ...]], ahead: int | None = None
) -> Iterator[tuple[Any, Any]]:
    """Tasks with their futures as they are done; no future is held longer."""
    from distributed import as_completed

    from wavesym.sweeps.worker import computed

    ahead = ahead or _AHEAD * _threads(client)
    left, waiting, under_way = iter(tasks), {}, as_completed(loop=client.loop)

    def send(count: int) -> None:
        for task in islice(left, count):
            # a name of its own: what another client asked for is another task
            name = f"wavesym-{plan.sha256[:12]}-{task[0]}-{uuid4().hex[:12]}"
            future = client.submit(computed, __version__, plan.sha256, *task, key=name, pure=False)
            waiting[name] = task
            under_way.add(future)

    send(ahead)
    for future in under_way:
        yield waiting.pop(future.key), future
        future.release()
        send(1)


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


def _threads(client: Any) -> int:
    """Of all workers. ClusterError where there is none."""
    try:
        client.wait_for_workers(1, timeout=_WAIT)
    except TimeoutError:
        raise ClusterError(f"no worker at the Dask scheduler for {_WAIT} s, at least 1 expected") from None
    return sum(client.nthreads().values())


def _send(client: Any, plan: SweepPlan, batches: Batches) -> None:
    """The plan to every worker there is, and to those that come, once."""
    from wavesym.sweeps.worker import SentPlan

    try:
        client.register_plugin(SentPlan(plan, batches))
    except Exception as error:  # of the worker's side: wavesym is missing there, or another version
        raise ClusterError(f"the workers cannot take the sweep: {type(error).__name__}: {error}") from None
