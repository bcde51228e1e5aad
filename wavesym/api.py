"""One function for each thing that people do with a scene: the command line, Python and sweeps enter here.

    stage     call                       takes             gives                             room
    -------   ------------------------   ---------------   -------------------------------   --------------------
    read      Scene.from_toml            TOML              Scene: what the user wrote        scene/, systems/
    lower     lower                      Scene             Model: exact, nodes and loads     scene/ -> mechanics/
    derive    node_law, recurrence       nodes, a system   laws of coefficients              derivation/   SymPy
    solve     network_table, signals ... Model, laws       tables, waves, reference values   exact/
    choose    program                    Model, Request    Program: tables and bounds        programs/
    write     generate                   Program           C, NumPy, FMU, manifest           targets/

Each function calls the stages that it needs once, in this order; what people read of the result is written by
documents/, results/ and report/, judged by verification/ and papers/, measured by lab/. What a function needs is
imported when it is called, so that no command waits for a library that another one needs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from importlib.util import find_spec
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from wavesym.errors import UnservedError, WavesymError
from wavesym.programs.request import KINDS, Request, refuse_unknown
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import named_chain, sources

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from wavesym.derivation.equations import Equations
    from wavesym.derivation.table import Row, Table
    from wavesym.documents.advice import Advice
    from wavesym.exact.tables.network_table import NetworkTable
    from wavesym.mechanics.chain import Chain
    from wavesym.mechanics.model import Model
    from wavesym.mechanics.node import System
    from wavesym.papers.entries import PaperEntry
    from wavesym.programs.program import Program
    from wavesym.results.frequency_response import FrequencyResponse
    from wavesym.results.mode_ranges import ModeRanges
    from wavesym.results.modes import Modes
    from wavesym.results.peaks import Peaks
    from wavesym.results.response import Response
    from wavesym.results.result import Result
    from wavesym.results.spectrum import Spectra
    from wavesym.results.summary import Summary
    from wavesym.running.model import RuntimeModel
    from wavesym.sweeps.status import SweepStatus

MOST_FACTORED = 100_000  # coefficients of a symbolic table; half a millisecond each, however small


# Values -------------------------------------------------------------------------------------------------------------


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
    from wavesym.results.response import Response
    from wavesym.results.rows import csv_lines
    from wavesym.results.unexpected import event_lines, outside, unexpected

    model = lower(scene)
    response = Response(model)
    for line in (*outside(model, at or ()), *unexpected(model), *event_lines(response)):
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
    from wavesym.results.summary import summarised
    from wavesym.scene.lowering import drifts, sample_comb

    model = lower(scene)
    return summarised(model, own_samples(model, sample_comb(scene)) if at_samples else None, drifts(scene))


def peaks(scenes: Scene | Iterable[Scene], *, at_samples: bool = False) -> Peaks:
    """Statistics of one scene, or of several, as arrays: `min`, `tau_min`, `max`, `tau_max`, `arrival` (a tau), `mean`,
    `rms` and `residual`, the value at the end.

    Args:
        scenes: what to compute.
        at_samples: as of `summary`.

    Returns:
        A mapping of these names to NumPy arrays, (cases, outputs), or (outputs,) of one scene, with the names of
        `cases` (by what varies) and `outputs`; `to_xarray()` and `to_pandas()` make labelled tables. What a scene does
        not have is NaN.

    Raises:
        ToleranceError, CostError: as of `summary`.

    >>> import wavesym
    >>> scene = wavesym.Scene.from_toml("drive_m1")
    >>> table = wavesym.peaks(scene.with_({"system.kappa[0]": kappa}) for kappa in ("1/2", 2))
    >>> table.cases, table["max"].shape
    (('system.kappa[0] = 1/2', 'system.kappa[0] = 2'), (2, 5))
    """
    from wavesym.results.peaks import peaks_of

    every = [scenes] if isinstance(scenes, Scene) else list(scenes)
    summaries = [summary(scene, at_samples=at_samples) for scene in every]
    return peaks_of(every, summaries, several=not isinstance(scenes, Scene))


def spectrum(scene: Scene, damping: float = 0.05) -> Spectra:
    """Response spectra of the outputs of quantity acceleration.

    Args:
        scene: what to compute.
        damping: the ratio of the oscillators' damping, from 0 to below 1.

    Returns:
        `periods` (n,) in `time_unit`, `values` (outputs, n), pseudo-accelerations in `units`, and `names`; `change` is
        how much half as many steps change them, relative to each spectrum's largest value.

    Raises:
        WavesymError: for a scene without such outputs, or a horizon that is too short.
        ToleranceError, CostError: where nothing could be generated either.

    >>> import wavesym
    >>> scene = wavesym.Scene.from_toml("building_m2").with_({"output.acceleration": [1, 2], "output.until": 40})
    >>> wavesym.spectrum(scene, damping=0.02).names
    ('acceleration@1', 'acceleration@2')
    """
    from wavesym.results.spectrum import spectra

    return spectra(lower(scene), damping)


def spectrum_csv(scene: Scene, damping: float, path: Path | None = None) -> tuple[list[str], list[str]]:
    """Response spectra as CSV lines, and what to say of them; drawn at `path`, too. Errors as of `spectrum`."""
    from wavesym.results.spectrum import csv_lines, spectra
    from wavesym.results.stepping import apart
    from wavesym.results.unexpected import unexpected

    if path is not None:
        from wavesym.pictures.saving import picture_format

        picture_format(path)
    lowered = lower(scene)
    found = spectra(lowered, damping)
    if path is not None:
        from wavesym.pictures.saving import save
        from wavesym.pictures.spectra import draw

        save(draw(found), path)
    steps = f"damping {damping:g}, values {apart(lowered, found.step)}; with half as many spectra change by"
    return csv_lines(found), [*unexpected(lowered), f"{steps} {found.change:.1e}"]


def model(scene: Scene, runtime: Sequence[str]) -> RuntimeModel:
    """A scene whose parameters are given when it runs, for one set of them or for a million.

    Args:
        scene: what to compute.
        runtime: names of the parameters: "kappa", "inertia", "velocity", "load", or of a general chain "mass",
            "dashpot", "spring", "impedance", "velocity", "load", those that the scene has.

    Returns:
        What has `run`, `peaks`, `gradients`, `misfit` and `bounds`, compiled when they are first asked for.

    Raises:
        CompilerError: where there is no C compiler: the extra `compiler` brings one.
        WavesymError: for a scene that has not got these parameters.
        UnservedError, CostError: for one that no such program serves.

    >>> import wavesym
    >>> model = wavesym.model(wavesym.Scene.from_toml("drive_m1"), runtime=["kappa"])
    >>> model.run(kappa=[[0.5], [1], [2]], tau=[2.0, 4.0]).shape  # sets, outputs, then the shape of tau
    (3, 5, 2)
    >>> model.peaks(kappa=[[0.5], [1], [2]]).max.shape
    (3, 5)
    """
    from wavesym.programs.runtime.making import sets_program
    from wavesym.running.model import RuntimeModel
    from wavesym.scene.lowering import amplitudes

    if isinstance(runtime, str):
        raise WavesymError(f'runtime: "{runtime}" is not a list of names; write ["{runtime}"]')
    lowered = lower(scene)
    return RuntimeModel(sets_program(lowered, runtime, amplitudes(scene) if "load" in runtime else ()))


@overload
def modes(
    scene: Scene | str | PathLike[str], count: int = 10, below: float | None = None, *, points: int | None = None
) -> Modes: ...
@overload
def modes(
    scene: Scene | str | PathLike[str],
    count: int = 10,
    below: float | None = None,
    *,
    ranges: Mapping[str, tuple[str, str]],
) -> ModeRanges: ...


def modes(
    scene: Scene | str | PathLike[str],
    count: int = 10,
    below: float | None = None,
    *,
    ranges: Mapping[str, tuple[str, str]] | None = None,
    points: int | None = None,
) -> Modes | ModeRanges:
    """The modes of vibration of a scene: frequencies, none missed, damping, effective masses and shapes.

    Args:
        scene: a Scene; or a file, or the name of a built-in scene, which needs neither loads nor outputs.
        count: how many, where `below` is None; rigid modes come first.
        below: all up to this frequency: in Hz, or in rad per tau for a scene without units.
        ranges: of paths, as of `scene.with_`, the least and the greatest value: for the range of each frequency over
            the box, in place of modes; `below` does not matter then.
        points: at how many points of each rod shapes are wanted, from 2 on: `along` has them, line by line.

    Returns:
        A sequence of modes with `number`, `omega`, `hz`, `period`, `damping`, `radius` (proved), `effective_mass`,
        `shape` and `loads` (of each load its participation); `complete` says whether none is missed, `why` in words.

    Raises:
        UnservedError: for contacts, and frequencies whose modes cannot be told apart.
        WavesymError: for a count, or a frequency, that is not positive.

    >>> import wavesym
    >>> wavesym.modes("drive_m1", 3)
    Modes('drive_m1', 3 modes: 0, 0.18084, 0.565872 1/tau)
    """
    from wavesym.results.mode_ranges import mode_ranges
    from wavesym.results.modes import modes as modes_of

    chain = scene if isinstance(scene, Scene) else Scene.chain_from_toml(scene)
    if ranges is not None:
        return mode_ranges(chain, count, ranges)
    return modes_of(lower(chain, loads=False), count, below, chain.system.lines, points)


def frf(
    scene: Scene,
    frequencies: ArrayLike | None = None,
    load: str | int | None = None,
    *,
    low: float | None = None,
    high: float | None = None,
    points: int = 400,
) -> FrequencyResponse:
    """The frequency response of a scene: complex amplitudes of its outputs under one unit of a load exp(+i w t).

    They come from the dynamic stiffness K(w) of the chain, in balls: dashpots, absorbing ends and modal damping too.

    Args:
        scene: a chain whose contacts do not open.
        frequencies: (n,), in Hz, or w in rad per tau for a scene without units, each the shortest decimal that reads
            back to it; None for `points` of them, equally spaced from `low` to `high`.
        load: its number in the scene from 0 on, or the node it acts on; None where there is one load.
        low: the first frequency; None for one step above 0, where chains that nothing holds have no answer.
        high: the last one; None for that of the fifth mode without dashpots.
        points: how many.

    Returns:
        `frequency`, `response[NAME]`, `amplitude`, `phase`, `values` (outputs, n), `bound`, `poles`; `peaks()` encloses
        the greatest amplitudes between the first and the last frequency, `to_pandas()`, `csv()` and `json()` make
        tables.

    Raises:
        WavesymError: for a load or a frequency that is none.
        UnservedError: for contacts that open, and modes that cannot be told apart.
        ToleranceError: where damping ratios would need too many modes for the scene's tolerance.
        CostError: for too many frequencies.

    >>> import wavesym
    >>> response = wavesym.frf(wavesym.Scene.from_toml("building_m2"), [0.5, 1.0])
    >>> response
    FrequencyResponse('building_m2', 6 outputs at 2 frequencies from 0.5 to 1 rad per tau, bound 2.2e-16)
    >>> abs(response["strain@0.5"])
    array([4.60118888, 3.58758905])
    """
    from wavesym.results.frequency_response import equally_spaced, frequency_response
    from wavesym.results.transfer import harmonic_load

    lowered = lower(scene, loads=False)
    acting = harmonic_load(lowered, sources(scene), load)
    at = equally_spaced(lowered, low, high, points) if frequencies is None else frequencies
    return frequency_response(lowered, acting, at)


def plot_frf(found: FrequencyResponse, path: Path) -> None:
    """Draw amplitudes and phases over frequency. SceneError for a suffix that is no picture's."""
    from wavesym.pictures.frequency_response import draw
    from wavesym.pictures.saving import picture_format, save

    picture_format(path)
    save(draw(found), path)


