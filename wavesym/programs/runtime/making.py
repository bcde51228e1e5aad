"""Model -> Program, for parameters at run time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from flint import fmpq

from wavesym.errors import WavesymError
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest, rational
from wavesym.numbers.reals import REALS, Real
from wavesym.programs.flat import firsts
from wavesym.programs.program import Program, ProgramOutput, Provenance, ReferenceValues
from wavesym.programs.reference_values import reference_values
from wavesym.programs.request import Request
from wavesym.programs.runtime.degree import LIGHTEST, degrees, lightest, share
from wavesym.programs.runtime.joints.making import joints_program
from wavesym.programs.runtime.laws import RuntimeLaws
from wavesym.programs.runtime.line import LOAD, Plan
from wavesym.programs.runtime.plan import RuntimePlan, runtime_plan
from wavesym.programs.runtime.pushes import Push, as_one
from wavesym.programs.runtime.readings import reading_tables
from wavesym.programs.runtime.request import fields
from wavesym.programs.runtime.roundings import most_roundings
from wavesym.programs.runtime.units import Function

FINEST = {"double": fmpq(1, 10**13), "single": fmpq(1, 10**5)}
"""The smallest tolerance that numbers keep, by precision."""


def runtime_program(
    model: Model, request: Request, amplitudes: Sequence[tuple[str, Applied]], *, tested: bool = False
) -> Program:
    """The program of a model whose parameters `request.runtime` are given at run time.

    `amplitudes` are those of its loads, each with what it is called. WavesymError, CostError as `fields`,
    `runtime_plan` and `degrees` say, and where other options are given that say otherwise.
    """
    for option, value, usual in (
        ("--evaluator", request.evaluator, "auto"),
        ("--optimize", request.optimize, None),
    ):
        if value != usual:
            raise WavesymError(f"{option}: {value} given with --runtime, {usual or 'nothing'} expected")
    real = REALS[request.precision]
    tolerance = max(model.tolerance, FINEST[real.name])
    if model.chain is None:
        program = joints_program(model, request, amplitudes, tolerance, real)
        return _with_reference(program) if tested else program
    given = fields(model, request.runtime, amplitudes)
    chosen = any(field.name == "load" for field in given)
    loads = [load for _, load in amplitudes] if chosen else as_one(model)
    made = runtime_plan(model, given, loads, real)
    kappa_max = lightest(given, request.kappa_max, max(model.named.parameters.kappa.values()))
    least, degree = degrees(made, tolerance, real, kappa_max)
    light = "" if kappa_max is None else f" and for kappa up to {nearest(kappa_max):g}"
    reason = (
        f"march with {', '.join(request.runtime)} at run time, degrees from {least} to {degree}, enough for the "
        f"scene's own parameters{light}; errors are estimated"
    )
    tables = _tables(made, real)
    laws = _laws(made, () if chosen else (1.0,) * len(loads))
    positive = [label for field in given if field.positive for label in field.labels]
    rounded = most_roundings(laws.functions, positive)
    constants = {
        **_constants(made, real),
        "roundings": rounded,
        "degree": degree,
        "least": least,
        **({} if kappa_max is None else {"kappa_max": real.nearest(kappa_max)}),
        "share": share(made, tolerance, real),
    }
    program = Program(
        "runtime",
        real,
        made.plan.tau_max,
        tuple(ProgramOutput(output.name, nearest(tolerance), 0.0) for output in made.plan.outputs),
        tables,
        constants,
        real.bytes * sum(map(len, tables.values())),
        Provenance(model, reason, request.options),
        proved=False,
        laws=laws,
        parts=request.every_part,
    )
    return _with_reference(program) if tested else program


def sets_program(
    model: Model, names: Sequence[str], amplitudes: Sequence[tuple[str, Applied]] = (), precision: str = "double"
) -> Program:
    """The same for sets that are computed here, where there is memory for bodies as light as `LIGHTEST`."""
    request = Request(precision=precision, runtime=tuple(names), kappa_max=LIGHTEST)
    return runtime_program(model, request, amplitudes)


def _laws(made: RuntimePlan, amplitudes: tuple[float, ...]) -> RuntimeLaws:
    nodes = made.plan.junctions
    functions: dict[str, tuple[Function, ...]] = {
        "alpha": tuple(node.alpha for node in nodes),
        "beta": tuple(node.beta for node in nodes),
        "rate": tuple(fmpq(0) if node.rate is None else node.rate for node in nodes),
        "motion": tuple(node.motion for node in nodes),
        "rod": made.plan.rods,
        "strength": _strengths(made.pushes),
        "gain": tuple(wave.gain for _, wave in made.heard),
    }
    return RuntimeLaws(made.fields, functions, amplitudes)


def _strengths(pushes: Iterable[Push]) -> tuple[Function, ...]:
    return tuple(dict.fromkeys(push.strength for push in pushes))


def _constants(made: RuntimePlan, real: Real) -> dict[str, float]:
    """Sizes."""
    plan = made.plan
    return {
        "windows": plan.windows,
        "panels": len(plan.panels),
        "nodes": len(plan.junctions),
        "forces": len(plan.loaded),
        "heard": len(made.heard),
        "strands": len(made.strands),
        "events": len(made.pushes),
        "strengths": len(_strengths(made.pushes)),
        "lanes": sum(len(field.values) for field in made.fields),
        "sections": len(made.sections) - 1,
        "groups": (len(made.sections) - 1) * len(plan.outputs),
        "unit": 2 * nearest(real.roundoff),
    }


def _tables(made: RuntimePlan, real: Real) -> dict[str, tuple[float, ...]]:
    """Panels, changes of loads, sections, strands and the waves they are made of."""
    plan, pushes = made.plan, made.pushes
    strengths = _strengths(pushes)
    terms = [term for strand in made.strands for term in strand.terms]
    sections, outputs = len(made.sections) - 1, len(plan.outputs)
    heard = [[made.listening(section, output) for output in range(outputs)] for section in range(sections)]
    listening = [strands for section in heard for strands in section]
    forces = {column: force for force, column in enumerate(plan.loaded)}
    places = {strength: place for place, strength in enumerate(strengths)}

    reals = real.table

    return {
        "half_length": reals(panel.length / 2 for panel in plan.panels),
        "since_panel": reals(panel.start - other.start for panel in plan.panels for other in plan.panels),
        "force_on": tuple(forces.get(column, -1) for column in range(len(plan.junctions))),
        "is_body": tuple(int(node.rate is not None) for node in plan.junctions),
        "alike": _alike(plan),
        "event_window": tuple(push.window for push in pushes),
        "event_panel": tuple(push.panel for push in pushes),
        "event_force": tuple(push.force for push in pushes),
        # of a load that is told anew 3 more
        "event_power": tuple(push.power + 3 * push.anew for push in pushes),
        "event_weight": reals(push.weight for push in pushes),
        "event_strength": tuple(places[push.strength] for push in pushes),
        "event_load": tuple(push.load for push in pushes),
        "from": tuple(real.not_below(begin) for begin in made.sections),
        "first_strand": firsts(map(len, listening)),
        "strand_at": tuple(strand for group in listening for strand in group),
        **reading_tables(made.strands, heard),
        "strand_start": reals(strand.start for strand in made.strands),
        "strand_excess": reals(rational(real.nearest(strand.start)) - strand.start for strand in made.strands),
        "strand_scale": reals(1 / strand.half for strand in made.strands),
        "first_term": firsts(len(strand.terms) for strand in made.strands),
        "term_heard": tuple(term.heard for term in terms),
        "term_way": tuple(term.wave.way for term in terms),
        "term_sender": tuple(term.wave.column + (term.wave.way != LOAD) for term in terms),
        "term_back": tuple(term.stretch.back for term in terms),
        "term_panel": tuple(term.stretch.panel for term in terms),
        "term_summed": tuple(int(term.wave.summed) for term in terms),
        "term_low": reals(term.low for term in terms),
        "term_high": reals(term.high for term in terms),
        "heard_output": tuple(output for output, _ in made.heard),
        "silent": tuple(map(int, made.silent)),
    }


def _alike(plan: Plan) -> tuple[int, ...]:
    """For each node on each panel the first with the same rate, on a panel of the same length."""
    bodies = [(node.rate, panel.length) for panel in plan.panels for node in plan.junctions]
    return tuple(map(bodies.index, bodies))


@dataclass(frozen=True)
class _Built:
    """What reference values are asked for: the program with the scene's own parameters."""

    program: Program

    @property
    def real(self) -> Real:
        return self.program.real

    @property
    def outputs(self) -> tuple[ProgramOutput, ...]:
        return self.program.outputs

    @property
    def check_points(self) -> list[float]:
        until = self.program.tau_max
        return sorted({k / 8 for k in range(int(min(8 * until, 160)) + 1)} | {until})


def _with_reference(program: Program) -> Program:
    """With values of the scene's own parameters, for a self-test, and the largest of each output."""
    found = reference_values(program.provenance.model, _Built(program))
    assert isinstance(found, ReferenceValues)
    sizes = (max(map(abs, row)) for row in found.values)
    outputs = tuple(replace(output, largest=size) for output, size in zip(program.outputs, sizes, strict=True))
    return replace(program, outputs=outputs, reference=found)
