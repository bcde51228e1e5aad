"""Printed tables as data: which cells of a text are formulas, which heads say where they hold, and how it is laid out.

A text is a grid: its lines, cut where tabs are. A `PrintedTable` is a block of it with named rows and columns; every
cell of the block becomes an entry (entries.py). Labels are given as they stand and found in the grid again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from pydantic import BaseModel, ConfigDict, field_validator


class TableHead(NamedTuple):
    """The head of a row or column: the label that it has, its name in ids, and a record that holds in its cells."""

    label: str
    name: str
    record: str = ""


_WITHOUT_MARKUP = str.maketrans("", "", "${}")


class PrintedTable(BaseModel):
    """A block of cells, whose ids are made of {row} and {column} by `cell`; `name` and `caption` are for readers.

    A head that is a label alone is named by it, without dollar signs and braces.
    `head` is the line of the columns' labels, `line` that of the first row; labels stand at `left_column` or later.
    `heads` are the ids of the records whose ranges hold in every cell; `row_head` and `column_head` make those of a row
    or column. `unjudged_columns`, by name, are no records, for a reason.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    cell: str
    head: int
    line: int
    left_column: int = 0
    caption: str = ""
    heads: tuple[str, ...] = ()
    row_head: str = ""
    column_head: str = ""
    columns: tuple[TableHead, ...]
    rows: tuple[TableHead, ...]
    unjudged_columns: Mapping[str, str] = {}

    @field_validator("columns", "rows", mode="before")
    @classmethod
    def _name_by_labels(cls, heads: Sequence[Any]) -> list[Any]:
        return [(head, head.translate(_WITHOUT_MARKUP)) if isinstance(head, str) else head for head in heads]

    def cell_id(self, row: TableHead, column: TableHead) -> str:
        """The id of a cell."""
        return self.cell.format(row=row.name, column=column.name)

    def row_id(self, row: TableHead) -> str:
        """The id of a row's head, where it is a record."""
        return self.row_head.format(row=row.name)

    def column_id(self, column: TableHead) -> str:
        """The id of a column's head, where it is a record."""
        return self.column_head.format(column=column.name)

    @property
    def ids(self) -> frozenset[str]:
        """The ids of all cells."""
        return frozenset(self.cell_id(row, column) for row in self.rows for column in self.columns)


@dataclass(frozen=True)
class CellPlace:
    """A cell: its table, row and column, its line in the source, and what stands there."""

    table: PrintedTable
    row: TableHead
    column: TableHead
    line: int
    scan: str

    @property
    def id(self) -> str:
        """The id of the cell."""
        return self.table.cell_id(self.row, self.column)

    @property
    def heads(self) -> tuple[str, ...]:
        """The ids of the records that may say where the cell holds."""
        table = self.table
        return (*table.heads, self.column.record, table.row_id(self.row), table.column_id(self.column))


Grid = Sequence[Sequence[str]]


def grid(text: str) -> Grid:
    """The cells of a text, line by line."""
    return [[cell.strip() for cell in line.split("\t")] for line in text.strip("\n").split("\n")]


def places(tables: Iterable[PrintedTable], text: str, start: int) -> Iterator[CellPlace]:
    """The cells of all tables of a text whose first line is number `start`."""
    cells = grid(text)
    for table in tables:
        for number, row in enumerate(table.rows, table.line):
            for column, x in zip(table.columns, _columns(table, row, cells[number - start]), strict=False):
                yield CellPlace(table, row, column, number, cells[number - start][x])


def _columns(table: PrintedTable, row: TableHead, line: Sequence[str]) -> list[int]:
    """Where the cells of a row stand in its line: what is not empty behind its label; nowhere without the label."""
    if row.label not in line[table.left_column :]:
        return []
    after = line.index(row.label, table.left_column) + 1
    return [x for x in range(after, len(line)) if line[x]][: len(table.columns)]


def problems(tables: Iterable[PrintedTable], text: str, start: int, others: Iterable[str]) -> Iterator[str]:
    """Labels that do not stand where they should, and what is neither cell nor label nor among the `others`."""
    cells = grid(text)
    known = {cell.strip() for other in others for cell in other.split("\t")}
    rest = {(y, x) for y, line in enumerate(cells) for x, cell in enumerate(line) if cell and cell not in known}
    for table in tables:
        for number, row in enumerate(table.rows, table.line):
            y, columns = number - start, _columns(table, row, cells[number - start])
            if len(columns) < len(table.columns):
                yield f"line {number} has no label {row.label} with {len(table.columns)} cells"
            rest -= {(y, x) for x in columns} | {(y, x) for x, cell in enumerate(cells[y]) if cell == row.label}
        for column in table.columns:
            y = table.head - start
            if column.label not in cells[y]:
                yield f"line {table.head} has no label {column.label}"
            rest -= {(y, x) for x, cell in enumerate(cells[y]) if cell == column.label}
    if rest:
        yield "neither judged nor set aside: " + ", ".join(cells[y][x] for y, x in sorted(rest))
