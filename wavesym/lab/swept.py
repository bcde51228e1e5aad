"""Sweeps: wall times of whole commands, start-up included, with processes and without; and beside rivals.

Records are seeded noise and waves, in files. A cluster is a scheduler and workers on this machine, which run already.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, sleep

import numpy as np

from wavesym.lab.timing import ran
from wavesym.mechanics.model import Model
from wavesym.rivals.line import stated
from wavesym.rivals.specialised import SampleGrid, in_numpy
from wavesym.scene import Scene, lower

RECORDS, STRUCTURES, SAMPLES, SETS = 44, 25, 3000, 200
_GRID, _STRIDE = 2560, 2  # of the rival: samples to the horizon, steps between two of them
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
SHAFTS = """
scene = "drive.toml"
[vary]
"system.kappa[1]" = {{ from = "1/20", to = "1/2", count = {sets} }}
"""


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


def rows() -> Iterator[Sequence[str]]:
    """What, by whom, seconds, peak memory of the command in MB."""
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        inputs(folder)
        few = f"{RECORDS} records x {STRUCTURES} structures"
        yield few, "this process", *_swept(folder, FRAMES.format(structures=STRUCTURES))
        for workers in (1, 2):
            with cluster(folder, workers) as address:
                yield few, f"{workers} running workers", *_swept(folder, FRAMES.format(structures=STRUCTURES), address)
        double = FRAMES.format(structures=2 * STRUCTURES)
        yield f"{RECORDS} records x {2 * STRUCTURES} structures", "this process", *_swept(folder, double)
        for sets in (SETS, 100_000):
            yield f"peaks of {sets} kappa", "this process", *_swept(folder, SHAFTS.format(sets=sets))
        model = lower(Scene.from_toml(folder / "drive.toml"))
        yield f"peaks at samples of {SETS} kappa", "NumPy, all at once, by hand", f"{_rival(model, SETS):.2f}", ""


def _swept(folder: Path, text: str, address: str | None = None) -> tuple[str, str]:
    """Of the command, into a new folder."""
    (folder / "sweep.toml").write_text(text, encoding="ascii")
    given = ["--scheduler", address] if address else []
    with TemporaryDirectory() as out:
        done = ran([sys.executable, "-m", "wavesym", "sweep", str(folder / "sweep.toml"), "-o", out, *given])
    return f"{done.seconds:.2f}" if done.well else "failed", f"{done.megabytes:.0f}"


def _rival(model: Model, sets: int) -> float:
    """Seconds for the peaks of characteristics of order 4, all sets at once."""
    problem = stated(model)
    grid = SampleGrid(problem, _GRID + 1, _STRIDE)
    start = perf_counter()
    np.abs(in_numpy(grid, [problem] * sets)).max(axis=2)
    return perf_counter() - start


@contextmanager
def cluster(folder: Path, workers: int) -> Iterator[str]:
    """The address of a scheduler with so many workers, all of them processes of this machine."""
    file = folder / "scheduler.json"
    file.unlink(missing_ok=True)
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    dask, told = [sys.executable, "-m", "dask"], ["--no-dashboard", "--scheduler-file", str(file)]
    started = [subprocess.Popen([*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", *told], **quiet)]  # type: ignore[call-overload]
    try:
        _until(lambda: file.exists() and file.read_text(encoding="utf-8").endswith("}"))
        address = str(json.loads(file.read_text(encoding="utf-8"))["address"])
        alone = ["--nthreads", "1", "--no-nanny"]
        started += [subprocess.Popen([*dask, "worker", *told, *alone], **quiet) for _ in range(workers)]  # type: ignore[call-overload]
        from distributed import Client

        with Client(address, set_as_default=False) as client:
            client.wait_for_workers(workers)
        yield address
    finally:
        for process in started:
            process.kill()
            process.wait()


def _until(done: Callable[[], bool]) -> None:
    while not done():
        sleep(0.05)
