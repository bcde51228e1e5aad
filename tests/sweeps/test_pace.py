"""Workers are started where that is done sooner: what is started is counted, by a clock that counts batches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("distributed", reason="the extra `sweep` is not installed")

import wavesym
from wavesym.cli import main
from wavesym.sweeps import cluster, pace, running, work
from wavesym.sweeps.running import Computing, run

CASES = 40
SWEEP: dict[str, Any] = {"scene": "drive_m1", "vary": {"output.until": {"from": 4, "to": 12, "count": CASES}}}


class Machine:
    """Four processors; a batch takes the seconds that a test says, and workers none. `started` counts these."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.clock, self.here, self.processors = 0.0, 0, 4
        self.seconds: Sequence[float] = [1.0] * CASES
        self.started: list[int] = []
        patch.setattr(pace, "process_time", lambda: self.clock)
        patch.setattr(pace, "processors", lambda: self.processors)
        patch.setattr(running, "compute", self.compute)
        patch.setattr(cluster, "connect", self.connect)
        patch.setattr(cluster, "on_workers", self.on_workers)
        patch.setattr(work, "single", lambda *_: (_ for _ in ()).throw(wavesym.WavesymError("costs nothing")))

    def compute(self, plan: Any, batches: Any, batch: int, places: Any = None) -> Any:
        self.clock += self.seconds[self.here]
        self.here += 1
        return work.compute(plan, batches, batch, places)

    @contextmanager
    def connect(self, workers: int, address: str | None) -> Iterator[None]:
        self.started.append(workers)
        yield

    def on_workers(self, client: object, plan: Any, batches: Any, todo: Any) -> Iterator[Any]:
        return ((batch, work.compute(plan, batches, batch, places)) for batch, places in todo)


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> Machine:
    return Machine(monkeypatch)


def swept(folder: Path, workers: int | None) -> list[str]:
    """What is told of the workers asked for, when all cases are met."""
    told: list[str] = []
    assert run(SWEEP, folder, Computing(workers), tell=told.append) == CASES
    return told


@pytest.mark.parametrize("workers", [None, 1, 2, 4, 8])
def test_a_sweep_that_is_shorter_than_workers_start_starts_none(
    tmp_path: Path, machine: Machine, workers: int | None
) -> None:
    machine.seconds = [3, *[0.2] * (CASES - 1)]
    told = swept(tmp_path, workers)
    assert (machine.here, machine.started) == (CASES, [])
    said = ["done without workers: 11 s of work, and they would take 10 s to start"]
    assert told == (said if workers not in (None, 1) else [])


@pytest.mark.parametrize(
    ("workers", "started", "told"),
    [
        (None, [4], []),
        (1, [], []),
        (2, [2], []),
        (4, [4], []),
        (8, [4], ["4 workers, not 8: this machine has 4 processors"]),
    ],
)
def test_of_a_long_one_so_many_are_started_as_are_asked_for_and_there(
    tmp_path: Path, machine: Machine, workers: int | None, started: list[int], told: list[str]
) -> None:
    """Of 40 s, or of 39 when the first batch was measured, two workers save more than the ten that they start."""
    assert swept(tmp_path, workers) == told
    assert machine.started == started
    assert machine.here == (2 if started else CASES)


def test_two_workers_need_more_work_than_four(tmp_path: Path, machine: Machine) -> None:
    """They save half of it, these three quarters: of some 15 s more than their start."""
    machine.seconds = [0.4] * CASES
    for workers in (2, 4):
        swept(tmp_path / str(workers), workers)
        machine.here = 0
    assert machine.started == [4]


def test_a_first_batch_that_loads_much_starts_none(tmp_path: Path, machine: Machine) -> None:
    machine.seconds = [60, *[0.05] * (CASES - 1)]
    swept(tmp_path, None)
    assert machine.started == []


def test_batches_that_grow_long_start_them_later(tmp_path: Path, machine: Machine) -> None:
    machine.seconds = [*[0.1] * 10, *[5.0] * (CASES - 10)]
    assert swept(tmp_path, 4) == []
    assert machine.started == [4]
    assert 10 < machine.here < 15


def test_no_more_than_batches(tmp_path: Path, machine: Machine) -> None:
    machine.seconds = [1.0] * (CASES - 4) + [60.0] * 4
    machine.processors = 1
    assert swept(tmp_path / "one", 8) == ["done without workers: this machine has 1 processor"]
    machine.processors, machine.here = 16, 0
    machine.seconds = [0.0] * (CASES - 4) + [900.0] * 4
    assert swept(tmp_path / "many", 8) == ["3 workers, not 8: a batch for each is left"]


def test_one_batch_is_computed_here(tmp_path: Path, machine: Machine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wavesym.sweeps.batches._MOST_BATCHES", 1)
    machine.seconds = [900.0]
    assert swept(tmp_path, 4) == ["done without workers: what was left is one batch"]
    assert machine.started == []
    assert swept(tmp_path, 4) == []  # all is there


def test_the_command_says_it_in_a_line_and_python_in_a_warning(
    tmp_path: Path, machine: Machine, capsys: pytest.CaptureFixture[str]
) -> None:
    machine.seconds = [0.1] * CASES
    (tmp_path / "sweep.toml").write_text('scene = "drive_m1"\n[vary]\n"output.until" = [4, 5, 6]\n')
    out = tmp_path / "out"
    assert main(["sweep", str(tmp_path / "sweep.toml"), "-o", str(out), "--workers", "2"]) == 1
    told = "done without workers: 0 s of work, and they would take 10 s to start"
    assert capsys.readouterr().err.splitlines()[0] == f"{out}: {told}"
    machine.here = 0
    with pytest.warns(UserWarning, match="without workers: 4 s of work"):
        wavesym.sweep(SWEEP, tmp_path / "python", workers=2)


def test_workers_that_cannot_be_had_are_refused_before_the_work(
    tmp_path: Path, machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = running.require_packages

    def without_dask(*names: str) -> None:
        if "distributed" in names:
            raise wavesym.WavesymError("distributed not installed")
        found(*names)

    monkeypatch.setattr(running, "require_packages", without_dask)
    with pytest.raises(wavesym.WavesymError, match="distributed not installed"):
        run(SWEEP, tmp_path / "out", Computing(2))
    assert not (tmp_path / "out").exists()
    run(SWEEP, tmp_path / "out", Computing(1))
