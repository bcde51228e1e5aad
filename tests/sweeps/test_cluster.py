"""What clusters do to sweeps: processes are killed, and what comes of it is what comes of an undisturbed run.

A real scheduler and real workers on this machine. Each worker says which batches it computes.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

pytest.importorskip("distributed", reason="the extra `sweep` is not installed")

from wavesym import __version__
from wavesym.sweeps.running import run
from wavesym.sweeps.status import status

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
BATCHES = 16
SWEEP = f"""
scene = "drive_m1"
[vary]
"output.until" = {{ from = 4, to = 12, count = {BATCHES} }}
"""
FRAME = """
name = "frame"
[system]
type = "building"
m = 1
kappa = ["1/20", "1/20"]
base = "ground"
damping = 0.05
[[load]]
spacing = 5
record = "a.csv"
[output]
until = 30
tolerance = 1e-4
drift = [1]
"""
_PATIENCE = 600  # seconds: a busy machine takes a minute to start a worker


def until(done: Callable[[], object]) -> None:
    end = time.monotonic() + _PATIENCE
    while not done():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.05)


def files(folder: Path) -> dict[str, bytes]:
    """All that a sweep leaves, to the byte."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class Lab:
    """A scheduler, workers and clients in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.log, self.out = folder, folder / "log", folder / "out"
        self.sweep = folder / "sweep.toml"
        self.sweep.write_text(SWEEP)
        self.log.touch()
        self.running: list[subprocess.Popen[str]] = []
        self.environment = os.environ | {
            "PYTHONPATH": str(ROOT),
            "SPIED_LOG": str(self.log),
            "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "5s",
        }

    def start(self, *command: str, **environment: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-m", *command],
            cwd=self.folder,
            env=self.environment | environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT if command[0] == "dask" else subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        self.running.append(process)
        return process

    def scheduler(self, number: int = 0) -> subprocess.Popen[str]:
        self.address_file = self.folder / f"scheduler{number}.json"
        options = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(self.address_file)]
        process = self.start("dask", "scheduler", *options)
        until(lambda: self.address_file.exists() and self.address_file.read_text().endswith("}"))
        return process

    def worker(self, *options: str, **environment: str) -> subprocess.Popen[str]:
        given = ["--nthreads", "1", "--no-dashboard", "--scheduler-file", str(self.address_file), *options]
        return self.start("dask", "worker", "--preload", "tests.support.spied_worker", *given, **environment)

    def client(self, *options: str, **environment: str) -> subprocess.Popen[str]:
        if not options:
            options = ("--scheduler", json.loads(self.address_file.read_text())["address"])
        return self.start("tests.support.eager_sweep", str(self.sweep), "-o", str(self.out), *options, **environment)

    def computed(self) -> list[int]:
        """The batches that workers have begun, in order."""
        return [int(line.split()[0]) for line in self.log.read_text().splitlines()]

    def marks(self) -> int:
        return len(list((self.out / "done").glob("*.json")))

    def undisturbed(self) -> dict[str, bytes]:
        run(self.sweep, self.folder / "alone")
        return files(self.folder / "alone")


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[Lab]:
    made = Lab(tmp_path)
    yield made
    for process in made.running:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def finished(client: subprocess.Popen[str]) -> tuple[int, str]:
    _, err = client.communicate(timeout=_PATIENCE)
    return client.returncode, err


def test_workers_that_nobody_disturbs_compute_each_batch_once(lab: Lab) -> None:
    lab.scheduler()
    lab.worker(), lab.worker()
    assert finished(lab.client()) == (0, f"{lab.out}: {BATCHES} cases: {BATCHES} done, 0 failed, 0 left\n")
    assert sorted(lab.computed()) == list(range(BATCHES))
    assert files(lab.out) == lab.undisturbed()


def test_a_worker_that_is_killed_takes_nothing_with_it(lab: Lab) -> None:
    lab.scheduler()
    workers = [lab.worker("--no-nanny", SPIED_SECONDS="0.3") for _ in range(2)]
    client = lab.client()
    until(lambda: lab.marks() >= 4)
    workers[0].kill()
    code, err = finished(client)
    assert code == 0, err
    assert set(lab.computed()) == set(range(BATCHES))
    assert len(lab.computed()) <= BATCHES + 1  # what the worker was at
    assert files(lab.out) == lab.undisturbed()


def test_a_cluster_that_grows_is_fed_by_the_threads_it_has_now(lab: Lab) -> None:
    """More are under way at once than one worker was given ahead: nothing is done before."""
    lab.scheduler()
    lab.worker(SPIED_TOGETHER="5")
    client = lab.client()
    until(lambda: lab.computed() or client.poll() is not None)
    for _ in range(4):
        lab.worker(SPIED_TOGETHER="5")
    code, err = finished(client)
    assert code == 0, err
    assert sorted(lab.computed()) == list(range(BATCHES))
    assert files(lab.out) == lab.undisturbed()


def test_a_client_that_is_killed_goes_on_where_it_was(lab: Lab) -> None:
    lab.scheduler()
    lab.worker(SPIED_SECONDS="0.3"), lab.worker(SPIED_SECONDS="0.3")
    client = lab.client()
    until(lambda: lab.marks() >= 4)
    client.kill()
    client.wait()
    done = status(lab.out).done
    assert 4 <= done < BATCHES
    before = len(lab.computed())
    again, err = finished(lab.client())
    assert again == 0, err
    assert set(lab.computed()) == set(range(BATCHES))
    assert len(lab.computed()) - before <= BATCHES - done + 2  # what was under way for the first client
    assert files(lab.out) == lab.undisturbed()


def test_a_scheduler_that_is_killed_ends_the_command_and_nothing_else(lab: Lab) -> None:
    scheduler = lab.scheduler()
    workers = [lab.worker(SPIED_SECONDS="0.3") for _ in range(2)]
    client = lab.client()
    until(lambda: lab.marks() >= 4)
    scheduler.kill()
    code, err = finished(client)
    assert code == 1, err
    assert err.count("\n") == 1, err
    assert "goes on" in err
    for worker in workers:
        os.killpg(worker.pid, signal.SIGKILL)
    done, before = status(lab.out).done, len(lab.computed())
    assert 4 <= done < BATCHES
    lab.scheduler(1)
    lab.worker(), lab.worker()
    again, err = finished(lab.client())
    assert again == 0, err
    assert len(lab.computed()) - before == BATCHES - done
    assert files(lab.out) == lab.undisturbed()


def test_a_case_that_kills_its_worker_is_the_only_one_that_fails(lab: Lab) -> None:
    preload = {"DASK_DISTRIBUTED__WORKER__PRELOAD": "tests.support.spied_worker", "SPIED_CRASH": "5"}
    code, err = finished(lab.client("--workers", "2", **preload))
    assert code == 1, err
    found = status(lab.out)
    assert (found.done, found.failed, found.left) == (BATCHES - 1, 1, 0)
    (failure,) = found.reasons
    assert failure["case"] == 5
    assert "died" in failure["reason"]
    code, err = finished(lab.client("--workers", "2", "--retry-failed"))
    assert code == 0, err
    assert files(lab.out) == lab.undisturbed()


def test_a_case_that_fills_its_worker_s_memory_is_the_only_one_that_fails(lab: Lab) -> None:
    lab.scheduler()
    for _ in range(2):
        lab.worker("--memory-limit", "700 MB", SPIED_EAT="3")
    code, err = finished(lab.client())
    assert code == 1, err
    found = status(lab.out)
    assert (found.done, found.failed, found.left) == (BATCHES - 1, 1, 0)
    assert found.reasons[0]["case"] == 3


def test_workers_that_live_too_short_for_a_batch_finish_it_in_parts(lab: Lab) -> None:
    """None lives through more than three of the 24 records of a batch; what is marked in between stays."""
    (lab.folder / "frame.toml").write_text(FRAME.replace("a.csv", "r00.csv"))
    lab.sweep.write_text('scene = "frame.toml"\nrecords = "r*.csv"\n')
    for k in range(24):
        (lab.folder / f"r{k:02}.csv").write_text(f"a\n0\n1\n{k - 12}\n{k * k - 90}\n0\n")
    undisturbed = lab.undisturbed()
    preload = {"DASK_DISTRIBUTED__WORKER__PRELOAD": "tests.support.spied_worker", "SPIED_MOST": "3"}
    client = lab.client("--workers", "2", **preload, SPIED_SECONDS="0.3")
    until(lambda: lab.marks() or client.poll() is not None)
    assert 0 < status(lab.out).done < 24
    client.kill()
    client.wait()
    done = status(lab.out).done
    before = len(lab.computed())
    client = lab.client("--workers", "2", **preload)
    code, err = finished(client)
    assert code == 0, err
    assert len(lab.computed()) - before <= 2 + 24 - done
    assert files(lab.out) == undisturbed


def test_an_address_where_nobody_listens_is_said(lab: Lab) -> None:
    code, err = finished(lab.client("--scheduler", "tcp://127.0.0.1:9"))
    assert code == 1
    assert "no Dask scheduler answers at tcp://127.0.0.1:9" in err
    assert err.count("\n") == 1


def test_a_worker_with_another_wavesym_is_refused(lab: Lab) -> None:
    lab.scheduler()
    lab.worker(SPIED_VERSION="99.1")
    code, err = finished(lab.client())
    assert code == 2, err
    assert err.count("\n") == 1
    assert f"wavesym 99.1 at a worker, {__version__} here; install the same" in err
    assert lab.computed() == []
    assert lab.marks() == 0


def test_a_record_that_has_changed_meanwhile_makes_another_sweep(lab: Lab) -> None:
    """Whose folder is another one; with the record as it was the sweep goes on."""
    record, scene = lab.folder / "a.csv", lab.folder / "frame.toml"
    scene.write_text(FRAME)
    lab.sweep.write_text('scene = "frame.toml"\nrecords = "*.csv"\n[vary]\n"system.damping" = [0.02, 0.03, 0.04, 0.05]')
    record.write_text("a\n0\n1\n0\n")
    (lab.folder / "b.csv").write_text("a\n0\n2\n-1\n0\n")
    undisturbed = lab.undisturbed()
    lab.scheduler()
    lab.worker(SPIED_SECONDS="0.5")
    client = lab.client()
    until(lambda: lab.marks() >= 1)
    client.kill()
    client.wait()
    record.write_text("a\n0\n3\n0\n")
    code, err = finished(lab.client())
    assert code == 2, err
    assert "the folder of another sweep" in err
    record.write_text("a\n0\n1\n0\n")
    code, err = finished(lab.client())
    assert code == 0, err
    assert files(lab.out) == undisturbed


def test_a_script_without_a_guard_is_run_once(lab: Lab) -> None:
    """Processes that are started do not run the script that starts them."""
    script = lab.folder / "script.py"
    script.write_text(
        "import sys, wavesym\nfrom tests.support import eager_sweep\n"
        "eager_sweep.leave_to_workers()\nprint('once')\n"
        f"found = wavesym.sweep({str(lab.sweep)!r}, {str(lab.out)!r}, workers=2)\n"
        "print(int(found['max'].isnull().sum()), sys.modules['__main__'].__file__ == __file__)\n"
    )
    done = subprocess.run([sys.executable, script], env=lab.environment, capture_output=True, text=True, check=False)
    assert done.stdout == "once\n0 True\n", done.stderr
    assert files(lab.out) == lab.undisturbed()
