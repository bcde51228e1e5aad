"""Parameters at run time: how soon new ones are values, beside programs that are written by hand for one scene.

From numbers to 1001 samples of all outputs, nothing left out; compiling is apart. Errors are those of the worst output,
of its largest value, at the samples.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from time import perf_counter, process_time

import numpy as np
from numpy.typing import NDArray

from tools.bench.by_hand import SampleGrid, in_c, in_numpy, line
from tools.bench.harness import chosen_compiler, compilers, flags_cell, toolchains
from wavesym.errors import UnservedError
from wavesym.lab.timing import least
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.request import PARTS
from wavesym.programs.runtime.making import sets_program
from wavesym.results.response import Response
from wavesym.running.model import compiled_model
from wavesym.running.native import FAST, address, library, struct_size
from wavesym.scene import Scene, lower
from wavesym.targets.files import runtime_sets

HEAD = (
    "scene",
    "way",
    "compiler",
    "flags",
    "us to coefficients",
    "us to samples",
    "error",
    "estimate",
    "proved bound",
)
MANY_HEAD = ("many sets", "compiler", "flags", "how fast")
SAMPLES = 1001
LIGHT = 100
"""kappa of all bodies, in the rows that say so."""

_STRIDES = (1, 2, 4, 8, 16, 32)
_SETS = 256
_MANY, _ABREAST = 4096, 512
"""Sets that are asked for at once, from Python, and in C: these for so short a time that some turn is undisturbed."""

_CALLS = """
static NAME_model built;
void builds(const NAME_parameters *p, size_t calls);
void values(const NAME_parameters *p, size_t calls, double dtau, size_t count, double *out);
void bounds(const NAME_parameters *p, size_t calls, NAME_real *bound);
void batches(const NAME_parameters *p, size_t sets, NAME_batch *batch);
void builds(const NAME_parameters *p, size_t calls)
{
    for (size_t k = 0; k < calls; ++k) {
        (void)NAME_build(&built, p);
    }
}
void values(const NAME_parameters *p, size_t calls, double dtau, size_t count, double *out)
{
    for (size_t k = 0; k < calls; ++k) {
        (void)NAME_build(&built, p);
        (void)NAME_model_sample(&built, 0, (NAME_real)dtau, count, (NAME_real *)out);
    }
}
void bounds(const NAME_parameters *p, size_t calls, NAME_real *bound)
{
    for (size_t k = 0; k < calls; ++k) {
        (void)NAME_error_bound(&built, p, bound);
    }
}
void batches(const NAME_parameters *p, size_t sets, NAME_batch *batch)
{
    for (size_t k = 0; k < sets; k += PREFIX_WIDTH) {
        (void)NAME_build_batch(batch, p + k, sets - k);
    }
}
"""


def scenes(folder: Path) -> dict[str, Scene]:
    """The building, the drive and the collision of the benchmark, and one shaft for long."""
    texts = {
        "building, m = 2, to 20": Scene.from_toml(folder / "b.toml"),
        "drive, m = 3, to 40": Scene.from_toml(folder / "d.toml"),
        "collision, m = 4, to 10": Scene.from_toml(folder / "c.toml"),
        "drive, m = 1, to 200": Scene.from_toml("drive_m1").with_(
            {"output.until": 200, "output.strain": ["1/2"], "output.velocity": [0], "output.displacement": []}
        ),
    }
    return {label: scene.with_({"output.tolerance": "1e-12"}) for label, scene in texts.items()}


def light(scene: Scene) -> Scene:
    """With bodies as light as programs expect at most."""
    return scene.with_({"system.kappa": [LIGHT] * len(_kappa(scene))})


def _kappa(scene: Scene) -> Array:
    return np.array([nearest(one.value) for one in lower(scene).parameters.numbers["kappa"]])


class TimedSets:
    """A scene's C with kappa at run time, called in loops that are C, too."""

    def __init__(self, scene: Scene, precision: str = "double", flags: tuple[str, ...] = FAST) -> None:
        self.program = sets_program(lower(scene), ["kappa"], precision=precision)
        name = self.program.provenance.model.name
        files = runtime_sets(self.program, PARTS)
        real = {"double": "double", "single": "float"}[precision]
        calls = _CALLS.replace("NAME_real", real).replace("NAME", name).replace("PREFIX", name.upper())
        self.library = library(files[f"{name}.c"] + calls, flags, (f"{name}.h", files[f"{name}.h"]))
        self.kind = np.dtype(np.float64 if precision == "double" else np.float32)
        self.outputs, self.until = len(scene.outputs), self.program.tau_max

    def numbers(self, kappa: Array) -> NDArray[np.generic]:
        """As the C takes them."""
        return np.ascontiguousarray(kappa, self.kind)

    def call(self, name: str, kappa: Array, *more: object) -> Callable[[], object]:
        """A loop over one set, or over all of them."""
        given = self.numbers(kappa)
        function = getattr(self.library, name)
        function.restype = None

        def call() -> object:
            return function(ctypes.c_void_p(address(given)), *more)

        return call

    def batch(self) -> ctypes.c_void_p:
        """Memory for one, which stays."""
        self._memory = np.empty(struct_size(self.library, "batch") + 64, np.uint8)
        return ctypes.c_void_p(address(self._memory) + -address(self._memory) % 64)


