"""Sweeps: wall times of whole commands, start-up included, with processes and without; what a batch costs, and memory.

Records are seeded noise and waves, in files. A cluster is a scheduler and workers on this machine, which run already.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from math import nan
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time, sleep
from typing import NamedTuple

import numpy as np

from tools.bench.commands import ran
from tools.bench.many_sets import FIRST, LAST, MANY, SETS
from wavesym.lab.timing import medians
from wavesym.scene import Scene
from wavesym.sweeps import shared_records
from wavesym.sweeps.batches import batches
from wavesym.sweeps.kinds import kind
from wavesym.sweeps.manifest import settle
from wavesym.sweeps.marks import Marks
from wavesym.sweeps.plan import SweepPlan, plan
from wavesym.sweeps.request import SweepRequest
from wavesym.sweeps.running import keep
from wavesym.sweeps.work import compute

RECORDS, STRUCTURES, SAMPLES = 44, 25, 3000
GROWING = (100, 1000, 10_000)  # sets along the second dimension
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")  # as nannies do
_STOREYS = list(range(1, 6))

FRAME = f"""
name = "frame"
[system]
type = "building"
m = 5
kappa = ["31/1000", "31/1000", "31/1000", "31/1000", "31/1000", "31/1000"]
base = "ground"
damping = 0.05
[[load]]
record = "00.csv"
spacing = "4.995"
[output]
until = "14980"
tolerance = 1e-5
acceleration = {_STOREYS}
force = [0]
drift = {_STOREYS}
relative = {_STOREYS}
"""
FRAMES = """
scene = "frame.toml"
records = "*.csv"
[vary]
"system.kappa[5]" = {{ from = "31/1000", to = "31/500", count = {structures} }}
"""
DRIVE = """
name = "shafts"
[system]
type = "drive"
m = 3
kappa = [1, "1/2", "4/5"]
inertia = [1, 2, "1/2", "3/2"]
[[load]]
body = 1
times = [0, 3]
steps = [1, "-1/2"]
[output]
until = 40
tolerance = 1e-6
strain = ["1/2", "3/2", "5/2"]
"""
SHAFTS = f"""
scene = "drive.toml"
[vary]
"system.kappa[1]" = {{{{ from = "{FIRST}", to = "{LAST}", count = {{sets}} }}}}
"""
BOTH = (
    SHAFTS
    + """
