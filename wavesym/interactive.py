"""A Scene as people use it in Python: it runs, sums up, draws and shows itself."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any

from wavesym import api, scene

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from wavesym.results.frequency_response import FrequencyResponse
    from wavesym.results.modes import Modes
    from wavesym.results.result import Result
    from wavesym.results.summary import Summary


class Scene(scene.Scene):
    __doc__ = scene.Scene.__doc__

    def run(self, times: ArrayLike | None = None, samples: int = 1001, *, strict: bool = False) -> Result:
        """The histories of the outputs; arguments, value and errors are those of `wavesym.run`."""
        return api.run(self, times, samples, strict=strict)

    def summary(self, *, at_samples: bool = False) -> Summary:
        """The extremes of the outputs; arguments, value and errors are those of `wavesym.summary`."""
        return api.summary(self, at_samples=at_samples)

    def modes(self, count: int = 10, below: float | None = None) -> Modes:
        """The frequencies of the chain; arguments, value and errors are those of `wavesym.modes`."""
        return api.modes(self, count, below)

    def frf(self, frequencies: ArrayLike | None = None, load: str | int | None = None) -> FrequencyResponse:
        """The outputs under one unit of a harmonic load; arguments, value and errors are those of `wavesym.frf`."""
        return api.frf(self, frequencies, load)

    def formula(self, output: str, until: float | None = None, format: str = "text", *, symbolic: bool = False) -> str:
        """An output in closed form; arguments, value and errors are those of `wavesym.formula`."""
        return api.formula(self, output, until, format, symbolic=symbolic)

    def plot(self, path: str | PathLike[str] | None = None, kind: str = "history") -> Any:
        """A matplotlib Figure of the scene; arguments and errors are those of `wavesym.plot`."""
        return api.plot(self, path, kind)

    def report(self, path: str | PathLike[str]) -> None:
        """Write the scene as one page of HTML; arguments and errors are those of `wavesym.report`."""
        api.report(self, path)

    def _repr_html_(self) -> str:
        """The structure, drawn, under a line that says what it is."""
        return api.scene_html(self)