def rows(folder: Path) -> Iterator[Sequence[str]]:
    """As `HEAD` says."""
    for label, scene in scenes(folder).items():
        for name, each in ((label, scene), (f"{label}, kappa = {LIGHT}", light(scene))):
            truth = _truth(each)
            yield from ((name, *row) for row in _ours(scene, each, truth))
            if each is scene:
                yield from ((name, *row) for row in _theirs(each, truth))


def _truth(scene: Scene) -> Array:
    response = Response(lower(scene))
    return np.array(response(_instants(response.tau_max)))


def _instants(until: float) -> Array:
    return np.arange(SAMPLES, dtype=np.float64) * (until / (SAMPLES - 1))


def _worst(found: Array, truth: Array) -> float:
    largest = np.max(np.abs(truth), axis=1)
    return float(np.max(np.max(np.abs(found - truth), axis=1) / np.where(largest > 0, largest, 1)))


def _ours(scene: Scene, each: Scene, truth: Array) -> Iterator[Sequence[str]]:
    program, kappa = sets_program(lower(scene), ["kappa"]), _kappa(each)
    model = compiled_model(program)
    (estimate,), bound = model.check(kappa=kappa).estimate, model.bounds(kappa=kappa).max()
    out, calls = np.empty(truth.shape), 10
    many, where = ctypes.c_size_t(calls), ctypes.c_void_p(address(out))
    step = ctypes.c_double(program.tau_max / (SAMPLES - 1))
    built = {(compiler, flags): TimedSets(scene, flags=flags) for compiler, flags in toolchains()}
    turns = [
        call
        for timed in built.values()
        for call in (
            timed.call("values", kappa, many, step, ctypes.c_size_t(SAMPLES), where),
            timed.call("builds", kappa, many),
        )
    ]
    seconds = [each / calls for each in least(turns, rounds=200)]
    for (compiler, flags), values, table, call in zip(built, seconds[::2], seconds[1::2], turns[::2], strict=True):
        call()  # so that errors are those of these flags
        errors = (f"{each:.1e}" for each in (_worst(out, truth), estimate, bound))
        yield "wavesym, C", compiler, flags_cell(flags), f"{1e6 * table:.1f}", f"{1e6 * values:.1f}", *errors


