"""What an inspection consists of: named values and lists of rows, each with a line of words.

Text and JSON are written of the same sections, so that neither can say what the other does not.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from flint import fmpq

from wavesym.mechanics.node import UnitLoad

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

# What JSON can hold: exact numbers are text such as "6/5", doubles and counts are numbers.
Plain = Any


@dataclass(frozen=True)
class Display:
    """A value of JSON that is shown to a person in other `words`."""

    value: Plain
    words: str


@dataclass(frozen=True)
class Facts:
    """Named values, a line each. In JSON they are the object `key`."""

    key: str
    words: str
    values: Mapping[str, Plain | Display]


@dataclass(frozen=True)
class Listing:
    """Rows that all have the same columns. In JSON they are the list `key`.

    Text shows `sentences`, which a row may have or not, on lines of their own below it; no `hidden` columns.
    """

    key: str
    words: str
    rows: Sequence[Mapping[str, Plain | Display]]
    sentences: tuple[str, ...] = ()
    hidden: tuple[str, ...] = ()


Section = Facts | Listing


def plain(section: Section) -> Plain:
    """A section as JSON."""
    if isinstance(section, Facts):
        return _plain(section.values)
    return [_plain(row) for row in section.rows]


def _plain(values: Mapping[str, Plain | Display]) -> dict[str, Plain]:
    return {name: value.value if isinstance(value, Display) else value for name, value in values.items()}


def dump(key: str, words: str, values: Sequence[DataclassInstance], number: str = "", first: int = 0) -> Listing:
    """Frozen values as rows: all of their fields under their own names; text leaves out what all have by default.

    Args:
        key, words: as of a listing.
        values: of one class.
        number: the name of a column that counts them, from `first` on; empty for none.
    """
    columns = fields(values[0]) if values else ()
    rows = [
        {**({number: k} if number else {}), **{each.name: _field_json(getattr(value, each.name)) for each in columns}}
        for k, value in enumerate(values, first)
    ]
    usual = (each.name for each in columns if all(getattr(value, each.name) == each.default for value in values))
    return Listing(key, words, rows, hidden=tuple(usual))


def _field_json(value: Any) -> Plain:
    """A field as JSON: exact numbers as text, what is made of others by its fields, names as they are."""
    if isinstance(value, UnitLoad):
        return value.source
    if isinstance(value, tuple):
        return list(map(_field_json, value))
    return str(value) if isinstance(value, fmpq) else value


def finite(value: float | None) -> float | None:
    """A double for JSON, which has no infinity: None for what is not finite, or is not there."""
    return value if value is not None and abs(value) < float("inf") else None
