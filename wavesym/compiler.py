"""wavesym in one view: each stage takes one frozen value and gives the next.

    stage     call                       takes             gives                             room
    -------   ------------------------   ---------------   -------------------------------   --------------------
    read      Scene.from_toml            TOML              Scene: what the user said         scene/, systems/
    lower     lower                      Scene             Model: exact, nodes and loads     scene/ -> mechanics/
    derive    node_law, recurrence       nodes, a system   laws of coefficients              derivation/   SymPy
    run       full_table, signals, ...   Model, laws       tables, waves, reference values   exact/
    choose    make                       Model             Program: tables and bounds        programs/
    write     files                      Program           C, NumPy, manifest                targets/

A way through is a short function below, which calls these in order; tables, programs and reference values ask for the
laws they need themselves. What people read of it is written by documents/, results/ and report/, what is checked by
verification/ and papers/, what is measured by lab/. The heavy libraries load when a way needs them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesym.difference import Difference
from wavesym.documents.summary import summary_text as told
from wavesym.documents.tables import symbolic_lines, table_lines
from wavesym.errors import SceneError, UnservedError, WavesymError
from wavesym.exact.network_table import NetworkTable, network_table
from wavesym.exact.rate_letters import in_rates
from wavesym.exact.symbolic_cost import refuse_costly
from wavesym.exact.table import Row, Table, full_table
from wavesym.fields.loads import SampledLoad
from wavesym.fields.table import shown
from wavesym.mechanics.symbolic import generic, symbolic
from wavesym.numbers.doubles import fraction, nearest, rational
from wavesym.programs.making import make
from wavesym.programs.request import Request, refuse_unknown
from wavesym.records.load import RecordedLoad
from wavesym.results.peaks import table_of_peaks
from wavesym.results.response import Response
from wavesym.results.rows import SAMPLES, csv_lines, grid
from wavesym.results.summary import Summary, summarised
from wavesym.results.unexpected import event_lines, outside, unexpected, without_load
from wavesym.running.model import RuntimeModel
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import amplitudes, drifts, sources
from wavesym.targets import LANGUAGES, SIMULATORS
from wavesym.targets.files import files, is_ours, tested
from wavesym.writing import traces, write_whole

if TYPE_CHECKING:
    from wavesym.mechanics.chain import Chain
    from wavesym.mechanics.model import Model
    from wavesym.mechanics.node import System
    from wavesym.papers.entries import PaperEntry
    from wavesym.programs.program import Program
    from wavesym.sweeps.status import SweepStatus


_UNIT = re.compile(r"[A-Za-z\u00b5\u03bc%][A-Za-z0-9_*/^%-]{0,40}")
MOST_FACTORED = 100_000  # coefficients of a symbolic table; half a millisecond each, however small


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
    if not isinstance(scene, Scene):
        raise SceneError(f"{type(scene).__name__} given, a Scene expected (Scene.from_toml reads one)")
    return Response(lower(scene))


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


def sweep(
    source: str | PathLike[str] | Mapping[str, Any],
    folder: str | PathLike[str],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    retry_failed: bool = False,
) -> Any:
    """Compute many scenes into a folder, as `wavesym sweep` does; what is there goes on where it was.

    `source` is a file of TOML or the same fields: `scene` (a Scene, or a path), `vary`, `records`, `keep`. By
    `workers` processes of this machine (in a program under `if __name__ == "__main__":`, as these import it), those of
    a Dask `scheduler`, or whoever is best. An xarray.Dataset: extremes over the varied paths, `record` and `output`,
    NaN for a case that failed. SceneError for a request that is wrong, WavesymError for the folder of another sweep.

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
    """Compute what is left of a sweep; how many of its cases have failed. `watch` is told of all cases, and of those
    that are done and were done before."""
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


