"""A scene's text from where it is, and the TOML in it, with decimals kept as they are written."""

from __future__ import annotations

import os
import re
import sys
import tomllib
from importlib.resources import files
from itertools import islice
from os import PathLike
from typing import Any

from wavesym.errors import SceneError, did_you_mean
from wavesym.fields.table import WrittenDecimal
from wavesym.reading import read_text

_TEXT = "scene"  # what a text is called that is in no file
_BUILTIN = files("wavesym.scene") / "builtin"


def builtin_names() -> dict[str, str]:
    """The built-in scenes by name, each with its first comment line as description."""
    names = sorted(file.name.removesuffix(".toml") for file in _BUILTIN.iterdir() if file.name.endswith(".toml"))
    return {name: _builtin(name).decode().partition("\n")[0].lstrip("# ") for name in names}


def _builtin(name: str) -> bytes:
    return (_BUILTIN / f"{name}.toml").read_bytes()


def read_toml(source: str | PathLike[str]) -> tuple[str, str, dict[str, Any]]:
    """The name a source goes by in messages, its text, and the table in it.

    `source` is a path, `-` for standard input, the name of a built-in scene, or the text itself, whose records count
    from the working folder. Raises SceneError.
    """
    file, text = toml_text(source)
    folder = "" if file == _TEXT else os.path.dirname(os.fspath(source))
    return file, text, _absolute_records(folder, parse_text(file, text))


def toml_text(source: str | PathLike[str]) -> tuple[str, str]:
    """The name a source goes by in messages, and its text, not parsed yet. Raises SceneError."""
    if not isinstance(source, str | PathLike) or not isinstance(path := os.fspath(source), str):
        raise SceneError(f'{type(source).__name__} is no path and no text; write Scene.from_toml("scene.toml")')
    if isinstance(source, str) and "\n" in source and "=" in source:  # no scene has but one line
        return _TEXT, source
    if path in builtin_names():
        return path, _builtin(path).decode()
    try:
        return read_text(path, f"a TOML file, - or a built-in scene ({', '.join(builtin_names())})")
    except SceneError as error:
        meant = did_you_mean(path, builtin_names())
        raise SceneError(f"{error.what}{meant and f'. {meant}'}", error.path, error.file) from None


def _absolute_records(folder: str, fields: dict[str, Any]) -> dict[str, Any]:
    """A scene's table with paths of records that count from the scene's folder."""
    loads = fields.get("load")
    if not isinstance(loads, list):
        return fields
    return {**fields, "load": [_record_beside(folder, load) for load in loads]}


def _record_beside(folder: str, load: object) -> object:
    if not isinstance(load, dict) or not isinstance(record := load.get("record"), str):
        return load
    return {**load, "record": os.path.join(folder, record)}


def builtin_text(name: str) -> str:
    """A built-in scene as TOML. SceneError for a name that is none."""
    if name not in builtin_names():
        meant = did_you_mean(name, builtin_names())
        known = ", ".join(builtin_names())
        raise SceneError(f"unknown; write a built-in scene ({known}){meant and f'. {meant}'}", file=name)
    return _builtin(name).decode()


# Strings (also without an end, so that each is looked at once) and comments.
_STRINGS = re.compile(
    r'"""(?:\\[\s\S]|[^\\])*?(?:"""|\Z)|"(?:\\.|[^"\\\n])*+"?' + r"|'''[\s\S]*?(?:'''|\Z)|'[^'\n]*+'?|#[^\n]*+"
)
_MOST_KEYS = 10  # in a dotted key
_DEEP_KEY = re.compile(rf"(?<![\w-])(?:[\w-]++[ \t]*+\.[ \t]*+){{{_MOST_KEYS}}}[\w-]")
_TABLE = re.compile(
    r"^[ \t]*+\[|\{|(?<![\w.-])[\w-]++(?:[ \t]*+\.[ \t]*+[\w-]++)++[ \t]*+=",  # a header, { and a key with dots
    re.MULTILINE,
)
_MOST_TABLES = 20_000
_MOST_ASSIGNED = 60_000  # keys of all tables: a chain of thousands of rods in units has fewer
_MOST_VALUES = 300_000
_MOST_LINES = 1_000_000
_MOST_ESCAPES = 100_000  # the parser may copy a text for each of them


