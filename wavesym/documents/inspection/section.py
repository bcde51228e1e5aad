"""What an inspection consists of: named values and lists of rows, each with a line of words.

Text and JSON are written of the same sections, so that neither can say what the other does not.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

# What JSON can hold: exact numbers are text such as "6/5", doubles and counts are numbers.
Plain = Any


@dataclass(frozen=True)
class Told:
    """A value of JSON that is shown to a person in other `words`."""

    value: Plain
    words: str


@dataclass(frozen=True)
class Facts:
    """Named values, a line each. In JSON they are the object `key`."""

    key: str
    words: str
    values: Mapping[str, Plain | Told]


@dataclass(frozen=True)
class Listing:
    """Rows that all have the same columns. In JSON they are the list `key`.

    Text shows `sentences`, which a row may have or not, on lines of their own below it.
    """

    key: str
    words: str
    rows: Sequence[Mapping[str, Plain | Told]]
    sentences: tuple[str, ...] = ()


Section = Facts | Listing


def plain(section: Section) -> Plain:
    """A section as JSON."""
    if isinstance(section, Facts):
        return _plain(section.values)
    return [_plain(row) for row in section.rows]


def _plain(values: Mapping[str, Plain | Told]) -> dict[str, Plain]:
    return {name: value.value if isinstance(value, Told) else value for name, value in values.items()}


def finite(value: float | None) -> float | None:
    """A double for JSON, which has no infinity: None for what is not finite, or is not there."""
    return value if value is not None and abs(value) < float("inf") else None
