"""Ways to values: histories, extremes, spectra, and the same for parameters that are given at run time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesym.documents.summary import summary_text as told
from wavesym.errors import WavesymError
from wavesym.fields.loads import SampledLoad
from wavesym.numbers.doubles import nearest, rational
from wavesym.records.load import RecordedLoad
from wavesym.results.peaks import table_of_peaks
from wavesym.results.response import Response
from wavesym.results.rows import SAMPLES, csv_lines, grid
from wavesym.results.summary import Summary, summarised
from wavesym.results.unexpected import event_lines, outside, unexpected
from wavesym.running.model import RuntimeModel
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import amplitudes, drifts

if TYPE_CHECKING:
    from wavesym.mechanics.model import Model


def evaluator(scene: Scene) -> Response:
    """The outputs of a scene as a function of tau, each value right to the last bit where that takes no minutes.

    Called with an array of tau it gives an array of shape (outputs, *tau.shape). It has `outputs`, their names,
    `tau_max`, the end of the horizon, `error_bound`, and the `events` of contacts that open and close (`x`, `kind`,
    `tau` as a ball, `double`, `digits`). Elsewhere values are those of a `program` (else None), with its bound.
    SceneError for what is no Scene; where it is called, CostError for what would take minutes with any program, and
    ToleranceError where none meets the tolerance.

    >>> import wavesym
    >>> response = wavesym.evaluator(wavesym.Scene.from_toml("drive_m1"))
    >>> response.outputs[0], response.tau_max
    ('strain@0', 10.0)
    >>> response([2.0, 4.0])[0]
    array([-1.34196715, -1.0316365 ])
    """
    return Response(lower(scene))


def model(scene: Scene, runtime: Sequence[str]) -> RuntimeModel:
    """A scene whose parameters are given when it runs, for one set of them or for a million.

    `runtime` names them: "kappa", "inertia", "velocity", "load", or of a chain that is written out "mass", "dashpot",
    "spring", "impedance", "velocity", "load", those that the scene has. It is compiled: values,
    peaks and misfits together, gradients, and bounds, each when they are first asked for. CompilerError where there is
    no C compiler: the extra `compiler` brings one. WavesymError for a scene that has not got these parameters,
    UnservedError and CostError for one that no such program serves.

    >>> import wavesym
    >>> model = wavesym.model(wavesym.Scene.from_toml("drive_m1"), runtime=["kappa"])
    >>> model.run(kappa=[[0.5], [1], [2]], tau=[2.0, 4.0]).shape  # sets, outputs, then the shape of tau
    (3, 5, 2)
    >>> model.peaks(kappa=[[0.5], [1], [2]]).max.shape
    (3, 5)
    """
    from wavesym.programs.runtime.making import sets_program

    if isinstance(runtime, str):
        raise WavesymError(f'runtime: "{runtime}" given, a list of names expected')
    model = lower(scene)
    given = amplitudes(scene) if "load" in runtime else ()
    return RuntimeModel(sets_program(model, runtime, given))


def summary(scene: Scene, *, at_samples: bool = False) -> Summary:
    """Of each output the least and the greatest value, when, and when it first differs from 0.

    They are true extremes, also between samples, and proved where `run` is right to the last bit (`proved`, `how`,
    `bound`); or, `at_samples`, those of the values at the samples of a record, else at 1001 equally spaced tau.
    `outputs` have `name`, `unit`, `min`, `max` and `arrival`; a `min` has `value`, `at` (`tau` and `time`), `reached`.
    ToleranceError, CostError where nothing could be generated either.

    >>> import wavesym
    >>> strain = wavesym.summary(wavesym.Scene.from_toml("drive_m1")).outputs[0]
    >>> print(f"{strain.name}: {strain.max.value:.6g} at {strain.max.at.tau:.6g}, from {strain.arrival.tau} on")
    strain@0: 1.20241 at 6.46788, from 0.0 on
    """
    model = lower(scene)
    return summarised(model, _own_samples(scene, model) if at_samples else None, drifts(scene))


def summary_text(scene: Scene, at_samples: bool, format: str) -> tuple[str, list[str]]:
    """A summary as text or json, and what a user might not expect of it."""
    found = summary(scene, at_samples=at_samples)
    unproved = [] if found.proved or format == "text" else [f"{found.how}: {found.certain}"]
    return told(found, format), [*warnings(scene), *unproved]


def _own_samples(scene: Scene, model: Model) -> list[float]:
    """The samples of a record, or those of `run`."""
    combs = [(load.begin, load.step) for load in scene.load if isinstance(load, RecordedLoad)]
    combs += [(Fraction(0), load.spacing) for load in scene.load if isinstance(load, SampledLoad)]
    if not combs:
        return list(grid(model, SAMPLES))
    begin, step = (rational(number) for number in min(combs, key=lambda comb: comb[1]))
    count = int(((model.until - begin) / step).floor()) + 1
    return [nearest(begin + k * step) for k in range(-int((begin / step).floor()), count)]


def peaks(scenes: Scene | Iterable[Scene], *, at_samples: bool = False) -> Any:
    """Extremes of one scene, or of several, as arrays: `min`, `max`, `tau_min`, `tau_max`, `arrival` (a tau).

    An xarray.Dataset with the dimensions `case` (of several scenes) and `output`, or, where xarray is not installed, a
    dict of NumPy arrays with these shapes, and `case` and `output`, the names. What a scene does not have is NaN.

    >>> import wavesym
    >>> table = wavesym.peaks(wavesym.Scene.from_toml(name) for name in ("drive_m1", "building_m2"))
    >>> table["max"].shape
    (2, 10)
    """
    several = not isinstance(scenes, Scene)
    found = [summary(scene, at_samples=at_samples) for scene in ([scenes] if isinstance(scenes, Scene) else scenes)]
    return table_of_peaks(found, several)


def run(
    scene: Scene, samples: int, at: Sequence[float] | None = None, tell: Callable[[str], object] = lambda _: None
) -> Iterator[str]:
    """The outputs as CSV lines, as they are computed: at `at`, or at `samples` equally spaced tau of the horizon.

    `tell` is told, before the first line, what a user might not expect, when contacts open and close, and, where values
    are not right to the last bit, of which program they are, and its bound. ToleranceError or CostError where there is
    none that will do, or where it would take minutes to know what contacts do.
    """
    model = lower(scene)
    response = Response(model)
    for line in (*outside(model, at or ()), *unexpected(model), *event_lines(response)):
        tell(line)
    lines = csv_lines(response, samples, at)
    if made := response.program:
        said = "proved bound" if made.proved else "estimate"
        trusted = f"{said} of the error {made.error_bound:g} of an output's largest value"
        tell(f"values of {made.evaluator}, not right to the last bit: {trusted}")
    return lines


def spectrum(scene: Scene, damping: float, path: Path | None = None) -> tuple[list[str], list[str]]:
    """Response spectra as CSV lines, and what to say of them; drawn at `path`, too, where there is one.

    WavesymError for a scene without outputs of quantity acceleration; ToleranceError, CostError as in `spectra`.
    """
    from wavesym.results.spectrum import spectra
    from wavesym.results.stepping import apart

    if path is not None:
        from wavesym.report.saving import picture_format

        picture_format(path)
    model = lower(scene)
    found = spectra(model, damping)
    if path is not None:
        from wavesym.report.saving import save
        from wavesym.report.spectra import draw

        save(draw(found), path)
    names = [f"{name} [{unit}]" if unit else name for name, unit in zip(found.names, found.units, strict=True)]
    header = ",".join(["period" if found.time_unit is None else f"period [{found.time_unit}]", *names]) + "\n"
    rows = (",".join(map(repr, row)) + "\n" for row in np.vstack([found.periods, found.values]).T.tolist())
    said = f"damping {damping:g}, values {apart(model, found.step)}; with half as many spectra change by"
    return [header, *rows], [*unexpected(model), f"{said} {found.change:.1e}"]


def warnings(scene: Scene) -> list[str]:
    """What a user might not expect: no load, contacts that open early enough to matter."""
    return unexpected(lower(scene))