def plot_modes(scene: Scene, found: Modes, path: Path) -> None:
    """Draw the shapes of modes along the chain. SceneError for a suffix that is no picture's."""
    from wavesym.pictures.modes import draw
    from wavesym.pictures.saving import picture_format, save

    picture_format(path)
    save(draw(found, lower(scene, loads=False), scene.system.lines), path)


def unexpected_lines(scene: Scene) -> list[str]:
    """What a user might not expect: how the scene was read, no load, contacts that open early enough to matter."""
    from wavesym.results.unexpected import unexpected

    return unexpected(lower(scene))


# Programs -----------------------------------------------------------------------------------------------------------


def program(scene: Scene, request: Request, *, tested: bool = False) -> Program:
    """The program of a scene that a request asks for: of its loads, of loads sample by sample, or of parameters.

    Args:
        scene: what to compute.
        request: all options, made once.
        tested: whether it has reference values, for a self-test.

    Raises:
        ToleranceError: where no evaluator, or not the one asked for, meets the scene's tolerance.
        CostError, UnservedError, WavesymError: for what is too expensive, not supported, or contradicts itself.
    """
    from wavesym.scene.lowering import amplitudes, sources

    lowered = lower(scene)
    if request.is_of_modes(lowered):
        return _stepped_modes(scene, lowered, request, tested)
    if request.stream:
        from wavesym.programs.stream.making import stream_program
        from wavesym.programs.stream.plan import inputs_of

        endless = replace(lowered, endless=True)
        return stream_program(endless, request, inputs_of(endless, sources(scene)), tested=tested)
    if request.runtime:
        from wavesym.programs.runtime.making import runtime_program

        given = amplitudes(scene) if "load" in request.runtime else ()
        return runtime_program(lowered, request, given, tested=tested)
    from wavesym.programs.making import make

    return make(lowered, request, tested=tested)


