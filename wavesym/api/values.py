"""What the outputs of a scene are: as functions, histories, statistics and response spectra."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from wavesym.errors import WavesymError
from wavesym.scene import Scene, lower

if TYPE_CHECKING:
    from flint import fmpq
    from numpy.typing import ArrayLike

    from wavesym.results.peaks import Peaks
    from wavesym.results.response import Response
    from wavesym.results.result import Result
    from wavesym.results.spectrum import Spectra
    from wavesym.results.summary import Summary


def evaluator(scene: Scene) -> Response:
    """The outputs of a scene as a function of tau, each value right to the last bit where that takes no minutes.

    Args:
        scene: what to compute.

    Returns:
        A callable: an array of tau (dimensionless) -> an array of shape (outputs, *tau.shape) in `units`. It has
        `outputs`, `units`, `tau_max`, `error_bound` (relative to each output's largest value), `program` (None where
        values are right to the last bit) and the `events` of contacts (`x`, `kind`, `tau` as a ball, `digits`).

    Raises:
        SceneError: for what is no Scene.
        CostError, ToleranceError: when it is called, where no program serves the scene in moderate time or to its
            tolerance.

    >>> import wavesym
    >>> response = wavesym.evaluator(wavesym.Scene.from_toml("drive_m1"))
    >>> response.outputs[0], response.tau_max
    ('strain@0', 10.0)
    >>> response([2.0, 4.0])[0]
    array([-1.34196715, -1.0316365 ])
    """
    from wavesym.results.response import Response

    return Response(lower(scene))


def run(scene: Scene, times: ArrayLike | None = None, samples: int = 1001, *, strict: bool = False) -> Result:
    """The histories of a scene's outputs, as an object that shows itself.

    Args:
        scene: what to compute.
        times: instants, one-dimensional, in the time unit of the scene's results (s), or tau where it has no units;
            None for equally spaced ones on the horizon.
        samples: how many of these, both ends included.
        strict: whether an instant outside the horizon is an error; else its values are NaN, with one warning.

    Returns:
        `time`, `result[NAME]`, `outputs`, `units`, `bound` and `events`; it makes tables (`to_pandas`, `to_xarray`),
        a picture (`plot`) and a `summary`.

    Raises:
        SceneError: for what is no Scene.
        WavesymError: where `strict`, for an instant outside the horizon.
        CostError, ToleranceError: where no program serves the scene in moderate time or to its tolerance.

    >>> import wavesym
    >>> result = wavesym.run(wavesym.Scene.from_toml("drive_m1"), times=[2, 4])
    >>> result
    Result('drive_m1', 5 outputs at 2 tau from 2 to 4, right to the last bit)
    >>> result["strain@0"]
    array([-1.34196715, -1.0316365 ])
    """
    from wavesym.api.pictures import plot
    from wavesym.results.result import result

    return result(scene, times, samples, strict=strict, plot=plot)


def run_csv(
    scene: Scene, samples: int, at: Sequence[float] | None = None, tell: Callable[[str], object] = lambda _: None
) -> Iterator[str]:
    """The outputs as CSV lines, as they are computed: at `at`, or at `samples` equally spaced tau of the horizon.

    Args:
        scene: what to compute.
        samples: how many instants, where `at` is None.
        at: instants, in the time unit of the results, or tau.
        tell: called, before the first line, with what a user might not expect, when contacts open and close, and, where
            values are not right to the last bit, of which program they are, and its bound.

    Raises:
        ToleranceError, CostError: where no program will do, or it would take minutes to know what contacts do.
    """
    from wavesym.results.notes import event_notes, horizon_notes, link_notes, value_notes
    from wavesym.results.response import Response
    from wavesym.results.rows import csv_lines

    model = lower(scene)
    response = Response(model)
    for line in (*horizon_notes(model, at or ()), *value_notes(model), *event_notes(response), *link_notes(model)):
        tell(line)
    lines = csv_lines(response, samples, at)
    if made := response.program:
        kind = "proved bound" if made.proved else "estimate"
        bound = f"{kind} of the error {made.error_bound:g} of an output's largest value"
        tell(f"values of {made.evaluator}, not right to the last bit: {bound}")
    return lines


def summary(scene: Scene, *, at_samples: bool = False) -> Summary:
    """Of each output the least and the greatest value, when, and when it first differs from 0.

    Args:
        scene: what to compute.
        at_samples: whether they are those of the values at the samples of a record, else at 1001 equally spaced tau,
            in place of true extremes, also between samples.

    Returns:
        `outputs` with `name`, `unit`, `min`, `max` and `arrival`, found by name too (`summary["strain@0"]`); a `min`
        has `value` (in `unit`), `at` (`tau`, and `time` in the scene's unit) and `reached`. True extremes are `proved`
        where `run` is right to the last bit; `how` says how they were found, `bound` what values are wrong by at most,
        relative to an output's largest.

    Raises:
        ToleranceError, CostError: where nothing could be generated either.

    >>> import wavesym
    >>> strain = wavesym.summary(wavesym.Scene.from_toml("drive_m1"))["strain@0"]
    >>> print(f"{strain.name}: {strain.max.value:.6g} at {strain.max.at.tau:.6g}, from {strain.arrival.tau} on")
    strain@0: 1.20241 at 6.46788, from 0.0 on
    """
    from wavesym.results.rows import own_samples
    from wavesym.results.summary import summarise
    from wavesym.scene.lowering import drifts, sample_comb

    model = lower(scene)
    return summarise(model, own_samples(model, sample_comb(scene)) if at_samples else None, drifts(scene))


def peaks(
    scenes: Scene | Iterable[Scene],
    *,
    keep: Sequence[str] = ("min", "max", "tau_min", "tau_max"),
    at_samples: bool = False,
) -> Peaks:
    """Statistics of one scene, or of several, as arrays; many scenes share work as the cases of a sweep do.

    Scenes that differ in numbers which one compiled program takes (a diameter, a stiffness, an amplitude) take little
    longer than one: where only extremes are kept, and not `at_samples`. On a terminal a line says how far it is.

    Args:
        scenes: what to compute.
        keep: which statistics, as in a sweep: of `min`, `max`, `tau_min`, `tau_max`, and of what makes each scene be
            computed by itself, `arrival` (a tau), `mean`, `rms` and `residual`, the value at the end.
        at_samples: as of `summary`.

    Returns:
        A mapping of these names to NumPy arrays, (cases, outputs), or (outputs,) of one scene, with the names of
        `cases` (by what varies) and `outputs`, and the `bound` of errors (cases,), an estimate where work is shared;
        `to_xarray()` and `to_pandas()` make labelled tables. What a scene does not have is NaN.

    Raises:
        WavesymError: for a statistic that there is not.
        ToleranceError, CostError: as of `summary`.

    >>> import wavesym
    >>> scene = wavesym.Scene.from_toml("drive_m1")
    >>> table = wavesym.peaks(scene.with_({"system.kappa[0]": kappa}) for kappa in ("1/2", 2))
    >>> table.cases, table["max"].shape
    (('system.kappa[0] = 1/2', 'system.kappa[0] = 2'), (2, 5))
    """
    from wavesym.results.statistics import wrong_statistic
    from wavesym.sweeps.scenes import peaks_of

    if wrong := wrong_statistic(keep):
        raise WavesymError(f"keep[{wrong[1]}]: {wrong[0]}")
    every = [scenes] if isinstance(scenes, Scene) else list(scenes)
    if not every:
        raise WavesymError("peaks: no scene; write at least 1")
    for scene in every:
        if not isinstance(scene, Scene):
            raise WavesymError(f"peaks: {type(scene).__name__} is not a Scene; write Scene.from_toml(...)")
        scene.refuse_without_output()
    return peaks_of(every, keep, several=not isinstance(scenes, Scene), at_samples=at_samples)


def spectrum(scene: Scene, damping: float = 0.05) -> Spectra:
    """Response spectra of the outputs of quantity acceleration.

    Args:
        scene: what to compute.
        damping: the ratio of the oscillators' damping, from 0 to below 1.

    Returns:
        `periods` (n,) in `time_unit`, `values` (outputs, n), pseudo-accelerations in `units` of `outputs`; `[NAME]` is
        one of them. `change` is how much half as many steps change them, relative to each spectrum's largest value.

    Raises:
        WavesymError: for a scene without such outputs, or a horizon that is too short.
        ToleranceError, CostError: where nothing could be generated either.

    >>> import wavesym
    >>> scene = wavesym.Scene.from_toml("building_m2").with_({"output.acceleration": [1, 2], "output.until": 40})
    >>> wavesym.spectrum(scene, damping=0.02).outputs
    ('acceleration@1', 'acceleration@2')
    """
    from wavesym.results.spectrum import spectra

    return spectra(lower(scene), damping)


def spectrum_notes(scene: Scene, found: Spectra) -> list[str]:
    """What to know of response spectra: what `scene_notes` has, and how far the steps of their values matter."""
    from wavesym.results.stepping import describe_step

    damping, step = f"damping {found.damping:g}", describe_step(lower(scene), found.step)
    change = f"with half as many spectra change by {found.change:.1e}"
    return [*scene_notes(scene), f"{damping}, values {step}; {change}"]


def scene_notes(scene: Scene, *, values: bool = True, step: fmpq | None = None) -> list[str]:
    """What a user might not expect of a scene, a line for each: what was rounded, adjusted or understood.

    Args:
        scene: what was read.
        values: whether its outputs are of interest: a line, too, where there is no load, and for each contact that
            opens early enough to matter.
        step: of a stream, in tau, for which speeds may be changed.
    """
    from wavesym.results.notes import value_notes

    model = lower(scene)
    if step is not None:
        from wavesym.programs.stream.adjustment import fit_speeds

        model = fit_speeds(model, step)
    return value_notes(model) if values else list(model.labels.notes)
