"""Batches that workers died of: in parts, side by side, each part marked as it is done; what kills again is alone."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `sweep` is not installed")
pytest.importorskip("distributed", reason="the extra `sweep` is not installed")

from distributed import KilledWorker

from tests.sweeps.test_cluster import files
from tests.sweeps.test_store import fake
from wavesym.sweeps import batches as cutting
from wavesym.sweeps import cluster, marks, pace, store, work
from wavesym.sweeps.batches import Batches, Task
from wavesym.sweeps.results import results
from wavesym.sweeps.running import Computing, run
from wavesym.sweeps.status import status

CASES = 40
SWEEP: dict[str, Any] = {"scene": "drive_m1", "vary": {"output.until": {"from": 4, "to": 43, "count": CASES}}}


class Client:
    """A cluster of threads, as many as `threads` says of the number of tasks that were sent; `dies` says which tasks
    kill their worker."""

    loop = None

    def __init__(self, dies: Callable[[Any], bool], threads: Callable[[int], int] = lambda sent: 2) -> None:
        self.dies, self.threads, self.pool = dies, threads, ThreadPoolExecutor(1)
        self.sent: list[Task] = []
        self.under_way = 0
        self.most: list[int] = []

    def register_plugin(self, plugin: Any) -> None:
        self.plan, self.batches = plugin.plan, plugin.batches

    def nthreads(self) -> dict[str, int]:
        return {"worker": self.threads(len(self.sent))}

    def submit(self, _: Any, version: str, sha256: str, batch: int, places: Any, key: str, pure: bool) -> Any:
        self.sent.append((batch, places))
        self.under_way += 1
        self.most.append(self.under_way)
        given = places or self.batches.places(batch)

        future = SimpleNamespace(key=key, release=self.released)

        def done(put: Callable[[Any], None]) -> None:
            time.sleep(0.002)
            try:
                if self.dies(given):
                    raise KilledWorker("task", SimpleNamespace(address=""), 1)
                values = work.compute(self.plan, self.batches, batch, places)
                future.result = lambda: values
            except Exception as error:
                future.result = partial(raised, error)
            put(future)

        future.add_done_callback = partial(self.pool.submit, done)
        return future

    def released(self) -> None:
        self.under_way -= 1


def raised(error: Exception) -> None:
    raise error


@pytest.fixture
def swept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[..., Client]:
    """Computes the sweep, all in one batch, by such a cluster."""
    monkeypatch.setattr(cutting, "_MOST_BATCHES", 1)
    monkeypatch.setattr(work, "single", fake_summary)
    monkeypatch.setattr(pace, "processors", lambda: 1)
    monkeypatch.setattr(cluster, "_LOOK", 0.001)
    run(SWEEP, tmp_path / "alone")

    def computed(client: Client, **options: Any) -> Client:
        @contextmanager
        def connected(*_: Any) -> Iterator[Any]:
            yield client

        monkeypatch.setattr(cluster, "connect", connected)
        run(SWEEP, tmp_path / "out", Computing(scheduler="fake"), **options)
        return client

    return computed


def fake_summary(plan: Any, scene: Any) -> Any:
    case = fake(plan, scene)
    return type(case)({name: values for name, values in case.arrays.items() if name != "history"}, case.how)


def test_what_is_given_up_comes_in_parts_and_gives_the_same(swept: Callable[..., Client], tmp_path: Path) -> None:
    """Workers that do not live long enough for more than three cases."""
    client = swept(Client(dies=lambda places: len(places) > 3))
    assert [len(places or range(CASES)) for _, places in client.sent] == [CASES] + [3] * 13 + [1]
    assert max(client.most) == 2  # side by side: one on each thread
    assert files(tmp_path / "out") == files(tmp_path / "alone")


def test_workers_that_live_too_short_are_sent_no_more_batches(
    swept: Callable[..., Client], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Each batch would be given up by itself, after several deaths, before the first part is computed."""
    monkeypatch.setattr(cutting, "_MOST_BATCHES", 10)
    run(SWEEP, tmp_path / "batches")
    client = swept(Client(dies=lambda places: len(places) > 1, threads=lambda sent: 1))
    sizes = [len(places or range(4)) for _, places in client.sent]
    assert sizes.count(4) <= 4  # three under way at first, one when the first of these is given up
    assert sizes == sorted(sizes, reverse=True)
    assert sizes.count(1) == CASES
    assert client.most[-1] == 1
    assert files(tmp_path / "out") == files(tmp_path / "batches")


