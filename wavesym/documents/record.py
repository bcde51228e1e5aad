"""What a file of a record says, for people: how many samples, how far apart, the peak and when, what comes after."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path

from wavesym.errors import SceneError, WavesymError, printable
from wavesym.fields.numbers import decimal_text
from wavesym.fields.quantity import is_unit, likely_unit
from wavesym.fields.table import show
from wavesym.records.read import read_record
from wavesym.records.record_file import RecordFile
from wavesym.results.presentation import align_columns

_UNIT = re.compile(r"[A-Za-z\u00b5\u03bc%][A-Za-z0-9_*/^%-]{0,40}")
AFTER = "0: in a straight line within one step, and for good"


@dataclass(frozen=True)
class RecordFacts:
    """A record in words: `unit` is that of its samples, `clock` that of its times, each empty where nobody says it."""

    file: RecordFile
    unit: str

    @property
    def clock(self) -> str:
        """The unit of time; a physical record whose file does not say it is in seconds."""
        return self.file.clock or ("s" if self.unit and self.file.times else "")

    @cached_property
    def step(self) -> Fraction | None:
        """The time between samples. SceneError where times are uneven."""
        return self.file.even()

    @property
    def start(self) -> Fraction:
        """The time of the first sample."""
        return self.file.times[0] if self.file.times else Fraction(0)

    @cached_property
    def peak(self) -> int:
        """The sample that is largest, whatever its sign; the first of them."""
        samples = self.file.samples
        return max(range(len(samples)), key=lambda k: abs(samples[k]))

    def time(self, k: int) -> Fraction | None:
        """The time of a sample."""
        return None if self.step is None else self.start + k * self.step

    def format_time(self, time: Fraction) -> str:
        """A time with its unit."""
        return f"{decimal_text(time)} {self.clock}".rstrip()

    def describe_peak(self) -> str:
        """The peak with the file's digits, and when."""
        time = self.time(self.peak)
        at = f"sample {self.peak + 1}" if time is None else self.format_time(time)
        size = f"{self.file.digits[self.peak].lstrip('+-')} {self.unit}".rstrip()
        return f"{size} at {at}{', negative' * (self.file.samples[self.peak] < 0)}"


def record_lines(path: Path, unit: str | None, column: str | None = None) -> tuple[RecordFile, str, list[str]]:
    """The lines of `wavesym record`.

    Args:
        path: an AT2 or CSV file.
        unit: that of its samples, where it has none.
        column: that of a CSV with several.

    Returns:
        The record, the unit of its samples, and the lines.

    Raises:
        SceneError: for a file that is damaged, has uneven times or another unit.
        WavesymError: for what is no unit.
    """
    if unit is not None and not _UNIT.fullmatch(unit):
        raise WavesymError(f"--unit: {show(unit)} is not a unit; write one such as g or m/s^2")
    found = read_record(path, column)
    if unit is not None and found.unit not in ("", unit):
        raise SceneError(f"--unit {unit} is not that of the file; write {found.unit}, or none", file=found.file)
    rows = list(_rows(RecordFacts(found, unit or found.unit)))
    lines = [printable(f"{found.file}: {found.kind}"), *(f"  {line}" for line in align_columns(rows, left=(0, 1)))]
    return found, unit or found.unit, lines


def _rows(facts: RecordFacts) -> Iterator[tuple[str, str]]:
    count, step = len(facts.file.samples), facts.step
    yield "samples", str(count)
    if step is None:
        yield "spacing", "the file does not say; `spacing` in a scene does"
    else:
        yield "spacing", facts.format_time(step)
        remark = "" if facts.file.times else " (the file does not say when; `start` in a scene does)"
        yield "first", f"at {facts.format_time(facts.start)}{remark}"
        yield "duration", facts.format_time((count - 1) * step)
    yield "peak", facts.describe_peak()
    yield "unit", _describe_unit(facts.unit)
    yield "after it", AFTER


def _describe_unit(unit: str) -> str:
    if not unit:
        return "the file does not say; `unit` in a scene, or --unit, does"
    meant = likely_unit(unit)
    if meant != unit:
        return f"{unit}, which a scene refuses: did you mean {meant}?"
    return unit if is_unit(unit) else f"{unit}, which a scene does not know; write another behind the column's name"
