"""How fast: `make bench` writes bench/README.md, measured in one run, single thread, as ratios to the write floor."""

from __future__ import annotations

import ctypes
import os
import platform
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np

from wavesym.lab.timing import medians
from wavesym.programs.choice import choose
from wavesym.programs.making import make
from wavesym.programs.pieces import Pieces
from wavesym.programs.request import Request
from wavesym.running.compiled import imported
from wavesym.running.native import FAST, address, library
from wavesym.running.toolchain import Compiler, at_hand
from wavesym.scene import Scene, lower
from wavesym.targets.files import files

SAMPLES = 10_001
PLAIN = ("-O2",)
# In C, so that nothing else is timed: many calls of sample, as many straight lines of the same size, many of eval.
_CALLS = 20
_HARNESS = """
void many(double dtau, size_t count, double *out, int calls)
{
    for (int call = 0; call < calls; ++call) {
        NAME_sample(0.0, dtau, count, out);
    }
}

void straight(double v, double d, size_t count, double *out);
__attribute__((noinline)) void straight(double v, double d, size_t count, double *out)
{
    for (size_t k = 0; k < count; ++k) {
        out[k] = v + d * (double)(int)k;
    }
}

void lines(double d, size_t count, double *out, int calls)
{
    for (int call = 0; call < calls; ++call) {
        for (size_t row = 0; row < PREFIX_OUTPUTS; ++row) {
            straight((double)call, d, count, out + row * count);
        }
    }
}

void each(const double *tau, size_t count, double *out)
{
    for (size_t k = 0; k < count; ++k) {
        NAME_eval(tau[k], out);
    }
}
"""
_PEAK = """
#include <stddef.h>
enum { LANES = 32 };
void peak(size_t count, double *x)
{
    double s[LANES], t[LANES], w[LANES];
    UNROLLED
    for (int j = 0; j < LANES; ++j) s[j] = t[j] = w[j] = x[j];
    for (size_t k = 0; k < count; ++k) {
        const double next = x[k % 2];
        UNROLLED
        for (int j = 0; j < LANES; ++j) s[j] = s[j] * w[j] + next;
        UNROLLED
        for (int j = 0; j < LANES; ++j) t[j] = t[j] * w[j] + next;
    }
    UNROLLED
    for (int j = 0; j < LANES; ++j) x[j] = s[j] + t[j];
}
"""
_UNROLLED = {"gcc": 'UNROLLED=_Pragma("GCC unroll 32")', "clang": 'UNROLLED=_Pragma("clang loop unroll(full)")'}

Output = dict[str, Any]


def scene(name: str, until: float, system: dict[str, Any], load: Sequence[dict[str, Any]], **output: Any) -> Scene:
    """A scene from its parts."""
    return Scene(name=name, system=system, load=list(load), output={"until": until, **output})


def scenes(folder: Path) -> dict[str, Scene]:
    """The three scenes that the figures are for."""
    return {label: Scene.from_toml(folder / f"{label.lower()}.toml") for label in "BDC"}


def report(folder: Path) -> Iterator[str]:
    """The whole report on the scenes in `folder`, line by line."""
    yield "# Benchmarks"
    yield ""
    yield "Made by `make bench`; times are medians of interleaved rounds in one process, single thread."
    yield ""
    yield from _machine()
    yield ""
    yield "## Evaluating"
    yield ""
    yield f"{SAMPLES} uniform samples, proved bound 1e-14. ns a double; *ratio* is that of `sample` to the write floor."
    yield ""
    yield from _table(
        ("scene", "compiler", "flags", "floor", "sample", "ratio", "of FMA peak", "eval, random", "NumPy", "bound"),
        _evaluating(scenes(folder)),
    )
    yield ""
    yield "## Generating"
    yield ""
    yield from _table(("what", "wall s", "peak MB", "evaluator"), _generating(scenes(folder)))
    yield ""
    yield "## Charts"
    yield ""
    yield "Time a sample against largest error, rivals included, by `wavesym chart`; the numbers are in the CSVs."
    yield ""
    yield from (f"![{label}]({label}.svg)" for label in "bdc")
    yield ""
    yield "## Growth"
    yield ""
    yield "Fitted exponents of the time to choose and fit the pieces, and of the bytes of their tables."
    yield ""
    yield from _table(("against", "range", "time", "bytes"), _growth())


def _machine() -> Iterator[str]:
    cpu = next(
        (line.split(":", 1)[1].strip() for line in _lines("/proc/cpuinfo") if line.startswith("model name")),
        platform.processor(),
    )
    yield f"- {cpu}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}"
    yield f"- Python {platform.python_version()}, NumPy {np.__version__}"
    for compiler in _compilers():
        yield f"- {compiler.version}"


def _lines(path: str) -> list[str]:
    try:
        return Path(path).read_text(encoding="utf-8").splitlines()
    except OSError:
        return []


def _compilers() -> list[Compiler]:
    return [compiler for compiler in at_hand() if compiler.name in _UNROLLED]


def _table(header: Sequence[str], rows: Iterator[Sequence[str]]) -> Iterator[str]:
    yield "| " + " | ".join(header) + " |"
    yield "|" + "---|" * len(header)
    for row in rows:
        yield "| " + " | ".join(row) + " |"


