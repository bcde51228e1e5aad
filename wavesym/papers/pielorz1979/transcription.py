"""The paper as data, read once."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path

from wavesym.papers.entries import Entry, Paper, read_paper

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
