"""Files read: whole, and of limited size."""

from __future__ import annotations

import os
import stat
import sys
from os import PathLike

from wavesym.errors import SceneError

LARGEST_FILE = 16 * 2**20  # bytes
_OPEN = ("/dev/fd/", "/dev/stdin", "/proc/")
"""How names of files begin that a process has open."""


def read_bytes(path: str | PathLike[str], wanted: str) -> tuple[str, bytes]:
    """The name a path (or `-`, standard input) goes by in messages, and the bytes there.

    Raises SceneError where it cannot be read or is larger than LARGEST_FILE; `wanted` says what it should be.
    """
    path = os.fspath(path)
    file = "<stdin>" if path == "-" else path
    try:
        content = _read_limited(path)
    except OSError as error:
        raise SceneError(f"{error.strerror}; write {wanted}", file=file) from None
    except ValueError:  # a 0 byte in the path
        raise SceneError(f"not a path; write {wanted}", file=file) from None
    if len(content) > LARGEST_FILE:
        raise SceneError(f"larger than {LARGEST_FILE >> 20} MB; write {wanted} of at most that", file=file)
    return file, content


def read_text(path: str | PathLike[str], wanted: str) -> tuple[str, str]:
    """The same with the text there. Raises SceneError where that is empty or no UTF-8, too."""
    file, content = read_bytes(path, wanted)
    try:
        text = content.decode("utf-8-sig")  # with the mark that some editors put first
    except UnicodeDecodeError as error:
        raise SceneError(f"byte {error.start} is not UTF-8; write {wanted}", file=file) from None
    if not text.strip():
        raise SceneError(f"empty; write {wanted}", file=file)
    return file, text


def _read_limited(path: str) -> bytes:
    """The file's bytes, or one more than the limit: a device or a pipe need not end.

    What a kernel makes while it is read (/proc/kmsg) may never come, and says that it holds nothing: so it is not read.
    Nor is a pipe with a name, to open which may take for ever: only one that this process has open, as of a shell.
    """
    if path != "-":
        held = os.stat(path)
        if stat.S_ISFIFO(held.st_mode) and not os.path.abspath(path).startswith(_OPEN):
            raise OSError(None, "Is a named pipe, into which nobody may write")
        if stat.S_ISREG(held.st_mode) and held.st_size == 0:
            return b""
        with open(path, "rb") as stream:
            return stream.read(LARGEST_FILE + 1)
    if sys.stdin is None:
        raise OSError(None, "No standard input")
    return sys.stdin.buffer.read(LARGEST_FILE + 1)
