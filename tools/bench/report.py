"""The page that `make bench` writes: measured in one run, single thread, as ratios to the write floor."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np

from tools.bench import (
    corners,
    frame_records,
    frames,
    many_sets,
    panels,
    parameters,
    record_response,
    streaming,
    sweeps,
    vibration,
)
from tools.bench.commands import ran
from tools.bench.equal_degree import FittedPieces, at_degree, fit_pieces, ratios
from tools.bench.harness import CALLS, EVERY, SAMPLES, chosen_compiler, compilers, many, one_by_one, peak
from wavesym.lab.floor import floor
from wavesym.lab.timing import least, medians
from wavesym.numbers.doubles import rational
from wavesym.programs.choice import choose
from wavesym.programs.making import make
from wavesym.programs.piece_grid import Pieces
from wavesym.programs.request import Request
from wavesym.running.compilation import import_text
from wavesym.running.native import FAST
from wavesym.scene import Scene, lower
from wavesym.targets.files import files

NAMED = "BDC"
"""Of the paper's systems."""

COUNTS = (300, 1001, SAMPLES)
"""Of samples: runs are short with few of them, and with many all time goes into polynomials."""

CHAINS = "LSE"
"""Written out: three lengths, a spring, contact events."""


def scene(name: str, until: float, system: dict[str, Any], load: Sequence[dict[str, Any]], **output: Any) -> Scene:
    """A scene from its parts."""
    return Scene(name=name, system=system, load=list(load), output={"until": until, **output})


def scenes(folder: Path, labels: str) -> dict[str, Scene]:
    """The scenes that the figures are for."""
    return {label: Scene.from_toml(folder / f"{label.lower()}.toml") for label in labels}


def report(folder: Path) -> Iterator[str]:
    """The whole report on the scenes in `folder`, line by line."""
    named, chains = scenes(folder, NAMED), scenes(folder, CHAINS)
    yield "# Benchmarks"
    yield ""
    yield "Made by `make bench`; times are medians of interleaved rounds in one process, single thread."
    yield ""
    yield from _machine()
    yield ""
    yield from _values(named, chains)
    yield ""
    yield from _set_up(folder)
    yield ""
    yield from _records(folder)
    yield ""
    yield from corner_figures(folder.parent / "examples" / "corners")
    yield ""
    yield "## Charts"
    yield ""
    yield "Time a sample against largest error, by `wavesym chart`, with other methods; the numbers are in the CSVs."
    yield ""
    for label, scene in scenes(folder, "bdclr").items():
        yield f"![{scene.system.type}: time a value over largest error, of wavesym and others]({label}.svg)"
    yield ""
    yield "## Growth"
    yield ""
    yield "Fitted exponents of the time to choose and fit the pieces, and of the bytes of their tables."
    yield ""
    yield from _table(("against", "range", "time", "bytes"), _growth())


def _values(named: dict[str, Scene], chains: dict[str, Scene]) -> Iterator[str]:
    """What values take once a program is there."""
    yield "## Evaluating"
    yield ""
    yield f"{SAMPLES} uniform samples, proved bound 1e-14. ns a double; *ratio* is that of `sample` to the write floor,"
    yield "*of FMA peak* what polynomials need, one multiplication with an addition a degree, of what a core can do."
    yield ""
    yield from _table(
        ("scene", "compiler", "flags", "floor", "sample", "ratio", "of FMA peak", "eval, random", "NumPy", "bound"),
        _evaluating({**named, **chains}),
    )
    yield ""
    yield "## Few samples and many"
    yield ""
    yield "`sample` and the write floor, each the best of many turns, for so many samples of each output."
    yield ""
    yield from _table(
        ("scene", "compiler", "flags", *(f"{count}, ns" for count in COUNTS), *(f"{count}, ratio" for count in COUNTS)),
        _sampling(named),
    )
    yield ""
    yield "## Chains against the collision"
    yield ""
    yield "Time a value, over that of C at the same degree: with as many samples, and with as many on a piece. A chain"
    yield "has more pieces where fronts come more often."
    yield ""
    yield from _table(
        ("scene", "compiler", "flags", "degree", "that of C", "pieces", "those of C", "ratio", "at as many on a piece"),
        _at_equal_degree(named["C"], chains),
    )


def _set_up(folder: Path) -> Iterator[str]:
    """What it takes until values can be had: generation, and models of new parameters."""
    yield "## Generating"
    yield ""
    yield from _table(("what", "wall s", "peak MB", "evaluator"), _generating(folder))
    yield ""
    yield "Of scenes that come with wavesym, in turns with `python -c 'import sympy, numpy'`: wall time, and beyond it."
    yield ""
    yield from _table(("what", "wall s", "beyond"), _beyond_imports())
    yield ""
    yield "## Parameters at run time"
    yield ""
    yield f"From kappa to {parameters.SAMPLES} samples of all outputs, tolerance 1e-12, nothing left out but compiling."
    yield "*By hand*: characteristics with exponential integration of order 4, written for the scene alone; C with"
    yield f"`{' '.join(FAST)}`."
    yield ""
    yield from _table(
        ("scene", "way", "us to coefficients", "us to samples", "error", "estimate", "proved bound"),
        parameters.rows(folder),
    )
    yield ""
    yield from _table(("many sets", "how fast"), parameters.many_rows(folder))


