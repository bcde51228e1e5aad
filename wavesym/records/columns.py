"""Columns of text: comments after #, a header line with a name for each column, then a row for each sample.

Without a header one column is samples, and of two the first is the times. A first column in seconds is the times under
whatever name.

The unit of a column stands behind its name in brackets, `accel [m/s^2]` or `acc (g)`, or, where the name is a plain
word for a quantity, after an underscore: `time_s`, `accel_g`. (a_g is the acceleration of the ground.) Powers may be
written as loggers do: m/s2 and m/s² are m/s^2.

Columns stand apart by tabs, semicolons or commas, or where there are none by blanks; cells may be quoted. A decimal
comma is read where no comma parts columns, and all numbers have it that have a fraction.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import chain, islice
from typing import NamedTuple

from wavesym.records.record_file import RecordFile, bare, damage_error, decimal

_TIMES = ("time", "t", "tau")
_QUANTITIES = "acc|accel|acceleration|velocity|displacement|force|moment|torque"
_SECONDS = ("s", "sec", "ms")
_MARKS, _BLANK = "\t;,", " "
_MOST_COLUMNS = 10_000
_HEADLESS = "begin lines of words, but one header, with #"
_QUOTING = re.compile(r'(?:[^"#]|"[^"]*("|$))*')
_NAMES = re.compile(r"[^\s\[(]+(?:\s*(?:\[[^\]]*\]|\([^)]*\)))?")  # of columns, each with its unit
_BRACKETS = re.compile(r"(.*\S)\s*(?:\[(.*)\]|\((.*)\))")
_POWER = re.compile(r"(?<=[A-Za-z])[2-9](?![A-Za-z0-9])")
_RAISED = str.maketrans({"²": "2", "³": "3"})
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
    top = list(islice(rows, 2))
    at, head = top[0] if top else (1, "")
    if max(head.count(mark) for mark in _MARKS) >= _MOST_COLUMNS:
        raise damage_error(file, at, f"more than {_MOST_COLUMNS} columns; write a column of samples and one of times")
    mark = _mark(file, top)
    named = [_column(place, cell) for place, cell in enumerate(_cells(file, at, head, mark))]
    headless = all(decimal(column.header.replace(",", ".")) is not None for column in named)
    if headless and len(named) > 2:
        raise damage_error(file, at, "no header; write one such as time,acceleration")
    if headless:
        named = [_Column(place, "", name, "") for place, name in enumerate(("time", "samples")[-len(named) :])]
    first = next((column for column in named[:1] if len(named) > 1 and column.unit in _SECONDS), None)
    clock = next((column for column in named if column.name.casefold() in _TIMES), first)
    below = _cells(file, *top[1], mark) if len(top) > 1 else []
    numeric = any(decimal(cell.replace(",", ".")) is not None for cell in below)
    column = _choose(file, at, named, clock, wanted, numeric=numeric)
    decimals = _Decimals(file, mark is not None and mark != ",", named if numeric else ())
    times: list[Fraction] = []
    samples: list[Fraction] = []
    written: list[str] = []
    places: list[int] = []
    for number, row in chain(top if headless else top[1:], rows):
        cells = _cells(file, number, row, mark)
        if len(cells) != len(named):
            words = "" if places else ", and # before other lines of words"
            raise damage_error(
                file, number, f"{len(cells)} columns, but {len(named)} in the header; write as many{words}"
            )
        if clock:
            times.append(decimals.read(cells[clock.place], number, clock.place, first=not places)[0])
        sample, word = decimals.read(cells[column.place], number, column.place, first=not places)
        samples.append(sample)
        written.append(word)
        places.append(number)
    if not places:
        raise damage_error(file, at, "the file ends after its header; write rows of numbers")
    return RecordFile(
        file,
        f"CSV, {bare(column.header)}" if column.header else f"without a header: {', '.join(c.name for c in named)}",
        tuple(samples),
        tuple(written),
        tuple(places),
        column.unit,
        clock.unit if clock else "",
        times=tuple(times) if clock else None,
        head=at,
    )


def _rows(lines: Sequence[str]) -> Iterator[tuple[int, str]]:
    """The lines that say something, with their numbers, without comments."""
    for number, line in enumerate(lines, 1):
        if row := (_QUOTING.match(line)[0] if '"' in line else line.partition("#")[0]).strip():  # type: ignore[index]
            yield number, row


def _mark(file: str, top: Sequence[tuple[int, str]]) -> str | None:
    """What columns stand apart by: what makes as many of the header as of the row after it; None where nothing does."""
    there = [mark for mark in _MARKS if top and mark in top[0][1]]
    for mark in there:
        if len({len(_cells(file, number, row, mark)) for number, row in top}) == 1:
            return mark
    numbers = [decimal(word.replace(",", ".")) for word in top[-1][1].split()] if top and not there else []
    return _BLANK if len(numbers) > 1 and None not in numbers else next(iter(there), None)


def _cells(file: str, number: int, row: str, mark: str | None) -> list[str]:
    """The cells of a row, without quotes and without what is empty around them."""
    if mark == _BLANK:
        return row.split() if decimal(row.split()[0].replace(",", ".")) is not None else _NAMES.findall(row)
    if '"' not in row:
        return [cell.strip() for cell in row.split(mark)] if mark else [row]
    try:
        (cells,) = csv.reader([row], delimiter=mark or ",", skipinitialspace=True, strict=True)
    except csv.Error:
        raise damage_error(file, number, "quotes inside a cell; write them around whole cells") from None
    return [cell.strip() for cell in cells]


class _Decimals:
    """The numbers of a file, exact; with a decimal comma where it `may` be one and every other number has it."""

    def __init__(self, file: str, may: bool, named: Sequence[_Column]) -> None:
        self._file, self._may, self._named = file, may, named
        self._mark: str | None = None  # once there was one

    def read(self, word: str, line: int, place: int, *, first: bool) -> tuple[Fraction, str]:
        """A number, and how it is written, with a point; whether its row is the `first` decides what helps."""
        mark = "." if "." in word else "," if self._may and "," in word else None
        plain = word.replace(",", ".") if mark == "," else word
        value = decimal(plain)
        if value is None:
            name = f" ({bare(self._named[place].header)})" if self._named else ""
            remedy = _HEADLESS if first else "write a number in every row"
            raise damage_error(self._file, line, f"column {place + 1}{name} is no decimal; {remedy}")
        if mark is not None and mark != self._mark:
            if self._mark is not None:
                raise damage_error(
                    self._file, line, f'{bare(word)} is not a number; write a decimal with "{self._mark}" as before'
                )
            self._mark = mark
        return value, plain


def _column(place: int, header: str) -> _Column:
    if found := _BRACKETS.fullmatch(header):
        return _Column(place, header, found[1], _unit(found[2] or found[3] or ""))
    if found := _SUFFIX.fullmatch(header):
        return _Column(place, header, found[1], _unit(found[2]))
    return _Column(place, header, header, "")


def _unit(text: str) -> str:
    """A unit of a header, its powers as scenes write them."""
    return bare(_POWER.sub(r"^\g<0>", text.translate(_RAISED).strip()))


def _choose(
    file: str, at: int, named: Sequence[_Column], clock: _Column | None, wanted: str | None, *, numeric: bool
) -> _Column:
    """The column of the samples; messages name those of a `numeric` table, in which numbers follow the header."""
    others = [column for column in named if column is not clock]
    known = f" ({', '.join(bare(column.header) for column in others[:8])})" if numeric else ""
    if not others:
        raise damage_error(file, at, "only a column of times; write a column of samples")
    if wanted is None:
        if len(others) > 1 and not numeric:
            raise damage_error(file, at, f"{len(named)} columns, and no number below; {_HEADLESS}")
        if len(others) > 1:
            raise damage_error(file, at, f"{len(others)} columns of samples; write `column` to say which{known}")
        return others[0]
    matching = [column for column in others if wanted in (column.header, column.name)]
    if len(matching) != 1:
        what = "no column" if not matching else f"{len(matching)} columns"
        raise damage_error(file, at, f"{what} called {bare(wanted)}; write the name of one{known}")
    return matching[0]
