"""A paper as data: passages of its text in their order, each cut into records, or set aside with a reason.

A passage is some whole lines of the source, as they stand, with marks around what is a record (selection.py); what of a
passage is no record is set aside with a reason, so that nothing can be left out unseen. All passages together, with
their marks, translations and edits, have a committed hash: a transcription that is changed afterwards no longer fits it
(`problems`).
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from itertools import pairwise, product
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from wavesym.papers import tables
from wavesym.papers.selection import Aside, MarkedText, formula_text, has_edit, read_marks
from wavesym.papers.tables import PrintedTable

Origin = Literal["print", "scan", "unknown"]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class Slip(_Data):
    """What is right where what is printed is wrong: the whole formula or sentence, as printed where only ranges differ.

    `origin`: "print" only where the text itself proves it, "scan" where the scan is garbled beyond doubt.
    """

    origin: Origin = "unknown"
    correction: str = ""
    ranges: tuple[str, ...] | None = None
    note: str


class PaperEntry(_Data):
    """One printed formula, cell or sentence.

    `scan` is its part of the source, verbatim; `printed` is what is read of it, in one line, without layout and with
    its `edits` (from, to, why). `english` is a sentence in the words that are judged; then `edits` are of what it says.
    `ranges` are printed too, `inferred_ranges` are not. `equivalent` are the faults that no case can turn (name, why).
    `subject` is what the test of this `kind` needs to know. The ranges of a cell of a table are those of its `heads`.
    """

    id: str
    kind: str
    printed: str
    english: str = ""
    scan: str = ""
    ranges: tuple[str, ...] = ()
    inferred_ranges: tuple[str, ...] = ()
    edits: tuple[tuple[str, str, str], ...] = ()
    equivalent: tuple[tuple[str, str], ...] = ()
    slip: Slip | None = None
    note: str = ""
    subject: Mapping[str, Any] = {}
    where: str = ""
    lines: tuple[int, int] = (0, 0)
    heads: tuple[str, ...] = ()

    @model_validator(mode="before")
    @classmethod
    def _correct_as_printed(cls, data: dict[str, Any]) -> dict[str, Any]:
        """A slip of the ranges alone leaves the formula as it is."""
        slip = data.get("slip")
        if not isinstance(slip, dict) or "correction" in slip:
            return data
        return {**data, "slip": {**slip, "correction": data.get("english") or data["printed"]}}

    @property
    def statement(self) -> str:
        """What is judged: the formula, or the sentence in English."""
        return self.english or self.printed

    @property
    def printed_strings(self) -> tuple[str, tuple[str, ...]]:
        """What is judged, and its ranges, those that are not printed too."""
        return self.statement, (*self.ranges, *self.inferred_ranges)

    @property
    def right_ranges(self) -> tuple[str, ...]:
        """The printed ranges, as they are right."""
        return self.ranges if self.slip is None or self.slip.ranges is None else self.slip.ranges

    @property
    def right_strings(self) -> tuple[str, tuple[str, ...]]:
        """What is right, as printed or as corrected, and its ranges, those that are not printed too."""
        right = self.statement if self.slip is None else self.slip.correction
        return right, (*self.right_ranges, *self.inferred_ranges)


class Passage(_Data):
    """Lines of the source, first to last, with their text where anything of it is judged, else the reason.

    `marked` is the text with its marks. `where` names the place; {line} in it is the last part of a record's id.
    `record` has what there is to say of records, by id (`merge_records`); those of the passage have its `kind` and
    `subject` unless they say otherwise. Every cell of a `table` is a record too.
    """

    lines: tuple[int, int]
    where: str = ""
    marked: str = Field("", alias="text")
    why: str = ""
    kind: str = ""
    subject: Mapping[str, Any] = {}
    record: Mapping[str, Mapping[str, Any]] = {}
    table: tuple[PrintedTable, ...] = ()

    @cached_property
    def marks(self) -> MarkedText:
        """The text, and its parts."""
        return read_marks(self.marked)

    @property
    def text(self) -> str:
        """The lines as they stand."""
        return self.marks.text

    @cached_property
    def entries(self) -> tuple[PaperEntry, ...]:
        """The records, each with its place and its scan."""
        heads = [self._entry(id) for id in self.marks.records]
        return (*heads, *self._cells({entry.id: entry for entry in heads}))

    def _entry(self, id: str) -> PaperEntry:
        parts, data = self.marks.records[id], self.record.get(id, {})
        edits, (start, end) = data.get("edits", ()), parts.span
        (formula,) = (self.text[slice(*span)] for span in parts.formulas)
        return PaperEntry(
            id=id,
            printed=" ".join(formula.split()) if data.get("english") else formula_text(formula, edits),
            scan=self.text[start:end],
            lines=(self._line(start), self._line(max(start, end - 1))),
            **{
                "kind": self.kind,
                "subject": self.subject,
                "where": self.where.replace("{line}", id.rpartition(".")[-1]),
                "ranges": [formula_text(self.text[slice(*span)], edits) for span in parts.ranges],
                **data,
            },
        )

    def _line(self, place: int) -> int:
        """The number of the line in which a place of the text is."""
        return self.lines[0] + self.text.count("\n", 0, place)

    def _cells(self, known: Mapping[str, PaperEntry]) -> Iterator[PaperEntry]:
        """The cells of tables, each with the ranges of its heads."""
        for place in tables.places(self.table, self.text, self.lines[0]):
            if place.column.name in place.table.unjudged_columns:
                continue
            heads = tuple(head for head in place.heads if head in known)
            own = self.record.get(place.id, {})
            yield PaperEntry(
                id=place.id,
                printed=formula_text(place.scan, own.get("edits", ())),
                scan=place.scan,
                lines=(place.line, place.line),
                heads=heads,
                **{
                    "kind": "cell",
                    "ranges": tuple(range_ for head in heads for range_ in _head_ranges(known[head])),
                    "subject": {"row": place.row.name, "column": place.column.name},
                    "where": f"{self.where}, row {place.row.name}, column {place.column.name}",
                    **own,
                },
            )

    @property
    def asides(self) -> tuple[Aside, ...]:
        """The parts that are not judged, columns of tables among them."""
        cells = tables.places(self.table, self.text, self.lines[0])
        named = ((cell.scan, cell.table.unjudged_columns.get(cell.column.name)) for cell in cells)
        unjudged = dict.fromkeys((self.text[slice(*span)], why) for span, why in self.marks.asides)
        return tuple(Aside(scan, why) for scan, why in (*unjudged, *named) if why)


def _head_ranges(head: PaperEntry) -> tuple[str, ...]:
    """The ranges that a head gives to its cells: its own, and itself where it is one."""
    return (head.printed, *head.ranges) if head.kind == "range" else head.ranges


class PaperDescription(_Data):
    """A paper: author, title, the title in English, its date, and in what form it was at hand."""

    author: str
    title: str
    english: str
    date: str
    transcription: str


@dataclass(frozen=True)
class Paper:
    """What is known of a paper itself, all passages in the order of the source, and the `digest` that they had when
    they were checked.
    """

    description: PaperDescription
    passages: tuple[Passage, ...]
    digest: str

    @cached_property
    def entries(self) -> Mapping[str, PaperEntry]:
        """All records by their ids, in the order of print."""
        return {entry.id: entry for passage in self.passages for entry in passage.entries}

    @property
    def tables(self) -> tuple[PrintedTable, ...]:
        """All tables."""
        return tuple(table for passage in self.passages for table in passage.table)


def read_paper(directory: Path) -> Paper:
    """The passages of the TOML files of a directory, and what paper.toml says of the paper."""
    data = {file.stem: tomllib.loads(file.read_text(encoding="utf-8")) for file in sorted(directory.glob("*.toml"))}
    about = data.pop("paper")
    checked = about.pop("digest")
    passages = [
        Passage(**{**passage, "record": merge_records(passage.get("record", {}))})
        for file in data.values()
        for passage in file["passage"]
    ]
    for first, last, where, why in (row for file in data.values() for row in file.get("unjudged_lines", ())):
        passages.append(Passage(lines=(first, last), where=where, text="", why=why))
    in_order = tuple(sorted(passages, key=lambda passage: passage.lines))
    return Paper(PaperDescription(**about), in_order, checked)


def merge_records(tables: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """What is known of each record, by id, in the order of the first keys.

    A key such as "T1.{I,III}.S" is of several records. Lists that several keys give one record are joined, and what a
    slip has; ValueError where anything else stands there twice.
    """
    merged: dict[str, dict[str, Any]] = {}
    for key, data in tables.items():
        choices = [part.split(",") if number % 2 else [part] for number, part in enumerate(re.split(r"[{}]", key))]
        for parts in product(*choices):
            id = "".join(parts)
            merged[id] = _joined_values(id, merged.get(id, {}), data)
    return merged


def _joined_values(name: str, known: Mapping[str, Any], more: Mapping[str, Any]) -> dict[str, Any]:
    joined = dict(known)
    for key, value in more.items():
        match joined.get(key), value:
            case None, _:
                joined[key] = value
            case list() as values, list():
                joined[key] = [*values, *value]
            case dict() as values, dict():
                joined[key] = _joined_values(f"{name}.{key}", values, value)
            case _:
                raise ValueError(f"{name}: {key} stands there twice")
    return joined


def digest(passages: Iterable[Passage]) -> str:
    """The hash of passages with their marks, translations and edits; how many spaces there are makes no difference."""
    parts: list[object] = []
    for passage in passages:
        parts += [passage.lines, passage.marked]
        parts += [part for entry in passage.entries for part in (entry.english, *entry.edits) if part]
    return sha256(" ".join(" ".join(map(str, parts)).split()).encode()).hexdigest()


WHOLE = "paper"
"""What is wrong with the data as a whole, not with a record."""


def problems(paper: Paper) -> Iterator[tuple[str, str]]:
    """What does not fit: the id of a record, or `WHOLE`, and what is wrong. A passage's are all its records'."""
    if (found := digest(paper.passages)) != paper.digest:
        yield WHOLE, f"passages, marks, translations and edits are not those that were checked: their digest is {found}"
    spans = [passage.lines for passage in paper.passages]
    if twice := [after for before, after in pairwise(spans) if after[0] <= before[1]]:
        yield WHOLE, f"lines in two passages: {twice}"
    for passage in paper.passages:
        for problem in _misfits(passage):
            message = f"lines {passage.lines[0]}-{passage.lines[1]}: {problem}"
            yield from ((entry.id, message) for entry in passage.entries)
            if not passage.entries:
                yield WHOLE, message
        for entry in passage.entries:
            yield from ((entry.id, problem) for problem in _unlike(entry))


def _misfits(passage: Passage) -> Iterator[str]:
    """How a passage leaves out something of its lines."""
    if not passage.text:
        if not passage.why:
            yield "neither judged nor set aside"
        return
    if len(passage.text.split("\n")) != passage.lines[1] - passage.lines[0] + 1:
        yield "not as many lines as it says"
    ids = {entry.id for entry in passage.entries}
    yield from (f"there is no cell {id}" for id in passage.record if id not in ids)
    if passage.table:
        others = [entry.scan for entry in passage.entries] + [aside.scan for aside in passage.asides]
        yield from tables.problems(passage.table, passage.text, passage.lines[0], others)
    else:
        yield from (f"neither judged nor set aside: {rest.strip()}" for rest in passage.marks.rest if _says(rest))


def _says(rest: str) -> bool:
    """Whether what is left of a passage is more than the number of an equation and a few words."""
    words = formula_text(_TAGS.sub("", rest)).replace(" ", "")
    return len(words) > LONGEST_REST or bool(re.search(r"[\d\\]", words))


LONGEST_REST = 25
"""Letters that may stand between records without a reason: "and", "where", "for"."""
_TAGS = re.compile(r"\(\d\.\d+\)(_\d)?|\[cd\.\]")


def _unlike(entry: PaperEntry) -> Iterator[str]:
    """Edits that are none."""
    for before, after, _ in entry.edits:
        if not has_edit(entry.scan, before):
            yield f"nothing to edit: {before}"
        if entry.english and formula_text(after) not in entry.english:
            yield f"is not in the English: {after}"
