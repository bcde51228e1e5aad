"""What the folder of a sweep holds, to be shown: its dimensions, the values of each output, the scene of any case.

All of it is compared with its hash before anything is shown. It is data: neither zarr nor any codec sees it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field, ValidationError

from wavesym.errors import WavesymError, printable
from wavesym.numbers.arrays import Array
from wavesym.results.statistics import LINK_ARRAYS
from wavesym.scene.paths import replace_at_path
from wavesym.sweeps.manifest import Manifest
from wavesym.sweeps.marks import BatchMark, Marks
from wavesym.sweeps.sealed_files import DamagedError, StrictTable
from wavesym.sweeps.status import SweepStatus, damage, marks_of, status_of
from wavesym.sweeps.store import ATTRIBUTES, NAME, Store, file_hash, folder_content

_DTYPE = re.compile("<f8|<U[1-9][0-9]{0,4}")


@dataclass(frozen=True)
class StoredColumn:
    """A field that was varied: its path, its exact values as they are written, and what people read of them."""

    path: str
    texts: tuple[str, ...]
    coordinate: tuple[float | str, ...]
    unit: str

    @property
    def numbers(self) -> bool:
        """Whether all values are numbers, of one unit or none."""
        return not isinstance(self.coordinate[0], str)

    def format(self, k: int) -> str:
        """A value, short, in one line without what a terminal or a browser would do."""
        value = self.coordinate[k]
        return printable(value) if isinstance(value, str) else f"{value:.6g} {self.unit}".rstrip()


@dataclass(frozen=True)
class StoredAxis:
    """A dimension: one column, or those that were zipped."""

    name: str
    columns: tuple[StoredColumn, ...]

    def __len__(self) -> int:
        return len(self.columns[0].texts)


@dataclass(frozen=True)
class SweepResults:
    """The results in a folder: what sweep it is of, marks of its batches by number, and arrays where it has any."""

    manifest: Manifest
    marks: Mapping[int, BatchMark]
    dimensions: tuple[StoredAxis, ...]
    store: Store

    @property
    def status(self) -> SweepStatus:
        """How far it is."""
        return status_of(self.manifest, self.marks)

    @property
    def name(self) -> str:
        """Of its scene."""
        return self.manifest.name

    @property
    def outputs(self) -> dict[str, str]:
        """Their units, by name."""
        return self.manifest.outputs

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(map(len, self.dimensions))

    @property
    def statistics(self) -> tuple[str, ...]:
        """The statistics of outputs that there are."""
        return tuple(name for name in self.manifest.keep.summary if name not in LINK_ARRAYS)

    @property
    def link_statistics(self) -> tuple[str, ...]:
        """Those of links."""
        return tuple(name for name in self.manifest.keep.summary if name in LINK_ARRAYS)

    @property
    def time_unit(self) -> str:
        """The unit of time of results; empty for scenes without units."""
        units = self.manifest.scene.get("units")
        return "" if units is None else str(units.get("time", "s"))

    @property
    def bound(self) -> float:
        """The largest of any case, of errors of values; NaN where no case is done."""
        return float(np.fmax.reduce(self.array("bound"), axis=None))

    def values(self, statistic: str, output: int) -> Array:
        """A statistic of an output over all dimensions, NaN where there is none."""
        return self.array(statistic, output=output)

    def array(self, name: str, part: tuple[slice, ...] | None = None, output: int | None = None) -> Array:
        """An array over a part of the dimensions, or all, of one output or all; NaN where nothing is marked."""
        part = part or tuple(slice(0, n) for n in self.shape)
        beside = self.store.arrays[name] if output is None else ()
        made = np.full((*(each.stop - each.start for each in part), *beside), np.nan)
        for batch in self.store.batches.touching(part):
            if batch in self.marks:
                region = self.store.batches.region(batch)
                here = [slice(max(a.start, b.start), min(a.stop, b.stop)) for a, b in zip(part, region, strict=True)]
                values = self.store.read(name, batch)[_relative_slices(here, region)]
                made[_relative_slices(here, part)] = values if output is None else values[..., output]
        return made

    def place(self, case: int) -> tuple[int, ...]:
        """The index of a case in each dimension."""
        return tuple(int(k) for k in np.unravel_index(case, self.shape))

    def labels_at(self, case: int) -> dict[str, str]:
        """The values that make a case, short, by path."""
        chosen = zip(self.dimensions, self.place(case), strict=True)
        return {column.path: column.format(k) for dimension, k in chosen for column in dimension.columns}

    def scene(self, case: int) -> dict[str, Any]:
        """The fields of a case's scene, all values exact; records by their names, which count from the sweep's file."""
        fields: dict[str, Any] = self.manifest.scene
        for dimension, k in zip(self.dimensions, self.place(case), strict=True):
            for column in dimension.columns:
                fields = replace_at_path(fields, column.path, _value(column.texts[k]))
        return fields


def _value(written: str) -> object:
    """A value as a scene takes it: what is no number, list or table is text."""
    with suppress(ValueError):
        return json.loads(written)
    return written


def _relative_slices(part: Sequence[slice], whole: Sequence[slice]) -> tuple[slice, ...]:
    """A part as it counts from where the whole begins."""
    return tuple(slice(a.start - b.start, a.stop - b.start) for a, b in zip(part, whole, strict=True))


class _CoordinateLabels(StrictTable):
    """What the store says of a coordinate."""

    dimensions: list[str] = Field(alias="_ARRAY_DIMENSIONS", min_length=1, max_length=1)
    path: str
    number: int
    written: list[str]
    units: str = ""


def results(folder: Path) -> SweepResults:
    """What there is in the folder of a sweep. WavesymError where it is none; DamagedError for what is not as it was."""
    manifest = Manifest.read_folder(folder)
    store, marks = manifest.store(folder), marks_of(folder, manifest)
    if not store.path.exists():
        raise WavesymError(f"{folder}: no {NAME} in it; write the folder of a sweep")
    there = folder_content(store.path)
    damaged = [
        each for each, known in manifest.files.items() if each not in there or file_hash(store.path / each) != known
    ]
    again = {batch: wrong for batch in list(marks) if (wrong := _damaged_chunks(store, manifest, marks, batch))}
    if damaged or again:
        files = [f"{NAME}/{each}" for each in (*damaged, *chain.from_iterable(again.values()))]
        raise damage(folder, files, sum(map(store.batches.count, again)), manifest.cases)
    try:
        return SweepResults(manifest, marks, _dimensions(store, manifest), store)
    except (ValidationError, ValueError, LookupError, TypeError, RecursionError) as error:
        # nothing of this comes from damage: it is none of a sweep, though its hashes are right
        raise DamagedError(f"{store.path}: coordinates that are none ({type(error).__name__})") from None


def _damaged_chunks(store: Store, manifest: Manifest, marks: dict[int, BatchMark], batch: int) -> list[str]:
    """The chunks of a batch that are not what its mark says, which a sweep that goes on may put anew meanwhile."""
    while wrong := store.damaged_chunks(batch, marks[batch]):
        now = Marks(store.folder).get(store.batches.mark(manifest.sha256, batch), store.batches, batch)
        if now == marks[batch]:
            return wrong
        if now is None:
            del marks[batch]
            return []
        marks[batch] = now
    return []


def _dimensions(store: Store, manifest: Manifest) -> tuple[StoredAxis, ...]:
    """Dimensions and their columns, as the store says them."""
    own: dict[str, list[tuple[int, StoredColumn]]] = {name: [] for name in manifest.dimensions}
    for each in manifest.files:
        name, _, last = each.rpartition("/")
        if last == ATTRIBUTES and "path" in (fields := json.loads((store.path / each).read_bytes())):
            labels = _CoordinateLabels.model_validate(fields)
            column = StoredColumn(labels.path, tuple(labels.written), _coordinate(store.path / name), labels.units)
            own[labels.dimensions[0]].append((labels.number, column))
    made = tuple(StoredAxis(name, _in_order(columns)) for name, columns in own.items())
    for axis, n in zip(made, manifest.dimensions.values(), strict=True):
        if {len(each) for column in axis.columns for each in (column.texts, column.coordinate)} != {n}:
            raise ValueError("not as many values as cases")
    return made


def _coordinate(path: Path) -> tuple[float | str, ...]:
    """The values of a coordinate: one chunk, of doubles or of texts."""
    dtype = json.loads((path / ".zarray").read_bytes())["dtype"]
    if not _DTYPE.fullmatch(dtype):
        raise ValueError("neither doubles nor texts")
    values: list[float | str] = np.frombuffer((path / "0").read_bytes(), dtype).tolist()
    "".join(value for value in values if isinstance(value, str)).encode()  # half a character is none
    return tuple(values)


def _in_order(columns: list[tuple[int, StoredColumn]]) -> tuple[StoredColumn, ...]:
    return tuple(column for _, column in sorted(columns, key=lambda each: each[0]))
