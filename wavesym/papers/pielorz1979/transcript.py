"""The paper's data, and the records that stand together in it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path

from wavesym.papers.entries import Paper, PaperEntry, read_paper
from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.reader import UnreadableError
from wavesym.papers.record import Reading, reading
from wavesym.papers.sentences import SentencePattern, read_patterns

_DATA = Path(__file__).with_name("data")


@cache
def paper() -> Paper:
    """The data."""
    return read_paper(_DATA)


@cache
def patterns() -> tuple[SentencePattern, ...]:
    """The patterns of sentences that can be judged, those about a `figure` among them."""
    return read_patterns(Path(__file__).with_name("sentences.toml"))


def entries() -> Mapping[str, PaperEntry]:
    """All records by their ids, in the order of print."""
    return paper().entries


def entry(id: str) -> PaperEntry:
    """A record by its id; KeyError."""
    return entries()[id]


@cache
def right_reading(id: str) -> Reading:
    """A record as it is right; KeyError where there is none, MeaninglessError where it cannot be read."""
    try:
        return reading(*entry(id).right_strings)
    except UnreadableError as error:
        raise MeaninglessError(str(error)) from None


@cache
def ids(kind: str, start: str = "") -> tuple[str, ...]:
    """The records of a kind, those whose ids begin so."""
    return tuple(id for id, entry in entries().items() if entry.kind == kind and id.startswith(start))


@cache
def others(id: str, kind: str) -> tuple[Reading, ...]:
    """Beside "(4.6).1": "(4.6).2", "(4.6).3", ... of its kind, as they are right; beside "(4.6)" all of them."""
    number, _, _ = id.partition(")")
    beside = (e for e in entries().values() if e.kind == kind and e.id != id)
    return tuple(reading(*entry.right_strings) for entry in beside if entry.id.partition(")")[0] == number)
