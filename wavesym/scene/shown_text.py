"""A scene's text as others may read it: without the remarks of its author, and without the folders of a machine."""

from __future__ import annotations

import json
import tomllib
from pathlib import PureWindowsPath

from wavesym.scene.key_lines import TOKEN

_RECORD = (["record", "="], ['"record"', "="], ['"record"', ":"])  # the last in JSON


def shown_text(text: str) -> str:
    """A text that is TOML, or JSON, without comments, which may be older than its numbers; records by their files.

    It is the same scene where files of records lie beside it.
    """
    written: list[str] = []
    before: list[str] = []  # the two tokens before, of those that mean something
    end = 0
    for found in TOKEN.finditer(text):
        token, end = text[end : found.start()] + found[0], found.end()
        if found.lastgroup == "skipped":
            written += [token] * (not token.startswith("#"))
            continue
        if token == "\n":
            while written and written[-1].isspace() and written[-1] != "\n":
                written.pop()
            if written and written[-1] == "\n" and _ends_with_comment(text, found.start()):
                continue  # the line was a comment
        if found.lastgroup == "text" and before in _RECORD:
            token = json.dumps(PureWindowsPath(tomllib.loads(f"file = {token}")["file"]).name, ensure_ascii=False)
        written.append(token)
        before = [*before[-1:], token]
    return ("".join(written) + text[end:]).lstrip("\n")


def _ends_with_comment(text: str, place: int) -> bool:
    line = text[text.rfind("\n", 0, place) + 1 : place]
    return line.lstrip().startswith("#")