def scene_notes(scene: Scene) -> list[str]:
    """How the scene was read where that may surprise, and a line for a scene in which nothing happens."""
    from wavesym.results.unexpected import without_load

    lowered = lower(scene)
    return [*lowered.labels.notes, *without_load(lowered)]


def fmu_notes(path: Path) -> list[str]:
    """What to know of an FMU that was made."""
    from wavesym.running.fmu import told

    return told(path)


def _stepped_modes(scene: Scene, lowered: Model, request: Request, tested: bool) -> Program:
    """A stream that modes step, for a simulator only what its input changes."""
    from wavesym.programs.making import make

    if not request.target:
        return make(lowered, request, tested=tested)
    if request.runtime:
        raise WavesymError(
            f"--runtime: {','.join(request.runtime)} does not go with modes and --target; leave --runtime out"
        )
    if request.step is not None:
        raise WavesymError(f"--step: {request.step} does not go with modes, whose loads say the step; leave --step out")
    if not scene.load:
        raise UnservedError("load: none, and it is the input of an FMU with modes; write at least one [[load]]")
    return make(lowered, replace(request, evaluator="modes"), tested=tested)


def generate(
    scene: Scene,
    directory: str | PathLike[str] | None = None,
    language: str = "c",
    evaluator: str = "auto",
    precision: str = "double",
    optimize: str | None = None,
    runtime: Sequence[str] = (),
    *,
    parts: Sequence[str] = (),
    kappa_max: Fraction | None = None,
    stream: bool = False,
    step: Fraction | None = None,
    package: bool = False,
    target: str = "",
    force: bool = False,
) -> tuple[Path, ...]:
    """Write the files of a scene, all or none.

    Args:
        scene: what to compute.
        directory: the folder; None for ./NAME.
        language: "c", "numpy" or "all".
        evaluator: "auto", "closed", "pieces", "march" or "modes".
        precision: "double" or "single".
        optimize: "speed" (usual in double precision) or "size" (usual in single).
        runtime: parameters that C takes when it runs: "kappa", "inertia", "velocity", "load"; of a general chain
            "mass", "dashpot", "spring", "impedance", "velocity", "load".
        parts: what that C has besides values and the estimate of their errors: "peaks", "gradients", "batch", "misfit",
            "bound".
        kappa_max: the largest kappa that it is made for (ten times the scene's own), in a general chain the largest
            rate of a joint, dimensionless.
        stream: whether loads come sample by sample, at any time, and `runtime` when it starts.
        step: in tau; loads of a stream change at multiples of it.
        package: whether CMake, ctest and pkg-config come with the C.
        target: "fmu2" or "fmu3" for one file, NAME.fmu, a stream for simulators.
        force: whether files are replaced that wavesym did not write.

    Returns:
        The paths written.

    Raises:
        WavesymError: for files that wavesym did not write, and for words that there are not.
        ToleranceError, CostError, UnservedError: as of `program`.
        CompilerError: for an FMU where there is no C compiler.

    >>> import wavesym
    >>> for path in wavesym.generate(wavesym.Scene.from_toml("drive_m1"), "drive", language="numpy"):
    ...     print(path.as_posix())
    drive/drive_m1.json
    drive/drive_m1.py
    """
    request = Request.checked(
        evaluator=evaluator,
        precision=precision,
        optimize=optimize,
        runtime=tuple(runtime),
        parts=tuple(parts),
        kappa_max=kappa_max,
        stream=stream or bool(target),
        step=step,
        target=target,
        language=language,
        package=package,
    )
    return write(scene, directory, request, force=force)


