"""The verdicts on a paper as one list of sections, which every format renders: tables, and records with fields."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from operator import attrgetter

from wavesym import __version__
from wavesym.papers.entries import Paper, PaperEntry
from wavesym.papers.pages.lines import (
    Code,
    Line,
    Sentence,
    correction,
    fault,
    formula,
    formula_or_words,
    join_lines,
    prose,
    sentence,
    statement,
)
from wavesym.papers.record import VERDICTS, Record, Reproduction, Verdict
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
ORIGINS = {
    "print": "The text itself proves the slip.",
    "scan": "The scan is garbled at this place beyond doubt.",
    "unknown": "Whether the print or the scan is at fault cannot be told from the text.",
}


@dataclass(frozen=True)
class Findings:
    """The verdicts on a paper, or on the records of it that were requested; `reproduce`: with their examples.

    `whole`: all of it was requested; `only` are the verdicts of those that are shown, empty for all of them.
    """

    paper: Paper
    records: tuple[Record, ...]
    whole: bool = False
    reproduce: bool = False
    only: frozenset[str] = frozenset()

    @property
    def visible(self) -> tuple[Record, ...]:
        """The records that are shown, of which the others are counted alone."""
        return tuple(record for record in self.records if not self.only or record.verdict in self.only)

    @property
    def are_complete(self) -> bool:
        """Whether everything could be tested."""
        return all(record.verdict != "untested" for record in self.records)

    @property
    def counts(self) -> list[tuple[Verdict, int]]:
        """How many records have each verdict, those that occur."""
        counted = Counter(record.verdict for record in self.records)
        return [(verdict, counted[verdict]) for verdict in VERDICTS if counted[verdict]]

    @property
    def faults(self) -> tuple[int, int]:
        """How many faults were put in, and seen."""
        mutations = [record.mutations for record in self.records]
        return sum(each.count for each in mutations), sum(each.turned_count for each in mutations)

    @property
    def errors(self) -> list[tuple[Record, ...]]:
        """What does not hold, in groups that are one error: one note in one place, or one line of a table."""
        groups: defaultdict[object, list[Record]] = defaultdict(list)
        for record in self.visible:
            if record.verdict != "holds":
                groups[self._error(record)].append(record)
        return [tuple(group) for group in groups.values()]

    @cached_property
    def _cells(self) -> frozenset[str]:
        return frozenset[str]().union(*(table.ids for table in self.paper.tables))

    def _error(self, record: Record) -> object:
        """What one error is distinguished from others by."""
        if record.id in self._cells:
            return record.id.split(".")[0], record.id.rsplit(".", 1)[-1], record.verdict
        note = record.entry.slip.note if record.entry.slip else ""
        return _place(record.entry), note or record.id, record.verdict


# the parts of a document


@dataclass(frozen=True)
class Cell:
    """A cell of a table; `verdict` where it is a record."""

    line: Line
    verdict: str = ""
    anchor: str = ""


@dataclass(frozen=True)
class Table:
    """A table: heads of its columns, and rows; `widths` are the shares of its columns in a line, in tenths."""

    heads: tuple[Cell, ...]
    rows: tuple[tuple[Cell, ...], ...]
    widths: tuple[int, ...] = ()
    is_grid: bool = False


@dataclass(frozen=True)
class Field:
    """What is said of a record under a name, in a line or, of a formula with ranges, in several; or a `listing`."""

    name: str
    lines: tuple[Line, ...] = ()
    listing: str = ""

    @property
    def line(self) -> Line:
        """All of it in one line."""
        return join_lines(self.lines)


@dataclass(frozen=True)
class JudgedEntry:
    """A record with all that is said of it."""

    id: str
    anchor: str
    verdict: str
    fields: tuple[Field, ...]


@dataclass(frozen=True)
class Block:
    """A part of a section, perhaps with a title: some lines, a table, or records."""

    title: str = ""
    verdict: str = ""
    text: str = ""
    table: Table | None = None
    entries: tuple[JudgedEntry, ...] = ()


@dataclass(frozen=True)
class Section:
    """A section of a document; the first one has no title."""

    title: str
    anchor: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Document:
    """All of it, in the order in which it is read."""

    title: str
    source: Line
    introduction: str
    sections: tuple[Section, ...]
    signs: Mapping[str, str]


def document(findings: Findings, format: str) -> Document:
    """What pages in a format show.

    Args:
        findings: the verdicts.
        format: its name; markdown has no tables of the paper.
    """
    about, (tried, turned) = findings.paper.description, findings.faults
    errors = [
        Block(_titles(group), group[0].verdict, entries=tuple(_entry(record, findings) for record in group))
        for group in findings.errors
    ]
    printed = [] if format == "markdown" else _printed_tables(findings)
    held = [record for record in findings.visible if record.verdict == "holds"]
    sections = [
        Section("", "", (counts(findings), statistics(findings))),
        Section("What does not hold as printed", "errors", tuple(errors)),
        Section("The tables, cell by cell", "tables", tuple(printed)),
        Section("What holds", "holds", tuple(_holding_blocks(held))),
        *appendices(findings),
    ]
    return Document(
        f"Errata to a paper by {about.author}",
        (f"{about.author}, {about.title} ({about.english}), {about.date}. {about.transcription}",),
        "Every formula, table cell, range and testable sentence was evaluated as it is printed and compared, in exact "
        "arithmetic (statements about curves on samples of the exact motion), with the derived laws of the same "
        f"systems. {len(findings.records)} records were judged. What holds, as printed or as corrected, was tried "
        f"again with {tried} faults put in, one at a time; {turned} of them made a comparison fail. Written by wavesym "
        f"{__version__}, verify --published --format {format}; verdicts and evidence are computed, notes and reasons "
        "are our reading.",
        tuple(section for section in sections if section.blocks),
        SIGNS,
    )


def word_cells(*texts: str) -> tuple[Cell, ...]:
    """Cells of plain words."""
    return tuple(Cell((text,)) for text in texts)


def counts(findings: Findings) -> Block:
    """How many records have each verdict."""
    rows = [(Cell((name,), name), *word_cells(str(count), VERDICTS[name])) for name, count in findings.counts]
    return Block(table=Table(word_cells("verdict", "records", "meaning"), tuple(rows), (2, 1, 7)))


def statistics(findings: Findings) -> Block:
    """The counts of each section and table, in the order of print."""
    used = [verdict for verdict, _ in findings.counts]
    rows = []
    for name, records in by_place(findings.records).items():
        counts = Counter(record.verdict for record in records)
        rows.append(word_cells(name, *(str(counts[verdict] or "") for verdict in used)))
    return Block("By section and table", table=Table(word_cells("where", *used), tuple(rows)))


def appendices(findings: Findings) -> list[Section]:
    """What was edited, what was not judged, and what no case turns."""
    edits = tuple(
        (Cell((record.id,)), Cell((Code(before),)), Cell((Code(after),) if after else ("nothing",)), Cell((why,)))
        for record in findings.visible
        for before, after, why in record.entry.edits
    )
    survivors = tuple(
        (Cell((record.id,)), Cell((fault(change),)), Cell((sentence(because or "unknown"),)))
        for record in findings.visible
        for change, because in record.mutations.survivors
    )
    unjudged = tuple(
        (Cell((span(lines), f", {where}" if where else "")), Cell((Sentence(Code(scan), prose(scan)),)), Cell((why,)))
        for lines, where, scan, why in _unjudged_parts(findings)
    )
    parts = [
        ("What is read otherwise than the scan has it", "edits", ("id", "scan", "read as", "why"), edits, (2, 3, 3, 2)),
        ("What was not judged, and why", "unjudged", ("source", "text", "why"), unjudged, (2, 4, 4)),
        ("Faults that no case turns, and why", "survivors", ("id", "fault", "why"), survivors, (2, 4, 4)),
    ]
    return [
        Section(title, anchor, (Block(table=Table(word_cells(*heads), rows, widths)),) if rows else ())
        for title, anchor, heads, rows, widths in parts
    ]


def _unjudged_parts(findings: Findings) -> Iterable[tuple[tuple[int, int], str, str, str]]:
    for passage in findings.paper.passages if findings.whole else ():
        if passage.why:
            yield passage.lines, passage.where, passage.text, passage.why
        for aside in passage.asides:
            yield passage.lines, passage.where, aside.scan, aside.why


def _holding_blocks(records: Sequence[Record]) -> list[Block]:
    """What holds, by place and by what it was compared with."""
    blocks = []
    for name, group in by_place(records).items():
        for against, same in groupby(group, attrgetter("reference")):
            rows = [
                (
                    Cell((record.id,), anchor=_anchor(record)),
                    Cell((f"{record.entry.where}, {span(record.entry.lines)}",)),
                    Cell(_full_statement(record)),
                    Cell((sentence(f"{' '.join(record.evidence)} {_faults(record)}."), *_note(record))),
                )
                for record in same
            ]
            table = Table(word_cells("id", "source", "printed", "evidence"), tuple(rows), (2, 2, 3, 3))
            blocks.append(Block(name, text=f"Compared with {against}:", table=table))
            name = ""
    return blocks


def _note(record: Record) -> Line:
    return (" Note: ", sentence(record.note)) if record.note else ()


def _full_statement(record: Record) -> Line:
    """What is printed, in English too, and the ranges that are not printed."""
    parts = [*((prose(record.entry.printed), ("in English: ",)) if record.entry.english else ()), *statement(record)]
    line = join_lines(parts) if not record.entry.english else (*join_lines(parts[:2]), *join_lines(parts[2:]))
    inferred = join_lines([(formula(range_),) for range_ in record.entry.inferred_ranges])
    return (*line, " (not printed: ", *inferred, ")") if inferred else line


def _entry(record: Record, findings: Findings) -> JudgedEntry:
    return JudgedEntry(record.id, _anchor(record), record.verdict, tuple(fields(record, findings)))


def fields(record: Record, findings: Findings) -> Iterable[Field]:
    """All that is said of a record."""
    entry, slip = record.entry, record.entry.slip
    yield Field("where", ((f"{entry.where}, {span(entry.lines)} of the source",),))
    if entry.english:
        yield Field("printed", (prose(entry.printed),))
        yield Field("in English", statement(record))
    else:
        yield Field("printed", statement(record))
    if entry.inferred_ranges:
        yield Field("not printed", tuple((formula(range_),) for range_ in entry.inferred_ranges))
    for before, after, why in entry.edits:
        yield Field("read", ((Code(before), " as ", Code(after) if after else "nothing", f": {why}"),))
    if slip:
        yield Field("corrected", correction(record))
    if record.difference:
        yield Field("difference", ((formula(record.difference),),))
    yield Field("evidence", ((sentence(" ".join(record.evidence)),),))
    if record.note:
        yield Field("note", ((sentence(record.note),),))
    if origin := describe_origin(record):
        yield Field("origin", ((origin,),))
    yield Field("tested", ((sentence(f"Compared with {record.reference}; {_faults(record)}."),),))
    for change, because in record.mutations.survivors if not findings.whole else ():
        yield Field("unseen", ((fault(change), ", a fault that no case shows: ", sentence(because)),))
    for problem in record.problems:
        yield Field("problem", ((problem,),))
    if findings.reproduce:
        yield from _reproduction_fields(record)


def describe_origin(record: Record) -> str | None:
    """Whether the print or the scan is at fault; None where neither is."""
    slip = record.entry.slip
    return ORIGINS[slip.origin] if slip and record.verdict in ("misprint", "unreadable") else None


def reproduction(record: Record) -> dict[str, str] | None:
    """How to see a counterexample: its scene with the name of a file, the command that shows it, what to look at, and
    what it says; only this where there is no chain behind it. None where there is no counterexample.
    """
    wrong = record.counterexample
    if wrong is None:
        return None
    example, file = (wrong.example(), scene_file(record)) if wrong.example else (Reproduction("", "", ""), "")
    command = example.command.replace("SCENE", file)
    return {"file": file, "scene": example.scene, "command": command, "look": example.look, "said": f"{wrong}."}


def _reproduction_fields(record: Record) -> Iterable[Field]:
    parts = reproduction(record)
    if parts and parts["file"]:
        yield Field("reproduce", (("Save this scene as ", Code(parts["file"]), ":"),), parts["scene"])
        yield Field("then type", ((Code(parts["command"]),),))
        yield Field("look at", ((sentence(parts["look"]),),))
    elif parts:
        words = "There is no chain behind it to run: these are all its numbers."
        yield Field("reproduce", ((f"{parts['said']} {words}",),))


def scene_file(record: Record) -> str:
    """The name of a file for a record, without what a shell would read."""
    return re.sub(r"[^\w.-]+", "_", re.sub(r"[()]", "", record.id)) + ".toml"


# the tables of the paper


def _printed_tables(findings: Findings) -> list[Block]:
    judged = {record.id: record for record in findings.visible}
    scans = {
        place.id: place.scan.strip("$")
        for passage in findings.paper.passages
        for place in places(passage.table, passage.text, passage.lines[0])
    }
    return [
        Block(table.name, text=table.caption, table=_printed_table(table, judged, scans, findings))
        for table in findings.paper.tables
        if table.ids & judged.keys()
    ]


def _printed_table(
    table: PrintedTable, judged: Mapping[str, Record], scans: Mapping[str, str], findings: Findings
) -> Table:
    """A table as it is printed; each cell with its verdict."""

    def cell(row: TableHead, column: TableHead) -> Cell:
        id = table.cell_id(row, column)
        if id in judged:
            return Cell(statement(judged[id])[0], judged[id].verdict, _anchor(judged[id]))
        if column.name in table.unjudged_columns:
            return Cell((formula(scans[id]),))
        return Cell(("not requested" if id in findings.paper.entries else "",))

    def head(head: TableHead, id: str) -> Cell:
        """A record with its ranges, or a label."""
        known = findings.paper.entries
        more = [known[head.record].printed] if head.record in known else []
        if id not in known:
            line: Line = (formula(head.label.strip("$").replace("\N{GREEK SMALL LETTER ALPHA}", r"\alpha")),)
        else:
            line = (formula(known[id].printed),)
            more += known[id].ranges
        line = (*line, " ", *join_lines([(formula_or_words(each),) for each in more])) if more else line
        return Cell(line, judged[id].verdict, _anchor(judged[id])) if id in judged else Cell(line)

    heads = (Cell(("",)), *(head(column, table.column_id(column)) for column in table.columns))
    rows = [(head(row, table.row_id(row)), *(cell(row, column) for column in table.columns)) for row in table.rows]
    return Table(heads, tuple(rows), is_grid=True)


# small things


def _place(entry: PaperEntry) -> str:
    """The section or table of an entry."""
    name = entry.where.split(",")[0].strip() or "elsewhere"
    return name[0].upper() + name[1:]


def by_place(records: Iterable[Record]) -> dict[str, list[Record]]:
    """The records of each section and table."""
    places: dict[str, list[Record]] = {}
    for record in records:
        places.setdefault(_place(record.entry), []).append(record)
    return places


def span(lines: tuple[int, int]) -> str:
    """Lines of the source in words."""
    first, last = lines
    return f"line {first}" if first == last else f"lines {first}-{last}"


def _anchor(record: Record) -> str:
    return re.sub(r"[^\w.-]+", "_", record.id.strip("("))


def _faults(record: Record) -> str:
    """How many faults were tried, in words."""
    tried = record.mutations.count
    return f"{tried} fault{'' if tried == 1 else 's'} put in, {record.mutations.turned_count} of them seen"


def _titles(group: Sequence[Record]) -> str:
    """The ids of an error's records: all of a few, the first and how many more of many."""
    ids = [record.id for record in group]
    return ", ".join(ids) if len(ids) <= 3 else f"{ids[0]} and {len(ids) - 1} more"
