"""What all pages say of a paper, whatever their markup: counts, errors in groups, what was not judged or survived."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

from wavesym.papers.entries import Paper, PaperEntry, Slip
from wavesym.papers.record import VERDICTS, Record, Verdict

ORIGINS = {
    "print": "The text itself proves the slip.",
    "scan": "The scan is garbled at this place beyond doubt.",
    "unknown": "Whether the print or the scan is at fault cannot be told from the text.",
}


@dataclass(frozen=True)
class Unjudged:
    """Lines of the source of which nothing is judged, or a piece of them, and why."""

    lines: tuple[int, int]
    where: str
    scan: str
    why: str


@dataclass(frozen=True)
class Survivor:
    """A fault in a record that no case turns, and why."""

    record: Record
    change: str
    because: str


@dataclass(frozen=True)
class ScanEdit:
    """A place of the scan that is not judged as it stands, how it is read, and why."""

    record: Record
    scan: str
    read: str
    because: str


@dataclass(frozen=True)
class Findings:
    """The verdicts on a paper, or on the records of it that were asked for; `reproduce`: with their examples.

    `whole`: all of it was asked for; `only` is the verdict of those that are shown, empty for all of them.
    """

    paper: Paper
    records: tuple[Record, ...]
    whole: bool = False
    reproduce: bool = False
    only: str = ""

    @property
    def shown(self) -> tuple[Record, ...]:
        """The records that are shown, of which the others are counted alone."""
        return tuple(record for record in self.records if self.only in ("", record.verdict))

    @property
    def passed(self) -> bool:
        """Whether everything could be tested."""
        return all(record.verdict != "untested" for record in self.records)

    @property
    def counts(self) -> list[tuple[Verdict, int]]:
        """How many records have each verdict, those that occur."""
        found = Counter(record.verdict for record in self.records)
        return [(verdict, found[verdict]) for verdict in VERDICTS if found[verdict]]

    @property
    def statistics(self) -> list[tuple[str, Counter[Verdict]]]:
        """The same for each section and table, in the order of print."""
        return [
            (name, Counter(record.verdict for record in records)) for name, records in by_place(self.records).items()
        ]

    @property
    def errors(self) -> list[tuple[Record, ...]]:
        """What does not hold, in groups that are one error: one note in one place, or one line of a table."""
        groups: defaultdict[object, list[Record]] = defaultdict(list)
        for record in self.records:
            if record.verdict != "holds":
                groups[self._error(record)].append(record)
        return [tuple(group) for group in groups.values()]

    @property
    def holding(self) -> tuple[Record, ...]:
        """What holds."""
        return tuple(record for record in self.records if record.verdict == "holds")

    @property
    def unjudged(self) -> list[Unjudged]:
        """What of the paper was set aside, in the order of print."""
        found = []
        for passage in self.paper.passages if self.whole else ():
            if passage.why:
                found.append(Unjudged(passage.lines, passage.where, passage.text, passage.why))
            found += [Unjudged(passage.lines, passage.where, aside.scan, aside.why) for aside in passage.asides]
        return found

    @property
    def edits(self) -> list[ScanEdit]:
        """Where the scan is read otherwise than it stands, in the order of print."""
        return [ScanEdit(record, *edit) for record in self.records for edit in record.entry.edits]

    @property
    def survivors(self) -> list[Survivor]:
        """The faults that no case turned."""
        return [
            Survivor(record, change, because)
            for record in self.records
            for change, because in record.mutations.survived
        ]

    @property
    def faults(self) -> tuple[int, int]:
        """How many faults were tried, and turned."""
        return (
            sum(record.mutations.tried for record in self.records),
            sum(record.mutations.turned for record in self.records),
        )

    @cached_property
    def _cells(self) -> frozenset[str]:
        return frozenset[str]().union(*(table.ids for table in self.paper.tables))

    def _error(self, record: Record) -> object:
        """What one error is told from others by."""
        if record.id in self._cells:
            return record.id.split(".")[0], record.id.rsplit(".", 1)[-1], record.verdict
        note = record.entry.slip.note if record.entry.slip else ""
        return place(record.entry), note or record.id, record.verdict


def place(entry: PaperEntry) -> str:
    """The section or table of an entry."""
    name = entry.where.split(",")[0].strip() or "elsewhere"
    return name[0].upper() + name[1:]


def by_place(records: Iterable[Record]) -> dict[str, list[Record]]:
    """The records of each section and table."""
    found: dict[str, list[Record]] = {}
    for record in records:
        found.setdefault(place(record.entry), []).append(record)
    return found


def lines(span: tuple[int, int]) -> str:
    """Lines of the source in words."""
    first, last = span
    return f"line {first}" if first == last else f"lines {first}-{last}"


def ranges_as_corrected(slip: Slip, entry: PaperEntry) -> tuple[str, ...]:
    """The printed ranges as they should be."""
    return entry.ranges if slip.ranges is None else slip.ranges


def origin(record: Record) -> str:
    """What is known of where a slip comes from; of what the text says without a slip, nothing."""
    slip = record.entry.slip
    return ORIGINS[slip.origin] if slip and slip.verdict in ("misprint", "unreadable") else ""


def difference(record: Record) -> str:
    """What is printed less what is derived, where that is known and not nothing."""
    return record.difference if record.difference and record.difference != "0" else ""


def faults_tried(record: Record) -> str:
    """How many faults were tried, in words."""
    return f"{counted(record.mutations.tried, 'fault')} put in, {record.mutations.turned} of them seen"


def tested(record: Record) -> str:
    """What a verdict rests on, in a sentence."""
    return f"Compared with {record.against}; {faults_tried(record)}."


def counted(number: int, what: str) -> str:
    """A number of things, in words."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def titles(group: Sequence[Record]) -> str:
    """The ids of an error's records: all of a few, the first and how many more of many."""
    ids = [record.id for record in group]
    return ", ".join(ids) if len(ids) <= 3 else f"{ids[0]} and {len(ids) - 1} more"