def write(
    scene: Scene, directory: str | PathLike[str] | None, request: Request, *, force: bool = False
) -> tuple[Path, ...]:
    """As `generate`, for a request that is made."""
    from wavesym.targets.files import is_ours
    from wavesym.writing import write_whole

    made = _files(scene, directory, request)
    for path in made:
        if not force and path.is_file() and not is_ours(path):
            raise WavesymError(f"{path}: exists and was not written by wavesym; --force replaces it")
    write_whole(made)
    return tuple(made)


def check(scene: Scene, directory: str | PathLike[str] | None, request: Request, source: str = "SCENE") -> str:
    """The difference between what stands in a folder and what `write` would write; empty where there is none.

    Args:
        scene, directory, request: as of `write`.
        source: how the scene was given, for the last line.

    Returns:
        Each file that is changed, missing or orphaned, with a diff, and what a process that was killed left; the last
        line is the command that mends them.
    """
    from wavesym.difference import Difference
    from wavesym.writing import traces

    made = {path: text for path, text in _files(scene, directory, request).items() if isinstance(text, str)}
    folder = Path(directory or scene.name)
    found = [path for path in {*folder.glob(f"{scene.name}*"), *made} if path.is_file()]
    left = [path for path, place in traces(folder) if place.name.startswith(scene.name)]
    options = ["--language", request.language, *request.options.split(), *(["--package"] if request.package else [])]
    return Difference(made, [*found, *left]).report(["wavesym", "generate", source, "-o", str(folder), *options])


