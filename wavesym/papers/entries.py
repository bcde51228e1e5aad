"""A paper as data: passages of its text in their order, each cut into records, or set aside with a reason.

A passage is some whole lines of the source, as they stand. A record says what is printed there, and selects its part of
the passage by that (selection.py); what of a passage is no record is set aside with a reason, so that nothing can be
left out unseen. The lines of every passage, and its translations and edits, have a committed hash: a transcription that
is changed afterwards no longer fits it (`problems`).
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
from typing import Any, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict, model_validator

from wavesym.papers import tables
from wavesym.papers.selection import plain, position
from wavesym.papers.tables import PrintedTable

Origin = Literal["print", "scan", "unknown"]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


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

    `printed` stands in one line, a formula without words; `scan` is its part of the source, verbatim, from which it
    differs by `edits` alone (from, to, why). `english` is a sentence in the words that are judged; then `edits` are of
    what it says. `ranges` are printed too, `inferred_ranges` are not. `equivalent` are the faults that no case can
    turn (name, why). `subject` is what the test of this `kind` needs to know. The ranges of a cell of a table are those
    of its `heads`, whose records bind them to the source.
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
    def right_strings(self) -> tuple[str, tuple[str, ...]]:
        """What is right, as printed or as corrected: the formula, and its ranges."""
        if self.slip is None:
            return self.statement, (*self.ranges, *self.inferred_ranges)
        ranges = self.ranges if self.slip.ranges is None else self.slip.ranges
        return self.slip.correction, (*ranges, *self.inferred_ranges)


class Aside(NamedTuple):
    """A part of a passage that is not judged: a definition, an announcement, a reference."""

    scan: str
    why: str


class Passage(_Data):
    """Lines of the source, first to last, with their text where anything of it is judged, else the reason.

    `where` names the place; {line} in it is the last part of a record's id. `record` has what is printed, by id
    (`merge_records`); its records have the `kind` and `subject` of the passage unless they say otherwise. Every cell of
    a `table` is a record too, about which `record` may say more.
    """

    lines: tuple[int, int]
    where: str = ""
    text: str = ""
    why: str = ""
    kind: str = ""
    subject: Mapping[str, Any] = {}
    record: Mapping[str, Mapping[str, Any]] = {}
    aside: tuple[Aside, ...] = ()
    table: tuple[PrintedTable, ...] = ()

    @cached_property
    def entries(self) -> tuple[PaperEntry, ...]:
        """The records, each with its place and its scan."""
        cells = {place.id for place in tables.places(self.table, self.text, self.lines[0])}
        used: list[tuple[int, int]] = []
        heads = [self._entry(id, data, used) for id, data in self.record.items() if id not in cells]
        return (*heads, *self._cells({entry.id: entry for entry in heads}))

    def _entry(self, id: str, data: Mapping[str, Any], used: list[tuple[int, int]]) -> PaperEntry:
        entry = PaperEntry(**{"id": id, "kind": self.kind, "subject": self.subject, **data})
        strings = (entry.printed,) if entry.english else (entry.printed, *entry.ranges)
        start, end = span = position(self.text, strings, () if entry.english else entry.edits, used) or (0, 0)
        used.append(span)
        place = {
            "scan": self.text[start:end],
            "where": entry.where or self.where.replace("{line}", id.rpartition(".")[-1]),
            "lines": (self._line(start), self._line(max(start, end - 1))),
        }
        return entry.model_copy(update=place)

    def _line(self, place: int) -> int:
        """The number of the line in which a place of the text is."""
        return self.lines[0] + self.text.count("\n", 0, place)

    def _cells(self, known: Mapping[str, PaperEntry]) -> Iterator[PaperEntry]:
        """The cells of tables, each with the ranges of its heads."""
        for place in tables.places(self.table, self.text, self.lines[0]):
            if place.column.name in place.table.unjudged_columns:
                continue
            heads = tuple(head for head in place.heads if head in known)
            data: dict[str, Any] = {
                "kind": "cell",
                "printed": place.scan.strip("$"),
                "ranges": tuple(range_ for head in heads for range_ in _head_ranges(known[head])),
                "subject": {"row": place.row.name, "column": place.column.name},
                "where": f"{self.where}, row {place.row.name}, column {place.column.name}",
                **self.record.get(place.id, {}),
            }
            yield PaperEntry(id=place.id, scan=place.scan, lines=(place.line, place.line), heads=heads, **data)

    @property
    def asides(self) -> tuple[Aside, ...]:
        """The parts that are not judged, columns of tables among them."""
        cells = tables.places(self.table, self.text, self.lines[0])
        named = ((cell.scan, cell.table.unjudged_columns.get(cell.column.name)) for cell in cells)
        return (*self.aside, *(Aside(scan, why) for scan, why in named if why))


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


class PassageHashes(NamedTuple):
    """The hashes of the lines of a passage, and of its translations and edits."""

    lines: str
    edits: str


@dataclass(frozen=True)
class Paper:
    """What is known of a paper itself, all passages in the order of the source, and their hashes, by their lines."""

    description: PaperDescription
    passages: tuple[Passage, ...]
    hashes: Mapping[tuple[int, int], PassageHashes]

    @cached_property
    def entries(self) -> Mapping[str, PaperEntry]:
        """All records by their ids, in the order of print."""
        return {entry.id: entry for passage in self.passages for entry in passage.entries}

    @property
    def tables(self) -> tuple[PrintedTable, ...]:
        """All tables."""
        return tuple(table for passage in self.passages for table in passage.table)


def read_paper(directory: Path) -> Paper:
    """The passages of the TOML files of a directory, what paper.toml says of the paper, and hashes.txt."""
    data = {file.stem: tomllib.loads(file.read_text(encoding="utf-8")) for file in sorted(directory.glob("*.toml"))}
    description = PaperDescription(**data.pop("paper"))
    passages = [
        Passage(**{**passage, "record": merge_records(passage.get("record", {}))})
        for file in data.values()
        for passage in file["passage"]
    ]
    for first, last, where, why in (row for file in data.values() for row in file.get("unjudged_lines", ())):
        passages.append(Passage(lines=(first, last), where=where, why=why))
    hashes = {}
    for line in (directory / "hashes.txt").read_text(encoding="utf-8").splitlines():
        first, last, *known = line.split()
        hashes[int(first), int(last)] = PassageHashes(*known)
    return Paper(description, tuple(sorted(passages, key=lambda passage: passage.lines)), hashes)


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


def digest(text: str) -> str:
    """The hash of a text; how many spaces there are makes no difference."""
    return sha256(" ".join(text.split()).encode()).hexdigest()[:16]


def passage_hashes(text: str, entries: Iterable[PaperEntry] = ()) -> PassageHashes:
    """The hashes of a text of some lines, and of the translations and edits of its records."""
    checked = [
        part for entry in entries for part in (entry.english, *(part for edit in entry.edits for part in edit[:2]))
    ]
    return PassageHashes(digest(text), digest(" | ".join(part for part in checked if part)))


WHOLE = "paper"
"""What is wrong with the data as a whole, not with a record."""


def problems(paper: Paper) -> Iterator[tuple[str, str]]:
    """What does not fit: the id of a record, or `WHOLE`, and what is wrong. A passage's are all its records'."""
    yield from _coverage_problems(paper)
    for passage in paper.passages:
        for problem in _misfits(passage, paper.hashes.get(passage.lines)):
            message = f"lines {passage.lines[0]}-{passage.lines[1]}: {problem}"
            yield from ((entry.id, message) for entry in passage.entries)
            if not passage.entries:
                yield WHOLE, message
        for entry in passage.entries:
            yield from ((entry.id, problem) for problem in _unlike(entry))


def _coverage_problems(paper: Paper) -> Iterator[tuple[str, str]]:
    spans = [passage.lines for passage in paper.passages]
    if twice := [after for before, after in pairwise(spans) if after[0] <= before[1]]:
        yield WHOLE, f"lines in two passages: {twice}"
    if missing := sorted(paper.hashes.keys() - set(spans)):
        yield WHOLE, f"lines in no passage: {missing}"


def _misfits(passage: Passage, known: PassageHashes | None) -> Iterator[str]:
    """How a passage does not fit the source, or leaves out something of it."""
    if not passage.text:
        if not passage.why:
            yield "neither judged nor set aside"
        return
    hashes = passage_hashes(passage.text, passage.entries)
    if known is None or hashes.lines != known.lines:
        yield "they are not the source's"
    if known is None or hashes.edits != known.edits:
        yield "their translations and edits are not those that were checked"
    if len(passage.text.split("\n")) != passage.lines[1] - passage.lines[0] + 1:
        yield "not as many lines as it says"
    ids = {entry.id for entry in passage.entries}
    yield from (f"there is no cell {id}" for id in passage.record if id not in ids)
    if passage.table:
        others = [entry.scan for entry in passage.entries] + [aside.scan for aside in passage.aside]
        yield from tables.problems(passage.table, passage.text, passage.lines[0], others)
    elif rest := _rest(passage):
        yield f"neither judged nor set aside: {rest}"
    yield from (f"set aside without a reason: {aside.scan}" for aside in passage.aside if not aside.why)


def _rest(passage: Passage) -> str:
    """Formulas and long stretches of words that are in no record and not set aside."""
    text = passage.text
    for scan in sorted([e.scan for e in passage.entries if e.scan] + [a.scan for a in passage.aside], key=len)[::-1]:
        text = text.replace(scan, "\0")
    for rest in text.split("\0"):
        words = plain(_TAGS.sub("", rest))
        if len(words) > LONGEST_REST or re.search(r"[\d\\]", words):
            return rest.strip()
    return ""


LONGEST_REST = 25
"""Letters that may stand between records without a reason: "and", "where", "for"."""
_TAGS = re.compile(r"\(\d\.\d+\)(_\d)?|\[cd\.\]")


def _unlike(entry: PaperEntry) -> Iterator[str]:
    """How a record is not what its edits make of its scan."""
    text = plain(entry.scan)
    if not text:
        yield f"does not stand in its passage: {entry.printed}"
        return
    for before, after, _ in entry.edits:
        if plain(before) not in text:
            yield f"nothing to edit: {before}"
        if entry.english and plain(after) not in plain(entry.english):
            yield f"is not in the English: {after}"
        text = text if entry.english else text.replace(plain(before), plain(after))
    printed = plain(entry.printed if entry.heads or entry.english else ",".join((entry.printed, *entry.ranges)))
    if text != printed:
        yield f"is not what its edits make of the scan: {text} there, {printed} printed"
