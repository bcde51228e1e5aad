"""Files written whole or not at all, each by one writer at a time."""

from __future__ import annotations

import os
import re
import secrets
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import BinaryIO

from filelock import FileLock

Content = str | bytes | Iterable[str]

# beside the file NAME: the lock of its writer, drafts of it, and what they replace until all are in their places
_TRACE = re.compile(r"\.(?P<name>.+)\.(writing|[0-9a-f]{16}\.(part|old))", re.DOTALL)


def write_whole(files: Mapping[Path, Content]) -> None:
    """Write every file, or, where one cannot be made, none.

    All of them are written beside their places, to the disk, before the first takes its place; where one cannot, those
    before it get their old content back (on disks with hard links). A process that is killed in between leaves every
    file whole, old or new, and traces, which the next writer of the file removes.

    Who writes a file waits until no other thread or process writes it (on disks with locks), so that files which two
    calls write at once are all of one. A file that is replaced keeps its permissions, and they must allow to write it.

    Content is text or chunks of text, written as UTF-8 with "\\n", or bytes. Folders that are missing are made. What is
    there and is no regular file (/dev/stdout, a pipe) cannot be replaced and is written to last, as it is.
    Raises OSError, which names the path as it is in `files`.
    """
    special = [path for path in files if path.exists() and not path.is_file()]
    for path in special:
        if path.is_dir():
            raise IsADirectoryError(21, "Is a directory; write the path of a file", str(path))
    # a link stays a link: what it points to is replaced
    asked = {Path(os.path.realpath(path)): path for path in files if path not in special}
    drafts: dict[Path, Path] = {}
    with ExitStack() as alone:
        for place, path in sorted(asked.items()):  # in one order, so that no two wait for each other
            with _name_errors(path), suppress(FileExistsError):  # no folder: that is said where the draft is made
                place.parent.mkdir(parents=True, exist_ok=True)
            alone.enter_context(_lock(place))
        try:
            for place, path in asked.items():
                drafts[place] = place.with_name(f".{place.name}.{secrets.token_hex(8)}.part")
                with _name_errors(path):
                    _draft(drafts[place], place, files[path])
            _put(drafts, asked)
        finally:
            for draft in drafts.values():
                with suppress(OSError):  # in place by now, or never made
                    draft.unlink()
    for path in special:
        with _name_errors(path), path.open("wb") as file:
            _fill(file, files[path])


def traces(folder: Path) -> Iterator[tuple[Path, Path]]:
    """What those who write now, or were killed, have in a folder beside their files, each with its file."""
    for path in folder.glob(".*"):
        if trace := _TRACE.fullmatch(path.name):
            yield path, folder / trace["name"]


@contextmanager
def _lock(place: Path) -> Iterator[None]:
    """No other writer of a file, and no traces of earlier ones."""
    path = place.with_name(f".{place.name}.writing")
    lock = FileLock(path, fallback_to_soft=False)
    try:
        os.close(
            os.open(path, os.O_CREAT | os.O_WRONLY, 0o644)
        )  # for a lock in a folder that takes no files one waits for ever
        lock.acquire()
    except OSError as error:  # not all disks have locks; what keeps drafts away too is met with these
        if not isinstance(error, PermissionError):  # a lock of another user may be held
            with suppress(OSError):
                path.unlink()
        yield
        return
    try:
        for trace, owner in traces(place.parent):
            if owner == place and trace != path:
                with suppress(OSError):  # of another user
                    trace.unlink()
        yield
    finally:
        with suppress(OSError):  # Windows removes no open file; there the lock does it when it is released
            path.unlink()
        lock.release()


@contextmanager
def _name_errors(path: Path) -> Iterator[None]:
    """Errors name the path that was asked for, whatever was done for it."""
    try:
        yield
    except OSError as error:
        error.filename, error.filename2 = str(path), None
        raise


def _draft(draft: Path, place: Path, content: Content) -> None:
    mode = _permissions(place)
    opener = partial(os.open, mode=0o666 if mode is None else mode)  # never open to more than the file is
    with open(draft, "xb", opener=opener) as file:
        if mode is not None:
            with suppress(OSError):  # not all disks have permissions
                draft.chmod(mode)
        _fill(file, content)
        file.flush()
        os.fsync(file.fileno())


def _permissions(place: Path) -> int | None:
    """Of the file that is there; OSError where it may not be written."""
    try:
        file = os.open(place, os.O_WRONLY)
    except FileNotFoundError:
        return None
    try:
        return os.fstat(file).st_mode & 0o777
    finally:
        os.close(file)


def _put(drafts: Mapping[Path, Path], files: Mapping[Path, Path]) -> None:
    """Every draft into its place, or none."""
    kept: dict[Path, Path] = {}
    new: list[Path] = []
    try:
        for place, draft in drafts.items():
            old, there = draft.with_suffix(".old"), place.exists()
            with suppress(OSError):  # not all disks have links; without, what is replaced is gone
                if there:
                    os.link(place, old)
                    kept[place] = old
            with _name_errors(files[place]):
                os.replace(draft, place)
            if not there:
                new.append(place)
    except BaseException:
        for place, old in kept.items():
            with suppress(OSError):  # one that cannot be put back is no reason to leave the others
                os.replace(old, place)
        for place in new:
            with suppress(OSError):
                place.unlink()
        raise
    finally:
        for old in kept.values():
            with suppress(OSError):  # back in place
                old.unlink()


def _fill(file: BinaryIO, content: Content) -> None:
    match content:
        case bytes():
            file.write(content)
        case str():
            file.write(content.encode())
        case _:
            file.writelines(chunk.encode() for chunk in content)
