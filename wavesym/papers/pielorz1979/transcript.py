"""The paper's data, and the records that stand together in it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path

from wavesym.papers.entries import Entry, Paper, read_paper
from wavesym.papers.record import Reading, reading

_DATA = Path(__file__).with_name("data")


@cache
def paper() -> Paper:
    """The data."""
    return read_paper(sorted(_DATA.glob("*.toml")), _DATA / "hashes.txt")


@cache
def entries() -> Mapping[str, Entry]:
    """All records by their ids, in the order of print."""
    return {entry.id: entry for entry in paper().entries()}


def entry(id: str) -> Entry:
    """A record by its id; KeyError."""
    return entries()[id]


@cache
def others(id: str, kind: str) -> tuple[Reading, ...]:
    """Beside "(4.6).1": "(4.6).2", "(4.6).3", ... of its kind, as they are right; beside "(4.6)" all of them."""
    number, _, _ = id.partition(")")
    entries = (e for e in paper().entries() if e.kind == kind and e.id != id)
    return tuple(reading(*entry.settled) for entry in entries if entry.id.partition(")")[0] == number)
