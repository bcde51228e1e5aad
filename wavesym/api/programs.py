"""Programs of a scene: made from one `Request`, written to files, compared with what stands there, run from Python."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from os import PathLike
from pathlib import Path
from shlex import split
from typing import TYPE_CHECKING

from wavesym.errors import UnservedError, WavesymError
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import amplitudes, lower_rising, sources

if TYPE_CHECKING:
    from wavesym.mechanics.loads import AppliedLoad
    from wavesym.mechanics.model import Model
    from wavesym.programs.program import Program
    from wavesym.running.model import RuntimeModel


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
    lowered = lower(scene)
    if request.runtime or request.stream or request.target or request.evaluator == "modes":
        scene = scene.in_lines  # all of these take loads sample by sample
        lowered = lower(scene)
    if request.runtime and request.is_of_mode_sets(lowered):
        from wavesym.programs.mode_sets.making import mode_sets_program

        return mode_sets_program(lowered, request, _varied_loads(scene, request.runtime), tested=tested)
    if request.is_of_modes(lowered):
        return _stepped_modes(scene, lowered, request, tested)
    if request.stream:
        from wavesym.programs.stream.making import stream_program
        from wavesym.programs.stream.plan import inputs_of

        endless = replace(lowered, endless=True)
        return stream_program(endless, request, inputs_of(endless, sources(scene)), tested=tested)
    if request.runtime:
        from wavesym.programs.runtime.making import runtime_program

        return runtime_program(lowered, request, _varied_loads(scene, request.runtime), tested=tested)
    from wavesym.programs.making import make

    return make(lowered, request, tested=tested)


def _varied_loads(scene: Scene, runtime: Sequence[str]) -> tuple[tuple[str, AppliedLoad], ...]:
    """The numbers of the loads, with their labels, where they are parameters at run time."""
    return amplitudes(scene) if "load" in runtime else ()


def _stepped_modes(scene: Scene, lowered: Model, request: Request, tested: bool) -> Program:
    """A stream that modes step, under the loads of the scene, or a rise of each within the `step` that is requested."""
    from wavesym.numbers.doubles import fraction
    from wavesym.programs.making import make

    if not scene.load and (request.target or request.step is not None):
        raise UnservedError("load: none, and it is the input of a stream of modes; write at least one [[load]]")
    if request.step is not None:
        lowered = lower_rising(scene, fraction(request.step))
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
    request = Request.from_options(
        evaluator=evaluator,
        precision=precision,
        optimize=optimize,
        runtime=tuple(runtime),
        parts=tuple(parts),
        kappa_max=kappa_max,
        stream=stream,
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
    typed = split(request.options(lower(scene)))
    options = ["--language", request.language, *typed, *(["--package"] if request.package else [])]
    return Difference(made, [*found, *left]).report(["wavesym", "generate", source, "-o", str(folder), *options])


def _files(scene: Scene, directory: str | PathLike[str] | None, request: Request) -> dict[Path, str | bytes]:
    """The content of every file of a scene, by path."""
    from wavesym.targets.files import files, has_selftest, refuse_shadows

    refuse_shadows(lower(scene).name, "" if request.target else request.language)
    made = program(scene, request, tested=not request.target and has_selftest(request.language))
    folder = Path(directory or scene.name)
    if request.target:
        from wavesym.running.fmu import fmu

        return {folder / f"{scene.name}.fmu": fmu(made, request.target)}
    texts = files(made, request.language, packaged=request.package)
    return {folder / name: text for name, text in texts.items()}


def model(scene: Scene, runtime: Sequence[str]) -> RuntimeModel:
    """A scene whose parameters are given when it runs, for one set of them or for a million.

    Args:
        scene: what to compute.
        runtime: names of the parameters: "kappa", "inertia", "velocity", "load", or of a general chain "mass",
            "dashpot", "spring", "impedance", "velocity", "load", those that the scene has. Where modes are damped, or
            where one of the first three is named: "stiffness" (of rods and springs, N/m with units), "rod_mass",
            "damping" (ratios), "mass" (kg), "load".

    Returns:
        What has `run`, `peaks`, `gradients`, `misfit` and `bounds`, compiled when they are first asked for.

    Raises:
        CompilerError: where there is no C compiler: the extra `compiler` brings one.
        WavesymError: for a scene that has not got these parameters.
        UnservedError, CostError: for one that no such program serves.
        ToleranceError: where modes do not serve the scene's own numbers to its tolerance.

    >>> import wavesym
    >>> model = wavesym.model(wavesym.Scene.from_toml("drive_m1"), runtime=["kappa"])
    >>> model.run(kappa=[[0.5], [1], [2]], tau=[2.0, 4.0]).shape  # sets, outputs, then the shape of tau
    (3, 5, 2)
    >>> model.peaks(kappa=[[0.5], [1], [2]]).max.shape
    (3, 5)
    """
    from wavesym.programs.mode_sets.parameters import mode_parameters
    from wavesym.programs.runtime.making import sets_program
    from wavesym.running.model import RuntimeModel, compiled_model

    if isinstance(runtime, str):
        raise WavesymError(f'runtime: "{runtime}" is not a list of names; write ["{runtime}"]')
    scene = scene.in_lines if isinstance(scene, Scene) else scene  # which is refused in a line
    lowered, loads = lower(scene), _varied_loads(scene, runtime)
    if not Request(runtime=tuple(runtime)).is_of_mode_sets(lowered):
        return compiled_model(sets_program(lowered, runtime, loads))
    from wavesym.running.mode_sets import ModalSets

    return RuntimeModel(ModalSets(mode_parameters(lowered, runtime, loads)))


def fmu_notes(path: Path) -> list[str]:
    """What to know of an FMU that was made."""
    from wavesym.running.fmu import describe_fmu

    return describe_fmu(path)
