"""A paper as data: passages of its text in their order, each cut into records, or set aside with a reason.

A passage is some whole lines of the source. Its records say what is printed there; what of it is no record is set aside
with a reason, so that nothing can be left out unseen. Every line of the source has a committed hash: a transcription
that is changed afterwards no longer fits it (`problems`).
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from wavesym.papers import tables
from wavesym.papers.tables import PrintedTable

Slipped = Literal["misprint", "unreadable", "convention", "model", "depends", "incomplete"]
Origin = Literal["print", "scan", "unknown"]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Slip(_Data):
    """What is wrong as printed, and what is right: the whole formula, or the whole sentence.

    `origin`: "print" only where the text itself proves it, "scan" where the scan is garbled beyond doubt.
    """

    verdict: Slipped
    origin: Origin = "unknown"
    corrected: str
    ranges: tuple[str, ...] | None = None
    note: str


class PaperEntry(_Data):
    """One printed formula, cell or sentence.

    `scan` is the text of the source, verbatim; `printed` is the same on one line, a formula without words: it differs
    by `edits` alone (from, to, why). `english` is a sentence in the words that are judged; then `edits` are of what it
    says. `ranges` are printed too, `inferred` ones are not. `equivalent` are the faults that no case can turn (name,
    why). `about` is what the adapter of this `kind` needs to know. The ranges of a cell of a table are those of its
    `heads`, whose records bind them to the source.
    """

    id: str
    kind: str
    printed: str = ""
    english: str = ""
    scan: str = ""
    ranges: tuple[str, ...] = ()
    inferred: tuple[str, ...] = ()
    edits: tuple[tuple[str, str, str], ...] = ()
    equivalent: tuple[tuple[str, str], ...] = ()
    slip: Slip | None = None
    note: str = ""
    about: Mapping[str, Any] = {}
    where: str = ""
    lines: tuple[int, int] = (0, 0)
    heads: tuple[str, ...] = ()

    @property
    def statement(self) -> str:
        """What is judged: the formula, or the sentence in English."""
        return self.english or self.printed

    @property
    def settled(self) -> tuple[str, tuple[str, ...]]:
        """What is right, as printed or as corrected: the formula, and its ranges."""
        if self.slip is None:
            return self.statement, (*self.ranges, *self.inferred)
        ranges = self.ranges if self.slip.ranges is None else self.slip.ranges
        return self.slip.corrected, (*ranges, *self.inferred)


class Aside(_Data):
    """A part of a passage that is not judged: a definition, an announcement, a reference."""

    scan: str
    why: str


class Passage(_Data):
    """Lines of the source, first to last, with their text where anything of it is judged.

    Every cell of a `table` is a record too; `cell` gives what is to be said of one beyond what stands there, by its id.
    """

    lines: tuple[int, int]
    where: str = ""
    text: str = ""
    why: str = ""
    record: tuple[PaperEntry, ...] = ()
    aside: tuple[Aside, ...] = ()
    table: tuple[PrintedTable, ...] = ()
    cell: Mapping[str, Mapping[str, Any]] = {}

    def entries(self) -> Iterator[PaperEntry]:
        """The records, each with its place and its scan."""
        for entry in self.record:
            scan = entry.scan or self.text.strip("\n")
            yield entry.model_copy(
                update={
                    "scan": scan,
                    "printed": entry.printed or " ".join(scan.split()),
                    "where": entry.where or self.where,
                    "lines": self.lines,
                }
            )
        yield from self._cells()

    def _cells(self) -> Iterator[PaperEntry]:
        """The cells of tables, each with the ranges of its heads."""
        known = {entry.id: entry for entry in self.record}
        for place in tables.places(self.table, self.text, self.lines[0]):
            heads = tuple(head for head in place.heads if head in known)
            given: dict[str, Any] = {
                "printed": place.scan.strip("$"),
                "ranges": tuple(range_ for head in heads for range_ in _said(known[head])),
                "about": {"table": place.table.id, "row": place.row, "column": place.column},
                **self.cell.get(place.id, {}),
            }
            where = f"{self.where}, row {place.row}, column {place.column}"
            yield PaperEntry(
                id=place.id, kind="cell", scan=place.scan, where=where, lines=self.lines, heads=heads, **given
            )


def _said(head: PaperEntry) -> tuple[str, ...]:
    """The ranges that a head gives to its cells: its own, and itself where it is one."""
    return (head.printed, *head.ranges) if head.kind == "range" else head.ranges


@dataclass(frozen=True)
class Paper:
    """All passages in the order of the source, and the hashes of its lines and of the translations."""

    passages: tuple[Passage, ...]
    hashes: Mapping[str, str]

    def entries(self) -> tuple[PaperEntry, ...]:
        """All records."""
        return tuple(entry for passage in self.passages for entry in passage.entries())


def read_paper(files: Iterable[Path], hashes: Path) -> Paper:
    """The passages of some TOML files, in the order of the source."""
    passages = [
        Passage(**passage)
        for file in files
        for passage in tomllib.loads(file.read_text(encoding="utf-8")).get("passage", ())
    ]
    known = dict(line.split() for line in hashes.read_text(encoding="utf-8").splitlines())
    return Paper(tuple(sorted(passages, key=lambda passage: passage.lines)), known)


def digest(text: str) -> str:
    """The hash of a line, spaces told apart from nothing else."""
    return sha256(" ".join(text.split()).encode()).hexdigest()[:16]


WHOLE = "paper"
"""What is wrong with the data as a whole, not with a record."""


def problems(paper: Paper) -> Iterator[tuple[str, str]]:
    """What does not fit: the id of a record, or `WHOLE`, and what is wrong. A passage's are all its records'."""
    yield from _uncovered(paper)
    for passage in paper.passages:
        entries = tuple(passage.entries())
        for problem in _misfits(passage, paper.hashes):
            told = f"lines {passage.lines[0]}-{passage.lines[1]}: {problem}"
            yield from ((entry.id, told) for entry in entries)
            if not entries:
                yield WHOLE, told
        for entry in entries:
            yield from ((entry.id, problem) for problem in _unlike(entry, passage, paper.hashes))


def _misfits(passage: Passage, hashes: Mapping[str, str]) -> Iterator[str]:
    """How a passage does not fit the source, or leaves out something of it."""
    if not passage.text:
        if not passage.why:
            yield "neither judged nor set aside"
        return
    lines = passage.text.strip("\n").split("\n")
    for number, line in zip(_span(passage), lines, strict=False):
        if hashes.get(str(number), digest("")) != digest(line):
            yield f"line {number} is not the source's"
    if len(lines) != len(_span(passage)):
        yield "not as many lines as it says"
    if passage.table:
        others = [record.scan for record in passage.record] + [aside.scan for aside in passage.aside]
        yield from tables.problems(passage.table, passage.text, passage.lines[0], others)
        ids = {entry.id for entry in passage.entries()}
        yield from (f"there is no cell {id}" for id in passage.cell if id not in ids)
    elif left := _left_over(passage):
        yield f"neither judged nor set aside: {left}"
    yield from (f"set aside without a reason: {aside.scan}" for aside in passage.aside if not aside.why)


def _span(passage: Passage) -> range:
    return range(passage.lines[0], passage.lines[1] + 1)


def _uncovered(paper: Paper) -> Iterator[tuple[str, str]]:
    numbers = sorted(number for passage in paper.passages for number in _span(passage))
    lines = sorted(int(name) for name in paper.hashes if name.isdigit())
    if twice := sorted({n for n in numbers if numbers.count(n) > 1}):
        yield WHOLE, f"lines in two passages: {twice}"
    if missing := sorted(set(lines) - set(numbers)):
        yield WHOLE, f"lines in no passage: {missing}"


def _left_over(passage: Passage) -> str:
    """Formulas and long stretches of words that are in no record and not set aside."""
    text = passage.text
    for scan in sorted([e.scan for e in passage.record if e.scan] + [a.scan for a in passage.aside], key=len)[::-1]:
        text = text.replace(scan, "\0")
    if any(not entry.scan for entry in passage.record):
        return ""
    for rest in text.split("\0"):
        words = plain(_TAGS.sub("", rest))
        if len(words) > LONGEST_REST or re.search(r"[\d\\]", words):
            return rest.strip()
    return ""


LONGEST_REST = 25
"""Letters that may stand between records without a reason: "and", "where", "for"."""
_TAGS = re.compile(r"\(\d\.\d+\)(_\d)?|\[cd\.\]")


def _unlike(entry: PaperEntry, passage: Passage, hashes: Mapping[str, str]) -> Iterator[str]:
    if entry.scan not in passage.text:
        yield "its scan is not in the text of its passage"
    if entry.english and hashes.get(entry.id) != digest(entry.english):
        yield "is not the translation that was checked"
    if entry.edits and hashes.get(f"{entry.id}:edits") != digest(edited(entry)):
        yield "its edits are not those that were checked"
    text = plain(entry.scan)
    for before, after, _ in entry.edits:
        if plain(before) not in text:
            yield f"nothing to edit: {before}"
        if entry.english and plain(after) not in plain(entry.english):
            yield f"is not in the English: {after}"
        text = text if entry.english else text.replace(plain(before), plain(after))
    said = plain(entry.printed if entry.heads or entry.english else ",".join((entry.printed, *entry.ranges)))
    if text != said:
        yield f"is not what its edits make of the scan: {text} there, {said} printed"


def edited(entry: PaperEntry) -> str:
    """What is edited in a scan, as it is checked: from, to, from, to."""
    return " | ".join(part for before, after, _ in entry.edits for part in (before, after))


def plain(text: str) -> str:
    """A formula without what only lays it out: spaces, alignment, braces of cases, sizes of brackets.

    "dla" (for), and what stands for it in cases, is a comma.
    """
    for pattern, instead in _LAYOUT:
        text = pattern.sub(instead, text)
    return text.strip(",.;")


_LAYOUT: Sequence[tuple[re.Pattern[str], str]] = tuple(
    (re.compile(pattern), instead)
    for pattern, instead in (
        (r"(?s)&(?=(?:(?!\\begin\{).)*\\end\{cases\})", " , "),
        (r"\\(?:begin|end)\{cases\}", " "),
        (r"\\begin\{aligned\}|\\end\{aligned\}|\\left\.|\\right\.|\$|&|\\\\|\\quad", " "),
        (r"\\left(?=[\W_])|\\right(?=[\W_])", " "),
        (r"\\text\{([^}]*)\}", r"\1"),
        (r"(^|\s)dla(\s|$)", " , "),
        (r"\s+", ""),
        (r",+", ","),
    )
)