def _records(folder: Path) -> Iterator[str]:
    """Records, one and many, streams, and sweeps."""
    yield "## A record"
    yield ""
    samples = record_response.SAMPLES
    yield f"Ten storeys, damped, 31 outputs at all {samples} samples, from the model of the scene on. Errors"
    yield "are those of the worst output, of its largest value, against modes to a thirtieth of the tolerance (1e-6)."
    yield ""
    yield from _table(("way", "s", "error"), record_response.rows())
    yield ""
    yield "## El Centro"
    yield ""
    yield "All floors of a damped steel frame: of `run`, start-up included, at all samples of the record; and of parts."
    yield ""
    yield from _table(("what", "time", "peak MB", "modes"), streaming.rows(folder.parent / "examples" / "records"))
    yield ""
    yield "## Streams"
    yield ""
    yield "Waves under loads that come step by step (`generate --stream`): steps as long as a panel, and of 0.01."
    yield ""
    yield from _table(panels.HEAD, panels.rows())
    if find_spec("zarr") and find_spec("distributed"):
        yield ""
        yield "## Sweeps"
        yield ""
        yield "Whole commands, start-up included: 5 storeys, damped, 3000 samples, true peaks of 16 outputs; a drive of"
        yield "three shafts to tau = 40, true peaks of three strains at 1e-6."
        yield ""
        yield from _table(("what", "by", "s", "busy s", "peak MB"), sweeps.rows())
        yield ""
        yield "As the drive's sweep grows, over two kappa:"
        yield ""
        yield from _table(("cases", "s", "busy s", "peak MB", "peak MB of a worker"), sweeps.growth())
        yield ""
        yield "What a sweep of records is made of; a batch is 44 of them through one structure."
        yield ""
        yield from _table(("what", "how much"), sweeps.overheads())
    yield ""
    yield "## Many sets"
    yield ""
    yield "The peaks of that drive from kappa on, compiling apart. Grids by hand are the coarsest that keep 1e-6."
    yield ""
    yield from _table(("sets", "way", "s", "sets a second", "error"), many_sets.rows(sweeps.drive()))
    yield ""
    yield from frame_figures(folder.parent / "examples" / "records")
    yield ""
    yield from vibration_figures(folder.parent / "examples" / "records")


def vibration_figures(records: Path) -> Iterator[str]:
    """Frequencies and responses: also measured alone, by `python -m tools.bench FOLDER vibration`."""
    yield vibration.TITLE
    yield ""
    yield f"Whole commands, start-up included: ten modes, none missed, and responses at {vibration.POINTS} frequencies."
    yield ""
    yield from _table(vibration.HEAD, vibration.rows(records))


def frame_figures(records: Path) -> Iterator[str]:
    """Damped frames: also measured alone, by `python -m tools.bench FOLDER frames`."""
    yield frames.TITLE
    yield ""
    yield f"Frames of {frames.STOREYS} storeys, damped, each with stiffnesses and masses of its own, under El Centro to"
    yield "1e-3: the peaks of 31 outputs by modes, compiling apart, on one core. Errors are those of eight frames."
    yield ""
    yield from _table(frames.HEAD, frames.rows(records))
    if find_spec("zarr"):
        yield ""
        yield "`wavesym sweep` of such frames, of many stiffnesses, under El Centro scaled and delayed: true peaks of"
        yield "all outputs, to 1e-5, by one process, start-up included."
        yield ""
        yield from _table(frame_records.HEAD, frame_records.rows(records))


def corner_figures(examples: Path) -> Iterator[str]:
    """Links with corners: also measured alone, by `python -m tools.bench FOLDER corners`."""
    yield corners.TITLE
    yield ""
    yield "The examples whose laws change, in seconds of processor: all events to 20 digits, `run` with 1001 samples,"
    yield f"and the C of pieces at the scene's tolerance with `{' '.join(FAST)}`."
    yield ""
    yield from _table(corners.HEAD, corners.rows(examples))
    yield ""
    yield "A block on a spring that friction holds, and a load that turns again and again:"
    yield ""
    yield from _table(corners.GROWTH_HEAD, corners.growth_rows())
    yield ""
    yield "Explicit steps for the same outputs, central differences with return mapping (NumPy), halved until the worst"
    yield "is within so much of its largest value away from fronts; too many are reckoned from the order seen."
    yield ""
    yield from _table(corners.STEPS_HEAD, corners.steps_rows(examples))


