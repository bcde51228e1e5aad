"""Model -> Program, for parameters at run time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from flint import fmpq

from wavesym.errors import CostError
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest, rational
from wavesym.numbers.reals import REALS, Real
from wavesym.programs.form import reference_values
from wavesym.programs.march.space import BLOCK, BODY
from wavesym.programs.march.tables import plan_constants, port_tables
from wavesym.programs.program import Program, ProgramOutput, Provenance
from wavesym.programs.request import Request, refuse_beside
from wavesym.programs.runtime.degree import LIGHTEST, degrees, largest_kappa
from wavesym.programs.runtime.laws import Function, RuntimeLaws, matrix_laws, matrix_places, most_roundings
from wavesym.programs.runtime.network import free_network
from wavesym.programs.runtime.plan import RuntimePlan, as_one_load, reading_tables, runtime_plan
from wavesym.programs.tables import Tables, firsts

FINEST = {"double": fmpq(1, 10**13), "single": fmpq(1, 10**5)}
"""The smallest tolerance that numbers keep, by precision."""
LARGEST_MODEL = 1 << 28  # bytes

_MARGIN = 24  # outputs are often smaller than waves, and errors a few times what is missed
_MOST_STATES = 8
_MOST_WINDOWS = 20_000


def runtime_program(
    model: Model, request: Request, amplitudes: Sequence[tuple[str, AppliedLoad]], *, tested: bool = False
) -> Program:
    """The program of a model whose parameters `request.runtime` are given at run time.

    `amplitudes` are those of its loads, each with what it is called. WavesymError, UnservedError as `free_network`
    says, CostError as `runtime_plan`, and WavesymError where other options are given that say otherwise.
    """
    refuse_beside("--runtime", (("--evaluator", request.evaluator, "auto"), ("--optimize", request.optimize, None)))
    real = REALS[request.precision]
    tolerance = max(model.tolerance, FINEST[real.name])
    program = _program(model, request, amplitudes, tolerance, real)
    return _with_reference(program) if tested else program


def sets_program(
    model: Model, names: Sequence[str], amplitudes: Sequence[tuple[str, AppliedLoad]] = (), precision: str = "double"
) -> Program:
    """The same for sets that are computed here, where there is memory for bodies as light as `LIGHTEST`."""
    request = Request(precision=precision, runtime=tuple(names), kappa_max=LIGHTEST)
    return runtime_program(model, request, amplitudes)


def _program(
    model: Model, request: Request, amplitudes: Sequence[tuple[str, AppliedLoad]], tolerance: fmpq, real: Real
) -> Program:
    free = free_network(model, request.runtime, amplitudes)
    chosen = "load" in request.runtime
    loads = [load for _, load in amplitudes] if chosen else as_one_load(model)
    made = runtime_plan(model, free, loads, real)
    _refuse_large(made)
    share = max(nearest(tolerance / (_MARGIN * made.plan.windows)), 2 * nearest(real.roundoff))
    kappa_max = largest_kappa(made, request.kappa_max)
    least, degree = degrees(made, share, tolerance, kappa_max)
    _refuse_huge(made.plan.windows, made.plan.tau_max, len(made.strands), degree, real)
    laws = _laws(made, () if chosen else (1.0,) * len(loads))
    tables = _tables(made, laws, real)
    positive = [label for field in laws.fields if field.positive for label in field.labels]
    constants = {
        **_constants(made, laws, real),
        "roundings": most_roundings(laws.functions, positive),
        "degree": degree,
        "least": least,
        **({} if kappa_max is None else {"kappa_max": real.nearest(kappa_max)}),
        "share": share,
    }
    what = model.parameters.lightness or "rates"
    light = "" if kappa_max is None else f" and for {what} up to {nearest(kappa_max):g}"
    on = "" if made.plan.step == 1 else f" on steps of {made.plan.step}"
    reason = (
        f"march with {', '.join(request.runtime)} at run time, degrees from {least} to {degree}{on}, enough for the "
        f"scene's own parameters{light}; errors are estimated"
    )
    return Program(
        "runtime",
        real,
        made.plan.tau_max,
        tuple(ProgramOutput(output.name, nearest(tolerance), 0.0) for output in made.plan.outputs),
        tables,
        constants,
        real.bytes * sum(map(len, tables.values())),
        Provenance(model, reason, request.options(model)),
        proved=False,
        laws=laws,
        parts=request.every_part,
    )


def _refuse_large(made: RuntimePlan) -> None:
    states = max(joint.space.states for joint in made.plan.joints)
    if states > _MOST_STATES:
        raise CostError(
            f"system.parts: {states} masses and springs linked to one another, the limit with --runtime is "
            f"{_MOST_STATES} (fewer springs between the same rods help)"
        )
    if made.plan.windows > _MOST_WINDOWS:
        raise CostError(
            f"output.until: {made.plan.windows} steps of {made.plan.step} to tau = {made.plan.tau_max:g}, the "
            f"limit is {_MOST_WINDOWS} (a shorter horizon, or lengths with a larger common measure, help)"
        )


def _refuse_huge(windows: int, tau_max: float, strands: int, degree: int, real: Real) -> None:
    """CostError for a model that would be beyond reason."""
    size = real.bytes * windows * strands * (degree + 2)
    if size > LARGEST_MODEL:
        raise CostError(
            f"output.until: a model of {size:.1e} bytes would be kept to tau = {tau_max:g}, the limit is "
            f"{LARGEST_MODEL:.1e} (a shorter horizon, fewer outputs, or a smaller --kappa-max helps)"
        )


def _laws(made: RuntimePlan, amplitudes: tuple[float, ...]) -> RuntimeLaws:
    spaces = [joint.space for joint in made.plan.joints]
    functions = matrix_laws(made.plan.joints) | {
        "push": tuple(port.push for space in spaces for port in space.ports),
        "initial_wave": tuple(track.initial_value for track in made.plan.tracks),
        "initial": tuple(value for space in spaces for value in space.initial_state),
        "weight": tuple(value for space in spaces for value in space.weights),
        "impedance": tuple(port.impedance for space in spaces for port in space.ports),
        "strength": _strengths(made),
        "gain": tuple(wave.gain for _, wave in made.output_terms),
    }
    return RuntimeLaws(made.free.fields, functions, amplitudes)


def _strengths(made: RuntimePlan) -> tuple[Function, ...]:
    return tuple(dict.fromkeys(event.strength for event in made.events))


def _constants(made: RuntimePlan, laws: RuntimeLaws, real: Real) -> dict[str, float]:
    plan = made.plan
    spaces = [joint.space for joint in plan.joints]
    return {
        **plan_constants(plan, real),
        "windows": plan.windows,
        "points": sum(space.points for space in spaces),
        "squares": sum(space.states**2 for space in spaces if space.law == BLOCK),
        "bodies": len(_bodies(made)),
        "widest": max(max(space.states, space.points) for space in spaces),
        "ports": sum(len(space.ports) for space in spaces),
        "gains": len(made.output_terms),
        "strands": len(made.strands),
        "events": len(made.events),
        "lanes": sum(len(field.values) for field in laws.fields),
        "sections": len(made.sections) - 1,
        "groups": (len(made.sections) - 1) * len(plan.outputs),
        "unit": 2 * nearest(real.roundoff),
    }


def _tables(made: RuntimePlan, laws: RuntimeLaws, real: Real) -> Tables:
    """Joints and their ends, rings, panels, changes of loads, sections, strands and the waves they are made of."""
    plan, events = made.plan, made.events
    spaces = [joint.space for joint in plan.joints]
    strengths = _strengths(made)
    terms = [term for strand in made.strands for term in strand.terms]
    sections, outputs = len(made.sections) - 1, len(plan.outputs)
    strands = [[made.strands_of(section, output) for output in range(outputs)] for section in range(sections)]
    groups = [group for section in strands for group in section]
    windows = [plan.step * phase for phase in range(plan.cycle[0])]
    starts = [begin + strand.start for begin in windows for strand in made.strands]

    reals = real.table

    return {
        **port_tables(plan.joints, real),
        **matrix_places(plan.joints),
        "at_square": firsts(space.states**2 * (space.law == BLOCK) for space in spaces),
        # one more, where there is none
        "body_joint": (*_bodies(made), 0),
        "is_body": tuple(int(space.law == BODY) for space in spaces),
        "steps": tuple(track.steps for track in plan.tracks),
        "ring": firsts(track.steps + 1 for track in plan.tracks),
        "is_mass": (*_masses(made), 0),
        "half_length": reals(panel.length / 2 for panel in plan.panels),
        "since_panel": reals(
            panel.start - other.start + (plan.step if panel.start < other.start else 0)
            for panel in plan.panels
            for other in plan.panels
        ),
        "event_window": tuple(event.window for event in events),
        "event_panel": tuple(event.panel for event in events),
        "event_force": tuple(event.force for event in events),
        # 3 more where it replaces what acts
        "event_power": tuple(event.power + 3 * event.replaces for event in events),
        "event_weight": reals(event.weight for event in events),
        "event_strength": tuple(strengths.index(event.strength) for event in events),
        "event_load": tuple(event.load for event in events),
        "from": (
            *(real.not_below(begin + at) for begin in windows for at in made.sections[:-1]),
            real.nearest(fmpq(plan.cycle[1])),
        ),
        "first_strand": firsts(map(len, groups)),
        "strand_at": tuple(strand for group in groups for strand in group),
        **reading_tables(made.strands, strands),
        "strand_start": reals(starts),
        "strand_excess": reals(rational(real.nearest(start)) - start for start in starts),
        "strand_scale": reals(1 / strand.half for strand in made.strands),
        "first_term": firsts(len(strand.terms) for strand in made.strands),
        "term_gain": tuple(term.number for term in terms),
        "term_track": tuple(term.wave.track for term in terms),
        "term_back": tuple(term.stretch.back for term in terms),
        "term_panel": tuple(term.stretch.panel for term in terms),
        "term_summed": tuple(int(term.wave.summed) for term in terms),
        "term_low": reals(term.low for term in terms),
        "term_high": reals(term.high for term in terms),
        "gain_output": tuple(output for output, _ in made.output_terms),
        "is_zero": tuple(map(int, made.is_zero)),
    }


def _bodies(made: RuntimePlan) -> list[int]:
    """The joints that are bodies."""
    return [n for n, joint in enumerate(made.plan.joints) if joint.space.law == BODY]


def _masses(made: RuntimePlan) -> Iterator[int]:
    """Of each state whether it is the velocity of a mass: these come first in a joint."""
    for joint in made.plan.joints:
        yield from (int(point >= 0) for point in joint.space.moves_with)


def _with_reference(program: Program) -> Program:
    """With values of the scene's own parameters, for a self-test, and the largest of each output."""
    until = program.tau_max
    check_points = sorted({k / 8 for k in range(int(min(8 * until, 160)) + 1)} | {until})
    found = reference_values(program.provenance.model, program.real, check_points)
    sizes = (max(map(abs, row)) for row in found.values)
    outputs = tuple(replace(output, largest=size) for output, size in zip(program.outputs, sizes, strict=True))
    return replace(program, outputs=outputs, reference=found)
