"""The tables and constants of a kernel, declared once: in the header that its C is read with, and written from there.

templates/c/KIND/tables.h stands for what a program has above the text of its kernel; ports.h there is part of it. Of
its paragraphs those of
`extern const real NAME[];` and `extern const real NAME;` with comments become definitions, in the same order; in those
of `enum { NAME = 3 };` constants of a program take the places of numbers.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from wavesym.programs.program import Program
from wavesym.rendering import text_of
from wavesym.targets.c.kernel import with_names
from wavesym.targets.description import Description
from wavesym.targets.literals import Lines, c_constants, c_tables

_ITEM = re.compile(
    r"(?P<comment>/\*.*?\*/)"
    r"|(?P<enum>enum \{(?:(?!\bNAME_\w+ =)[^}])*\};)"  # those of names that begin with the scene's are in its header
    r"|extern const (?P<type>int|real) (?P<name>\w+)(?P<table>\[\])?;"
    r"|(?P<other>\S[^\n]*)",
    re.DOTALL,
)
_NUMBER = re.compile(r"\b([A-Z][A-Z_]*) = (-?\d+)\b")


def declarations(file: str) -> Iterator[list[re.Match[str]]]:
    """The paragraphs of templates/c/`file` that a program has: comments, enumerations, tables and single numbers."""
    ports = text_of("c/ports.h").partition("\n\n")[2]
    for paragraph in text_of(f"c/{file}").replace('#include "../ports.h"\n', ports).split("\n\n"):
        items = [*_ITEM.finditer(paragraph)]
        if not any(item["other"] for item in items):
            yield items


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


def tables_text(file: str, tables: Mapping[str, Lines], constants: Mapping[str, str]) -> list[str]:
    """The same with values, each paragraph as text: what has none is left out, and comments of nothing else."""
    return ["\n".join(_write(items, tables, constants)) for items in declarations(file)]


def _write(items: list[re.Match[str]], tables: Mapping[str, Lines], constants: Mapping[str, str]) -> Iterator[str]:
    comment = ""
    for item in items:
        if item["comment"]:
            comment = item["comment"]
            continue
        name, text = item["name"], ""
        if item["enum"]:
            text = _NUMBER.sub(lambda of: f"{of[1]} = {constants.get(of[1].lower(), of[2])}", item[0])
        elif item["table"] and name in tables:
            rows = (f"    {row}\n" for row in tables[name])
            text = f"static const {item['type']} {name}[] = {{\n{''.join(rows)}}};\n"
        elif not item["table"] and name in constants:
            text = f"static const {item['type']} {name} = {constants[name]};"
        if text:
            yield from filter(None, (comment, text))
            comment = ""