def _files(scene: Scene, directory: str | PathLike[str] | None, request: Request) -> dict[Path, str | bytes]:
    """The content of every file of a scene, by path."""
    from wavesym.targets.files import files, tested

    made = program(scene, request, tested=not request.target and tested(request.language))
    folder = Path(directory or scene.name)
    if request.target:
        from wavesym.running.fmu import fmu

        return {folder / f"{scene.name}.fmu": fmu(made, request.target)}
    texts = files(made, request.language, packaged=request.package)
    return {folder / name: text for name, text in texts.items()}


# Texts and pictures -------------------------------------------------------------------------------------------------


def table(scene: Scene, intervals: int | None = None) -> Table | NetworkTable:
    """The unit responses of all sources of the scene's system, exact; errors as of `tables`."""
    from wavesym.documents.named_table import named_table
    from wavesym.exact.tables.network_table import network_table
    from wavesym.numbers.doubles import rational

    lowered = lower(scene)
    lowered.refuse_damping()
    network, until, chain = lowered.network, rational(lowered.horizon()), named_chain(scene)
    return named_table(chain, network, intervals, until) if chain else network_table(network, intervals, until)


def tables(scene: Scene, intervals: int | None = None) -> list[Row]:
    """The rows of the coefficient table, exact.

    Args:
        scene: whose system it is.
        intervals: how many of every function; None for those that the horizon needs.

    Returns:
        One row for each term: in the interval that it names, the derivative of the wave function gains
        value * exp(-rate * w) * w**power, all dimensionless. In a general chain `interval` is the tau at which the wave
        leaves its end of the rod.

    Raises:
        UnservedError: for a chain that has contacts, or a node whose polynomial does not split.

    >>> import wavesym
    >>> row = wavesym.tables(wavesym.Scene.from_toml("building_m2"), intervals=1)[0]
    >>> row.function, row.rod, row.source, row.interval, row.rate, row.power, row.value
    ('f', 1, 'a', 1, Fraction(0, 1), 0, Fraction(-4, 1))
    """
    from wavesym.numbers.doubles import fraction

    return [
        row._replace(
            interval=row.interval if isinstance(row.interval, int) else fraction(row.interval),
            rate=fraction(row.rate),
            value=fraction(row.value),
        )
        for row in table(scene, intervals).rows()
    ]


def symbolic_tables(scene: Scene, intervals: int | None, format: str) -> tuple[list[str], Iterator[str]]:
    """The table as rational functions of the parameters: what the symbols stand for, then its lines, in a format.

    Parameters and rates that are equal in the scene are equal in the table. CostError where it would be absurd.
    """
    from wavesym.derivation.rate_letters import in_rates
    from wavesym.derivation.table import full_table
    from wavesym.derivation.table_size import refuse_costly
    from wavesym.documents.tables import symbolic_lines
    from wavesym.mechanics.symbolic import symbolic
    from wavesym.numbers.doubles import rational

    lowered = lower(scene)
    symbols = in_rates(symbolic(_paper_chain(scene, lowered, "--symbolic", "tables")))
    until = rational(lowered.horizon())
    refuse_costly(symbols.chain, intervals, until)
    made = full_table(symbols.chain, intervals, until, most=MOST_FACTORED)
    merged = [f"{name} = {ratio}" for name, ratio in symbols.meaning.items() if str(ratio) != name]
    return merged, symbolic_lines(made, symbols, scene.name, format)


