"""El Centro through frames of 10 and 40 storeys: the command line, many records at once, and the stream in C."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from tools.bench.commands import ran
from tools.bench.harness import flags_cell, toolchains
from wavesym.lab.stream import stream
from wavesym.lab.timing import medians
from wavesym.numbers.doubles import nearest
from wavesym.programs.choice import choose
from wavesym.programs.making import program
from wavesym.programs.modes.evaluator import ModesEvaluator
from wavesym.programs.modes.records import RecordResponse
from wavesym.programs.program import Program
from wavesym.scene import Scene, lower
from wavesym.targets.files import sources

RECORDS, AT_ONCE = 1000, 50
_SAMPLES = 1560  # of the record, the 0 before its first one included


def frame(record: Path, storeys: int) -> str:
    """A scene: a steel frame at 5 % on ground that shakes as the record says; all floors, and the base shear."""
    floors = list(range(1, storeys + 1))
    return f"""
name = "frame"
[units]
[system]
type = "building"
base = "ground"
damping = 0.05
[[system.storey]]
count = {storeys}
height = "3.5 m"
stiffness = "678 MN/m"
column_mass = "10.871 t"
floor_mass = "350 t"
[[load]]
record = "{record.resolve().as_posix()}"
start = "0.02 s"
[output]
until = "31.18 s"
tolerance = 1e-5
acceleration = {floors}
force = [0]
drift = {floors}
relative = {floors}
"""


def rows(records: Path) -> Iterator[Sequence[str]]:
    """What, its time, its peak memory in MB, and how many modes."""
    record = records / "elcentro_1940_ns_peknold.at2"
    for storeys in (10, 40):
        yield f"`wavesym run`, {storeys} storeys, {3 * storeys + 1} outputs", *_run(frame(record, storeys))
    with TemporaryDirectory() as directory:
        path = Path(directory, "frame.toml")
        path.write_text(frame(record, 10), encoding="utf-8")
        model = lower(Scene.from_toml(path))
    made = choose(model, "modes").evaluator
    assert isinstance(made, ModesEvaluator)
    count = str(len(made.system.frequency))
    yield f"{RECORDS} records of {_SAMPLES} samples through 10 storeys", f"{_many(made):.2f} s", "", count
    for compiler, flags in toolchains():
        seconds = _stepping(program(model, made), flags)
        yield f"a sample of the stream, {compiler} {flags_cell(flags)}", f"{1e6 * seconds:.2f} us", "", count


def _run(text: str) -> tuple[str, str, str]:
    """Of `wavesym run` at all samples."""
    with TemporaryDirectory() as directory:
        path = Path(directory, "frame.toml")
        path.write_text(text, encoding="utf-8")
        out = str(Path(directory, "frame.csv"))
        command = [sys.executable, "-m", "wavesym", "run", str(path), "--samples", str(_SAMPLES), "-o", out]
        done = ran(command)
    return f"{done.seconds:.2f} s" if done.well else "refused", f"{done.megabytes:.0f}", ""


def _many(made: ModesEvaluator) -> float:
    """Seconds for the peaks of all outputs under many records."""
    samples = np.random.default_rng(1).standard_normal((AT_ONCE, _SAMPLES, 1))
    start = perf_counter()
    response = RecordResponse(made.system, nearest(made.spacing))
    for _ in range(RECORDS // AT_ONCE):
        np.abs(response.in_blocks(response.block_states(samples), samples)).max(axis=(1, 3, 4))
    return perf_counter() - start


def _stepping(made: Program, flags: tuple[str, ...]) -> float:
    """Seconds for a sample in C."""
    samples = np.random.default_rng(1).standard_normal((_SAMPLES, int(made.constants["loads"])))
    call = stream(made.provenance.model.name, sources(made, "c"), samples, len(made.outputs), flags)
    (seconds,) = medians([call])
    return seconds / _SAMPLES