def tables(scene: Scene, intervals: int | None = None) -> list[Row]:
    """The rows of the coefficient table, exact: `intervals` of every function, or those the horizon needs.

    A row is one term: in the interval that it names, the derivative of the wave function gains
    value * exp(-rate * w) * w**power. Of a chain that is written out `interval` is the tau at which the wave leaves its
    end of the rod. UnservedError for a chain that has contacts, or a node whose polynomial does not split.

    >>> import wavesym
    >>> row = wavesym.tables(wavesym.Scene.from_toml("building_m2"), intervals=1)[0]
    >>> row.function, row.rod, row.source, row.interval, row.rate, row.power, row.value
    ('f', 1, 'a', 1, Fraction(0, 1), 0, Fraction(-4, 1))
    """
    rows = table(scene, intervals).rows()
    return [
        row._replace(
            interval=row.interval if isinstance(row.interval, int) else fraction(row.interval),
            rate=fraction(row.rate),
            value=fraction(row.value),
        )
        for row in rows
    ]


def table(scene: Scene, intervals: int | None = None) -> Table | NetworkTable:
    """The unit responses of all sources of the scene's system."""
    model = lower(scene)
    model.refuse_damping()
    until = rational(model.horizon())
    if model.chain is None:
        return network_table(model.network, intervals, until)
    return full_table(model.chain, intervals, until)


def tables_text(scene: Scene, intervals: int | None, format: str) -> Iterator[str]:
    """The table as csv, json or latex, line by line."""
    return table_lines(table(scene, intervals), scene.name, format)


def symbolic_tables_text(scene: Scene, intervals: int | None, format: str) -> tuple[list[str], Iterator[str]]:
    """The table as rational functions of the parameters, csv or json, after what the symbols stand for, line by line.

    Parameters and rates that are equal in the scene are equal in the table. CostError where it would be absurd.
    """
    model = lower(scene)
    model.refuse_damping()
    symbols = in_rates(symbolic(_named(model, "--symbolic", "tables")))
    until = rational(model.horizon())
    refuse_costly(symbols.chain, intervals, until)
    made = full_table(symbols.chain, intervals, until, most=MOST_FACTORED)
    merged = [f"{name} = {ratio}" for name, ratio in symbols.meaning.items() if str(ratio) != name]
    return merged, symbolic_lines(made, symbols, scene.name, format)


def inspect(scene: Scene, stage: str | None = None, format: str = "text") -> str:
    """What a stage makes of a scene, or a summary of all of them, as text or json; refusals are part of it.

    `stage` is "scene", "model", "laws", "table" or "program".
    """
    from wavesym.documents.inspection.document import SUMMARY, inspection

    return inspection(scene, stage or SUMMARY, format)


def derive(source: str | Scene, m: int | None, format: str = "text") -> str:
    """The derivation of "collision", "drive" or "building" (both bases), or of a scene, as text, latex or json.

    With m, every line is written out; a scene has its own. Of a chain that is written out it is the law of each kind of
    node. WavesymError for an m that the system does not have.
    """
    from wavesym.documents.derivation.document import derivation, network_derivation, scene_derivation

    if isinstance(source, str):
        return derivation(source, m, format)
    model = lower(source)
    model.refuse_damping()
    if model.chain is None:
        return network_derivation(model, format)
    return scene_derivation(source.name, symbolic(model.chain), format)


def walks(source: str | Scene, m: int | None, intervals: int, format: str = "text") -> str:
    """The walk polynomials of `derive`'s systems with m elastic elements, or of a scene, as text, latex or json.

    WavesymError for an m that the system does not have; CostError where the polynomials would be absurd.
    """
    from wavesym.documents.derivation.statement import systems
    from wavesym.documents.walks import walk_polynomials

    if isinstance(source, str):
        assert m is not None  # polynomials are those of one chain
        return walk_polynomials((generic(system, m) for system in systems(source, m)), intervals, format)
    return walk_polynomials([symbolic(_named(lower(source), "--walks", "derive"))], intervals, format)


def _named(model: Model, option: str, command: str) -> Chain:
    """The chain as the paper has it. UnservedError where it is written out."""
    model.refuse_damping()
    if model.chain is None:
        raise UnservedError(
            f"system.type: {model.labels.type} given with {option}, collision, drive or building expected "
            f"(`{command}` without {option} serves a chain)"
        )
    return model.chain


