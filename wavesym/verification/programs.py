"""Every program of a scene, compiled and run, against exact values and against what integrations have of its outputs.

A program answers for the bound, or the estimate, that it states itself. An integration may be wrong by what it allows:
a program that differs more than both together from it, or more than its bound from exact values, is wrong. Where all of
them, `run` too, differ from integrations alike, what they start from is wrong, or the integrations are.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from math import inf, isnan

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.errors import CostError, RangeError, ToleranceError, UnservedError
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import SINGLE
from wavesym.programs.making import make
from wavesym.programs.mode_sets.making import mode_sets_program
from wavesym.programs.program import Program
from wavesym.programs.request import KINDS, PARTS, Request
from wavesym.programs.runtime.making import runtime_program
from wavesym.programs.stream.making import stream_program
from wavesym.programs.stream.plan import inputs_of
from wavesym.running.compilation import CompiledLibrary, compile_files, import_text
from wavesym.running.toolchain import CompilerError, compiler
from wavesym.scene import Scene
from wavesym.scene.lowering import amplitudes, sources
from wavesym.targets.files import files
from wavesym.verification.integrations import collocation_method
from wavesym.verification.models import (
    ParameterSet,
    functions_of_parameters,
    mode_set_names,
    mode_set_values,
    model_values,
)
from wavesym.verification.other_parameters import draw_parameters, runtime_names
from wavesym.verification.outcome import Integrals, IntegratedOutput, Outcome, ProgramValues, format_error
from wavesym.verification.reference import ReferenceOutputs, even_taus, sample_evenly
from wavesym.verification.streams import run_streams

FLAGS = ("-std=c99", "-O1")
"""Tests compile programs strictly, and with more effort; here are many of them."""
LOOSENED = (fmpq(1, 1000), fmpq(1, 20))
"""The tolerances that programs in single precision are made for where they do not meet the scene's."""
_ROUNDED = 2.0**-53  # exact values are rounded once
_ROUNDINGS = 8  # no program in single precision is made for a smaller tolerance
_MOST_MARCHED = 400  # values of a march in C, each from tau = 0 on
_SOME = 4  # of the instants one of so many is compared for other parameters


def all_requests(scene: Scene, model: Model) -> Iterator[Request]:
    """What may serve a scene: all evaluators, in double and in single precision, parameters and loads at run time."""
    for precision in ("double", "single"):
        yield from (Request(kind, precision) for kind in KINDS)
    if names := runtime_names(scene, model):
        yield Request(runtime=names)
        yield Request(runtime=tuple(name for name in names if name != "load"), stream=True)
    if model.damping is None:  # else it is that of modes
        yield Request(stream=True)
    if names := mode_set_names(model):
        yield Request("modes", runtime=names)
        yield Request("modes", runtime=tuple(name for name in names if name != "load"), stream=True)


def compare_programs(
    scene: Scene, known: ReferenceOutputs, integrals: Integrals, requests: Sequence[Request] | None = None
) -> list[Outcome]:
    """A row for each program in each language: the output in which it is worst.

    Without `requests` all that may serve the scene, and `run`. What is refused has a row that says so, and no error.
    """
    model, compiles = known.whole, _compiles()
    found: list[ProgramValues] = []
    reasons: dict[str, list[str]] = {}
    refused: set[str] = set()
    if requests is None and known.outputs:
        found.append(_run(known, integrals))
    for request in all_requests(scene, model) if requests is None else requests:
        if requests is None and request.precision == "single" and request.evaluator in refused:
            continue
        name = _name(request)
        try:
            if request.runtime and not request.stream and request.is_of_mode_sets(model) and compiles:
                found += _run_mode_sets(scene, known, integrals, request, name)
                continue
            program = _build(scene, model, request, is_required=requests is not None)
        except (CostError, UnservedError, ToleranceError, RangeError) as error:
            refused.add(request.evaluator)
            reasons.setdefault(str(error), []).append(name)
            continue
        found += _run_numpy(known, integrals, program, name)
        if program.numpy_only or not compiles:
            reasons.setdefault(program.numpy_only or "there is no C compiler", []).append(f"{name}, C")
        else:
            found += _run_c(scene, known, integrals, program, name)
    for each in found:
        if each.refusal:
            reasons.setdefault(each.refusal, []).append(each.name)
    return [_compare(known, integrals, each) for each in found if not each.refusal] + [
        Outcome(name, {"of": "-", "error": "refused"}, True, f"{model.name}: not {'; not '.join(names)}: {why}")
        for why, names in reasons.items()
        for name in names
    ]


def _compiles() -> bool:
    try:
        compiler()
    except CompilerError:
        return False
    return True


def _name(request: Request) -> str:
    kind = request.evaluator if request.evaluator != "auto" else "" if request.stream or request.runtime else "auto"
    runtime = " ".join(("runtime", *request.runtime)) if request.runtime else ""
    precision = "single" if request.precision == "single" else ""
    return ", ".join(filter(None, (kind, "stream" if request.stream else "", runtime, precision)))


