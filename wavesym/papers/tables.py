"""Printed tables as data: which cells of a text are formulas, and which heads say where they hold.

A text is a grid: its lines, cut where tabs are. A `PrintedTable` is a block of it with named rows and columns; every
cell of the block becomes an entry (entries.py). Labels and heads are given as they stand and found in the grid again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from pydantic import BaseModel, ConfigDict


class TableRow(NamedTuple):
    """A row: its line in the source, where in it the first cell stands, the label that it has, and its name in ids."""

    line: int
    first: int
    label: str
    name: str


class TableColumn(NamedTuple):
    """A column: the label that it has, and its name in ids."""

    label: str
    name: str


class PrintedTable(BaseModel):
    """A block of cells, named `id`.`cell`, where `cell` puts names together, such as "{row}.{column}".

    `head` is the line of the columns' labels. `heads` are the ids of the records whose ranges hold in every cell; those
    of a row or column, where there are any, are the records `id`.row and `id`.column.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    id: str
    cell: str
    head: int
    heads: tuple[str, ...] = ()
    columns: tuple[TableColumn, ...]
    rows: tuple[TableRow, ...]


@dataclass(frozen=True)
class CellPlace:
    """A cell: its id, its table, row and column by name, and what stands there."""

    id: str
    table: PrintedTable
    row: str
    column: str
    scan: str

    @property
    def heads(self) -> tuple[str, ...]:
        """The ids of the records that may say where the cell holds."""
        return (*self.table.heads, f"{self.table.id}.{self.row}", f"{self.table.id}.{self.column}")


Grid = Sequence[list[str]]


def grid(text: str) -> Grid:
    """The cells of a text, line by line."""
    return [[cell.strip() for cell in line.split("\t")] for line in text.strip("\n").split("\n")]


def places(tables: Iterable[PrintedTable], text: str, start: int) -> Iterator[CellPlace]:
    """The cells of all tables of a text whose first line is number `start`; IndexError where a line is too short."""
    cells = grid(text)
    for table in tables:
        for row in table.rows:
            for number, column in enumerate(table.columns):
                name = table.cell.format(row=row.name, column=column.name)
                scan = cells[row.line - start][row.first + number]
                yield CellPlace(f"{table.id}.{name}", table, row.name, column.name, scan)


def problems(tables: Iterable[PrintedTable], text: str, start: int, others: Iterable[str]) -> Iterator[str]:
    """Labels that do not stand where they should, and what is neither cell nor label nor among the `others`."""
    cells = grid(text)
    left = {(y, x) for y, line in enumerate(cells) for x, cell in enumerate(line) if cell}
    known = {cell.strip() for other in others for cell in other.split("\t")}
    left -= {(y, x) for y, x in left if cells[y][x] in known}
    for table in tables:
        for row in table.rows:
            y = row.line - start
            if row.label not in cells[y][: row.first]:
                yield f"line {row.line} has no label {row.label}"
            left -= {(y, x) for x, cell in enumerate(cells[y]) if cell == row.label and x < row.first}
            left -= {(y, row.first + number) for number in range(len(table.columns))}
        for column in table.columns:
            if column.label not in cells[table.head - start]:
                yield f"line {table.head} has no label {column.label}"
            left -= {
                (table.head - start, x) for x, cell in enumerate(cells[table.head - start]) if cell == column.label
            }
    if left:
        yield "neither judged nor set aside: " + ", ".join(cells[y][x] for y, x in sorted(left))
