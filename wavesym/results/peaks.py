"""Statistics of several scenes as arrays that say what is what."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesym.results.optional import require_packages
from wavesym.results.statistics import ARRAYS, array_values
from wavesym.results.summary import Summary
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

    `peaks["max"]` is an array; its names are those that it goes through: `min`, `tau_min`, `max`, `tau_max`, `arrival`,
    `mean`, `rms`, `residual`. What a scene does not have is NaN.
    """

    cases: tuple[str, ...]
    outputs: tuple[str, ...]
    several: bool
    _arrays: Mapping[str, NDArray[np.float64]]

    def __getitem__(self, name: str) -> NDArray[np.float64]:
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


def peaks_of(scenes: Sequence[Scene], summaries: Sequence[Summary], *, several: bool) -> Peaks:
    """The statistics of scenes, from the summary of each."""
    outputs = tuple(dict.fromkeys(output.name for summary in summaries for output in summary.outputs))
    place = {name: k for k, name in enumerate(outputs)}
    arrays = {name: np.full((len(summaries), len(outputs)), np.nan) for name in ARRAYS}
    for row, summary in enumerate(summaries):
        for output in summary.outputs:
            for name, number in array_values(output).items():
                arrays[name][row, place[output.name]] = number
    if not several:
        arrays = {name: values[0] for name, values in arrays.items()}
    return Peaks(case_names(scenes), outputs, several, arrays)


def case_names(scenes: Sequence[Scene]) -> tuple[str, ...]:
    """Scenes by the few fields in which they differ; by their names where these differ, or where many fields do."""
    names = [scene.name for scene in scenes]
    fields = [leaves(scene.model_dump()) for scene in scenes]
    paths = dict.fromkeys(path for each in fields for path in each)
    varied = [path for path in paths if len({repr(each.get(path)) for each in fields}) > 1]
    if len(set(names)) > 1 or not 0 < len(varied) <= _MOST_VARIED:
        return tuple(names)
    return tuple(", ".join(f"{path} = {each.get(path, 'none')}" for path in varied) for each in fields)