def generate(
    scene: Scene,
    directory: str | Path | None = None,
    language: str = "c",
    evaluator: str = "auto",
    precision: str = "double",
    windows: int | None = None,
    optimize: str | None = None,
    runtime: Sequence[str] = (),
    *,
    stream: bool = False,
    step: Fraction | None = None,
    package: bool = False,
    target: str = "",
    force: bool = False,
) -> tuple[Path, ...]:
    """Write the files of a scene into `directory` (default ./NAME), all or none; the paths written.

    `windows`: a march is to be driven by hand for so many, under loads that are given while it runs. `optimize` is for
    "speed" (usual in double precision) or for "size" (usual in single). `runtime` names parameters that C takes when it
    runs: "kappa", "inertia", "velocity", "load". A `stream` takes the loads sample by sample, at any time, or best at
    multiples of `step`, in tau. `package` adds what CMake builds, tests and installs C with. `target` "fmu2" or "fmu3"
    makes one file, NAME.fmu, a stream for simulators; CompilerError without a C compiler. Files that wavesym did not
    write are replaced only by `force`; WavesymError else, and for a language, evaluator, precision or aim that there is
    not.

    >>> import wavesym
    >>> for path in wavesym.generate(wavesym.Scene.from_toml("drive_m1"), "drive", language="numpy"):
    ...     print(path.as_posix())
    drive/drive_m1.json
    drive/drive_m1.py
    """
    request = _request(evaluator, precision, windows, optimize, runtime, stream, step, target)
    made: Mapping[Path, str | bytes]
    if target:
        made = {Path(directory or scene.name) / f"{scene.name}.fmu": _fmu(scene, language, request, package)}
    else:
        made = _written(scene, directory, language, request, package)
    for path in made:
        if not force and path.is_file() and not is_ours(path):
            raise WavesymError(f"{path}: exists and was not written by wavesym; --force replaces it")
    write_whole(made)
    return tuple(made)


def check(
    scene: Scene,
    directory: str | Path | None = None,
    language: str = "c",
    evaluator: str = "auto",
    precision: str = "double",
    windows: int | None = None,
    optimize: str | None = None,
    source: str = "SCENE",
    runtime: Sequence[str] = (),
    *,
    stream: bool = False,
    step: Fraction | None = None,
    package: bool = False,
) -> str:
    """The difference between what stands in `directory` and what `generate` would write; empty where there is none.

    Each file that is changed, missing or orphaned is named, with a diff; so is what a process that was killed left. The
    last line is the command that mends them, with the scene as it is given by `source`.
    """
    request = _request(evaluator, precision, windows, optimize, runtime, stream, step)
    made = _written(scene, directory, language, request, package)
    folder = Path(directory or scene.name)
    found = [path for path in folder.glob(f"{scene.name}*") if path.is_file()]
    left = [path for path, place in traces(folder) if place.name.startswith(scene.name)]
    difference = Difference(made, [*found, *left])
    options = ["--language", language, *request.options.split(), *(["--package"] if package else [])]
    return difference.report(["wavesym", "generate", source, "-o", str(folder), *options])


def _request(
    evaluator: str,
    precision: str,
    windows: int | None,
    optimize: str | None,
    runtime: Sequence[str],
    stream: bool,
    step: Fraction | None,
    target: str = "",
) -> Request:
    """The options of `generate` as one value. WavesymError for a step without a stream."""
    stream = stream or bool(target)
    if step is not None and not stream:
        raise WavesymError(f"--step: {step} given without --stream, nothing expected")
    if step is not None and evaluator == "modes":
        raise WavesymError(f"--step: {step} given with --evaluator modes, nothing expected (loads say what it is)")
    every = None if step is None else rational(step)
    return Request(evaluator, precision, windows, optimize, tuple(runtime), stream, every, target)


