"""The tables and constants of a kernel, declared once: in the header that its C is read with, and written from there.

templates/c/KIND/tables.h stands for what a program has above the text of its kernel; ports.h there is part of it. Of
its paragraphs those of
`extern const real NAME[];` and `extern const real NAME;` with comments become definitions, in the same order; in those
of `enum { NAME = 3 };` constants of a program take the places of numbers.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from wavesym.programs.program import Program
from wavesym.rendering import text_of
from wavesym.targets.c.kernel import with_names
from wavesym.targets.description import Description
from wavesym.targets.literals import Lines, c_constants, c_tables

_DECLARATION = re.compile(r"extern const (int|real) (\w+)(\[\])?;")
_ENUM = re.compile(r"enum \{[^}]*\};")
_NUMBER = re.compile(r"\b([A-Z][A-Z_]*) = -?\d+\b")


class Declaration(NamedTuple):
    """A table, or a single number."""

    type: str
    name: str
    is_table: bool


def declarations(file: str) -> Iterator[list[str | Declaration]]:
    """The paragraphs of templates/c/`file` that a program has: comments and enumerations are their text."""
    ports = text_of("c/ports.h").partition("\n\n")[2]
    for paragraph in text_of(f"c/{file}").replace('#include "../ports.h"\n', ports).rstrip().split("\n\n"):
        items: list[str | Declaration] = []
        for line in paragraph.splitlines():
            if found := _DECLARATION.fullmatch(line):
                items.append(Declaration(found[1], found[2], bool(found[3])))
            elif items and isinstance(items[-1], str) and not items[-1].endswith("*/" if items[-1][0] == "/" else "};"):
                items[-1] += f"\n{line}"
            else:
                items.append(line)
        # those of an enumeration whose names begin with the scene's are in its header
        if all(isinstance(item, Declaration) or _is_text(item) for item in items):
            yield items


def _is_text(item: str) -> bool:
    return item.startswith("/*") or bool(_ENUM.fullmatch(item) and not re.search(r"\bNAME_\w+ =", item))


def sizes(file: str, program: Program) -> Iterator[tuple[str, str]]:
    """The constants of a program that are enumerated there under the scene's name: those of its header."""
    for name in re.findall(r"\bNAME_(\w+) = \d", text_of(f"c/{file}")):
        if name.lower() in program.constants:
            yield name, str(program.constants[name.lower()])


def program_tables(file: str, scene: Description, program: Program, constants: Mapping[str, str] | None = None) -> str:
    """The tables and constants of a program, and more `constants`."""
    known = c_constants(program.constants, program.real) | dict(constants or {})
    paragraphs = tables_text(file, c_tables(program.tables, program.real), known)
    return with_names("\n\n".join(text.rstrip() for text in paragraphs if text), scene)


def tables_text(
    file: str,
    tables: Mapping[str, Lines],
    constants: Mapping[str, str],
) -> list[str]:
    """The same with values, each paragraph as text: what has none is left out, and comments of nothing else."""
    return ["\n".join(_write(items, tables, constants)) for items in declarations(file)]


def _write(items: list[str | Declaration], tables: Mapping[str, Lines], constants: Mapping[str, str]) -> Iterator[str]:
    comment = ""
    for item in items:
        if isinstance(item, str) and item.startswith("/*"):
            comment = item
            continue
        text = _NUMBER.sub(lambda of: _enumerate_constant(of, constants), item) if isinstance(item, str) else ""
        if isinstance(item, Declaration):
            text = _define_item(item, tables, constants)
        if text:
            yield from filter(None, (comment, text))
            comment = ""


def _enumerate_constant(found: re.Match[str], constants: Mapping[str, str]) -> str:
    value = constants.get(found[1].lower())
    return found[0] if value is None else f"{found[1]} = {value}"


def _define_item(item: Declaration, tables: Mapping[str, Lines], constants: Mapping[str, str]) -> str:
    """Empty where there is no value."""
    if item.is_table:
        rows = tables.get(item.name, ())
        return "\n".join((f"static const {item.type} {item.name}[] = {{", *(f"    {row}" for row in rows), "};\n")) * (
            item.name in tables
        )
    value = constants.get(item.name)
    return "" if value is None else f"static const {item.type} {item.name} = {value};"
