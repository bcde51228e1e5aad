"""Many records through many frames: a sweep of damped frames of ten storeys, a whole command, and its peak memory.

The records are El Centro, scaled, and later by some samples; the frames differ in the stiffness of their storeys.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from tools.bench.streaming import frame
from tools.bench.sweeps import run_sweep

STOREYS, RECORDS, FRAMES = 10, 100, 100
HEAD = ("records x frames", "s", "s of processor", "cases a second of processor", "peak MB")
_LEAST, _MOST = 0.5, 1.5  # times the record; of stiffnesses in MN/m, as far from those of `frame`
_LATER = 7  # so many delays, each of a sample more
_HEADER = 4  # lines of an AT2 file before its samples


def rows(records: Path) -> Iterator[Sequence[str]]:
    """What, wall time, how long processors were busy, cases for each second of that, and peak memory."""
    with TemporaryDirectory() as directory:
        folder = Path(directory)
        sweep = inputs(folder, records / "elcentro_1940_ns_peknold.at2", RECORDS, FRAMES)
        seconds, busy, megabytes = run_sweep(folder, sweep)
    rate = f"{RECORDS * FRAMES / float(busy):.0f}" if seconds != "failed" else ""
    yield f"{RECORDS} x {FRAMES}", seconds, busy, rate, megabytes


def inputs(folder: Path, record: Path, records: int, frames: int) -> str:
    """Write the scene and its records; the text of a sweep in the same folder."""
    *head, counts = (lines := record.read_text(encoding="ascii").splitlines())[:_HEADER]
    samples = [float(word) for line in lines[_HEADER:] for word in line.split()]
    (folder / "records").mkdir()
    for number in range(records):
        later = number % _LATER
        scale = _LEAST + (_MOST - _LEAST) * number / records
        moved = [0.0] * later + [scale * sample for sample in samples[: len(samples) - later]]
        text = "\n".join([*head, counts, *(f"{sample:.7f}" for sample in moved)])
        (folder / "records" / f"{number:03}.at2").write_text(f"{text}\n", encoding="ascii")
    (folder / "frame.toml").write_text(frame(folder / "records" / "000.at2", STOREYS), encoding="utf-8")
    least, most = (f'"{678 * factor:.0f} MN/m"' for factor in (_LEAST, _MOST))
    return f"""
scene = "frame.toml"
records = "records/*.at2"
[vary]
"system.storey[0].stiffness" = {{ from = {least}, to = {most}, count = {frames} }}
"""
