"""Values of many sets of parameters as an array that says what is what."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from wavesym.numbers.arrays import Array
from wavesym.results.optional import require_packages
from wavesym.results.statistics import ARRAYS

SETS = "set"
_TIMES = {"min": "time of the least value", "max": "time of the greatest value"}


@dataclass(frozen=True)
class SetLabels:
    """What the rows of an array of values are.

    Attributes:
        parameters: the numbers of each field that were given, (sets, numbers) or (numbers,), by name.
        names, units: of each field what its numbers are called, and their units.
        outputs, output_units: the names of the outputs and their units.
        titles: the names of the outputs for people.
        time_unit: that of times, None for a scene without units.
        time_per_tau: how many of it one tau is, 1 without.
    """

    parameters: Mapping[str, Array]
    names: Mapping[str, tuple[str, ...]]
    units: Mapping[str, tuple[str, ...]]
    outputs: tuple[str, ...]
    output_units: tuple[str, ...]
    titles: tuple[str, ...]
    time_unit: str | None
    time_per_tau: float

    def label_values(self, values: Array, tau: Array, times: Array) -> Any:
        """Values as an xarray.DataArray.

        Args:
            values: (sets, outputs, *tau.shape).
            tau: the instants, dimensionless, of any shape.
            times: the same in the unit of results, or tau where there is none.

        Returns:
            An array of dimensions (set, output, time), or where exactly one number varies that number in place of
            `set`; every number that varies is a coordinate, `kappa[0]` or, alone in its field, `inertia`. Values as
            they are where xarray is not installed.
        """
        if not find_spec("xarray"):
            return values
        xarray = require_packages("xarray", "arrays")

        along, sets = self._sets()
        axes = ("time",) if tau.ndim == 1 else tuple(f"time_{k}" for k in range(tau.ndim))
        unit = {} if self.time_unit is None else {"units": self.time_unit}
        coordinates: dict[str, Any] = {
            **self._outputs(),
            "time": (axes, times, unit),
            "tau": (axes, tau),
            **sets,
        }
        return xarray.DataArray(values, coordinates, (along, "output", *axes))

    def label_extremes(self, arrays: Mapping[str, Array]) -> Any:
        """Arrays of shape (sets, outputs), by name, as an xarray.Dataset with the coordinates of `label_values`.

        Raises:
            WavesymError: without xarray.
        """
        along, sets = self._sets()
        fields = {name: ((along, "output"), values, {"long_name": ARRAYS[name]}) for name, values in arrays.items()}
        if self.time_unit is not None:
            for name, about in _TIMES.items():
                times = arrays[f"tau_{name}"] * self.time_per_tau
                fields[f"time_{name}"] = (along, "output"), times, {"long_name": about, "units": self.time_unit}
        return require_packages("xarray", "arrays").Dataset(fields, {**self._outputs(), **sets})

    def _outputs(self) -> dict[str, Any]:
        names = {"unit": self.output_units, "title": self.titles}
        return {"output": list(self.outputs)} | {name: ("output", list(texts)) for name, texts in names.items()}

    def _sets(self) -> tuple[str, dict[str, Any]]:
        """The dimension of sets, and the numbers that vary along it."""
        varied = {name: column for name, column in self._columns() if len(np.unique(column)) > 1}
        along = next(iter(varied)) if len(varied) == 1 else SETS
        return along, {name: (along, column, self._attributes(name)) for name, column in varied.items()}

    def _columns(self) -> list[tuple[str, Array]]:
        return [
            (name if field.shape[1] == 1 else f"{name}[{k}]", field[:, k])
            for name, field in self.parameters.items()
            if field.ndim == 2
            for k in range(field.shape[1])
        ]

    def _attributes(self, column: str) -> dict[str, str]:
        name, _, number = column.partition("[")
        k = int(number[:-1]) if number else 0
        about = {"long_name": self.names[name][k], "units": self.units[name][k]}
        return {key: text for key, text in about.items() if text}
