"""The histories of a scene's outputs as an object that shows itself, in the units of the scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesym.errors import WavesymError
from wavesym.mechanics.event import ContactEvent
from wavesym.mechanics.probe import with_unit
from wavesym.results.horizon import check_horizon
from wavesym.results.optional import require_packages
from wavesym.results.presentation import OutputRows, html_table
from wavesym.results.response import Response
from wavesym.results.rows import instants
from wavesym.results.summary import Summary, summarise
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import drifts

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


_SHOWN = 5  # rows of a long table at its start and its end


@dataclass(frozen=True, repr=False, eq=False)
class Result(OutputRows):
    """The outputs of a scene at some instants; `scene.run` and `wavesym.run` make it.

    Attributes:
        scene: what was computed.
        outputs: the names, in the order of the scene.
        units: that of each output; empty without [units].
        time: the instants, (n,), in `time_unit`, or tau where that is None.
        time_unit: the unit of time, None for a scene without [units].
        values: (outputs, n); NaN outside the horizon.
        bound: what a value is wrong by at most, relative to its output's largest value on the horizon.
        program: the kind of the program that values are of; None where they are right to the last bit.
        proved: whether the bound is.

    `result[NAME]` is one output, (n,).

    >>> import wavesym
    >>> result = wavesym.Scene.from_toml("drive_m1").run(times=[2.0, 4.0])
    >>> result["strain@0"]
    array([-1.34196715, -1.0316365 ])
    """

    scene: Scene
    outputs: tuple[str, ...]
    units: tuple[str, ...]
    time: NDArray[np.float64]
    time_unit: str | None
    values: NDArray[np.float64]
    bound: float
    program: str | None
    proved: bool
    _response: Response = field(repr=False, compare=False)
    _plot: Callable[[Scene, str | PathLike[str] | None], Any] = field(repr=False, compare=False)

    @property
    def name(self) -> str:  # type: ignore[override]
        """That of the scene."""
        return self.scene.name

    @property
    def events(self) -> tuple[ContactEvent, ...]:
        """When contacts open and close, in order: `x`, `kind`, `tau` as a ball, `double`, `digits`."""
        return self._response.events

    @property
    def notes(self) -> tuple[str, ...]:
        """How the scene was read, where that may surprise: a line for each, as `wavesym run` says them."""
        return self._response.model.labels.notes

    @property
    def columns(self) -> tuple[str, ...]:
        """The outputs with their units, as in the header of `wavesym run`."""
        pairs = zip(self.outputs, self.units, strict=True)
        return tuple(with_unit(name, unit) for name, unit in pairs)

    @property
    def time_label(self) -> str:
        """What time is called, with its unit."""
        return "tau" if self.time_unit is None else f"time [{self.time_unit}]"

    def summary(self) -> Summary:
        """The extremes of the outputs on the whole horizon; errors as of `wavesym.summary`."""
        return summarise(self._response.model, drifts=drifts(self.scene))

    def plot(self, path: str | PathLike[str] | None = None) -> Any:
        """The histories of the scene as a picture.

        Args:
            path: a file, .svg, .png or .pdf, that it is written to as well.

        Returns:
            A matplotlib Figure, which a notebook shows.

        Raises:
            WavesymError: where matplotlib is not installed.
            SceneError: for another suffix.
        """
        return self._plot(self.scene, path)

    def to_pandas(self) -> Any:
        """A pandas.DataFrame: a column for each output, by name, over the time. WavesymError without pandas."""
        pandas = require_packages("pandas", "sweep")
        index = pandas.Index(self.time, name=self.time_label)
        return pandas.DataFrame(dict(zip(self.columns, self.values, strict=True)), index=index)

    def to_xarray(self) -> Any:
        """An xarray.DataArray of dimensions (output, time), with units as attributes. WavesymError without xarray."""
        xarray = require_packages("xarray", "arrays")
        unit = {} if self.time_unit is None else {"units": self.time_unit}
        coordinates = {
            "output": list(self.outputs),
            "time": ("time", self.time, unit),
            "unit": ("output", list(self.units)),
        }
        about = {"bound": self.bound, "proved": int(self.proved), "scene_sha256": self._response.model.labels.sha256}
        return xarray.DataArray(self.values, coordinates, ("output", "time"), self.scene.name, about)

    def __repr__(self) -> str:
        count, unit = len(self.outputs), self.time_unit
        size = f"{count} output{'s' * (count != 1)} at {self.time.size} {'instants' if unit else 'tau'}"
        if self.time.size:
            size += f" from {self.time[0]:g} to {self.time[-1]:g}" + (f" {unit}" if unit else "")
        return f"Result({self.scene.name!r}, {size}, {self.accuracy})"

    @property
    def accuracy(self) -> str:
        """How right values are, in a few words."""
        lines = self._response.acting_model.labels.left_out_text
        if self.program is None:
            return f"right to the last bit{lines}"
        return f"{self.program}, {'proved bound' if self.proved else 'estimated error'} {self.bound:.2g}{lines}"

    def _repr_html_(self) -> str:
        """A table of the outputs, of long ones the start and the end."""
        rows = range(self.time.size)
        kept = list(rows) if len(rows) <= 2 * _SHOWN + 1 else [*rows[:_SHOWN], -1, *rows[-_SHOWN:]]
        return html_table(
            ". ".join([repr(self), *self.notes]), (self.time_label, *self.columns), map(self._cells, kept)
        )

    def _cells(self, k: int) -> list[str]:
        if k < 0:
            return ["\u22ee"] * (1 + len(self.outputs))
        return [f"{value:.6g}" for value in (self.time[k], *self.values[:, k])]


def result(
    scene: Scene,
    times: ArrayLike | None,
    samples: int,
    *,
    strict: bool,
    plot: Callable[[Scene, str | PathLike[str] | None], Any],
) -> Result:
    """The histories of a scene; arguments and errors are those of `wavesym.run`.

    Args:
        scene: what is computed.
        times, samples, strict: as of `wavesym.run`.
        plot: draws a scene, and writes it where there is a path.
    """
    model = lower(scene)
    at = None if times is None else _instants(times)
    if at is None and samples < 1:
        raise WavesymError(f"samples: {samples} is not positive; write 1001, or give times")
    pairs = np.array(list(instants(model, samples, at)), dtype=np.float64).reshape(-1, 2)
    time, tau = pairs[:, 0], pairs[:, 1]
    response = Response(model)
    check_horizon(tau, model.horizon(), strict=strict, clock=model.clock)
    values = np.asarray(response.values(tau))
    program = response.program
    return Result(
        scene=scene,
        outputs=response.outputs,
        units=response.units,
        time=time,
        time_unit=model.clock.unit if model.clock else None,
        values=values,
        bound=response.error_bound,
        program=program.evaluator if program else None,
        proved=program.proved if program else True,
        _response=response,
        _plot=plot,
    )


def _instants(times: ArrayLike) -> list[float]:
    try:
        found = np.asarray(times, dtype=np.float64)
    except (TypeError, ValueError):
        found = np.empty((0, 0))
    if found.ndim > 1 or np.iscomplexobj(times):
        raise WavesymError("times: not a list of numbers; write [0, 0.5, 1]")
    return [float(each) for each in found.ravel()]
