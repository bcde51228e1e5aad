"""Statistics of several scenes as arrays that say what is what."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesym.results.optional import require_packages
from wavesym.results.statistics import ARRAYS
from wavesym.scene import Scene
from wavesym.scene.paths import leaves

_MOST_VARIED = 4  # fields in the name of a case


@dataclass(frozen=True, repr=False, eq=False)
class Peaks(Mapping[str, NDArray[np.float64]]):
    """The statistics of the outputs of some scenes; `wavesym.peaks` makes it.

    Attributes:
        cases: what each scene is called: by what varies, `system.kappa[0] = 1/2`, or by its name.
        outputs: the names of the outputs, each once.
        several: whether arrays have a dimension of cases, (cases, outputs); else they are (outputs,).
        bound: (cases,), the error of values, relative to each output's largest: as of sweeps.

    `peaks["max"]` is an array; its names are those that were kept. What a scene does not have is NaN.
    """

    cases: tuple[str, ...]
    outputs: tuple[str, ...]
    several: bool
    bound: NDArray[np.float64]
    _arrays: Mapping[str, NDArray[np.float64]]

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        if name not in self._arrays:
            raise KeyError(f'{name} was not kept; write keep = ["{name}", …]')
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __repr__(self) -> str:
        cases = f"{len(self.cases)} cases of " if self.several else ""
        return f"Peaks({cases}{len(self.outputs)} outputs: {', '.join(self)})"

    def to_xarray(self) -> Any:
        """An xarray.Dataset of dimensions (case, output), or (output) of one scene. WavesymError without xarray."""
        labels = {**({"case": list(self.cases)} if self.several else {}), "output": list(self.outputs)}
        arrays = {name: (tuple(labels), values, {"long_name": ARRAYS[name]}) for name, values in self.items()}
        return require_packages("xarray", "arrays").Dataset(arrays, labels)

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with a row for each case and output. WavesymError without pandas."""
        pandas = require_packages("pandas", "sweep")
        rows = pandas.Index(list(self.outputs), name="output")
        if self.several:
            rows = pandas.MultiIndex.from_product([list(self.cases), rows], names=["case", "output"])
        return pandas.DataFrame({name: values.ravel() for name, values in self.items()}, index=rows)


def case_names(scenes: Sequence[Scene]) -> tuple[str, ...]:
    """Scenes by the few fields in which they differ; by their names where these differ, or where many fields do."""
    names = [scene.name for scene in scenes]
    fields = [leaves(scene.model_dump()) for scene in scenes]
    varied = varied_paths(fields)
    if len(set(names)) > 1 or not 0 < len(varied) <= _MOST_VARIED:
        return tuple(names)
    return tuple(", ".join(f"{path} = {each.get(path, 'none')}" for path in varied) for each in fields)


def varied_paths(every: Sequence[Mapping[str, object]]) -> list[str]:
    """The paths at which some fields, by path, differ."""
    paths = dict.fromkeys(path for each in every for path in each)
    return [path for path in paths if len({repr(each.get(path)) for each in every}) > 1]
