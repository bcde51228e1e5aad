"""The verdicts as a document to read and cite, before its markup: what the templates of HTML and LaTeX go through."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import sqrt
from operator import attrgetter

from wavesym import __version__
from wavesym.papers.entries import About
from wavesym.papers.pages.findings import (
    Findings,
    ScanEdit,
    Survivor,
    Unjudged,
    by_place,
    difference,
    faults_tried,
    lines,
    origin,
    titles,
)
from wavesym.papers.pages.reproduction import ReproducedPage, reproduction
from wavesym.papers.pages.shown import Shown, Stated, compared, formula, inferred, printed, readable, words
from wavesym.papers.record import VERDICTS, Record
from wavesym.papers.tables import PrintedTable, TableHead, places

SIGNS = {
    "holds": "✓",
    "misprint": "✗",
    "unreadable": "?",
    "convention": "≈",
    "model": "≠",
    "depends": "±",
    "incomplete": "…",
    "untested": "!",
}
"""Of verdicts, beside their colours: nothing is said by colour alone."""

LONGEST = 90
"""Characters of a formula that may stand beside another one."""
SHORTEST = 16
"""Characters that every column of a table has room for."""


@dataclass(frozen=True)
class Judged:
    """A record as it is shown; `right` where what is printed does not hold, below it where both are `wide`.

    Of prose `words` are printed, and `printed` says so in English.
    """

    id: str
    anchor: str
    verdict: str
    sign: str
    where: str
    lines: str
    words: Shown | None
    printed: Stated
    right: Stated | None
    wide: bool
    size: int
    inferred: tuple[Shown, ...]
    note: str
    evidence: str
    difference: str
    origin: str
    against: str
    faults: str
    problems: tuple[str, ...]
    reproduction: ReproducedPage | None


@dataclass(frozen=True)
class Mistake:
    """One error, in all places where it is printed."""

    number: int
    title: str
    verdict: str
    sign: str
    note: str
    records: tuple[Judged, ...]


@dataclass(frozen=True)
class Head:
    """The head of a row or column: a formula, or words, or both; `judged` where it is a record."""

    formula: Shown | None
    words: str
    judged: Judged | None = None


@dataclass(frozen=True)
class Laid:
    """A table as the paper prints it; a cell that is no record is what it names, or None.

    `widths` are parts of the whole, of the heads of rows and of each column.
    """

    name: str
    caption: str
    columns: tuple[Head, ...]
    rows: tuple[tuple[Head, tuple[Judged | Head | None, ...]], ...]
    widths: tuple[float, ...]


@dataclass(frozen=True)
class Document:
    """All of it, in the order in which it is read."""

    about: About
    version: str
    command: str
    whole: bool
    records: int
    counts: Sequence[tuple[str, str, int, str]]
    statistics: Sequence[tuple[str, Sequence[int]]]
    tried: int
    turned: int
    mistakes: Sequence[Mistake]
    tables: Sequence[Laid]
    holding: Mapping[str, Sequence[tuple[str, Sequence[Judged]]]]
    edits: Sequence[ScanEdit]
    unjudged: Sequence[tuple[str, Unjudged]]
    survivors: Sequence[Survivor]


def document(findings: Findings, format: str) -> Document:
    """The document of some findings."""
    judged = {record.id: _judged(record, findings.reproduce) for record in findings.records}
    mistakes = [
        Mistake(
            number,
            titles(group),
            group[0].verdict,
            SIGNS[group[0].verdict],
            _note(group),
            tuple(judged[record.id] for record in group),
        )
        for number, group in enumerate(findings.errors, 1)
    ]
    tried, turned = findings.faults
    used = [verdict for verdict, _ in findings.counts]
    return Document(
        findings.paper.about,
        __version__,
        f"wavesym verify --published --format {format}",
        findings.whole,
        len(findings.records),
        [(verdict, SIGNS[verdict], count, VERDICTS[verdict]) for verdict, count in findings.counts],
        [(name, [counts[verdict] for verdict in used]) for name, counts in findings.statistics],
        tried,
        turned,
        mistakes,
        [_laid(table, findings, judged) for table in findings.paper.tables if table.ids & judged.keys()],
        {name: _by_test([judged[record.id] for record in group]) for name, group in by_place(findings.holding).items()},
        findings.edits,
        [(lines(part.lines), part) for part in findings.unjudged],
        findings.survivors,
    )


def _judged(record: Record, reproduce: bool) -> Judged:
    entry = record.entry
    one, other = compared(record) or (printed(record), None)
    return Judged(
        record.id,
        re.sub(r"[^\w.-]+", "_", record.id.strip("(")),
        record.verdict,
        SIGNS[record.verdict],
        entry.where.removesuffix(f", {record.id}"),
        lines(entry.lines),
        words(record),
        one,
        other,
        max(len(entry.statement), len(record.corrected or "")) > LONGEST,
        len(entry.printed),
        inferred(record),
        readable(record.note),
        readable(" ".join(record.evidence)),
        difference(record),
        origin(record),
        record.against,
        faults_tried(record),
        record.problems,
        reproduction(record) if reproduce else None,
    )


def _by_test(records: Sequence[Judged]) -> list[tuple[str, list[Judged]]]:
    """Records one after another, put together where they are compared with the same."""
    return [(against, list(group)) for against, group in groupby(records, attrgetter("against"))]


def _note(group: Sequence[Record]) -> str:
    """The note that an error's records share, if they do."""
    notes = {record.note for record in group}
    return readable(notes.pop()) if len(notes) == 1 else ""


def _laid(table: PrintedTable, findings: Findings, judged: Mapping[str, Judged]) -> Laid:
    columns = tuple(_head(column, findings, judged.get(table.column_id(column))) for column in table.columns)
    scans = {
        place.id: Head(formula(place.scan.strip("$")), "")
        for passage in findings.paper.passages
        for place in places(passage.table, passage.text, passage.lines[0])
        if place.column.name in place.table.unjudged
    }
    rows = []
    for row in table.rows:
        ids = [table.cell_id(row, column) for column in table.columns]
        head = _head(row, findings, judged.get(table.row_id(row)))
        rows.append((head, tuple(judged.get(id) or scans.get(id) for id in ids)))
    return Laid(table.name, table.caption, columns, tuple(rows), _widths(rows))


def _widths(rows: Sequence[tuple[Head, Sequence[Judged | Head | None]]]) -> tuple[float, ...]:
    """By the longest cell of a column; a cell twice as long takes two lines of a column that is not twice as wide."""
    columns = zip(*(cells for _, cells in rows), strict=True)
    longest = [max(cell.size if isinstance(cell, Judged) else 0 for cell in column) for column in columns]
    sizes = [sqrt(max(SHORTEST, size)) for size in (max(len(head.words) for head, _ in rows), *longest)]
    return tuple(round(size / sum(sizes), 3) for size in sizes)


def _head(head: TableHead, findings: Findings, judged: Judged | None) -> Head:
    """A head as it is printed: a record with its ranges, or a label."""
    known = findings.paper.entries
    other = (known[head.record].printed,) if head.record in known else ()
    if judged is None:
        label = head.label.strip("$").replace("\N{GREEK SMALL LETTER ALPHA}", r"\alpha")
        return Head(formula(label), readable(", ".join(other)))
    return Head(judged.printed.formula, readable(", ".join((*other, *known[judged.id].ranges))), judged)
