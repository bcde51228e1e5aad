"""A file of a record, AT2 or CSV, as what it says."""

from __future__ import annotations

import os
import stat
from os import PathLike

from wavesym.errors import SceneError
from wavesym.reading import read_bytes
from wavesym.records.at2 import at2, is_at2
from wavesym.records.columns import columns
from wavesym.records.record_file import MOST_SAMPLES, RecordFile, damage_error

_FORM = "a file of AT2 or CSV"


def read_record(path: str | PathLike[str], column: str | None = None) -> RecordFile:
    """The samples of a file, in `column` where a CSV has more than one. SceneError says which line is damaged.

    A name that ends in .at2, or NPTS in the fourth line, makes it AT2.
    """
    file = os.fspath(path)
    _refuse_special(file)
    file, content = read_bytes(file, _FORM)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise damage_error(file, line, f"byte 0x{content[error.start]:02x} is not UTF-8; write {_FORM}") from None
    if content.count(b"\n") + content.count(b"\r") > 2 * MOST_SAMPLES:
        raise SceneError(f"more lines than {MOST_SAMPLES} samples take; thin the record, or cut it", file=file)
    if not text.strip():
        raise SceneError(f"empty; write {_FORM}", file=file)
    lines = text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n").split("\n")
    if not file.lower().endswith(".at2") and not is_at2(lines):
        return columns(file, lines, column)
    if column is not None:
        raise SceneError("an AT2 file has one column; leave column out", file=file)
    return at2(file, lines)


def _refuse_special(file: str) -> None:
    """What is no file on a disk: a pipe, or a device, may never end."""
    try:
        mode = os.stat(file).st_mode
    except (OSError, ValueError):
        return  # said by who reads it
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise SceneError(f"no file on a disk; write {_FORM}", file=file)