def formula(
    scene: Scene, output: str, until: float | Fraction | None = None, format: str = "text", *, symbolic: bool = False
) -> str:
    """An output in closed form between its breakpoints, with exact coefficients.

    Args:
        scene: whose contacts do not open, and whose modes are not damped.
        output: its name, such as "strain@0.5".
        until: in the time unit of the results, or tau; None for the horizon.
        format: "text", "latex", "sympy" (one expression in `tau`) or "c" (a function).
        symbolic: whether coefficients are functions of the parameters: of the paper's systems only.

    Returns:
        The text, which ends with a line break.

    Raises:
        WavesymError: for an output, a format or a time that is none.
        UnservedError: where there is no closed form.
        CostError: for a formula of too many terms.

    >>> import wavesym
    >>> print(wavesym.formula(wavesym.Scene.from_toml("drive_m1"), "strain@0", 1), end="")
    strain@0 of drive_m1, tau from 0 to 1: the sum of
    from tau = 0 on, w = tau:
        -1 + exp(-w)
    """
    from wavesym.documents.formula import output_formula, symbolic_formula
    from wavesym.numbers.doubles import rational

    refuse_unknown("format", format, ("text", "latex", "sympy", "c"))
    model = lower(scene)
    if until is not None:
        last = rational(Fraction(repr(float(until)) if isinstance(until, float) else until)) / (
            model.clock.per_tau if model.clock else 1
        )
        if not 0 < last <= model.until:
            raise WavesymError(f"--until: {float(until):g} is not between 0 and the horizon of the scene")
        model = model.shortened(last)
    if not symbolic:
        return output_formula(model, output).render(format)
    from wavesym.derivation.rate_letters import in_rates
    from wavesym.mechanics.symbolic import symbolic as in_letters

    chain = _paper_chain(scene, model, "--symbolic", "formula")
    return symbolic_formula(model, output, in_rates(in_letters(chain)), chain.nodes[-1].velocity).render(format)


class Derivation(str):
    """A derivation: text, and for the paper's systems SymPy objects, in the paper's letters.

    `equations` has for each system (a building has two bases) `delay_equations` and `recurrences`: tuples of a SymPy
    `equation` and the rods i = `first`, `first` + `step`, ... `last` that it holds for.
    """

    _systems: tuple[System, ...] = ()

    @cached_property
    def equations(self) -> tuple[Equations, ...]:
        """Those of each system, for any m; none for a chain that is written out."""
        from wavesym.derivation.equations import equations

        return equations(self._systems)


def derive(source: str | Scene, m: int | None = None, format: str = "text") -> Derivation:
    """The derivation of a system, or of a scene: boundary conditions, delay equations, coefficient recurrences.

    Args:
        source: "collision", "drive", "building" (both bases), or a scene; of a general chain it is the law of each kind
            of node.
        m: how many elastic elements; then every line is written out. A scene has its own.
        format: "text", "latex" or "json".

    Returns:
        The text, which has SymPy objects as `equations`.

    Raises:
        WavesymError: for an m that the system does not have.

    >>> import wavesym
    >>> print(wavesym.derive("drive", 1).splitlines()[0])
    drive, m = 1
    >>> wavesym.derive("drive").equations[0].delay_equations[0].equation.lhs
    Derivative(f(1, z), z)*kappa[1] + Derivative(f(1, z), (z, 2))
    """
    from wavesym.documents.derivation.document import derivation, network_derivation, scene_derivation
    from wavesym.documents.derivation.statement import systems
    from wavesym.mechanics.symbolic import symbolic

    if isinstance(source, str):
        made = Derivation(derivation(source, m, format))
        made._systems = tuple(systems(source, m))
        return made
    lowered = lower(source)
    lowered.refuse_damping()
    chain = named_chain(source)
    if chain is None:
        return Derivation(network_derivation(lowered, format))
    made = Derivation(scene_derivation(source.name, symbolic(chain), format))
    made._systems = (chain.system,)
    return made


def walks(source: str | Scene, m: int | None, intervals: int, format: str = "text") -> str:
    """The walk polynomials of `derive`'s systems with m elastic elements, or of a scene, as text, latex or json.

    WavesymError for an m that the system does not have; CostError where the polynomials would be absurd.
    """
    from wavesym.documents.derivation.statement import systems
    from wavesym.documents.walks import walk_polynomials
    from wavesym.mechanics.symbolic import generic, symbolic

    if isinstance(source, str):
        assert m is not None  # polynomials are those of one chain
        return walk_polynomials((generic(system, m) for system in systems(source, m)), intervals, format)
    return walk_polynomials([symbolic(_paper_chain(source, lower(source), "--walks", "derive"))], intervals, format)


def _paper_chain(scene: Scene, lowered: Model, option: str, command: str) -> Chain:
    """The chain as the paper has it. UnservedError for a general chain."""
    lowered.refuse_damping()
    chain = named_chain(scene)
    if chain is None:
        raise UnservedError(
            f"system.type: {lowered.labels.type} has no {option}, as collision, drive and building have; "
            f"`{command}` without {option} takes a chain"
        )
    return chain


def inspect(scene: Scene, stage: str | None = None, format: str = "text") -> str:
    """What a stage makes of a scene, or a summary of all of them, as text or json; refusals are part of it.

    Args:
        scene: what is looked at.
        stage: "scene", "model", "laws", "table", "program", or "summary" (None).
        format: "text" or "json".
    """
    from wavesym.documents.inspection.document import SUMMARY, inspection

    return inspection(scene, stage or SUMMARY, format)


