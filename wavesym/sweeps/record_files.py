"""Records as a dimension of a sweep: files found by a pattern, and what is in each of them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from glob import glob
from pathlib import PurePath
from typing import Any

from pydantic_core import PydanticCustomError

from wavesym.errors import SceneError
from wavesym.fields.numbers import exact
from wavesym.fields.table import show
from wavesym.records.recording import read_recording
from wavesym.scene.physical.loads import Acts, read
from wavesym.sweeps.dimension import Column


@dataclass(frozen=True)
class Unreadable:
    """A record whose file is damaged, and why: the cases that need it fail."""

    reason: str


def match_files(patterns: Sequence[str], folder: str) -> list[str]:
    """The files that patterns name, each once, in order. SceneError for a pattern that names none."""
    every: list[str] = []
    for k, pattern in enumerate(patterns):
        some = sorted(glob(os.path.join(folder, pattern)))
        if not some:
            raise SceneError(f"no file at {show(pattern)}; write that of an AT2 or CSV file", f"records[{k}]")
        every += [file for file in some if file not in every]
    return every


def record_column(path: str, files: Sequence[str], folder: str, load: Mapping[str, Any], acts: Acts | None) -> Column:
    """The records of files as values of a load's field, as they are dumped; a coordinate of names."""
    names = tuple(PurePath(os.path.relpath(file, folder or ".")).as_posix() for file in files)
    return Column(path, tuple(_content(file, load, acts) for file in files), names, names)


def _content(file: str, load: Mapping[str, Any], acts: Acts | None) -> dict[str, Any] | Unreadable:
    """What a scene makes of a record, for a load that says the rest."""
    try:
        if acts is not None:
            given = read({**load, "record": file}, acts)
            assert isinstance(given, Mapping)  # as the load
            return dict(given["record"].model_dump(exclude_defaults=True))
        spacing = load.get("spacing")
        exact_spacing = None if spacing is None else exact(spacing)
        return read_recording(file, load.get("column"), lambda _: exact_spacing).model_dump(exclude_defaults=True)
    except SceneError as error:
        return Unreadable(str(error))
    except PydanticCustomError as error:
        return Unreadable(str(error))
