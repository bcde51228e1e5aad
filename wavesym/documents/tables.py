"""A table as text: CSV, JSON or LaTeX, with exact values, line by line."""

from __future__ import annotations

import json
from collections.abc import Iterator

from flint import fmpq

from wavesym.derivation.symbolic import SymbolicChain
from wavesym.derivation.table import Row, Table
from wavesym.documents.latex_number import latex_number
from wavesym.exact.tables.network_table import NetworkTable
from wavesym.numbers.factorization import polynomial_text
from wavesym.numbers.ratio import Ratio
from wavesym.rendering import render_stream


def table_lines(table: Table | NetworkTable, name: str, format: str) -> Iterator[str]:
    """The rows of a table as text. `format` is "csv", "json", "latex", or "fragment": LaTeX to be \\input."""
    if format in ("latex", "fragment"):
        return _latex(table, name, fragment=format == "fragment")
    return {"csv": _csv, "json": _json}[format](table, name)


def _csv(table: Table | NetworkTable, name: str) -> Iterator[str]:
    yield ",".join(Row._fields) + "\n"
    for row in table.rows():
        yield ",".join(map(str, row)) + "\n"


def _json(table: Table | NetworkTable, name: str) -> Iterator[str]:
    interval = f'"interval": {table.interval}, ' if isinstance(table, Table) else ""
    yield f'{{"name": {json.dumps(name)}, {interval}"rows": ['
    separator = "\n"
    for row in table.rows():
        exact = {"rate": str(row.rate), "value": str(row.value)}
        if isinstance(row.interval, fmpq):
            exact["interval"] = str(row.interval)
        yield separator + json.dumps(row._asdict() | exact)
        separator = ",\n"
    yield "\n]}\n"


def symbolic_lines(table: Table, symbols: SymbolicChain, name: str, format: str) -> Iterator[str]:
    """The rows of a table of rational functions as text. `format` is as of `table_lines`."""
    return _symbolic_json(table, symbols, name) if format == "json" else table_lines(table, name, format)


def _symbolic_json(table: Table, symbols: SymbolicChain, name: str) -> Iterator[str]:
    meaning = json.dumps({parameter: str(ratio) for parameter, ratio in symbols.meaning.items()})
    yield f'{{"name": {json.dumps(name)}, "interval": {table.interval}, "symbols": {meaning}, "rows": ['
    separator = "\n"
    forms: dict[str, None] = {}
    for row in table.rows():
        value = row.value if isinstance(row.value, Ratio) else symbols.ring.constant(fmpq(str(row.value)))
        factors = value.factorization
        forms |= dict.fromkeys(polynomial_text(form) for form, _ in factors.denominator)
        above, below = factors.parts
        fields = row._asdict() | {"rate": str(row.rate), "numerator": above, "denominator": below}
        del fields["value"]
        yield separator + json.dumps(fields)
        separator = ",\n"
    yield f'\n], "forms": {json.dumps(list(forms))}}}\n'


def _latex(table: Table | NetworkTable, name: str, *, fragment: bool) -> Iterator[str]:
    if isinstance(table, Table):
        starts = f"at the start of interval $n$, with $w = z - {table.interval}(n-1)$"
    else:
        starts = r"when it leaves its end of the rod, at the $\tau$ that is the interval, with $w$ the time since then"
    rows = (tuple(map(_latex_cell, row)) for row in table.rows())
    template = "latex/tables_fragment.tex.j2" if fragment else "latex/tables.tex.j2"
    return render_stream(template, name=name.replace("_", r"\_"), label=name, starts=starts, rows=rows)


def _latex_cell(value: object) -> str:
    return latex_number(value) if isinstance(value, Ratio) else str(value).replace("_", r"\_")
