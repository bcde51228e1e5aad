"""Tables in a document, each between two marks that say which command writes it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from wavesym.writing import write_whole

Rows = Iterable[Sequence[str]]


def table(head: Sequence[str], rows: Rows) -> str:
    """Lines of Markdown."""
    return "".join(f"| {' | '.join(row)} |\n" for row in (head, ["---"] * len(head), *rows))


def marked_text(text: str, name: str) -> str:
    """What stands between the marks of a name. ValueError where there are none."""
    return _match(text, name)[2]


def put(page: Path, name: str, made: str) -> None:
    """Put what was made between the marks of a name, and leave all else."""
    text = page.read_text(encoding="utf-8")
    found = _match(text, name)
    write_whole({page: text[: found.start(2)] + made + text[found.end(2) :]})


def _match(text: str, name: str) -> re.Match[str]:
    marks = re.compile(rf"(<!-- written by `make {name}` -->\n)(.*?)(<!-- end -->)", re.DOTALL)
    found = marks.search(text)
    if found is None:
        raise ValueError(f"no marks of `make {name}`")
    return found