"system.kappa[2]" = {{ from = "1/2", to = 1, count = 10 }}
"""
)


def inputs(folder: Path, records: int = RECORDS, samples: int = SAMPLES) -> None:
    """The scenes, and records that begin and end at rest."""
    draw, t = np.random.default_rng(7), np.arange(samples) / 100
    for number in range(records):
        waves = sum(np.sin(2 * np.pi * f * t + f * f) for f in draw.uniform(0.3, 8, 12))
        made = (waves * t * np.exp(-t / 4) + 0.4 * draw.standard_normal(samples) * np.exp(-t / 8)) / 100
        made[0] = 0
        lines = "".join(f"{value:.7f}\n" for value in made.tolist())
        (folder / f"{number:02}.csv").write_text(f"a\n{lines}", encoding="ascii")
    (folder / "frame.toml").write_text(FRAME, encoding="ascii")
    (folder / "drive.toml").write_text(DRIVE, encoding="ascii")


def drive() -> Scene:
    """The drive whose parameters are varied."""
    with TemporaryDirectory() as directory:
        (Path(directory) / "drive.toml").write_text(DRIVE, encoding="ascii")
        return Scene.from_toml(Path(directory) / "drive.toml")


def rows() -> Iterator[Sequence[str]]:
    """What, by whom, seconds, those that processors were busy (of workers too), peak memory of the command in MB."""
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        inputs(folder)
        frames = FRAMES.format(structures=STRUCTURES)
        few = f"{RECORDS} records x {STRUCTURES} structures"
        yield few, "this process", *run_sweep(folder, frames)
        for workers in (1, 2):
            with cluster(folder, workers) as running:
                run_sweep(folder, FRAMES.format(structures=2), running)  # so that workers have loaded all they need
                yield few, f"{workers} running workers", *run_sweep(folder, frames, running)
        double = FRAMES.format(structures=2 * STRUCTURES)
        yield f"{RECORDS} records x {2 * STRUCTURES} structures", "this process", *run_sweep(folder, double)
        for sets in (SETS, MANY):
            yield (
                f"peaks of {sets} kappa, compiling included",
                "this process",
                *run_sweep(folder, SHAFTS.format(sets=sets)),
            )
        with cluster(folder, 2) as running:
            yield (
                f"peaks of {MANY} kappa",
                "2 running workers",
                *run_sweep(folder, SHAFTS.format(sets=MANY), running),
            )


def growth() -> Iterator[Sequence[str]]:
    """Cases, seconds, busy ones, peak memory in MB of the command, and of the worker that computes for it so far."""
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        inputs(folder, records=0)
        with cluster(folder, 1) as running:
            for sets in GROWING:
                row = run_sweep(folder, BOTH.format(sets=sets), running)
                yield f"{10 * sets}", *row, f"{running.megabytes:.0f}"


def overheads() -> Iterator[Sequence[str]]:
    """What a sweep of records is made of: how long each part takes (what computes, of a processor), how large it is."""
    from distributed import Client
    from distributed.protocol import deserialize, serialize

    with TemporaryDirectory() as directory, cluster(Path(directory), 1) as running:
        folder = Path(directory)
        inputs(folder)
        (folder / "sweep.toml").write_text(FRAMES.format(structures=STRUCTURES), encoding="ascii")

        def read() -> SweepPlan:
            file, request = SweepRequest.read(folder / "sweep.toml")
            return plan(request, file)

        planned = read()
        parts = batches(planned, *kind(planned))
        store, marks = settle(folder, planned, parts), Marks(folder)
        values, sent = compute(planned, parts, 0), serialize(planned)

        def unpack() -> object:
            shared_records.doubles.cache_clear()
            records = deserialize(*sent).records
            return [shared_records.doubles(shared_records.key(each)) for each in records.values]

        with Client(running.address, set_as_default=False) as client:

            def round_trip() -> object:
                return client.submit(partial(_identity, values), pure=False).result()

            kept, passed = medians([partial(keep, planned, store, marks, 0, values), round_trip])
        computing, reading, unpacking = _busy(partial(compute, planned, parts, 1)), _busy(read), _busy(unpack)
    samples = RECORDS * SAMPLES
    yield "a record through a structure", f"{1e3 * computing / RECORDS:.2f} ms"
    yield "the chunks of a batch written and hashed, its mark", f"{1e3 * kept:.1f} ms"
    yield "its values through a scheduler and back, nothing else under way", f"{1e3 * passed:.1f} ms"
    yield "a sample of a record, read exactly from its file", f"{1e6 * reading / samples:.1f} us"
    yield "sent to a worker", f"{sum(map(len, sent[1])) / samples:.1f} bytes"
    yield "unpacked and rounded there", f"{1e6 * unpacking / samples:.1f} us"


def _busy(call: Callable[[], object]) -> float:
    """For how many seconds a call keeps a processor busy, the least of a few."""
    times = []
    for _ in range(5):
        start = process_time()
        call()
        times.append(process_time() - start)
    return min(times)


def _identity(values: object) -> object:
    return values


class Running(NamedTuple):
    """A scheduler's address, and the processes of its workers. What Linux says of them is NaN elsewhere."""

    address: str
    workers: tuple[int, ...]

    @property
    def megabytes(self) -> float:
        """The peak memory of a worker so far."""
        try:
            every = [Path(f"/proc/{worker}/status").read_text(encoding="ascii") for worker in self.workers]
        except OSError:
            return nan
        return max(float(status.partition("VmHWM:")[2].split()[0]) / 1000 for status in every)

    @property
    def busy(self) -> float:
        """For how many seconds they have kept processors busy."""
        try:
            every = [Path(f"/proc/{worker}/stat").read_text(encoding="ascii") for worker in self.workers]
        except OSError:
            return nan
        return sum(float(ticks) for stat in every for ticks in stat.split()[13:15]) / os.sysconf("SC_CLK_TCK")


_NOBODY = Running("", ())


def run_sweep(folder: Path, text: str, running: Running = _NOBODY) -> tuple[str, str, str]:
    """Seconds, busy ones, and MB of the command, into a new folder."""
    (folder / "sweep.toml").write_text(text, encoding="ascii")
    given = ["--scheduler", running.address] if running.address else ["--workers", "1"]
    before = running.busy
    with TemporaryDirectory() as out:
        done = ran([sys.executable, "-m", "wavesym", "sweep", str(folder / "sweep.toml"), "-o", out, *given])
    busy = done.busy + running.busy - before
    return f"{done.seconds:.2f}" if done.well else "failed", f"{busy:.2f}", f"{done.megabytes:.0f}"


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[Running]:
    """A scheduler with so many workers, all of them processes of this machine."""
    file = folder / "scheduler.json"
    file.unlink(missing_ok=True)
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": os.environ | _ONE_THREAD}
    dask, options = [sys.executable, "-m", "dask"], ["--no-dashboard", "--scheduler-file", str(file)]
    started = [subprocess.Popen([*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", *options], **quiet)]  # type: ignore[call-overload]
    try:
        _wait(lambda: file.exists() and file.read_text(encoding="utf-8").endswith("}"))
        address = str(json.loads(file.read_text(encoding="utf-8"))["address"])
        alone = ["--nthreads", "1", "--no-nanny"]
        started += [subprocess.Popen([*dask, "worker", *options, *alone], **quiet) for _ in range(workers)]  # type: ignore[call-overload]
        from distributed import Client

        with Client(address, set_as_default=False) as client:
            client.wait_for_workers(workers)
        yield Running(address, tuple(process.pid for process in started[1:]))
    finally:
        for process in started:
            process.kill()
            process.wait()


def _wait(done: Callable[[], bool]) -> None:
    while not done():
        sleep(0.05)