def _machine() -> Iterator[str]:
    cpu = next(
        (line.split(":", 1)[1].strip() for line in _lines("/proc/cpuinfo") if line.startswith("model name")),
        platform.processor(),
    )
    yield f"- {cpu}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}"
    yield f"- Python {platform.python_version()}, NumPy {np.__version__}"
    for compiler in compilers():
        yield f"- {compiler.version}"


def _lines(path: str) -> list[str]:
    try:
        return Path(path).read_text(encoding="utf-8").splitlines()
    except OSError:
        return []


def _table(header: Sequence[str], rows: Iterator[Sequence[str]]) -> Iterator[str]:
    yield "| " + " | ".join(header) + " |"
    yield "|" + "---|" * len(header)
    for row in rows:
        yield "| " + " | ".join(row) + " |"


def _evaluating(given: dict[str, Scene]) -> Iterator[Sequence[str]]:
    for label, each in given.items():
        made = files(make(lower(each), Request(evaluator="pieces")), "all")
        module = import_text(made[f"{each.name}.py"], each.name)
        form = choose(lower(each), "pieces").evaluator
        assert isinstance(form, Pieces)
        outputs, degree = len(each.outputs), FittedPieces(each, lower(each), form).degree
        taus = np.linspace(0.0, form.tau_max, SAMPLES)
        for compiler in compilers():
            for flags in EVERY:
                with chosen_compiler(compiler.name):
                    calls: list[Callable[[], object]] = [
                        floor(outputs, SAMPLES, CALLS, flags=flags),
                        many(each, made, flags),
                        one_by_one(each, made, flags, form.tau_max),
                        partial(module.evaluate, taus),
                        peak(compiler.name, flags),
                    ]
                low, sample, random, numpy, highest = medians(calls)
                low, sample = low / CALLS, sample / CALLS
                values = outputs * SAMPLES
                share = degree * values / sample / (64 * 10_000 / highest)
                yield (
                    label,
                    compiler.name,
                    f"`{' '.join(flags)}`",
                    *(f"{1e9 * seconds / values:.3f}" for seconds in (low, sample)),
                    f"{sample / low:.2f}",
                    f"{share:.0%}",
                    *(f"{1e9 * seconds / values:.1f}" for seconds in (random, numpy)),
                    f"{form.error_bound:.1e}",
                )


def _sampling(given: dict[str, Scene]) -> Iterator[Sequence[str]]:
    for label, each in given.items():
        made, outputs = files(make(lower(each), Request(evaluator="pieces")), "c"), len(each.outputs)
        for compiler in compilers():
            for flags in EVERY:
                times, ratios = [], []
                for count in COUNTS:
                    calls = CALLS * SAMPLES // count  # so many that what calls C takes no time beside them
                    with chosen_compiler(compiler.name):
                        lines = floor(outputs, count, calls, flags=flags)
                        low, sample = least([lines, many(each, made, flags, calls, count)])
                    times.append(f"{1e9 * sample / (calls * count * outputs):.3f}")
                    ratios.append(f"{sample / low:.2f}")
                yield label, compiler.name, f"`{' '.join(flags)}`", *times, *ratios


def _at_equal_degree(collision: Scene, chains: dict[str, Scene]) -> Iterator[Sequence[str]]:
    other = fit_pieces(collision, rational(collision.output.tolerance))
    for label, chain in chains.items():
        one = at_degree(chain, other.degree)
        for compiler in compilers():
            for flags in EVERY:
                with chosen_compiler(compiler.name):
                    found = [f"{ratio:.2f}" for ratio in ratios(one, other, flags)]
                degrees = [f"{each.degree:.1f}" for each in (one, other)]
                yield label, compiler.name, f"`{' '.join(flags)}`", *degrees, f"{one.count}", f"{other.count}", *found


def _generating(folder: Path) -> Iterator[Sequence[str]]:
    for label in NAMED + CHAINS:
        yield _generate_row(f"{label}, as above", (folder / f"{label.lower()}.toml").read_text(encoding="utf-8"))
    shafts = [f"{20 + i}/40" for i in range(49)]
    discs = [f"{30 + (7 * i) % 23}/30" for i in range(50)]
    drive = {"type": "drive", "m": 49, "kappa": shafts, "inertia": discs}
    load = {"body": 1, "times": [0], "steps": [1]}
    train = scene("discs", 100, drive, [load], strain=["1/2", "49/2"], velocity=["97/2"])
    yield _generate_row("drive of 50 unequal discs to tau = 100", _toml(train))
    yield _generate_row("50 unequal rods, lengths 9/10 to 13/10, to tau = 50", _toml(_rods()))
    tower = {"type": "building", "m": 10, "kappa": ["1/100"] * 11, "base": "ground"}
    step = {"times": [0], "a": [1], "b": [0]}
    tall = scene("tower", 20_000, tower, [step], tolerance="1e-6", strain=["1/2"], velocity=[10])
    yield _generate_row("building of 10 storeys to tau = 20 000", _toml(tall), "march")
    made = files(make(lower(tall), Request(evaluator="march")))
    for flags, seconds in zip(EVERY, medians([many(tall, made, flags, calls=1) for flags in EVERY]), strict=True):
        yield f"one run of its C, 10 001 samples, `{' '.join(flags)}`", f"{seconds:.3f}", "", "march"


