"""The page that `make bench` writes: measured in one run, single thread, as ratios to the write floor."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from tools.bench import (
    corners,
    frame_records,
    frames,
    generating,
    many_sets,
    panels,
    parameters,
    record_response,
    streaming,
    sweeps,
    vibration,
)
from tools.bench.equal_degree import FittedPieces, at_degree, fit_pieces, ratios
from tools.bench.harness import CALLS, SAMPLES, compilers, flags_cell, many, one_by_one, peak, toolchains
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


def scenes(folder: Path, labels: str) -> dict[str, Scene]:
    """The scenes that the figures are for."""
    return {label: Scene.from_toml(folder / f"{label.lower()}.toml") for label in labels}


def report(folder: Path) -> Iterator[str]:
    """The whole report on the scenes in `folder`, line by line."""
    yield "# Benchmarks"
    yield ""
    yield "Made by `make bench`; times are medians of interleaved rounds in one process, single thread."
    yield ""
    yield from _machine()
    for section in sections().values():
        yield ""
        yield from section(folder)


def sections() -> dict[str, Callable[[Path], Iterator[str]]]:
    """In the order of the page, those that can be measured here; each yields the lines under its title, that first."""
    with_sweeps = find_spec("zarr") and find_spec("distributed")
    return {
        "values": _value_figures,
        "samples": _sample_figures,
        "chains": _chain_figures,
        "generating": _generating_figures,
        "parameters": _parameter_figures,
        "record": _record_figures,
        "earthquake": _earthquake_figures,
        "streams": _stream_figures,
        **({"sweeps": _sweep_figures} if with_sweeps else {}),
        "sets": _set_figures,
        "frames": _frame_figures,
        "vibration": _vibration_figures,
        "corners": _corner_figures,
        "charts": _charts,
        "growth": _growth_figures,
    }


def _value_figures(folder: Path) -> Iterator[str]:
    yield "## Evaluating"
    yield ""
    yield f"{SAMPLES} uniform samples, proved bound 1e-14. ns a double; *ratio* is that of `sample` to the write floor,"
    yield "*of FMA peak* what polynomials need, one multiplication with an addition a degree, of what a core can do."
    yield ""
    yield from _table(
        ("scene", "compiler", "flags", "floor", "sample", "ratio", "of FMA peak", "eval, random", "NumPy", "bound"),
        _evaluating(scenes(folder, NAMED + CHAINS)),
    )


def _sample_figures(folder: Path) -> Iterator[str]:
    yield "## Few samples and many"
    yield ""
    yield "`sample` and the write floor, each the best of many turns, for so many samples of each output."
    yield ""
    yield from _table(
        ("scene", "compiler", "flags", *(f"{count}, ns" for count in COUNTS), *(f"{count}, ratio" for count in COUNTS)),
        _sampling(scenes(folder, NAMED)),
    )


def _chain_figures(folder: Path) -> Iterator[str]:
    yield "## Chains against the collision"
    yield ""
    yield "Time a value, over that of C at the same degree: with as many samples, and with as many on a piece. A chain"
    yield "has more pieces where fronts come more often."
    yield ""
    yield from _table(
        ("scene", "compiler", "flags", "degree", "that of C", "pieces", "those of C", "ratio", "at as many on a piece"),
        _at_equal_degree(scenes(folder, "C")["C"], scenes(folder, CHAINS)),
    )


def _generating_figures(folder: Path) -> Iterator[str]:
    yield "## Generating"
    yield ""
    yield from _table(("what", "wall s", "peak MB", "evaluator"), generating.rows(folder, NAMED + CHAINS))
    yield ""
    yield "Of scenes that come with wavesym, in turns with `python -c 'import sympy, numpy'`: wall time, and beyond it."
    yield ""
    yield from _table(("what", "wall s", "beyond"), generating.rows_beyond_imports())


def _parameter_figures(folder: Path) -> Iterator[str]:
    yield "## Parameters at run time"
    yield ""
    yield f"From kappa to {parameters.SAMPLES} samples of all outputs, tolerance 1e-12, nothing left out but compiling;"
    yield "each the best of many turns. *By hand*: characteristics with exponential integration of order 4, written for"
    yield "the scene alone."
    yield ""
    yield from _table(parameters.HEAD, parameters.rows(folder))
    yield ""
    yield from _table(parameters.MANY_HEAD, parameters.many_rows(folder))


def _record_figures(_: Path) -> Iterator[str]:
    yield "## A record"
    yield ""
    samples = record_response.SAMPLES
    yield f"Ten storeys, damped, 31 outputs at all {samples} samples, from the model of the scene on. Errors"
    yield "are those of the worst output, of its largest value, against modes to a thirtieth of the tolerance (1e-6)."
    yield ""
    yield from _table(("way", "s", "error"), record_response.rows())


def _earthquake_figures(folder: Path) -> Iterator[str]:
    yield "## El Centro"
    yield ""
    yield "All floors of a damped steel frame: of `run`, start-up included, at all samples of the record; and of parts."
    yield ""
    yield from _table(("what", "time", "peak MB", "modes"), streaming.rows(_examples(folder) / "records"))


def _stream_figures(_: Path) -> Iterator[str]:
    yield "## Streams"
    yield ""
    yield "Waves under loads that come step by step (`generate --stream`): steps as long as a panel, and of 0.01."
    yield ""
    yield from _table(panels.HEAD, panels.rows())


def _sweep_figures(_: Path) -> Iterator[str]:
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


def _set_figures(_: Path) -> Iterator[str]:
    yield "## Many sets"
    yield ""
    yield "The peaks of that drive from kappa on, compiling apart. Grids by hand are the coarsest that keep 1e-6."
    yield ""
    yield from _table(("sets", "way", "s", "sets a second", "error"), many_sets.rows(sweeps.drive()))


def _frame_figures(folder: Path) -> Iterator[str]:
    records = _examples(folder) / "records"
    yield "## Frames"
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


def _vibration_figures(folder: Path) -> Iterator[str]:
    yield "## Frequencies"
    yield ""
    yield f"Whole commands, start-up included: ten modes, none missed, and responses at {vibration.POINTS} frequencies."
    yield ""
    yield from _table(vibration.HEAD, vibration.rows(_examples(folder) / "records"))


def _corner_figures(folder: Path) -> Iterator[str]:
    examples = _examples(folder) / "corners"
    yield "## Links with corners"
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


def _charts(folder: Path) -> Iterator[str]:
    yield "## Charts"
    yield ""
    yield "Time a sample against largest error, by `wavesym chart`, with other methods; the numbers are in the CSVs."
    yield ""
    for label, scene in scenes(folder, "bdclr").items():
        yield f"![{scene.system.type}: time a value over largest error, of wavesym and others]({label}.svg)"


def _growth_figures(_: Path) -> Iterator[str]:
    yield "## Growth"
    yield ""
    yield "Fitted exponents of the time to choose and fit the pieces, and of the bytes of their tables."
    yield ""
    yield from _table(("against", "range", "time", "bytes"), generating.growth_rows())


def _examples(folder: Path) -> Path:
    return folder.parent / "examples"


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
        for compiler, flags in toolchains():
            calls: list[Callable[[], object]] = [
                floor(outputs, SAMPLES, CALLS, flags=flags),
                many(each, made, flags),
                one_by_one(each, made, flags, form.tau_max),
                partial(module.evaluate, taus),
                peak(compiler, flags),
            ]
            low, sample, random, numpy, highest = medians(calls)
            low, sample = low / CALLS, sample / CALLS
            values = outputs * SAMPLES
            share = degree * values / sample / (64 * 10_000 / highest)
            yield (
                label,
                compiler,
                flags_cell(flags),
                *(f"{1e9 * seconds / values:.3f}" for seconds in (low, sample)),
                f"{sample / low:.2f}",
                f"{share:.0%}",
                *(f"{1e9 * seconds / values:.1f}" for seconds in (random, numpy)),
                f"{form.error_bound:.1e}",
            )


def _sampling(given: dict[str, Scene]) -> Iterator[Sequence[str]]:
    for label, each in given.items():
        made, outputs = files(make(lower(each), Request(evaluator="pieces")), "c"), len(each.outputs)
        for compiler, flags in toolchains():
            times, ratios = [], []
            for count in COUNTS:
                calls = CALLS * SAMPLES // count  # so many that what calls C takes no time beside them
                lines = floor(outputs, count, calls, flags=flags)
                low, sample = least([lines, many(each, made, flags, calls, count)])
                times.append(f"{1e9 * sample / (calls * count * outputs):.3f}")
                ratios.append(f"{sample / low:.2f}")
            yield label, compiler, flags_cell(flags), *times, *ratios


def _at_equal_degree(collision: Scene, chains: dict[str, Scene]) -> Iterator[Sequence[str]]:
    other = fit_pieces(collision, rational(collision.output.tolerance))
    for label, chain in chains.items():
        one = at_degree(chain, other.degree)
        for compiler, flags in toolchains():
            found = [f"{ratio:.2f}" for ratio in ratios(one, other, flags)]
            degrees = [f"{each.degree:.1f}" for each in (one, other)]
            yield label, compiler, flags_cell(flags), *degrees, f"{one.count}", f"{other.count}", *found
