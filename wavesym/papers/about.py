"""What pages say of a paper itself: who wrote it, what was at hand of it, and how it lays its tables out."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

from pydantic import BaseModel, ConfigDict


class _Said(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Heading(_Said):
    """The head of a row or column: its part of the ids of its cells, and how it is printed, as formula or words."""

    key: str
    formula: str = ""
    words: str = ""


class TableLayout(_Said):
    """A table as the paper lays it out. `cell` makes the id of a cell of its {row} and {column}.

    `row_head` and `column_head` make that of a head in the same way, where heads are records too.

    `names` are formulas in cells that name something and are not judged, by the id that the cell would have.
    """

    name: str
    caption: str = ""
    cell: str
    row_head: str = ""
    column_head: str = ""
    columns: tuple[Heading, ...]
    rows: tuple[Heading, ...]
    names: Mapping[str, str] = {}

    def id(self, row: Heading, column: Heading) -> str:
        """The id of a cell."""
        return self.cell.format(row=row.key, column=column.key)

    def ids(self) -> frozenset[str]:
        """The ids of all cells."""
        return frozenset(self.id(row, column) for row in self.rows for column in self.columns)


class About(_Said):
    """A paper: author, title, the title in English, its date, and in what form it was at hand."""

    author: str
    title: str
    english: str
    date: str
    transcription: str
    table: tuple[TableLayout, ...] = ()


def read_about(file: Path) -> About:
    """The tables [paper] and [[table]] of a TOML file."""
    data = tomllib.loads(file.read_text(encoding="utf-8"))
    return About(**data["paper"], table=data.get("table", ()))
