"""A scene's text from where it is, and the TOML in it, with decimals kept as they are written."""

from __future__ import annotations

import os
import sys
import tomllib
from functools import lru_cache
from importlib.resources import files
from os import PathLike
from typing import Any, BinaryIO

from wavesym.errors import SceneError, did_you_mean
from wavesym.fields.table import Written

LARGEST_FILE = 16 * 2**20  # bytes

_BUILTIN, _FIRST = (files("wavesym.scene") / folder for folder in ("builtin", "first"))


def builtin_names() -> dict[str, str]:
    """The built-in scenes by name, each with its first comment line as description."""
    names = sorted(file.name.removesuffix(".toml") for file in _BUILTIN.iterdir() if file.name.endswith(".toml"))
    return {name: _builtin(name).decode().partition("\n")[0].lstrip("# ") for name in names}


def _builtin(name: str) -> bytes:
    return (_BUILTIN / f"{name}.toml").read_bytes()


def first_text(system: str) -> str:
    """A commented scene to start from: of a "building", "drive" or "collision"."""
    return (_FIRST / f"{system}.toml").read_bytes().decode()


def read_toml(source: str | PathLike[str]) -> tuple[str, dict[str, Any]]:
    """The name a source goes by in messages, and the table in it.

    `source` is a path, `-` for standard input, or the name of a built-in scene. Raises SceneError.
    """
    file, text = toml_text(source)
    return file, _parsed(file, text)


def toml_text(source: str | PathLike[str]) -> tuple[str, str]:
    """The name a source goes by in messages, and its text, not parsed yet. Raises SceneError."""
    path = os.fspath(source)
    if path in builtin_names():
        return path, _builtin(path).decode()
    try:
        return read_text(path, f"a TOML file, - or a built-in scene ({', '.join(builtin_names())})")
    except SceneError as error:
        meant = did_you_mean(path, builtin_names())
        raise SceneError(f"{error.what}{meant and f'. {meant}'}", error.path, error.file) from None


def builtin_text(name: str) -> str:
    """A built-in scene as TOML. SceneError for a name that is none."""
    if name not in builtin_names():
        meant = did_you_mean(name, builtin_names())
        expected = f"a built-in scene expected ({', '.join(builtin_names())})"
        raise SceneError(f"unknown, {expected}{meant and f'. {meant}'}", file=name)
    return _builtin(name).decode()


def read_text(path: str | PathLike[str], expected: str) -> tuple[str, str]:
    """The name a path (or `-`, standard input) goes by in messages, and the text there.

    Raises SceneError where it cannot be read, is empty, is no UTF-8 or larger than LARGEST_FILE; `expected` says what
    it should be.
    """
    path = os.fspath(path)
    file = "<stdin>" if path == "-" else path
    try:
        content = _bytes(path)
    except OSError as error:
        raise SceneError(f"{error.strerror}, {expected} expected", file=file) from None
    except ValueError:  # a 0 byte in the path
        raise SceneError(f"no path, {expected} expected", file=file) from None
    if len(content) > LARGEST_FILE:
        raise SceneError(f"larger than {LARGEST_FILE >> 20} MB, {expected} of at most that expected", file=file)
    try:
        text = content.decode("utf-8-sig")  # with the mark that some editors put first
    except UnicodeDecodeError as error:
        raise SceneError(f"byte {error.start} is not UTF-8, {expected} expected", file=file) from None
    if not text.strip():
        raise SceneError(f"empty, {expected} expected", file=file)
    return file, text


def _bytes(path: str) -> bytes:
    """The file's bytes, or one more than the limit: a device or a pipe need not end."""
    if path != "-":
        with open(path, "rb") as stream:
            return stream.read(LARGEST_FILE + 1)
    if sys.stdin is None:
        raise OSError(None, "No standard input")
    return _once(sys.stdin.buffer)


@lru_cache(maxsize=1)
def _once(stream: BinaryIO) -> bytes:
    """What a stream gives, for all who ask: it can be read only once."""
    return stream.read(LARGEST_FILE + 1)


def _parsed(file: str, text: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text, parse_float=Written)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"no TOML, {error}", file=file) from None
    except ValueError:  # the limit is Python's
        digits = sys.get_int_max_str_digits()
        raise SceneError(f"an integer of more than {digits} digits, fewer expected", file=file) from None
    except RecursionError:
        raise SceneError("tables or lists too deep in one another, a scene expected", file=file) from None