def _beyond_imports() -> Iterator[Sequence[str]]:
    """Whole commands; the least of a few turns of each, of which what else runs disturbs few."""
    names = ("building_m2", "drive_m1", "collision_m4")
    imports = [sys.executable, "-c", "import sympy, numpy"]
    with TemporaryDirectory() as folder:
        generating = [[sys.executable, "-m", "wavesym", "generate", name, "-o", folder] for name in names]
        turns = [[ran(command).seconds for command in (imports, *generating)] for _ in range(9)]
    bare, *seconds = map(min, zip(*turns, strict=True))
    yield "the imports", f"{bare:.2f}", ""
    for name, each in zip(names, seconds, strict=True):
        yield name, f"{each:.2f}", f"{each - bare:.2f}"


def _rods() -> Scene:
    """A push on the first of 51 masses, between rods of five lengths and five impedances."""
    parts: list[dict[str, Any]] = [{"mass": 1, "name": "first"}]
    for k in range(50):
        parts.append({"rod": f"{9 + (k * k + k // 3) % 5}/10", "impedance": f"{8 + 7 * k % 5}/10"})
        parts.append({"mass": f"{5 + 3 * k % 7}/10"})
    push = {"at": "first", "times": [0], "steps": [1]}
    return scene("rods", 50, {"type": "chain", "parts": parts}, [push], velocity=["first"])


def _generate_row(label: str, text: str, evaluator: str = "auto") -> Sequence[str]:
    """Wall time and peak memory of `wavesym generate`, start-up included, and what it chose."""
    with TemporaryDirectory() as directory:
        path = Path(directory, "scene.toml")
        path.write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", "wavesym", "generate", str(path), "-o", directory, "--evaluator", evaluator]
        done = ran(command)
        cells = label, f"{done.seconds:.2f}", f"{done.megabytes:.0f}"
        if not done.well:
            return *cells, "refused"
        header = next(Path(directory).glob("*.h")).read_text(encoding="utf-8")
        chosen = next(line for line in header.splitlines() if line.startswith(" * Evaluator: "))
    return *cells, chosen.removeprefix(" * Evaluator: ")


def _toml(each: Scene) -> str:
    """A scene as TOML; what a user would write."""
    fields = each.model_dump(exclude_defaults=True)

    def value(item: object) -> str:
        if isinstance(item, Mapping):
            return "{ " + ", ".join(f"{key} = {value(one)}" for key, one in item.items()) + " }"
        if isinstance(item, list | tuple):
            return "[" + ", ".join(map(value, item)) + "]"
        return str(item) if isinstance(item, int) else f'"{item}"'

    def table(name: str, items: dict[str, object]) -> str:
        return f"{name}\n" + "".join(f"{key} = {value(item)}\n" for key, item in items.items())

    loads = "".join(table("[[load]]", load) for load in fields["load"])
    name = table("", {"name": fields["name"]})
    return name + table("[system]", fields["system"]) + loads + table("[output]", fields["output"])


def _growth() -> Iterator[Sequence[str]]:
    step = {"times": [0], "a": [1], "b": [0]}

    def tower(m: int, until: float, tolerance: str) -> Scene:
        kappas = [f"{10 + i}/20" for i in range(m + 1)]
        system = {"type": "building", "m": m, "kappa": kappas, "base": "ground"}
        return scene("tower", until, system, [step], tolerance=tolerance, strain=["1/2", f"{2 * m - 1}/2"])

    for name, values, scene_of in (
        ("m", (4, 8, 16, 32), lambda m: tower(m, 40, "1e-10")),
        ("horizon", (10, 20, 40, 80), lambda until: tower(4, until, "1e-10")),
        ("digits", (4, 6, 9, 13), lambda digits: tower(4, 20, f"1e-{digits}")),
    ):
        times, sizes = [], []
        for each in map(scene_of, values):
            start = perf_counter()
            sizes.append(choose(lower(each), "pieces").evaluator.bytes)
            times.append(perf_counter() - start)
        exponents = (np.polyfit(np.log(values), np.log(costs), 1)[0] for costs in (times, sizes))
        yield name, f"{values[0]} to {values[-1]}", *(f"{exponent:.2f}" for exponent in exponents)