def inspect_lines(scene: Scene, stage: str | None, format: str) -> Iterator[str]:
    """The same in parts, as they are known: what the model is before programs are tried."""
    from wavesym.documents.inspection.document import SUMMARY, inspection_lines

    return inspection_lines(scene, stage or SUMMARY, format)


def plot(scene: Scene, path: str | PathLike[str] | None = None, kind: str = "history") -> Figure:
    """Draw a scene.

    Args:
        scene: what is drawn.
        path: a file that it is written to as well, as .svg, .png or .pdf.
        kind: "history", the outputs over time; "xt", place x time of all rods; "envelope", the least and greatest along
            the chain; "map", place x time as colours, for long horizons.

    Returns:
        A matplotlib Figure, which a notebook shows.

    Raises:
        SceneError: for another suffix, before the work.
        WavesymError: for another kind, and where matplotlib is not installed.
        ToleranceError, CostError: where nothing could be generated either.

    >>> import wavesym
    >>> figure = wavesym.plot(wavesym.Scene.from_toml("drive_m1"), "drive.svg")
    """
    return plot_with_notes(scene, path, kind)[0]


def plot_with_notes(scene: Scene, path: str | PathLike[str] | None, kind: str) -> tuple[Figure, list[str]]:
    """As `plot`, with what the picture leaves out, line by line."""
    if not find_spec("matplotlib"):
        raise WavesymError("matplotlib is not installed; `pip install 'wavesym[plot]'` brings it")
    from wavesym.pictures.saving import picture_format, save
    from wavesym.pictures.scene_picture import KINDS, draw

    refuse_unknown("kind", kind, KINDS)
    if path is not None:
        picture_format(Path(path))
    figure, notes = draw(scene, lower(scene), kind)
    if path is not None:
        save(figure, Path(path))
    return figure, notes


def scene_html(scene: Scene) -> str:
    """A scene as a notebook shows it: a line of what it is, and its structure drawn."""
    from wavesym.pictures.page.structure import structure_html

    return structure_html(repr(scene), lower(scene), scene.system.lines)


def record(path: Path, unit: str | None, column: str | None = None, picture: Path | None = None) -> list[str]:
    """What a file of a record has, line by line; drawn too, where there is a path for it.

    Args:
        path: an AT2 or CSV file.
        unit: that of the samples, where the file has none.
        column: that of a CSV with several.
        picture: a file, .svg, .png or .pdf.

    Raises:
        SceneError: for a file that is damaged or has another unit, and for a picture with another suffix.
        WavesymError: for what is no unit.
    """
    from wavesym.documents.record import record_lines

    found, unit, lines = record_lines(path, unit, column)
    if picture is not None:
        from wavesym.pictures.record import draw
        from wavesym.pictures.saving import picture_format, save

        picture_format(picture)
        save(draw(found, unit), picture)
    return lines


def report(scene: Scene, path: str | PathLike[str]) -> None:
    """Write a scene, and what happens in it, as one page of HTML that needs no network.

    Args:
        scene: what is shown.
        path: the file.

    Raises:
        ToleranceError, CostError: where nothing could be generated either.

    >>> import wavesym
    >>> wavesym.report(wavesym.Scene.from_toml("drive_m1"), "drive.html")
    """
    from wavesym.pictures.page.document import page
    from wavesym.writing import write_whole

    write_whole({Path(path): page(scene)})


# Many scenes --------------------------------------------------------------------------------------------------------


def sweep(
    source: str | PathLike[str] | Mapping[str, Any],
    folder: str | PathLike[str],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    retry_failed: bool = False,
) -> Any:
    """Compute many scenes into a folder, as `wavesym sweep` does; what is there goes on where it was.

    Args:
        source: a file of TOML, or the same fields: `scene` (a Scene, or a path), `vary`, `records`, `keep`.
        folder: where the results go.
        workers: so many processes of this machine compute; None for whoever is best.
        scheduler: the address of a Dask scheduler whose workers compute.
        retry_failed: whether cases that failed are tried again.

    Returns:
        An xarray.Dataset: extremes over the varied paths, `record` and `output`, NaN for a case that failed.

    Raises:
        SceneError: for a request that is wrong.
        WavesymError: for the folder of another sweep.

    >>> import wavesym
    >>> request = {"scene": "drive_m1", "vary": {"output.until": [4, 5], "system.kappa[0]": ["1/2", 1, 2]}}
    >>> wavesym.sweep(request, "stiffnesses")["max"].dims
    ('output.until', 'system.kappa[0]', 'output')
    """
    from wavesym.sweeps.store import needed, opened

    needed("xarray", "zarr")
    run_sweep(source, folder, workers, scheduler, retry_failed)
    return opened(folder)


