"""What the folder of a sweep holds, to be shown: its dimensions, the values of each output, the scene of any case."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import WavesymError
from wavesym.scene.paths import changed
from wavesym.sweeps.manifest import read
from wavesym.sweeps.status import SweepStatus, status
from wavesym.sweeps.store import DIMENSIONS, arrays

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class StoredColumn:
    """A field that was varied: its path, its exact values as they are written, and what people read of them."""

    path: str
    written: tuple[str, ...]
    coordinate: tuple[float | str, ...]
    unit: str

    @property
    def numbers(self) -> bool:
        """Whether all values are numbers, of one unit or none."""
        return not isinstance(self.coordinate[0], str)

    def told(self, k: int) -> str:
        """A value, short."""
        value = self.coordinate[k]
        return value if isinstance(value, str) else f"{value:.6g} {self.unit}".rstrip()


@dataclass(frozen=True)
class StoredAxis:
    """A dimension: one column, or those that were zipped."""

    name: str
    columns: tuple[StoredColumn, ...]

    def __len__(self) -> int:
        return len(self.columns[0].written)


@dataclass(frozen=True)
class SweepResults:
    """The results in a folder; `outputs` have their units, `manifest` and `status` are those of the sweep."""

    manifest: dict[str, Any]
    status: SweepStatus
    dimensions: tuple[StoredAxis, ...]
    outputs: dict[str, str]
    _arrays: Any

    @property
    def name(self) -> str:
        """Of its scene."""
        return str(self.manifest["name"])

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(map(len, self.dimensions))

    @property
    def kept(self) -> tuple[str, ...]:
        """The statistics of outputs that there are."""
        return tuple(self.manifest["keep"]["summary"])

    @property
    def bound(self) -> float:
        """The largest of any case, of errors of values; NaN where no case is done."""
        return float(np.fmax.reduce(self._arrays["bound"][:], axis=None))

    def values(self, statistic: str, output: int) -> Numbers:
        """A statistic of an output over all dimensions, NaN where there is none."""
        return np.asarray(self._arrays[statistic][..., output], dtype=np.float64)

    def place(self, case: int) -> tuple[int, ...]:
        """The index of a case in each dimension."""
        return tuple(int(k) for k in np.unravel_index(case, self.shape))

    def told(self, case: int) -> dict[str, str]:
        """The values that make a case, short, by path."""
        chosen = zip(self.dimensions, self.place(case), strict=True)
        return {column.path: column.told(k) for dimension, k in chosen for column in dimension.columns}

    def scene(self, case: int) -> dict[str, Any]:
        """The fields of a case's scene, all values exact; records by their names, which count from the sweep's file."""
        fields: dict[str, Any] = self.manifest["scene"]
        for dimension, k in zip(self.dimensions, self.place(case), strict=True):
            for column in dimension.columns:
                fields = changed(fields, column.path, _value(column.written[k]))
        return fields


def _value(written: str) -> object:
    """A value as a scene takes it: what is no number, list or table is text."""
    with suppress(ValueError):
        return json.loads(written)
    return written


def results(folder: Path) -> SweepResults:
    """What there is in the folder of a sweep. WavesymError where it is none."""
    manifest = read(folder)
    if manifest is None:
        raise WavesymError(f"{folder}: no manifest.json in it, the folder of a sweep expected")
    found = arrays(folder)
    own: dict[str, list[tuple[int, StoredColumn]]] = {name: [] for name in manifest["dimensions"]}
    for _, array in found.arrays():
        if "path" in (said := array.attrs):
            column = StoredColumn(said["path"], tuple(said["written"]), _plain(array[:]), said.get("units", ""))
            own[said[DIMENSIONS][0]].append((said["number"], column))
    dimensions = (StoredAxis(name, _in_order(columns)) for name, columns in own.items())
    return SweepResults(manifest, status(folder), tuple(dimensions), manifest["outputs"], found)


def _in_order(columns: list[tuple[int, StoredColumn]]) -> tuple[StoredColumn, ...]:
    return tuple(column for _, column in sorted(columns, key=lambda each: each[0]))


def _plain(coordinate: Any) -> tuple[float | str, ...]:
    values: Sequence[Any] = coordinate.tolist()
    return tuple(value if isinstance(value, str) else float(value) for value in values)
