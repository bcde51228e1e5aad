"""The arrays of a sweep, in a zarr store that xarray reads.

Coordinates, and what is said of arrays, are made by zarr at every start and compared with what is there. What was
computed is read and written here: a chunk is a file of doubles as they are in memory, so that no codec sees a folder
that others have made. One process writes. A chunk is whole on the disk before the mark, which has its hash.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from os import PathLike
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import Any

import numpy as np

from wavesym.errors import WavesymError, install_command
from wavesym.numbers.arrays import Array
from wavesym.sweeps.batches import Batches
from wavesym.sweeps.dimension import SweepAxis
from wavesym.sweeps.marks import BatchMark
from wavesym.sweeps.plan import CASE, LINK, OUTPUT, SAMPLE, SweepPlan
from wavesym.sweeps.sealed_files import DamagedError, refuse_other
from wavesym.sweeps.values import kept_arrays, sizes

NAME = "results.zarr"
DIMENSIONS = "_ARRAY_DIMENSIONS"
"""The attribute that xarray reads the names of an array's dimensions from."""
ATTRIBUTES = ".zattrs"
_CHUNK = re.compile(r"\.?\d+(\.\d+)*(\.part)?")


def require_packages(*libraries: str) -> None:
    """WavesymError where a library of the extra `sweep` is missing."""
    from importlib.util import find_spec

    if missing := [name for name in libraries if not find_spec(name)]:
        raise WavesymError(f"sweep: {' and '.join(missing)} not installed: {install_command('sweep')}")


@dataclass(frozen=True)
class Store:
    """The chunks of a sweep in its folder: `arrays` have these lengths beside those of the sweep's dimensions."""

    folder: Path
    batches: Batches
    arrays: Mapping[str, tuple[int, ...]]

    @property
    def path(self) -> Path:
        return self.folder / NAME

    def chunk(self, name: str, batch: int) -> str:
        """The file of an array's chunk, in the store."""
        return f"{name}/{'.'.join(map(str, (*self.batches.place(batch), *(0 for _ in self.arrays[name]))))}"

    def _shape(self, name: str) -> tuple[int, ...]:
        return (*self.batches.chunk, *self.arrays[name])

    def chunks(self, batch: int, arrays: Mapping[str, Array]) -> dict[str, bytes | None]:
        """The chunks of a batch, of arrays over its cases; None where all is NaN, as no file is read."""
        counts = [part.stop - part.start for part in self.batches.region(batch)]
        made: dict[str, bytes | None] = {}
        for name, values in arrays.items():
            whole = np.full(self._shape(name), np.nan, "<f8")
            whole[tuple(map(slice, counts))] = values.reshape(*counts, *self.arrays[name])
            made[name] = None if np.isnan(values).all() else whole.tobytes()
        return made

    def write(self, batch: int, chunks: Mapping[str, bytes | None]) -> None:
        """Put chunks of a batch in their places, one after the other."""
        for name, data in chunks.items():
            place = self.path / self.chunk(name, batch)
            if data is None:
                place.unlink(missing_ok=True)
                continue
            draft = place.with_name(f".{place.name}.part")
            draft.write_bytes(data)
            os.replace(draft, place)

    def damaged_chunks(self, batch: int, mark: BatchMark) -> list[str]:
        """The chunks of a batch that are not what its mark says."""
        return [
            self.chunk(name, batch)
            for name, found in self.hashes(batch).items()
            if found not in mark.allowed_hashes(name)
        ]

    def hashes(self, batch: int) -> dict[str, str | None]:
        """Of the chunks of a batch as they are; None where there is none, "" of a file that is no chunk of an array."""
        return {
            name: file_hash(self.path / self.chunk(name, batch), 8 * prod(self._shape(name))) for name in self.arrays
        }

    def read(self, name: str, batch: int) -> Array:
        """The values of a batch in an array, (dimensions, rest); NaN where there is no chunk."""
        shape = self._shape(name)
        try:
            data = (self.path / self.chunk(name, batch)).read_bytes()
            whole = np.frombuffer(data, "<f8").reshape(shape)
        except FileNotFoundError:
            whole = np.full(shape, np.nan)
        except ValueError:
            raise DamagedError(f"{self.path / self.chunk(name, batch)}: damaged") from None
        return whole[tuple(slice(part.stop - part.start) for part in self.batches.region(batch))]


def file_hash(path: Path, size: int | None = None) -> str | None:
    """Of a file; None where there is none, "" where a file is in the place of its folder, or one has another size than
    it should: it is not read then, however large it is. NoFileError as there."""
    try:
        refuse_other(path)
        if size is not None and path.stat().st_size != size:
            return ""
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except FileNotFoundError:
        return None
    except NotADirectoryError:
        return ""