def _build(scene: Scene, model: Model, request: Request, *, is_required: bool) -> Program:
    """The program; in single precision for a larger tolerance, where it has to be."""
    if request.runtime and request.is_of_mode_sets(model):
        return mode_sets_program(model, request, ())
    if request.stream and not request.is_of_modes(model):
        endless = replace(model, endless=True)
        return stream_program(endless, request, inputs_of(endless, sources(scene)))
    if request.runtime:
        request = replace(request, parts=PARTS)
        return runtime_program(model, request, amplitudes(scene) if "load" in request.runtime else ())
    tolerances = [model.tolerance]
    if request.precision == "single":
        least = max(model.tolerance, _ROUNDINGS * SINGLE.roundoff)
        tolerances = [each for each in (model.tolerance, *LOOSENED) if each >= least]
    for tolerance in tolerances[:-1]:
        with suppress(CostError, UnservedError, ToleranceError):
            return make(model.tolerating(tolerance), request, tested=True, asked=is_required)
    return make(model.tolerating(tolerances[-1]), request, tested=True, asked=is_required)


# running


def _run(known: ReferenceOutputs, integrals: Integrals) -> ProgramValues:
    """What `run` gives: the exact values, and more of them where integrations ask for them."""
    others = sorted({tau for each in integrals if each and each.clear for tau in each.taus} - {*known.taus})
    exact = np.array([each.values for each in known.outputs])
    taus = np.array([*known.taus, *others])
    if others and known.exact:
        exact = np.hstack([exact, known.exact.values(others)])
    sizes, order = [each.scale for each in known.outputs], np.argsort(taus[: exact.shape[1]])
    return ProgramValues("run", taus[order], exact[:, order], sizes, [_ROUNDED] * len(sizes))


def _run_numpy(known: ReferenceOutputs, integrals: Integrals, program: Program, name: str) -> Iterator[ProgramValues]:
    if program.laws or program.evaluator == "stream":
        return
    module = import_text(files(program, "numpy")[f"{known.whole.name}.py"], known.whole.name)
    taus, given, late = _instants(known, integrals, program)
    values = np.asarray(module.evaluate(given), np.float64)
    yield ProgramValues(f"{name}, NumPy", taus, values, _sizes(known, integrals, program), _bounds(program), late)


def _run_mode_sets(
    scene: Scene, known: ReferenceOutputs, integrals: Integrals, request: Request, name: str
) -> Iterator[ProgramValues]:
    sizes = [output.scale for output in known.outputs] or [each.size if each else 0.0 for each in integrals]
    taus = np.unique(np.array([*known.taus, *(tau for each in integrals if each for tau in each.taus)]))
    return mode_set_values(scene, known.whole, request.runtime, taus, sizes, name)


def _run_c(
    scene: Scene, known: ReferenceOutputs, integrals: Integrals, program: Program, name: str
) -> Iterator[ProgramValues]:
    model, sizes, bounds = known.whole, _sizes(known, integrals, program), _bounds(program)
    real = np.float32 if program.real.bytes == 4 else np.float64
    taus, given, late = _instants(known, integrals, program)
    with compile_files(files(program, "c"), len(model.probes), real, FLAGS) as built:
        fails = f"{model.name}: {name}: the self-test of the generated C fails"
        note = fails if program.reference and built.selftest() != 0 else ""
        started = ProgramValues(name, taus, np.empty(0), sizes, bounds, note=note)
        if program.evaluator == "runtime":
            yield from _with_parameters(scene, known, integrals, program, built, name)
        elif program.evaluator in ("stream", "modes", "mode_sets"):
            yield from run_streams(scene, known, program, built, started)
        else:
            some = np.arange(len(taus))
            if program.evaluator == "march":
                some = sample_evenly(some, _MOST_MARCHED)
            values = built(given[some].tolist())
            yield replace(started, name=f"{name}, C", taus=taus[some], values=values, late=late)


def _with_parameters(
    scene: Scene, known: ReferenceOutputs, integrals: Integrals, program: Program, built: CompiledLibrary, name: str
) -> Iterator[ProgramValues]:
    """With the scene's own parameters, and with others, of which only integrations know anything."""
    assert program.laws is not None
    _, taus, _ = _instants(known, integrals, program)
    numbers = [nearest(value) for field in program.laws.fields for value in field.values]
    own = ParameterSet(numbers, _sizes(known, integrals, program), integrals, known if known.outputs else None)
    others, changed = draw_parameters(scene, known.whole, program.laws.fields)
    yield from model_values(built, f"{name}, C", own, taus, known.until)
    yield from functions_of_parameters(built, f"{name}, C", own, others, taus, known.until)
    instants = np.unique([*[tau for tau in known.taus if np.float32(tau) == tau][::_SOME], *even_taus(known.until)])
    method = collocation_method(changed.shorten(known.model.until), known.until, instants.tolist())
    if isinstance(method, str):
        yield ProgramValues(f"{name}, C, others", taus, np.empty(0), [], [], refusal=method)
        return
    _, refined = method.refine([None] * len(program.outputs))
    sizes = [float(np.max(np.abs(each.values))) for each in refined]
    judges = [IntegratedOutput(instants.tolist(), each.values, each.error_bound * each.scale) for each in refined]
    yield from model_values(built, f"{name}, C, others", ParameterSet(others, sizes, judges), instants, known.until)


