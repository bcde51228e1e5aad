"""What keeps a page small: text, rows and columns of curves beyond what one looks at are left out, and it says so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from wavesym.pictures.page.page_tables import PageTable

LARGEST = 400_000  # bytes of a page
FEWEST = 60  # columns of a curve
_TEXT = 40_000  # characters of a scene
_ROWS = 250

P = TypeVar("P")


def fitting(drawn: Callable[[int], P], render: Callable[[P], str], columns: int) -> str:
    """A page whose curves have so many columns, or half as many until it is small enough, or they are too few."""
    while len((text := render(drawn(columns))).encode()) > LARGEST and columns >= 2 * FEWEST:
        columns //= 2
    return text


def first_rows(table: PageTable) -> PageTable:
    """A table of as many rows as one looks at."""
    if len(table.rows) <= _ROWS:
        return table
    note = f"The first {_ROWS} of {len(table.rows)} outputs; `wavesym summary` and `wavesym advise` have all of them"
    return replace(table, rows=table.rows[:_ROWS], notes=(*table.notes, note))


def first_text(text: str) -> str:
    """As much of a scene as one reads."""
    if len(text) <= _TEXT:
        return text
    return f"{text[:_TEXT]}\n... and {len(text) - _TEXT} characters more, left out to keep the page small"
