"""Files of a sweep's folder as they were written, or not at all: JSON with a hash of itself, and no links."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from stat import S_ISREG
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from wavesym.errors import WavesymError

_LARGEST = 1 << 28  # bytes of JSON
Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class DamagedError(WavesymError):
    """Files that are not as they were written; the message says which, and what writes them again."""

    status = 1


class NoFileError(DamagedError):
    """Something else where a sweep has a file: a link, a pipe or a folder. Only whoever put it there removes it."""


class StrictTable(BaseModel):
    """Data from a file: all fields and no others, of exactly these types."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class SealedFile(StrictTable):
    """A file of JSON whose key `seal` is the hash of all others."""

    def put(self, path: Path) -> None:
        """Write it, in its place by rename. NoFileError where a folder is there."""
        if path.is_dir():
            refuse_other(path)
        draft = path.with_suffix(".part")
        draft.unlink(missing_ok=True)  # it may be a link, in a folder that others have made
        fields = self.model_dump()
        draft.write_text(json.dumps({**fields, "seal": _seal(fields)}, indent=1) + "\n", encoding="utf-8")
        os.replace(draft, path)

    @classmethod
    def read(cls, path: Path) -> Self | None:
        """The file at a path, None where there is none.

        Raises DamagedError, which names the path, for one that is not as it was written.
        """
        try:
            fields = json.loads(file_bytes(path, _LARGEST))
            if isinstance(fields, dict) and fields.pop("seal", None) == _seal(fields):
                return cls.model_validate(fields)
        except (FileNotFoundError, NotADirectoryError):
            return None
        except NoFileError:
            raise
        except (ValidationError, ValueError, RecursionError):
            pass
        raise DamagedError(f"{path}: damaged")


def file_bytes(path: Path, most: int) -> bytes:
    """The bytes of a file. NoFileError for a link, a device or a folder, DamagedError for more than `most` bytes."""
    refuse_other(path)
    if path.stat().st_size > most:
        raise DamagedError(f"{path}: damaged")
    return path.read_bytes()


def refuse_other(path: Path) -> None:
    """NoFileError where what is at a path is no file; FileNotFoundError where nothing is."""
    if not S_ISREG(path.lstat().st_mode):
        raise NoFileError(f"{path}: no file, and a sweep has one there; delete it, and `wavesym sweep` makes it again")


def _seal(fields: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(fields, indent=1).encode()).hexdigest()
