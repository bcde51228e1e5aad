"""On which line of a scene's file each key and each part of a list stands: tomllib tells nobody."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping

from wavesym.fields.table import key_path

TOKEN = re.compile(
    r'(?P<text>"""(?:\\.|[^\\])*?"{3,5}|' + r"'''.*?'{3,5}|" + r'"(?:\\.|[^"\\\n])*"' + r"|'[^'\n]*')"
    r"|(?P<skipped>#[^\n]*|[ \t\r]+)|(?P<mark>[\[\]{},=.\n])|(?P<word>[^\s\[\]{},=.#\"']+)",
    re.DOTALL,
)
_LAST_KEY = re.compile(r'(?:\[\d+\]|(?:^|\.)(?:[^.\[\]"]+|"[^\n]*"))$')
Keys = tuple[str | int, ...]


def line_of(path: str, lines: Mapping[str, int]) -> int:
    """The line of the key at a path, of the table that has not got it, or 0.

    Args:
        path: as in messages, `load[0].times[2]`.
        lines: as of `key_lines`.

    Returns:
        The line, counted from 1; 0 for what stands on none.
    """
    while path and path not in lines:
        path = _LAST_KEY.sub("", path)
    return lines.get(path, 0)


def key_lines(text: str) -> dict[str, int]:
    """The line, counted from 1, of each key, table and part of a list in a text that is TOML, by its path."""
    return {key_path(keys): line for keys, line in _Reader(text).lines.items()}


class _Reader:
    """Reads TOML that is known to be valid, for nothing but where things are."""

    def __init__(self, text: str) -> None:
        self.lines: dict[Keys, int] = {}
        self._tables: dict[Keys, int] = {}  # how many tables each [[list]] has so far
        self._tokens: list[tuple[str, int]] = []
        line = 1
        for found in TOKEN.finditer(text):
            if found.lastgroup != "skipped":
                self._tokens.append((found[0], line))
            line += found[0].count("\n")
        self._tokens.append(("", line))
        self._next = 0
        table: Keys = ()
        while self._token:
            if self._token == "\n":
                self._next += 1
            elif self._token == "[":
                table = self._header()
            else:
                self._pair(table)

    @property
    def _token(self) -> str:
        return self._tokens[self._next][0]

    @property
    def _line(self) -> int:
        return self._tokens[self._next][1]

    def _take(self, *tokens: str) -> bool:
        """Go on behind a token where it is one of some."""
        taken = self._token in tokens
        self._next += taken
        return taken

    def _header(self) -> Keys:
        line = self._line
        self._take("[")
        several = self._take("[")
        keys: Keys = ()
        names = self._names()
        for k, name in enumerate(names, 1):
            keys += (name,)
            if several and k == len(names):
                self._tables[keys] = self._tables.get(keys, 0) + 1
            if keys in self._tables:
                self.lines.setdefault(keys, line)
                keys += (self._tables[keys] - 1,)
        self.lines.setdefault(keys, line)
        self._take("]")
        self._take("]")
        return keys

    def _names(self) -> list[str]:
        """The parts of a key with dots."""
        names = []
        while True:
            name = self._token
            names.append(tomllib.loads(f"{name} = 0").popitem()[0] if name[0] in "\"'" else name)
            self._next += 1
            if not self._take("."):
                return names

    def _pair(self, table: Keys) -> None:
        line = self._line
        for name in self._names():
            table = (*table, name)
            self.lines.setdefault(table, line)
        self._take("=")
        self._value(table)

    def _value(self, keys: Keys) -> None:
        if self._take("["):
            count = 0
            while not self._take("]"):
                if not self._take("\n", ","):
                    self.lines[(*keys, count)] = self._line
                    self._value((*keys, count))
                    count += 1
        elif self._take("{"):
            while not self._take("}"):
                if not self._take("\n", ","):
                    self._pair(keys)
        else:
            while self._token not in (",", "]", "}", "\n", ""):
                self._next += 1