def _evaluating(three: dict[str, Scene]) -> Iterator[Sequence[str]]:
    for label, each in three.items():
        made = files(make(lower(each), Request(evaluator="pieces")), "all")
        module = imported(made[f"{each.name}.py"], each.name)
        form = choose(lower(each), "pieces").evaluator
        assert isinstance(form, Pieces)
        outputs = len(each.outputs)
        taus = np.linspace(0.0, form.tau_max, SAMPLES)
        for compiler in _compilers():
            for flags in (FAST, PLAIN):
                with _compiler(compiler.name):
                    calls: list[Callable[[], object]] = [
                        _many("lines", each, made, flags),
                        _many("many", each, made, flags),
                        _each(each, made, flags, form.tau_max),
                        partial(module.evaluate, taus),
                        _peak(compiler.name, flags),
                    ]
                low, sample, random, numpy, peak = medians(calls)
                low, sample = low / _CALLS, sample / _CALLS
                values = outputs * SAMPLES
                share = (form.work - 2) * values / sample / (64 * 10_000 / peak)
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


class _compiler:
    """The C compiler that `toolchain` is to choose, for a while."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._before = os.environ.get("CC")

    def __enter__(self) -> None:
        library.cache_clear()
        os.environ["CC"] = self._name

    def __exit__(self, *_: object) -> None:
        library.cache_clear()
        if self._before is None:
            del os.environ["CC"]
        else:
            os.environ["CC"] = self._before


def _library(each: Scene, made: dict[str, str], flags: tuple[str, ...]) -> ctypes.CDLL:
    name = each.name
    harness = _HARNESS.replace("NAME", name).replace("PREFIX", name.upper())
    return library(made[f"{name}.c"] + harness, flags, (f"{name}.h", made[f"{name}.h"]))


def _many(
    which: str, each: Scene, made: dict[str, str], flags: tuple[str, ...], calls: int = _CALLS
) -> Callable[[], object]:
    function = getattr(_library(each, made, flags), which)
    function.argtypes = [ctypes.c_double, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_int]
    step = float(each.output.until) / (SAMPLES - 1)
    out = np.empty((len(each.outputs), SAMPLES))

    def call() -> object:
        return function(step, SAMPLES, address(out), calls)

    return call


def _each(each: Scene, made: dict[str, str], flags: tuple[str, ...], tau_max: float) -> Callable[[], object]:
    function = _library(each, made, flags).each
    function.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p]
    taus = np.random.default_rng(1).uniform(0.0, tau_max, SAMPLES)
    out = np.empty(len(each.outputs))

    def call() -> object:
        return function(address(taus), SAMPLES, address(out))

    return call


def _peak(compiler: str, flags: tuple[str, ...]) -> Callable[[], object]:
    function = library(_PEAK, (*flags, f"-D{_UNROLLED[compiler]}")).peak
    function.argtypes = [ctypes.c_size_t, ctypes.c_void_p]
    values = np.full(32, 0.5)

    def call() -> object:
        return function(10_000, address(values))

    return call


def _generating(three: dict[str, Scene]) -> Iterator[Sequence[str]]:
    for label, each in three.items():
        yield _generated(f"{label}, as above", each)
    shafts = [f"{20 + i}/40" for i in range(49)]
    discs = [f"{30 + (7 * i) % 23}/30" for i in range(50)]
    drive = {"type": "drive", "m": 49, "kappa": shafts, "inertia": discs}
    load = {"body": 1, "times": [0], "steps": [1]}
    yield _generated(
        "drive of 50 unequal discs to tau = 100",
        scene("discs", 100, drive, [load], strain=["1/2", "49/2"], velocity=["97/2"]),
    )
    tower = {"type": "building", "m": 10, "kappa": ["1/100"] * 11, "base": "ground"}
    step = {"times": [0], "a": [1], "b": [0]}
    tall = scene("tower", 20_000, tower, [step], tolerance="1e-6", strain=["1/2"], velocity=[10])
    yield _generated("building of 10 storeys to tau = 20 000", tall, "march")
    made = files(make(lower(tall), Request(evaluator="march")))
    (seconds,) = medians([_many("many", tall, made, FAST, calls=1)])
    yield "one run of its C, 10 001 samples", f"{seconds:.3f}", "", "march"


def _generated(label: str, each: Scene, evaluator: str = "auto") -> Sequence[str]:
    """Wall time and peak memory of `wavesym generate`, start-up included, and what it chose."""
    with TemporaryDirectory() as directory:
        path = Path(directory, "scene.toml")
        path.write_text(_toml(each), encoding="utf-8")
        command = [sys.executable, "-m", "wavesym", "generate", str(path), "-o", directory, "--evaluator", evaluator]
        start = perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = perf_counter() - start
        if status != 0:
            return label, f"{seconds:.2f}", f"{usage.ru_maxrss / 1000:.0f}", "refused"
        header = next(Path(directory).glob("*.h")).read_text(encoding="utf-8")
        chosen = next(line for line in header.splitlines() if line.startswith(" * Evaluator: "))
    return label, f"{seconds:.2f}", f"{usage.ru_maxrss / 1000:.0f}", chosen.removeprefix(" * Evaluator: ")


def _toml(each: Scene) -> str:
    """A scene as TOML; what a user would write."""
    fields = each.model_dump()

    def value(item: object) -> str:
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


if __name__ == "__main__":
    text = "\n".join(report(Path(sys.argv[1]))) + "\n"
    Path(sys.argv[1], "README.md").write_text(text, encoding="utf-8")