def _refuse_large(file: str, text: str) -> None:
    """SceneError for what would take long to parse: deep keys, many lines, escapes, tables, keys or values.

    A key with dots makes a table, as a header does.
    """
    if text.count("\n") > _MOST_LINES:
        raise SceneError(f"more than {_MOST_LINES} lines; a scene has no more", file=file)
    if text.count("\\") > _MOST_ESCAPES:
        raise SceneError(f"more than {_MOST_ESCAPES} backslashes; a scene has no more", file=file)
    bare = _STRINGS.sub("_", text)
    if found := _DEEP_KEY.search(bare):
        line = bare.count("\n", 0, found.start()) + 1
        raise SceneError(f"a key of more than {_MOST_KEYS} parts; a scene has no deeper ones", f"line {line}", file)
    tables = sum(1 for _ in islice(_TABLE.finditer(bare), _MOST_TABLES + 1))
    if tables > _MOST_TABLES:
        raise SceneError(
            f"more than {_MOST_TABLES} tables; a load that changes often is one table with `samples` or a `record`",
            file=file,
        )
    if bare.count("=") > _MOST_ASSIGNED:
        raise SceneError(f"more than {_MOST_ASSIGNED} keys; a scene has no more", file=file)
    if bare.count(",") + bare.count("=") > _MOST_VALUES:
        raise SceneError(f"more than {_MOST_VALUES} values; split the scene, or thin its samples", file=file)


_PLACE = re.compile(r"at line ([0-9]+), column ([0-9]+)")
_OPEN = ("Illegal character '\\n'", "Found invalid character '\\n'", "Unterminated string", 'Expected "\'"')
_COMMA = re.compile(r"=\s*([+-]?[0-9]+),([0-9]+)\s*\Z")
_UNQUOTED = re.compile(r"=\s*([+-]?[0-9]+(?:\.[0-9]+)?)\s*\Z")
_REST = re.compile(r"(,[0-9]+)|\s*([A-Za-z][\w/*^]*)")


def _remedy(text: str, error: str) -> str:
    """What to write in place of what is not TOML, for the slips that are frequent; empty for others."""
    if error.startswith(_OPEN):
        return '; a text begins and ends with a quote, on one line: write " at its end'
    if not (place := _PLACE.search(error)):
        return ""
    line, column = text.split("\n")[int(place[1]) - 1], int(place[2]) - 1
    before, after = line[:column], line[column:]
    if found := _COMMA.search(before):  # in braces, where what follows a comma should be a key
        return f"; numbers have a decimal point: write {found[1][:20]}.{found[2][:20]}"
    number, rest = _UNQUOTED.search(before), _REST.match(after)
    if number and rest and rest[1]:
        return f"; numbers have a decimal point: write {number[1][:20]}.{rest[1][1:20]}"
    if number and rest:
        return f'; a quantity has quotes: write "{number[1][:20]} {rest[2][:20]}"'
    return ""


def parse_text(file: str, text: str) -> dict[str, Any]:
    """The table in a text of TOML, decimals as they are written. SceneError, which names `file`, where it is none."""
    _refuse_large(file, text)
    try:
        return tomllib.loads(text, parse_float=WrittenDecimal)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"not TOML, {error}{_remedy(text, str(error))}", file=file) from None
    except ValueError:  # the limit is Python's
        digits = sys.get_int_max_str_digits()
        raise SceneError(f"an integer has more than {digits} digits; write fewer", file=file) from None
    except RecursionError:
        raise SceneError("tables or lists too deep in one another; write a scene", file=file) from None