def _written(
    scene: Scene, directory: str | Path | None, language: str, request: Request, package: bool
) -> dict[Path, str]:
    """The text of every file of a scene, by path."""
    folder = Path(directory or scene.name)
    refuse_unknown("language", language, LANGUAGES)
    request.refuse_unknown()
    if package and language not in ("c", "all"):
        raise WavesymError(f"package: language {language} given, c or all expected, since CMake builds C")
    model = lower(scene)
    if request.stream and request.evaluator != "modes":
        if language != "c":
            raise WavesymError(f"language: {language} given with --stream, c expected")
        program = stream_program(scene, request, tested=True)
    elif request.runtime:
        from wavesym.programs.runtime.making import runtime_program

        if language != "c":
            raise WavesymError(f"language: {language} given with --runtime, c expected")
        given = amplitudes(scene) if "load" in request.runtime else ()
        program = runtime_program(model, request, given, tested=True)
    else:
        program = make(model, request, tested=tested(language))
    return {folder / name: text for name, text in files(program, language, packaged=package).items()}


def _fmu(scene: Scene, language: str, request: Request, package: bool) -> bytes:
    """A scene's stream for simulators: of modes where they are damped or asked for, else of waves."""
    from wavesym.running.fmu import fmu

    refuse_unknown("target", request.target, SIMULATORS)
    for option, given, usual in (
        ("language", language, "c"),
        ("precision", request.precision, "double"),
        ("package", str(package), "False"),
    ):
        if given != usual:
            raise WavesymError(f"{option}: {given} given with --target, {usual or 'nothing'} expected")
    model = lower(scene)
    if request.evaluator != "modes" and (model.damping is None or request.evaluator != "auto"):
        return fmu(stream_program(scene, request), request.target)
    if request.runtime:
        raise WavesymError(f"runtime: {','.join(request.runtime)} given with modes and --target, nothing expected")
    if request.step is not None:
        raise WavesymError(f"--step: {request.step} given with modes, nothing expected (loads say what it is)")
    if not scene.load:
        raise UnservedError("load: none given with modes and --target, at least one expected (it is an input)")
    return fmu(make(model, replace(request, evaluator="modes")), request.target)


def fmu_told(path: Path) -> list[str]:
    """What to say of an FMU that was made."""
    from wavesym.running.fmu import told

    return told(path)


def model(scene: Scene, runtime: Sequence[str]) -> RuntimeModel:
    """A scene whose parameters are given when it runs, for one set of them or for a million.

    `runtime` names them: "kappa", "inertia", "velocity", "load", or of a chain that is written out "mass", "dashpot",
    "spring", "impedance", "velocity", "load", those that the scene has. It is compiled once, where there is a C
    compiler; elsewhere NumPy computes the same, more slowly, but not for such chains (CompilerError). WavesymError for
    a scene that has not got these parameters, UnservedError and CostError for one that no such program serves.

    >>> import wavesym
    >>> model = wavesym.model(wavesym.Scene.from_toml("drive_m1"), runtime=["kappa"])
    >>> model.run(kappa=[[0.5], [1], [2]], tau=[2.0, 4.0]).shape  # sets, outputs, then the shape of tau
    (3, 5, 2)
    >>> model.peaks(kappa=[[0.5], [1], [2]]).max.shape
    (3, 5)
    """
    from wavesym.programs.runtime.making import runtime_program

    given = amplitudes(scene) if "load" in runtime else ()
    return RuntimeModel(runtime_program(lower(scene), Request(runtime=tuple(runtime)), given))


def stream_program(scene: Scene, request: Request, *, tested: bool = False) -> Program:
    """The program of a scene whose loads are given while it runs; its sources are the inputs, in order."""
    from wavesym.programs.stream import making
    from wavesym.programs.stream.plan import inputs_of

    model = replace(lower(scene), endless=True)
    return making.stream_program(model, request, inputs_of(model, sources(scene)), tested=tested)


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


def warnings(scene: Scene) -> list[str]:
    """What a user might not expect: no load, contacts that open early enough to matter."""
    return unexpected(lower(scene))


def no_load(scene: Scene) -> list[str]:
    """A line for a scene in which nothing happens."""
    return without_load(lower(scene))


