"""Files written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path


def write_whole(files: Mapping[Path, str | Iterable[str]]) -> None:
    """Write every file, or, where one cannot be made, none: first beside their places, then all into place.

    Content is text or chunks of text, written as UTF-8 with "\\n". Folders that are missing are made. What is there
    and is no regular file (/dev/stdout, a pipe) cannot be replaced and is written to last, as it is.
    Raises OSError.
    """
    special = [path for path in files if path.exists() and not path.is_file()]
    # a link stays a link: what it points to is replaced
    places = {path: path.resolve() for path in files if path not in special}
    drafts: dict[Path, Path] = {}
    try:
        for path in special:
            if path.is_dir():
                raise IsADirectoryError(21, "Is a directory, a file expected", str(path))
        for path, place in places.items():
            place.parent.mkdir(parents=True, exist_ok=True)
            draft = place.with_name(f".{place.name}.{os.getpid()}.part")
            drafts[draft] = place
            _write(draft, files[path])
        for draft, place in drafts.items():
            os.replace(draft, place)
    finally:
        for draft in drafts:
            with suppress(OSError):  # in place by now, or never made
                draft.unlink()
    for path in special:
        _write(path, files[path])


def _write(path: Path, content: str | Iterable[str]) -> None:
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines([content] if isinstance(content, str) else content)
