"""How many tasks a cluster is given at a time: by a client that only counts them, one thread a worker."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("distributed", reason="the extra `sweep` is not installed")

import distributed

from wavesym.sweeps import cluster
from wavesym.sweeps.batches import Batches, Place, Task, batches
from wavesym.sweeps.plan import SweepPlan, plan
from wavesym.sweeps.request import SweepRequest
from wavesym.sweeps.values import BatchValues

SWEEP = """
scene = "drive_m1"
[vary]
"output.until" = { from = 4, to = 12, count = 64 }
"""


class Future:
    """A task: it is done when the cluster says so."""

    def __init__(self, crew: Crew, task: Task, key: str) -> None:
        self.crew, self.task, self.key = crew, task, key
        self.tell: Callable[[Future], object] = lambda _: None

    def add_done_callback(self, tell: Callable[[Future], object]) -> None:
        self.tell = tell

    def result(self) -> BatchValues:
        batch, places = self.task
        if places is None and batch in self.crew.deadly:
            raise distributed.KilledWorker(self.key, None, 1)
        return BatchValues.empty(self.crew.plan, places or self.crew.batches.places(batch))

    def release(self) -> None:
        self.crew.under_way -= 1


class Crew:
    """A cluster of `threads[0]` threads, of `threads[1]` when it was asked once more, and so on.

    A task is done when the sweep waits for one, the oldest first. `most` were under way at the same time, `most_parts`
    when parts of batches were.
    """

    def __init__(self, planned: SweepPlan, parts: Batches, threads: list[int], deadly: set[int]) -> None:
        self.plan, self.batches, self.deadly = planned, parts, deadly
        self.threads = deque(threads)
        self.waiting = deque[Future]()
        self.under_way = self.most = 0
        self.parts: list[list[Place]] = []
        self.most_parts = 0

    def register_plugin(self, _: object) -> None:
        pass

    def nthreads(self) -> dict[str, int]:
        return {"here": self.threads.popleft() if len(self.threads) > 1 else self.threads[0]}

    def finish_one(self) -> None:
        done = self.waiting.popleft()
        done.tell(done)

    def submit(self, _: object, __: str, ___: str, batch: int, places: list[Place] | None, **how: Any) -> Future:
        self.waiting.append(Future(self, (batch, places), how["key"]))
        self.under_way += 1
        self.most = max(self.most, self.under_way)
        if places is not None:
            self.parts.append(places)
            self.most_parts = max(self.most_parts, self.under_way)
        return self.waiting[-1]


@pytest.fixture
def sweep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[SweepPlan, Batches]:
    monkeypatch.setattr(cluster, "_LOOK", 0.0)
    (tmp_path / "sweep.toml").write_text(SWEEP)
    planned = plan(*reversed(SweepRequest.read(tmp_path / "sweep.toml")))
    return planned, batches(planned, "single")


def fed(crew: Crew, parts: Batches, monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, BatchValues]]:
    waits = cluster._TaskQueue.next_result

    def next_done(sent: cluster._Sent) -> Any:
        crew.finish_one()
        return waits(sent)

    with monkeypatch.context() as patch:
        patch.setattr(cluster._TaskQueue, "next_result", next_done)
        return list(cluster.on_workers(crew, crew.plan, parts, [(k, None) for k in range(len(parts))]))


def test_a_cluster_is_given_as_much_as_its_present_threads_want(
    sweep: tuple[SweepPlan, Batches], monkeypatch: pytest.MonkeyPatch
) -> None:
    planned, parts = sweep
    for threads, most in (([2], 2 * cluster._AHEAD), ([2] * 20 + [5], 5 * cluster._AHEAD)):
        crew = Crew(planned, parts, threads, set())
        assert sorted(batch for batch, _ in fed(crew, parts, monkeypatch)) == list(range(len(parts)))
        assert crew.most == most
        assert crew.under_way == 0


def test_a_cluster_that_starts_workers_for_tasks_has_tasks_first(
    sweep: tuple[SweepPlan, Batches], monkeypatch: pytest.MonkeyPatch
) -> None:
    planned, parts = sweep
    crew = Crew(planned, parts, [0, 0, 0, 2], set())
    assert len(fed(crew, parts, monkeypatch)) == len(parts)
    assert crew.most == 2 * cluster._AHEAD


def test_a_cluster_without_workers_is_told_of(
    sweep: tuple[SweepPlan, Batches], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "_WAIT", 0)
    planned, parts = sweep
    crew = Crew(planned, parts, [0], set())
    with pytest.raises(cluster.ClusterError, match="no worker at the Dask scheduler for 0 s; start at least 1"):
        list(cluster.on_workers(crew, planned, parts, [(0, None)]))
    assert crew.under_way == cluster._AHEAD - 2


def test_batches_that_were_given_up_come_in_parts_side_by_side(
    sweep: tuple[SweepPlan, Batches], monkeypatch: pytest.MonkeyPatch
) -> None:
    planned, _ = sweep
    parts = Batches("single", planned.shape, (32,))
    crew = Crew(planned, parts, [4], {0, 1})
    found = fed(crew, parts, monkeypatch)
    assert sorted(place for _, values in found for place in values.places) == [(k,) for k in range(64)]
    assert {len(places) for places in crew.parts} == {32 // cluster._PARTS}
    assert crew.most_parts == 4