def plot(scene: Scene, path: Path, kind: str = "history") -> list[str]:
    """Draw a scene as .svg, .png or .pdf; what the picture leaves out, line by line.

    `kind`: "history", the outputs over time; "xt", place x time of all rods; "envelope", the least and greatest along
    the chain; "map", place x time as colours, for long horizons. SceneError for another suffix, before the work;
    ToleranceError, CostError where nothing could be generated either.
    """
    from wavesym.report.saving import picture_format, save

    picture_format(path)
    if kind == "xt":
        from wavesym.report import xt

        save(xt.draw(lower(scene), scene.system.lines, scene.physical), path)
        return []
    if kind in ("envelope", "map"):
        from wavesym.report import envelope, heatmap
        from wavesym.report.along import along

        found = along(scene)
        if kind == "envelope":
            save(envelope.draw(lower(scene), found), path)
        else:
            from wavesym.report.loads import load_histories

            model = lower(scene)
            save(heatmap.draw(model, found, load_histories(model, scene.scale)), path)
        return []
    from wavesym.report.groups import notes
    from wavesym.report.histories import histories
    from wavesym.report.loads import load_histories
    from wavesym.report.panels import draw

    model = lower(scene)
    made = histories(model)
    save(draw(made, load_histories(model, scene.scale)), path)
    return notes(made)


def report(scene: Scene, path: Path) -> None:
    """Write a scene, and what happens in it, as one page of HTML.

    ToleranceError, CostError where nothing could be generated either.
    """
    from wavesym.report.page.document import page

    write_whole({path: page(scene)})


def sweep_report(folder: Path, path: Path) -> None:
    """Write what the sweep in a folder came to as one page of HTML. WavesymError where there is no sweep."""
    from wavesym.report.page.sweep import sweep_page

    write_whole({path: sweep_page(folder)})


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


def advise(scene: Scene, tolerance: float = 0.01, format: str = "text") -> str:
    """Which model of a scene is enough, massless springs, consistent mass or waves, as text or json.

    WavesymError for a tolerance that is not between 0 and 1; ToleranceError, CostError where nothing could be generated
    either.
    """
    from wavesym.rivals.advice import advise as advice

    if not 0 < tolerance < 1:
        raise WavesymError(f"--tolerance: {tolerance:g} given, a number between 0 and 1 expected")
    found = advice(lower(scene), tolerance)
    return found.json() if format == "json" else found.text()


def record(path: Path, unit: str | None, column: str | None = None, picture: Path | None = None) -> list[str]:
    """What a file of a record says, line by line; drawn too, where there is a path for it.

    `unit` is that of the samples where the file says none, `column` that of a CSV with several. SceneError for a file
    that is damaged or says another unit, and for a picture with another suffix; WavesymError for what is no unit.
    """
    from wavesym.documents.record import facts
    from wavesym.records.read import read_record

    if unit is not None and not _UNIT.fullmatch(unit):
        raise WavesymError(f"--unit: {shown(unit)} given, a unit such as g or m/s^2 expected")
    said = read_record(path, column)
    if unit is not None and said.unit not in ("", unit):
        raise SceneError(f"--unit {unit} given, {said.unit} expected, as in the file, or none", file=said.file)
    lines = facts(said, unit or said.unit)
    if picture is not None:
        from wavesym.report.record import draw
        from wavesym.report.saving import picture_format, save

        picture_format(picture)
        save(draw(said, unit or said.unit), picture)
    return lines


def verify(scenes: Iterable[Scene]) -> tuple[str, bool]:
    """Evaluators against direct integration: a table of errors, and whether all of them are allowed."""
    from wavesym.verification.report import verify as report

    return report(map(lower, scenes))


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
) -> tuple[str, bool]:
    """A verdict on every formula of the paper, or on those that `names` ask for, and whether all could be tested.

    As text, json, markdown, html or latex; `reproduce` adds a scene that shows each counterexample. `watch` goes
    through the records as they are judged. WavesymError for a name that the paper does not have.
    """
    from wavesym.papers.published import published as report

    return report(names, format, reproduce, watch)
