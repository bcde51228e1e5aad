"""The tables of a kernel, declared once: in the header that its C is read with, and written from there with values.

templates/c/KIND/tables.h stands for what a program has above the text of its kernel. Its paragraphs of
`extern const real NAME[];` with comments become those of `static const real NAME[] = {...};`, in the same order.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from wavesym.rendering import text_of
from wavesym.targets.literals import Lines

_TABLE = re.compile(r"extern const (int|real) (\w+)\[\];")


def table_declarations(file: str) -> Iterator[list[str | tuple[str, str]]]:
    """The paragraphs of tables in templates/c/`file`: a comment is its text, a table its type and name."""
    for paragraph in text_of(f"c/{file}").rstrip().split("\n\n"):
        items: list[str | tuple[str, str]] = []
        for line in paragraph.splitlines():
            if table := _TABLE.fullmatch(line):
                items.append((table[1], table[2]))
            elif items and isinstance(items[-1], str) and not items[-1].endswith("*/"):
                items[-1] += f"\n{line}"
            else:
                items.append(line)
        if all(isinstance(item, tuple) or item.startswith("/*") for item in items):
            yield items


def tables_text(file: str, values: Mapping[str, Lines], words: Mapping[str, str] | None = None) -> list[str]:
    """The same with `values`, each paragraph as text: tables without any are left out, and comments of nothing else.

    In comments `words` are replaced.
    """
    return ["\n".join(_write(items, values, words or {})) for items in table_declarations(file)]


def _write(items: list[str | tuple[str, str]], values: Mapping[str, Lines], words: Mapping[str, str]) -> Iterator[str]:
    comment = ""
    for item in items:
        if isinstance(item, str):
            comment = item
        elif item[1] in values:
            if comment:
                yield re.sub(r"\b[A-Z]+\b", lambda word: words.get(word[0], word[0]), comment)
                comment = ""
            kind, name = item
            yield "\n".join((f"static const {kind} {name}[] = {{", *(f"    {line}" for line in values[name]), "};\n"))