def test_parts_get_smaller_for_all_that_waits(swept: Callable[..., Client], tmp_path: Path) -> None:
    """Two parts of three are given up; those that wait are cut, and not given up each."""
    client = swept(Client(dies=lambda places: len(places) > 1, threads=lambda sent: 1))
    sizes = [len(places or range(CASES)) for _, places in client.sent]
    assert sizes[:3] == [CASES, 3, 1] or sizes[:3] == [CASES, 3, 3]
    assert sizes.count(3) <= 2
    assert sizes.count(1) == CASES
    assert files(tmp_path / "out") == files(tmp_path / "alone")


def test_a_case_that_kills_leaves_the_other_batches_whole(
    swept: Callable[..., Client], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(cutting, "_MOST_BATCHES", 10)
    client = swept(Client(dies=lambda places: (1,) in places, threads=lambda sent: 1))
    found = status(tmp_path / "out")
    assert (found.done, found.failed, found.left) == (CASES - 1, 1, 0)
    assert [batch for batch, places in client.sent if places is None] == list(range(10))


@pytest.mark.parametrize(("kind", "sizes"), [("recorded", [64, 64, 64, 8]), ("single", [13] * 15 + [5])])
def test_parts_have_groups_that_share_work_whole(kind: str, sizes: list[int]) -> None:
    """A part of a group takes as long as all of it."""
    batches = Batches(kind, (200,), (200,))
    parts = batches.cut(0, batches.places(0), 16)
    assert [len(part) for part in parts] == sizes
    assert [place for part in parts for place in part] == batches.places(0)
    (group, *_) = batches.groups(0)
    assert [len(part) for part in batches.cut(0, group, 16)] == [4] * 16


def test_a_case_that_kills_whatever_is_beside_it_is_the_only_one_that_fails(
    swept: Callable[..., Client], tmp_path: Path
) -> None:
    client = swept(Client(dies=lambda places: (7,) in places))
    found = status(tmp_path / "out")
    assert (found.done, found.failed, found.left) == (CASES - 1, 1, 0)
    assert found.reasons[0]["case"] == 7
    assert "died" in found.reasons[0]["reason"]
    assert client.sent[-1] == (0, [(7,)])  # once more, when nothing else was under way
    assert client.most[-1] == 1
    swept(again := Client(dies=lambda places: False), retry_failed=True)
    assert again.sent == [(0, [(7,)])]
    assert files(tmp_path / "out") == files(tmp_path / "alone")


def test_a_case_that_kills_and_is_a_batch_is_the_only_one_that_fails(
    swept: Callable[..., Client], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(cutting, "_MOST_BATCHES", CASES)
    client = swept(Client(dies=lambda places: (7,) in places))
    found = status(tmp_path / "out")
    assert (found.done, found.failed, found.left) == (CASES - 1, 1, 0)
    assert client.sent.count((7, None)) == 1
    assert client.sent[-1] == (7, [(7,)])
    assert client.most[-1] == 1


def test_a_case_that_dies_for_others_does_not_fail(swept: Callable[..., Client], tmp_path: Path) -> None:
    """As of a worker that is killed from outside: the third time it lives."""
    deaths = iter([True, True, True])
    swept(Client(dies=lambda places: (7,) in places and next(deaths, False)))
    assert status(tmp_path / "out").failed == 0
    assert files(tmp_path / "out") == files(tmp_path / "alone")


def test_parts_that_are_done_stay_done(swept: Callable[..., Client], tmp_path: Path) -> None:
    class Gone(Exception):
        pass

    def dies(places: Any) -> bool:
        if (30,) in places and len(places) < CASES:
            raise Gone
        return len(places) > 3

    with pytest.raises(Exception, match="Gone"):
        swept(Client(dies, threads=lambda sent: 1))
    found = status(tmp_path / "out")
    assert (found.done, found.failed, found.left) == (30, 0, 10)
    client = swept(Client(dies=lambda places: False))
    assert client.sent == [(0, [(case,) for case in range(30, CASES)])]
    assert files(tmp_path / "out") == files(tmp_path / "alone")


def test_a_cluster_that_grows_is_fed_as_it_is_now(
    swept: Callable[..., Client], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(cutting, "_MOST_BATCHES", 5000)
    client = swept(Client(dies=lambda places: False, threads=lambda sent: 1 if sent < 10 else 4))
    assert max(client.most[:9]) == 3
    assert max(client.most) == 12  # three for each thread
    assert np.all(np.diff([batch for batch, _ in client.sent]) > 0)
    assert status(tmp_path / "out").done == CASES


def interrupted(swept: Callable[..., Client], monkeypatch: pytest.MonkeyPatch, chunks: int) -> None:
    """The sweep, in parts of three, killed when so many chunks of its fifth part are in their places."""

    class Killed(BaseException):
        pass

    right, parts = store.Store.write, []

    def write(self: Any, batch: int, made: Any) -> None:
        parts.append(batch)
        if len(parts) < 5:
            return right(self, batch, made)
        right(self, batch, dict(list(made.items())[:chunks]))
        raise Killed

    with monkeypatch.context() as patch:
        patch.setattr(store.Store, "write", write)
        with pytest.raises(Killed):
            swept(Client(dies=lambda places: len(places) > 3, threads=lambda sent: 1))


@pytest.mark.parametrize("chunks", [0, 1, 3, 99])
def test_parts_stay_done_when_the_next_one_is_cut_off(
    swept: Callable[..., Client], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, chunks: int
) -> None:
    """Its chunks are put in the places of those of the parts before, one after the other."""
    interrupted(swept, monkeypatch, chunks)
    assert results(tmp_path / "out").status.done == status(tmp_path / "out").done == 12
    interrupted(swept, monkeypatch, 2)  # and again, from there: four more parts, of two
    assert results(tmp_path / "out").status.done == 20
    client = swept(Client(dies=lambda places: False))
    assert client.sent == [(0, [(case,) for case in range(20, CASES)])]
    assert files(tmp_path / "out") == files(tmp_path / "alone")


def test_a_sweep_that_goes_on_is_not_damaged(
    swept: Callable[..., Client], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Whoever reads finds chunks of now beside a mark that was read before."""
    interrupted(swept, monkeypatch, 1)
    right, looks = marks.Marks.get, []

    def get(self: marks.Marks, *which: Any) -> Any:
        found = right(self, *which)
        if not looks:  # as it was read before the last part
            looks.append(found)
            swept(Client(dies=lambda places: False))
        return found

    monkeypatch.setattr(marks.Marks, "get", get)
    assert results(tmp_path / "out").status.done == CASES
    assert looks[0].left


def test_workers_that_do_not_start_are_said_in_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where one is killed while it does."""

    def nobody(**_: object) -> None:
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr("distributed.LocalCluster", nobody)
    with pytest.raises(cluster.ClusterError, match=r"do not start \(Nanny failed to start"), cluster.connect(2, None):
        pass


def test_a_draft_that_has_come_to_its_place_is_no_damage(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "kept").touch()
    monkeypatch.setattr(store.os, "walk", lambda path: [(str(path), [], ["kept", ".0.part"])])
    assert store.folder_content(tmp_path) == {"kept"}