def run_sweep(
    source: str | PathLike[str] | Mapping[str, Any],
    folder: str | PathLike[str],
    workers: int | None,
    scheduler: str | None,
    retry_failed: bool,
    watch: Callable[[int, int, int], object] = lambda *_: None,
) -> int:
    """Compute what is left of a sweep; how many of its cases have failed.

    `watch` is called with the number of all cases, of those done, and of those done before; the rest as of `sweep`.
    """
    from wavesym.sweeps.running import Computing, run

    return run(source, folder, Computing(workers, scheduler), retry_failed, watch)


def sweep_status(folder: Path) -> SweepStatus:
    """How many cases of the sweep in a folder are done, have failed and are left. WavesymError where there is none."""
    from wavesym.sweeps.status import status

    return status(folder)


def sweep_table(folder: Path, path: Path) -> None:
    """Write the results of a sweep as .csv or .parquet, a row for each case."""
    from wavesym.sweeps.table import write_table

    write_table(folder, path)


def sweep_report(folder: Path, path: Path) -> None:
    """Write what the sweep in a folder came to as one page of HTML. WavesymError where there is no sweep."""
    from wavesym.pictures.page.sweep import sweep_page
    from wavesym.writing import write_whole

    write_whole({path: sweep_page(folder)})


# Verdicts -----------------------------------------------------------------------------------------------------------


def verify(
    scenes: Scene | Iterable[Scene],
    evaluator: str | None = None,
    precision: str | None = None,
    runtime: Sequence[str] = (),
    *,
    stream: bool = False,
) -> tuple[str, bool]:
    """Compare programs of scenes with direct integration of what the scenes state, and with exact values.

    Args:
        scenes: each is verified by itself.
        evaluator: "auto", "closed", "pieces", "march" or "modes".
        precision: "double" or "single".
        runtime: names of parameters that come at run time.
        stream: whether loads come sample by sample.
            Without any of these four every program that serves a scene is compared, else those that are meant.

    Returns:
        Tables of errors, and whether all of them are allowed and every output of every scene was seen.

    Raises:
        WavesymError: for a word that there is not, or options that exclude each other.

    >>> import wavesym
    >>> text, passed = wavesym.verify(wavesym.Scene.from_toml("drive_m1"), "march")
    >>> passed
    True
    """
    from wavesym.verification.report import verify as report

    each = [scenes] if isinstance(scenes, Scene) else scenes
    kinds = [evaluator] if evaluator else ["auto"] if runtime or stream else KINDS
    requests = [
        Request.checked(evaluator=kind, precision=precision or "double", runtime=tuple(runtime), stream=stream)
        for kind in kinds
    ]
    some = any((evaluator, precision, runtime, stream))
    return report(((scene, lower(scene)) for scene in each), requests if some else None)


def derived(watch: Callable[[list[System]], Iterable[System]] = iter) -> tuple[str, bool]:
    """The proofs of the derivation and other routes to its tables, with their arguments, and whether all of them hold.

    `watch` goes through the systems as they are proved.
    """
    from wavesym.verification.derived import derived as report

    return report(watch)


def published(
    format: str = "text",
    names: Sequence[str] = (),
    reproduce: bool = False,
    watch: Callable[[Sequence[PaperEntry]], Iterable[PaperEntry]] = iter,
    only: str = "",
) -> tuple[str, bool]:
    """A verdict on every formula of the paper, or on some.

    Args:
        format: "text", "json", "markdown", "html" or "latex".
        names: ids of formulas, tables or sections; empty for all.
        reproduce: whether each counterexample comes with a scene that shows it.
        watch: goes through the records as they are judged.
        only: a verdict ("misprint"): no other records are shown.

    Returns:
        The text, and whether all could be tested.

    Raises:
        WavesymError: for a name that the paper does not have, and a verdict that there is not.
    """
    from wavesym.papers.published import published as report

    return report(names, format, reproduce, watch, only)


def advise(scene: Scene, tolerance: float = 0.01) -> Advice:
    """Which model of a scene is enough: massless springs, consistent mass or waves.

    Args:
        scene: what is compared, over its horizon.
        tolerance: what histories may differ by, relative to the largest value of each output.

    Returns:
        `enough`, and the differences of each model in each output; `text()` and `json()` write them.

    Raises:
        WavesymError: for a tolerance that is not between 0 and 1.
        ToleranceError, CostError: where nothing could be generated either.
    """
    from wavesym.methods.advice import advise as advice

    if not 0 < tolerance < 1:
        raise WavesymError(f"--tolerance: {tolerance:g} is not between 0 and 1; write 0.01 for one percent")
    return advice(lower(scene), tolerance)