def _theirs(scene: Scene, truth: Array) -> Iterator[Sequence[str]]:
    model = lower(scene)
    problem = line(model)
    for stride in _STRIDES:
        try:
            grid = SampleGrid(problem, SAMPLES, stride)
        except UnservedError:
            continue
        calls = {}
        for compiler in compilers():
            with chosen_compiler(compiler.name):
                calls[compiler.name] = in_c(grid, problem)(problem)
        errors = [_worst(call(), truth) for call in calls.values()]
        for name, seconds, error in zip(calls, least([*calls.values()]), errors, strict=True):
            way = f"by hand, C, {grid.steps} steps a unit"
            yield way, name, flags_cell(FAST), "", f"{1e6 * seconds:.1f}", f"{error:.1e}", "", ""
        if max(errors) < 1e-12:
            break
    for stride in _STRIDES[1:3]:
        grid = SampleGrid(problem, SAMPLES, stride)
        seconds = min(_processor_seconds(partial(in_numpy, grid, [problem] * _SETS)) for _ in range(5))
        error = _worst(in_numpy(grid, [problem])[0], truth)
        way = f"by hand, NumPy, {_SETS} sets at once, {grid.steps} steps a unit"
        yield way, "", "", "", f"{1e6 * seconds / _SETS:.0f}", f"{error:.1e}", "", ""


def _processor_seconds(call: Callable[[], object]) -> float:
    """Of a call on one thread that takes so long that others interrupt it."""
    start = process_time()
    call()
    return process_time() - start


def many_rows(folder: Path) -> Iterator[Sequence[str]]:
    """As `MANY_HEAD` says."""
    building = Scene.from_toml(folder / "b.toml").with_({"output.tolerance": "1e-13"})
    kappa = _kappa(building) * np.random.default_rng(1).uniform(0.8, 1.2, (_MANY, len(_kappa(building))))
    for precision in ("double", "single"):
        built = {(compiler, flags): TimedSets(building, precision, flags) for compiler, flags in toolchains()}
        turns = [timed.call("batches", kappa, ctypes.c_size_t(_ABREAST), timed.batch()) for timed in built.values()]
        for (compiler, flags), seconds in zip(built, least(turns, rounds=200), strict=True):
            text = f"building to coefficients, {precision}, sets side by side"
            yield text, compiler, flags_cell(flags), f"{_ABREAST / seconds / 1e6:.2f} million sets/s"
    for each in compilers():
        with chosen_compiler(each.name):
            rows = list(_python_rows(folder, building, kappa))
        yield from ((f"{what}, from Python", each.name, flags_cell(FAST), fast) for what, fast in rows)


def _python_rows(folder: Path, building: Scene, kappa: Array) -> Iterator[tuple[str, str]]:
    """What Python does with C, and how fast."""
    model = compiled_model(sets_program(lower(building), ["kappa"]))
    tau = _instants(model.tau_max)
    data = model.values(tau, kappa=model.parameters["kappa"])[0] + 0.01
    (seconds,) = least([partial(model.misfit(tau, data), kappa=kappa)])
    yield f"building with the misfit of {SAMPLES} samples of 4 outputs", f"{_MANY / seconds / 1e6:.2f} million sets/s"
    drive = Scene.from_toml(folder / "d.toml").with_({"output.tolerance": "1e-6"})
    start = perf_counter()
    model = compiled_model(sets_program(lower(drive), ["kappa"]))
    model.peaks()
    yield "drive, m = 3: generated, compiled and loaded", f"{perf_counter() - start:.2f} s"
    sets = model.parameters["kappa"] * np.linspace(0.2, 3, 200)[:, np.newaxis]
    (seconds,) = least([partial(model.peaks, kappa=sets)])
    yield "200 kappa of it with true peaks, 1e-6", f"{1e3 * seconds:.1f} ms"
    shafts = Scene.from_toml(folder.parent / "examples" / "fit" / "shafts.toml")
    model = compiled_model(sets_program(lower(shafts), ["kappa"]))
    (seconds,) = least([partial(model.gradients, _instants(model.tau_max), kappa=model.parameters["kappa"])])
    yield f"a step of the fit in examples/fit: {SAMPLES} samples, their derivatives", f"{1e3 * seconds:.2f} ms"
