"""Rows of text in aligned columns."""

from __future__ import annotations

from collections.abc import Sequence

Row = dict[str, str]


def table(rows: Sequence[Row], names: Sequence[str]) -> list[str]:
    """Lines of aligned columns: `names` to the left, numbers to the right, and "verdict" last."""
    columns = [column for column in dict.fromkeys(column for row in rows for column in row) if column != "verdict"]
    columns.append("verdict")  # last, where a row has fewer columns too
    grid = [columns, *([row.get(column, "-") for column in columns] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*grid, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if column in names else cell.rjust(width)
            for cell, width, column in zip(line, widths, columns, strict=True)
        ).rstrip()
        for line in grid
    ]
