"""CSV: comments after #, a header line with a name for each column, then a row for each sample.

The unit of a column stands behind its name in brackets, `accel [m/s^2]` or `acc (g)`, or, where the name is a plain
word for a quantity, after an underscore: `time_s`, `accel_g`. (a_g is the acceleration of the ground.)
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

from wavesym.records.record_file import RecordFile, bare, damaged, decimal

_TIMES = ("time", "t", "tau")
_QUANTITIES = "acc|accel|acceleration|velocity|displacement|force|moment|torque"
_BRACKETS = re.compile(r"(.*\S)\s*(?:\[(.*)\]|\((.*)\))")
_SUFFIX = re.compile(rf"(time|t|{_QUANTITIES})_([a-z].*)", re.IGNORECASE)


class _Column(NamedTuple):
    """A column: its name, as the header has it and without its unit."""

    place: int
    header: str
    name: str
    unit: str


def columns(file: str, lines: Sequence[str], wanted: str | None) -> RecordFile:
    """The samples in the column `wanted`, or in the only one that is no time. SceneError, which names the line."""
    rows = _rows(lines)
    at, head = next(rows, (1, ""))
    mark = next((mark for mark in ",;\t" if mark in head), None)
    named = [_column(place, cell.strip()) for place, cell in enumerate(head.split(mark) if mark else [head])]
    if all(decimal(column.header) is not None for column in named):
        raise damaged(file, at, f"{bare(head)} given, a header line expected, such as time,acceleration")
    clock = next((column for column in named if column.name.casefold() in _TIMES), None)
    column = _chosen(file, at, named, clock, wanted)
    written: list[str] = []
    found: dict[_Column, list[Fraction]] = {each: [] for each in (clock, column) if each}
    places: list[int] = []
    for number, row in rows:
        cells = row.split(mark) if mark else [row]
        if len(cells) != len(named):
            raise damaged(file, number, f"{len(cells)} columns given, the {len(named)} of the header expected")
        for each, numbers in found.items():
            word = cells[each.place].strip()
            value = decimal(word)
            if value is None:
                raise damaged(file, number, f"{bare(word)} given, a decimal expected ({bare(each.header)})")
            numbers.append(value)
        written.append(cells[column.place].strip())
        places.append(number)
    if not places:
        raise damaged(file, at, "the file ends after its header, a row of numbers expected")
    return RecordFile(
        file,
        f"CSV, {bare(column.header)}",
        tuple(found[column]),
        tuple(written),
        tuple(places),
        column.unit,
        clock.unit if clock else "",
        times=tuple(found[clock]) if clock else None,
    )


def _rows(lines: Sequence[str]) -> Iterator[tuple[int, str]]:
    """The lines that say something, with their numbers, without comments."""
    for number, line in enumerate(lines, 1):
        if row := line.partition("#")[0].strip():
            yield number, row


def _column(place: int, header: str) -> _Column:
    if found := _BRACKETS.fullmatch(header):
        return _Column(place, header, found[1], bare((found[2] or found[3] or "").strip()))
    if found := _SUFFIX.fullmatch(header):
        return _Column(place, header, found[1], bare(found[2]))
    return _Column(place, header, header, "")


def _chosen(file: str, at: int, named: Sequence[_Column], clock: _Column | None, wanted: str | None) -> _Column:
    """The column of the samples."""
    others = [column for column in named if column is not clock]
    known = ", ".join(bare(column.header) for column in others[:8])
    if not others:
        raise damaged(file, at, f"only {bare(named[0].header)} given, a column of samples expected")
    if wanted is None:
        if len(others) > 1:
            raise damaged(file, at, f"{len(others)} columns given, `column` expected to say which ({known})")
        return others[0]
    matching = [column for column in others if wanted in (column.header, column.name)]
    if len(matching) != 1:
        what = "no column" if not matching else f"{len(matching)} columns"
        raise damaged(file, at, f"{what} called {bare(wanted)} given, one expected ({known})")
    return matching[0]
