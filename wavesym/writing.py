"""Files written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path

Content = str | bytes | Iterable[str]


def write_whole(files: Mapping[Path, Content]) -> None:
    """Write every file, or, where one cannot be made, none.

    All of them are written beside their places, to the disk, before the first takes its place; where one cannot, those
    before it get their old content back (on disks with hard links). A process that is killed in between leaves every
    file whole, old or new.

    Content is text or chunks of text, written as UTF-8 with "\\n", or bytes. Folders that are missing are made. What is
    there and is no regular file (/dev/stdout, a pipe) cannot be replaced and is written to last, as it is.
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
            _write(draft, files[path], lasting=True)
        _put(drafts)
    finally:
        for draft in drafts:
            with suppress(OSError):  # in place by now, or never made
                draft.unlink()
    for path in special:
        _write(path, files[path], lasting=False)


def _put(drafts: Mapping[Path, Path]) -> None:
    """Every draft into its place, or none."""
    kept: dict[Path, Path] = {}
    new: list[Path] = []
    try:
        for draft, place in drafts.items():
            old, there = draft.with_suffix(".old"), place.exists()
            with suppress(OSError):  # not all disks have links; without, what is replaced is gone
                if there:
                    os.link(place, old)
                    kept[old] = place
            os.replace(draft, place)
            if not there:
                new.append(place)
    except BaseException:
        for old, place in kept.items():
            os.replace(old, place)
        for place in new:
            place.unlink()
        raise
    finally:
        for old in kept:
            with suppress(OSError):  # back in place
                old.unlink()


def _write(path: Path, content: Content, *, lasting: bool) -> None:
    with path.open("wb") as file:
        match content:
            case bytes():
                file.write(content)
            case str():
                file.write(content.encode())
            case _:
                file.writelines(chunk.encode() for chunk in content)
        if lasting:
            file.flush()
            os.fsync(file.fileno())
