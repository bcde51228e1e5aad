"""What a chart compares: every evaluator of wavesym that a scene has, the ball reference, and other methods."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesym.errors import UnservedError, WavesymError
from wavesym.lab.stream import own_samples, stream
from wavesym.methods.catalogue import METHODS
from wavesym.methods.problem import Method, Problem
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import REALS
from wavesym.programs.choice import MAKERS, choose
from wavesym.programs.form import Form
from wavesym.programs.making import program
from wavesym.programs.modes.evaluator import ModesEvaluator
from wavesym.programs.program import Program
from wavesym.results.response import Response
from wavesym.running.native import address, library
from wavesym.scene import Scene, lower
from wavesym.targets.files import sources

Values = NDArray[Any]

TOLERANCES = tuple(Fraction(1, 10**digits) for digits in (4, 6, 8, 10, 12, 14))

# a value of the reference takes as long as thousands of others
_BALL_SAMPLES = 21
# finer than a resolution that takes so long no method goes (seconds)
_PATIENCE = 1.5


@dataclass(frozen=True)
class Subject:
    """Something that computes the outputs of a scene.

    `sample` makes the values at `instants`; `at` makes them at any ascending tau, where there are such values. Both
    give (outputs, n). `setup` is what a new parameter set costs, in seconds; `bound` the proved error relative to an
    output's largest value, if any.
    """

    name: str
    kind: str
    language: str
    precision: str
    resolution: str
    setup: float
    bound: float | None
    instants: Values
    sample: Callable[[], Values]
    evaluate: Callable[[Values], Values] | None

    @property
    def curve(self) -> tuple[str, str, str]:
        """What the points of one curve have in common."""
        return self.name, self.language, self.precision


def taus(until: float, samples: int, precision: str) -> Values:
    """k * dtau for k = 0 ... samples - 1, rounded as generated code rounds it."""
    counted: Values = np.arange(samples).astype(np.float32 if precision == "single" else np.float64)
    return np.asarray(counted * counted.dtype.type(spacing(until, samples, precision)))


def spacing(until: float, samples: int, precision: str) -> float:
    """The distance of samples, the largest with which none is beyond the horizon."""
    number = np.float32 if precision == "single" else np.float64
    apart = number(until / max(samples - 1, 1))
    while float(number(samples - 1) * apart) > until:
        apart = np.nextafter(apart, number(0))
    return float(apart)


def subjects(scene: Scene, samples: int) -> Iterator[Subject]:
    """All evaluators that the scene has, at each tolerance in each precision; the cheaper first."""
    for evaluator in MAKERS:
        for precision in REALS:
            seen: set[str] = set()
            for tolerance in TOLERANCES:
                start = perf_counter()
                made = _build(scene, evaluator, precision, tolerance)
                if made is None or made.c[f"{scene.name}.c"] in seen:  # refused, or the same as for a larger tolerance
                    continue
                seen.add(made.c[f"{scene.name}.c"])
                seconds = perf_counter() - start
                for language, load in (("C", _stream if evaluator == "modes" else _c), ("NumPy", _numpy)):
                    start = perf_counter()
                    instants, sample, at = load(scene, made, samples, precision)
                    yield Subject(
                        name=evaluator,
                        kind="wavesym",
                        language=language,
                        precision=precision,
                        resolution=f"tolerance {float(tolerance):.0e}",
                        setup=seconds + perf_counter() - start,
                        bound=made.program.error_bound,
                        instants=instants,
                        sample=sample,
                        evaluate=at,
                    )


def reference(scene: Scene, samples: int) -> Subject:
    """The exact tables in ball arithmetic, each value rounded once."""
    start = perf_counter()
    response = Response(lower(scene))
    response(0.0)  # derives its tables
    setup = perf_counter() - start
    few = taus(response.tau_max, min(samples, _BALL_SAMPLES), "double")
    bound, sample = response.error_bound, partial(response, few)
    return Subject("ball reference", "wavesym", "Python", "exact", "", setup, bound, few, sample, response)


def other_methods(scene: Scene, samples: int) -> Iterator[Subject]:
    """The other methods that take the scene, each from coarse to fine."""
    model = lower(scene)
    at = taus(model.horizon(), samples, "double")
    for method in METHODS:
        try:
            problem = method.state(model)
        except UnservedError:
            continue
        for resolution in method.resolutions:
            subject = other_method(method, resolution, problem, at)
            start = perf_counter()
            subject.sample()
            seconds = perf_counter() - start
            yield subject
            if seconds > _PATIENCE:
                break


def unsupported_methods(scene: Scene) -> Iterator[str]:
    """A line for each method that does not take the scene: which, and why."""
    model = lower(scene)
    for method in METHODS:
        try:
            method.state(model)
        except UnservedError as error:
            yield f"{method.name}: {error}"


def other_method(method: Method, resolution: float, problem: Problem, at: Values) -> Subject:
    """A method at one resolution. The C that any parameter set can use is compiled before the clock starts."""
    method.prepare(problem, method.resolutions[0])
    start = perf_counter()
    evaluate = method.prepare(problem, resolution)
    setup = perf_counter() - start
    return Subject(
        name=method.name,
        kind="other",
        language=method.language,
        precision="double",
        resolution=f"{resolution:g} {method.unit}",
        setup=setup,
        bound=None,
        instants=at,
        sample=partial(evaluate, at),
        evaluate=evaluate,
    )


class _Build(NamedTuple):
    form: Form
    program: Program
    c: dict[str, str]


def _build(scene: Scene, evaluator: str, precision: str, tolerance: Fraction) -> _Build | None:
    """A program and its C by file name, None where it cannot meet the tolerance or would cost too much."""
    model = lower(scene).tolerating(rational(tolerance))
    try:
        form = choose(model, evaluator, precision).evaluator
    except WavesymError:
        return None
    made = program(model, form)
    return _Build(form, made, sources(made, "c"))


Loaded = tuple[Values, Callable[[], Values], Callable[[Values], Values] | None]


def _c(scene: Scene, made: _Build, samples: int, precision: str) -> Loaded:
    name, outputs = scene.name, len(scene.outputs)
    number, dtype = (ctypes.c_float, np.float32) if precision == "single" else (ctypes.c_double, np.float64)
    compiled = library(made.c[f"{name}.c"], header=(f"{name}.h", made.c[f"{name}.h"]))
    call, evaluate = getattr(compiled, f"{name}_sample"), getattr(compiled, f"{name}_eval")
    call.argtypes = [number, number, ctypes.c_size_t, ctypes.c_void_p]
    evaluate.argtypes = [number, ctypes.c_void_p]
    until = lower(scene).horizon()
    apart = spacing(until, samples, precision)
    out = np.empty((outputs, samples), dtype=dtype)
    where = address(out)

    def sample() -> Values:
        call(0.0, apart, samples, where)
        return out

    def sample_at(instants: Values) -> Values:
        columns = np.empty((len(instants), outputs), dtype=dtype)
        for tau, column in zip(instants.tolist(), columns, strict=True):
            evaluate(tau, address(column))
        return np.asarray(columns.T)

    return taus(until, samples, precision), sample, sample_at


def _stream(scene: Scene, made: _Build, *_: object) -> Loaded:
    """It goes from sample to sample of the scene's loads, and says nothing of what is between."""
    assert isinstance(made.form, ModesEvaluator)
    instants, samples = own_samples(made.form)
    return instants, stream(scene.name, made.c, samples, len(scene.outputs)), None


def _numpy(scene: Scene, made: _Build, samples: int, precision: str) -> Loaded:
    evaluate = made.program.evaluate
    instants = taus(lower(scene).horizon(), samples, precision)
    return instants, partial(evaluate, instants), evaluate