def folder_content(path: Path) -> set[str]:
    """What is in a folder, folders in it too. DamagedError for links, and what else could lead to elsewhere."""
    found = [path, *(Path(parent, each) for parent, folders, files in os.walk(path) for each in (*folders, *files))]
    for each in list(found):
        try:
            mode = each.lstat().st_mode
        except FileNotFoundError:  # a draft that has come to its place since
            found.remove(each)
            continue
        if not S_ISREG(mode) and not S_ISDIR(mode):
            raise DamagedError(f"{each}: neither a file nor a folder; a sweep's folder holds nothing else: delete it")
    return {each.relative_to(path).as_posix() for each in found[1:]}


def lay_out(folder: Path, plan: SweepPlan, batches: Batches) -> dict[str, str]:
    """Make all of a store but its chunks; what is there already and as it should be stays. The hash of each file.

    WavesymError where there is anything that does not belong to it: nothing that others have made is ever opened.
    """
    path, draft = folder / NAME, folder / f".{NAME}.part"
    if draft.is_symlink():
        draft.unlink()
    shutil.rmtree(draft, ignore_errors=True)
    _make(draft, plan, batches)
    files = {each: file_hash(draft / each) or "" for each in sorted(folder_content(draft)) if (draft / each).is_file()}
    if not path.exists() and not path.is_symlink():
        os.replace(draft, path)
        return files
    names = {Path(each).parent.as_posix() for each in files}
    for each in sorted(folder_content(path)):
        parent, _, name = each.rpartition("/")
        if each not in files and each not in names and not (parent in names and parent and _CHUNK.fullmatch(name)):
            raise WavesymError(f"{path / each}: not of this sweep; move it elsewhere")
    for each, known in files.items():
        if file_hash(path / each, (draft / each).stat().st_size) != known:
            (path / each).parent.mkdir(exist_ok=True)
            os.replace(draft / each, path / each)
    shutil.rmtree(draft)
    return files


def _make(path: Path, plan: SweepPlan, batches: Batches) -> None:
    """All arrays without what is computed, and coordinates."""
    import zarr

    attributes = {"name": plan.name, "sweep_sha256": plan.sha256, "scene": json.dumps(plan.first_scene)}
    group = zarr.create_group(path, zarr_format=2, attributes=attributes)
    for dimension in plan.dimensions:
        _coordinates(group, dimension)
    _plain(group, OUTPUT, OUTPUT, np.array(plan.outputs))
    _plain(group, "unit", OUTPUT, np.array([unit or "1" for unit in plan.units]))
    if plan.links:
        _plain(group, LINK, LINK, np.array(plan.links))
    if plan.histories:
        share = np.arange(plan.histories) / (plan.histories - 1)
        _plain(group, SAMPLE, SAMPLE, share, long_name="part of the horizon that has passed", units="1")
    names, lengths = [dimension.name for dimension in plan.dimensions], sizes(plan)
    for each in kept_arrays(plan):
        rest = tuple(lengths[name] for name in each.dimensions)
        group.create_array(
            each.name,
            shape=(*plan.shape, *rest),
            chunks=(*batches.chunk, *rest),
            dtype="float64",
            fill_value=np.nan,
            compressors=None,
            attributes={
                DIMENSIONS: [*names, *each.dimensions],
                "long_name": each.what,
                **({"units": each.unit} if each.unit else {}),
            },
        )


def _coordinates(group: Any, dimension: SweepAxis) -> None:
    """What is varied along a dimension: its own coordinate, or of columns that are zipped one of each."""
    if dimension.name == CASE:
        _plain(group, CASE, CASE, np.arange(len(dimension)))
    for number, column in enumerate(dimension.columns):
        units = {"units": column.unit} if column.unit else {}
        name = column.path if dimension.name == CASE else dimension.name
        _plain(
            group,
            name,
            dimension.name,
            np.array(column.coordinate),
            path=column.path,
            number=number,
            written=column.labels,
            **units,
        )


def _plain(group: Any, name: str, dimension: str, values: Any, **attributes: object) -> None:
    metadata = {DIMENSIONS: [dimension], **attributes}
    # without a value that stands for none: xarray would take a 0 for it
    group.create_array(name, data=values, chunks=values.shape, compressors=None, fill_value=None, attributes=metadata)


def open_dataset(folder: str | PathLike[str]) -> Any:
    """The results of a sweep that was just computed as an xarray.Dataset: labelled arrays, read when they are needed.

    The statistics, `bound` and what else was kept, over the varied paths, `record` and `output`; NaN where a case is
    not done, or failed. WavesymError where xarray is missing.
    """
    require_packages("xarray")
    import xarray

    found = xarray.open_zarr(Path(folder, NAME), zarr_format=2, consolidated=False, chunks=None)
    return found.set_coords([name for name in found.data_vars if "path" in found[name].attrs or name == "unit"])
