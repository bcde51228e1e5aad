"""Ways to files: C, NumPy and FMUs, written or compared with what is there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from wavesym.difference import Difference
from wavesym.errors import UnservedError, WavesymError
from wavesym.numbers.doubles import rational
from wavesym.programs.making import make
from wavesym.programs.request import Request, refuse_unknown
from wavesym.results.unexpected import without_load
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import amplitudes, sources
from wavesym.targets import LANGUAGES, SIMULATORS
from wavesym.targets.files import files, is_ours, tested
from wavesym.writing import traces, write_whole

if TYPE_CHECKING:
    from wavesym.programs.program import Program


def generate(
    scene: Scene,
    directory: str | Path | None = None,
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
    """Write the files of a scene into `directory` (default ./NAME), all or none; the paths written.

    `optimize` is for "speed" (usual in double precision) or for "size" (usual in single). `runtime` names
    parameters that C takes when it runs: "kappa", "inertia", "velocity", "load"; `parts` are what it has then
    besides values and the estimate of their errors: "peaks", "gradients", "batch", "misfit", "bound". `kappa_max`
    is the largest kappa that it is made for (ten times the scene's own), in a general chain the largest rate of a
    joint. A `stream` takes the loads sample by sample, at any time, or best at multiples of `step`, in tau, and
    `runtime` when it starts. `package` adds what CMake builds, tests and installs C with. `target` "fmu2" or "fmu3"
    makes one file, NAME.fmu, a stream for simulators, whose parameters are `runtime`, or all of a named system;
    CompilerError without a C compiler. Files that wavesym did not write are replaced only by `force`; WavesymError
    else, and for a language, evaluator, precision, aim or part that there is not.

    >>> import wavesym
    >>> for path in wavesym.generate(wavesym.Scene.from_toml("drive_m1"), "drive", language="numpy"):
    ...     print(path.as_posix())
    drive/drive_m1.json
    drive/drive_m1.py
    """
    runtime_options = tuple(runtime), tuple(parts), kappa_max
    request = _request(evaluator, precision, optimize, *runtime_options, stream, step, target)
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
    optimize: str | None = None,
    source: str = "SCENE",
    runtime: Sequence[str] = (),
    *,
    parts: Sequence[str] = (),
    kappa_max: Fraction | None = None,
    stream: bool = False,
    step: Fraction | None = None,
    package: bool = False,
) -> str:
    """The difference between what stands in `directory` and what `generate` would write; empty where there is none.

    Each file that is changed, missing or orphaned is named, with a diff; so is what a process that was killed left. The
    last line is the command that mends them, with the scene as it is given by `source`.
    """
    runtime_options = tuple(runtime), tuple(parts), kappa_max
    request = _request(evaluator, precision, optimize, *runtime_options, stream, step)
    made = _written(scene, directory, language, request, package)
    folder = Path(directory or scene.name)
    found = [path for path in {*folder.glob(f"{scene.name}*"), *made} if path.is_file()]
    left = [path for path, place in traces(folder) if place.name.startswith(scene.name)]
    difference = Difference(made, [*found, *left])
    options = ["--language", language, *request.options.split(), *(["--package"] if package else [])]
    return difference.report(["wavesym", "generate", source, "-o", str(folder), *options])


def _request(
    evaluator: str,
    precision: str,
    optimize: str | None,
    runtime: tuple[str, ...],
    parts: tuple[str, ...],
    kappa_max: Fraction | None,
    stream: bool,
    step: Fraction | None,
    target: str = "",
) -> Request:
    """The options of `generate` as one value. WavesymError for a step without a stream, and a kappa that is none."""
    stream = stream or bool(target)
    if step is not None and not stream:
        raise WavesymError(f"--step: {step} given without --stream, nothing expected")
    if step is not None and evaluator == "modes":
        raise WavesymError(f"--step: {step} given with --evaluator modes, nothing expected (loads say what it is)")
    if kappa_max is not None and kappa_max <= 0:
        raise WavesymError(f"--kappa-max: {kappa_max} given, a positive number expected")
    every, largest = (None if number is None else rational(number) for number in (step, kappa_max))
    return Request(evaluator, precision, optimize, runtime, stream, every, target, parts, largest)


def _written(
    scene: Scene, directory: str | Path | None, language: str, request: Request, package: bool
) -> dict[Path, str]:
    """The text of every file of a scene, by path."""
    refuse_unknown("language", language, LANGUAGES)
    request.refuse_unknown()
    if package and language not in ("c", "all"):
        raise WavesymError(f"language: {language} given with --package, c or all expected, since CMake builds C")
    model = lower(scene)
    folder = Path(directory or model.name)
    if request.stream and request.evaluator != "modes":
        if language != "c":
            raise WavesymError(f"language: {language} given with --stream, c expected")
        program = stream_program(scene, request, tested=True)
    elif request.runtime:
        from wavesym.programs.runtime.making import runtime_program
        from wavesym.programs.runtime.request import POSITIVE

        if language != "c":
            raise WavesymError(f"language: {language} given with --runtime, c expected")
        if request.kappa_max is not None and POSITIVE.isdisjoint(request.runtime):
            told = f"--kappa-max: {request.kappa_max} given with --runtime {','.join(request.runtime)}"
            raise WavesymError(f"{told}, nothing expected (bodies stay as heavy as they are)")
        given = amplitudes(scene) if "load" in request.runtime else ()
        program = runtime_program(model, request, given, tested=True)
    else:
        program = make(model, request, tested=tested(language))
    return {folder / name: text for name, text in files(program, language, packaged=package).items()}


def _fmu(scene: Scene, language: str, request: Request, package: bool) -> bytes:
    """A scene's stream for simulators: of modes where they are damped or asked for, else of waves."""
    from wavesym.running.fmu import fmu

    refuse_unknown("target", request.target, SIMULATORS)
    request.refuse_unknown()
    for option, given, usual in (
        ("language", language, "c"),
        ("precision", request.precision, "double"),
        ("--package", "True" if package else "", ""),
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


def notes(scene: Scene) -> list[str]:
    """How the scene was read where that may surprise, and a line for a scene in which nothing happens."""
    model = lower(scene)
    return [*model.labels.notes, *without_load(model)]


def stream_program(scene: Scene, request: Request, *, tested: bool = False) -> Program:
    """The program of a scene whose loads are given while it runs; its sources are the inputs, in order."""
    from wavesym.programs.stream import making
    from wavesym.programs.stream.plan import inputs_of

    model = replace(lower(scene), endless=True)
    return making.stream_program(model, request, inputs_of(model, sources(scene)), tested=tested)
