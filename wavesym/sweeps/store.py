"""The arrays of a sweep, in a zarr store that xarray reads: made whole at the start, NaN, and filled chunk by chunk.

One process writes. A chunk is whole on the disk before the mark that says so, which has its hash.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from wavesym.errors import WavesymError
from wavesym.sweeps.batches import Batches
from wavesym.sweeps.dimension import SweepAxis
from wavesym.sweeps.plan import CASE, OUTPUT, SAMPLE, SweepPlan
from wavesym.sweeps.values import BatchValues, kept_arrays, sizes

NAME = "results.zarr"
DIMENSIONS = "_ARRAY_DIMENSIONS"
"""The attribute that xarray reads the names of an array's dimensions from."""


def needed(*libraries: str) -> None:
    """WavesymError where a library of the extra `sweep` is missing."""
    from importlib.util import find_spec

    if missing := [name for name in libraries if not find_spec(name)]:
        told = " and ".join(missing)
        raise WavesymError(f"sweep: {told} not installed, the extra `sweep` expected (pip install 'wavesym[sweep]')")


@dataclass(frozen=True)
class Store:
    """The arrays of the sweep in a folder."""

    folder: Path
    plan: SweepPlan
    batches: Batches

    @property
    def path(self) -> Path:
        return self.folder / NAME

    @cached_property
    def _group(self) -> Any:
        return _group(self.path, "r+", [each.name for each in kept_arrays(self.plan)])

    @property
    def sha256(self) -> str:
        """Of the sweep whose arrays there are."""
        return str(self._group.attrs.get("sweep_sha256", ""))

    def make(self) -> None:
        """All arrays, with their coordinates. What was begun and is not whole is made again."""
        import zarr

        draft = self.folder / f".{NAME}.part"
        shutil.rmtree(draft, ignore_errors=True)
        group = zarr.create_group(draft, zarr_format=2, attributes=self._attributes)
        for dimension in self.plan.dimensions:
            _coordinates(group, dimension)
        _plain(group, OUTPUT, OUTPUT, np.array(self.plan.outputs))
        _plain(group, "unit", OUTPUT, np.array([unit or "1" for unit in self.plan.units]))
        if self.plan.histories:
            share = np.arange(self.plan.histories) / (self.plan.histories - 1)
            _plain(group, SAMPLE, SAMPLE, share, long_name="part of the horizon that has passed", units="1")
        names, lengths = [dimension.name for dimension in self.plan.dimensions], sizes(self.plan)
        for each in kept_arrays(self.plan):
            rest = tuple(lengths[name] for name in each.dimensions)
            group.create_array(
                each.name,
                shape=(*self.plan.shape, *rest),
                chunks=(*self.batches.chunk, *rest),
                dtype="float64",
                fill_value=np.nan,
                attributes={DIMENSIONS: [*names, *each.dimensions], "long_name": each.what},
            )
        os.replace(draft, self.path)

    @property
    def _attributes(self) -> dict[str, str]:
        return {"name": self.plan.name, "sweep_sha256": self.plan.sha256, "scene": json.dumps(self.plan.said_scene)}

    def write(self, batch: int, values: BatchValues) -> dict[str, str]:
        """Put a batch into its chunks; the hash of each of them. OSError where that cannot be."""
        region = self.batches.region(batch)
        for name, array in values.arrays.items():
            self._group[name][region] = array
        return self.hashes(batch)

    def hashes(self, batch: int) -> dict[str, str]:
        """The hash of each chunk of a batch, "" of one that is not there: nothing but NaN."""
        at = self.batches.at(batch)
        made = {}
        for each in kept_arrays(self.plan):
            chunk = self.path / each.name / ".".join(map(str, (*at, *(0 for _ in each.dimensions))))
            made[each.name] = hashlib.sha256(chunk.read_bytes()).hexdigest() if chunk.exists() else ""
        return made


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
            written=column.told,
            **units,
        )


def _plain(group: Any, name: str, dimension: str, values: Any, **attributes: object) -> None:
    group.create_array(name, data=values, attributes={DIMENSIONS: [dimension], **attributes})


def arrays(folder: str | PathLike[str]) -> Any:
    """The arrays of the sweep in a folder as a zarr group, to read. WavesymError where there is none."""
    needed("zarr")
    if not Path(folder, NAME).is_dir():
        raise WavesymError(f"{folder}: no {NAME} in it, the folder of a sweep expected")
    return _group(Path(folder, NAME), "r", ["bound", OUTPUT])


def _group(path: Path, mode: str, names: list[str]) -> Any:
    """A group of arrays, some of which must be there. WavesymError where what is said of them is damaged."""
    import zarr

    try:
        group = zarr.open_group(path, mode=mode)
        missing = set(names) - {name for name, _ in group.arrays()}
    except Exception as error:  # whatever comes of files that are not what they were
        raise WavesymError(f"{path}: damaged ({type(error).__name__}), a sweep in a new folder expected") from None
    if missing:
        raise WavesymError(f"{path}: no {min(missing)} in it, a sweep in a new folder expected")
    return group


def opened(folder: str | PathLike[str]) -> Any:
    """The results of a sweep as an xarray.Dataset: labelled arrays, read when they are asked for.

    The statistics, `bound` and what else was kept, over the varied paths, `record` and `output`; NaN where a case is
    not done, or failed. WavesymError where xarray is missing, or the folder is none of a sweep.
    """
    needed("xarray")
    import xarray

    found = xarray.open_zarr(arrays(folder).store, consolidated=False, chunks=None)
    return found.set_coords([name for name in found.data_vars if "path" in found[name].attrs or name == "unit"])