def _instants(known: ReferenceOutputs, integrals: Integrals, program: Program) -> tuple[Array, Array, float]:
    """Where values are compared, these as numbers of the program's type, and how far they are from that at most.

    A front may pass between an instant and the number of single precision that is nearest to it: such instants are
    compared only where integrations are clear of fronts, and with these alone, as other outputs may not be.
    """
    real = np.float32 if program.real.bytes == 4 else np.float64
    there = [each for each in integrals if each]
    exact = np.array([*known.taus, *(tau for each in there if not each.clear for tau in each.taus)])
    clear = np.array([tau for each in there if each.clear for tau in each.taus])
    clear = clear[(clear.astype(real) == clear) | ~np.isin(clear, exact)]
    taus = np.unique(np.concatenate([exact[exact.astype(real) == exact], clear]))
    given = np.minimum(taus.astype(real), real(program.tau_max)).astype(np.float64)
    return taus, given, float(np.max(np.abs(given - taus), initial=0.0))


def _sizes(known: ReferenceOutputs, integrals: Integrals, program: Program) -> list[float]:
    """The largest value of each output on the whole horizon, as far as it is known.

    A stream has been judged under other loads: what it states is relative to what its outputs come to under these.
    """
    found = []
    for k, output in enumerate(program.outputs):
        if known.outputs:
            seen = 0.0 if known.outputs[k].zero else known.outputs[k].scale
        else:
            seen = each.size if (each := integrals[k]) else 0.0
        found.append(seen if program.evaluator == "stream" else max(output.largest, seen))
    return found


def _bounds(program: Program) -> list[float]:
    return [output.bound + _ROUNDED for output in program.outputs]


# judging


def _compare(known: ReferenceOutputs, integrals: Integrals, found: ProgramValues) -> Outcome:
    """The row of a program: of the output in which it comes closest to what it may be wrong by, or is wrong."""
    worst, row = -1.0, {"of": "-"}
    judges = zip(_exact(known, found), found.integrals or integrals, strict=True)
    for k, (probe, (exact, integral)) in enumerate(zip(known.whole.probes, judges, strict=True)):
        size = found.sizes[k]
        stated, unit, parts = found.bounds[k] * size, size or 1.0, []
        cells = {"of": probe.name} | dict.fromkeys(("error", "difference", "allowed"), "-")
        cells["bound"] = format_error(stated / unit)
        for column, judge, close in (("error", exact, 0.0), ("difference", integral, found.close)):
            if judge is None or not len(pairs := _pairs(found.taus, np.array(judge.taus), close)):
                continue
            error, allowed = _largest(found.values[k][pairs[:, 0]] - judge.values[pairs[:, 1]]), 0.0
            if judge is integral:
                allowed = judge.error_bound + found.late * judge.steepest
                cells["allowed"] = format_error(allowed / unit)
            cells[column] = format_error(error / unit)
            parts.append(_part(error, stated + allowed))
        if (part := max(parts, default=inf)) > worst:
            worst, row = part, cells
    return Outcome(found.name, row, not found.note and worst <= 1, found.note)


def _exact(known: ReferenceOutputs, found: ProgramValues) -> Integrals:
    """Exact values of each output at instants of a program, where there are any."""
    if found.integrals or not known.outputs or not len(found.taus):
        return [None] * len(known.whole.probes)
    taus, values = known.taus, [output.values for output in known.outputs]
    if known.exact and not len(_pairs(found.taus, np.array(taus))):
        taus = found.taus.tolist()
        values = [np.array(row) for row in known.exact.values(taus)]
    return [IntegratedOutput(taus, row, 0.0) for row in values]


def _pairs(mine: Array, theirs: Array, close: float = 0.0) -> NDArray[np.int_]:
    """Which of two ascending lists of instants are the same: pairs of places, (n, 2)."""
    if not len(mine):
        return np.zeros((0, 2), int)
    after = np.clip(np.searchsorted(mine, theirs), 0, len(mine) - 1)
    before = np.maximum(after - 1, 0)
    near = np.where(np.abs(mine[before] - theirs) < np.abs(mine[after] - theirs), before, after)
    (same,) = np.nonzero(np.abs(mine[near] - theirs) <= close)
    return np.stack([near[same], same], axis=1)


def _largest(errors: Array) -> float:
    """The largest absolute value; NaN where there is one."""
    return float(np.max(np.abs(errors), initial=0.0))


def _part(error: float, allowed: float) -> float:
    """What an error is of what is allowed: more than 1 where it is wrong."""
    if isnan(error) or isnan(allowed) or error > allowed == 0:
        return inf
    return error / allowed if allowed else 0.0
