"""A table as text: CSV, JSON or LaTeX, with exact values, line by line."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass

from wavesym.coefficients.table import Row, Table
from wavesym.emission.rendering import render_stream


@dataclass(frozen=True)
class LatexTable:
    """templates/latex/tables.tex.j2; `rows` is read once."""

    name: str
    interval: str
    rows: Iterator[tuple[str, ...]]


def table_lines(table: Table, name: str, format: str) -> Iterator[str]:
    """The rows of a table as text. `format` is "csv", "json" or "latex"."""
    return {"csv": _csv, "json": _json, "latex": _latex}[format](table, name)


def _csv(table: Table, name: str) -> Iterator[str]:
    yield ",".join(Row._fields) + "\n"
    for row in table.rows():
        yield ",".join(map(str, row)) + "\n"


def _json(table: Table, name: str) -> Iterator[str]:
    yield f'{{"name": {json.dumps(name)}, "interval": {table.interval}, "rows": ['
    separator = "\n"
    for row in table.rows():
        yield separator + json.dumps(row._asdict() | {"rate": str(row.rate), "value": str(row.value)})
        separator = ",\n"
    yield "\n]}\n"


def _latex(table: Table, name: str) -> Iterator[str]:
    rows = (tuple(map(str, row)) for row in table.rows())
    return render_stream("latex/tables.tex.j2", LatexTable(name.replace("_", r"\_"), str(table.interval), rows))
