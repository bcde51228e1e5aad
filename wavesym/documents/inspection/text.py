"""Sections as text: aligned columns and short lines; what is long is cut, and the cut says how much is left out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import islice
from textwrap import wrap

from wavesym.documents.inspection.section import Display, Facts, Listing, Plain, Section
from wavesym.results.presentation import align_columns

MOST_ROWS = 20
MOST_ITEMS = 8  # of a list within a line
_WIDTH = 100


def section_lines(section: Section) -> Iterator[str]:
    """A section, after an empty line: its words, then its values or rows."""
    yield ""
    yield f"{section.words}:"
    yield from _facts(section) if isinstance(section, Facts) else _rows(section)


def _facts(section: Facts) -> Iterator[str]:
    width = max(map(len, section.values), default=0)
    for name, value in section.values.items():
        first, *more = wrap(value_text(value), _WIDTH - width - 4) or [""]
        yield f"  {name:{width}}  {first}".rstrip()
        yield from (f"  {'':{width}}  {line}" for line in more)
    if not section.values:
        yield "  none"


def _rows(section: Listing) -> Iterator[str]:
    rows = [_shown_row(row) for row in islice(section.rows, MOST_ROWS)]
    columns = [name for name in (rows[0] if rows else ()) if name not in (*section.sentences, *section.hidden)]
    indent = " " * (6 if columns else 2)
    heads = [{name: name for name in columns}]
    cells = [[row[name] for name in columns] for row in (*heads, *rows)]
    head, *lines = align_columns(cells, left=range(len(columns)))
    if len(columns) > 1:
        yield f"  {head}"
    for row, line in zip(rows, lines, strict=True):
        if columns:
            yield f"  {line}"
        for name in section.sentences:
            for part in row.get(name, "").splitlines():
                yield from wrap(part, _WIDTH, initial_indent=indent, subsequent_indent=f"{indent}  ")
    if len(section.rows) > MOST_ROWS:
        yield f"  ... and {len(section.rows) - MOST_ROWS} more"
    if not rows:
        yield "  none"


def _shown_row(row: Mapping[str, Plain | Display]) -> dict[str, str]:
    return {name: value_text(value) for name, value in row.items()}


def value_text(value: Plain | Display) -> str:
    """A value for a person."""
    match value:
        case Display():
            return value.words
        case None:
            return "-"
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:.9g}"
        case dict():
            return _list_text(
                [f"{name}: {value_text(each)}" for name, each in islice(value.items(), MOST_ITEMS)], len(value)
            )
        case list() | tuple():
            return _list_text([value_text(each) for each in islice(value, MOST_ITEMS)], len(value))
    return str(value)


def _list_text(items: list[str], count: int) -> str:
    more = [f"... and {count - len(items)} more"] if count > len(items) else []
    return ", ".join([*items, *more]) or "none"
