"""Model -> Program, for a chain that is written out whose parameters come at run time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil, sqrt
from typing import Any

from flint import fmpq, fmpq_mat

from wavesym.errors import CostError
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest, rational
from wavesym.numbers.reals import Real
from wavesym.programs.flat import firsts
from wavesym.programs.march.plan import MarchPlan
from wavesym.programs.march.space import JointRows
from wavesym.programs.program import Program, ProgramOutput, Provenance
from wavesym.programs.request import Request
from wavesym.programs.runtime.degree import LEAST, MARGIN, lightest, refuse_huge
from wavesym.programs.runtime.joints.network import free_network
from wavesym.programs.runtime.joints.plan import JointsPlan, joints_plan
from wavesym.programs.runtime.laws import RuntimeLaws
from wavesym.programs.runtime.pushes import as_one
from wavesym.programs.runtime.readings import reading_tables
from wavesym.programs.runtime.roundings import most_roundings
from wavesym.programs.runtime.units import Function

_MOST_STATES = 8
_MOST_WINDOWS = 20_000


def joints_program(
    model: Model, request: Request, amplitudes: Sequence[tuple[str, Applied]], tolerance: fmpq, real: Real
) -> Program:
    """The program of a chain. WavesymError, UnservedError as `free_network` says, CostError as `joints_plan`."""
    free = free_network(model, request.runtime, amplitudes)
    chosen = "load" in request.runtime
    loads = [load for _, load in amplitudes] if chosen else as_one(model)
    made = joints_plan(model, free, loads, real)
    _refuse_large(made)
    fastest = _fastest(made.own)
    kappa_max = lightest(free.fields, request.kappa_max, fastest)
    least, degree = _degrees(made.own, fastest, kappa_max)
    refuse_huge(made.plan.windows, made.plan.tau_max, len(made.strands), degree, real)
    share = max(nearest(tolerance / (MARGIN * made.plan.windows)), 2 * nearest(real.roundoff))
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
    light = "" if kappa_max is None else f", for rates up to {nearest(max(fastest, kappa_max)):g}"
    reason = (
        f"march with {', '.join(request.runtime)} at run time, degrees from {least} to {degree} on steps of "
        f"{made.plan.step}{light}; errors are estimated"
    )
    return Program(
        "joints",
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


def _refuse_large(made: JointsPlan) -> None:
    states = max(len(joint.space.weights) for joint in made.plan.joints)
    if states > _MOST_STATES:
        raise CostError(
            f"system.parts: {states} masses and springs linked to one another, at most {_MOST_STATES} expected with "
            "--runtime (fewer springs between the same rods help)"
        )
    if made.plan.windows > _MOST_WINDOWS:
        raise CostError(
            f"output.until: {made.plan.windows} steps of {made.plan.step} to tau = {made.plan.tau_max:g}, at most "
            f"{_MOST_WINDOWS} expected (a shorter horizon, or lengths with a larger common measure, help)"
        )


def _fastest(own: MarchPlan) -> fmpq:
    """The largest rate at which a joint answers a wave: of a mass, impedances and dashpots beside it over it."""
    return max((-j.space.rates[n, n] for j in own.joints for n in range(j.space.states)), default=fmpq(0))


def _degrees(own: MarchPlan, fastest: fmpq, kappa_max: fmpq | None) -> tuple[int, int]:
    """About the degree to begin with, and one that is enough for rates up to `kappa_max`, too.

    A front that has met n bodies of rate g is like a Laguerre function: sqrt(2 g n) oscillations to be resolved. A
    stiff spring adds those of a body on it.
    """
    longest = max(nearest(panel.length) for panel in own.panels)
    turning = max(joint.space.turning for joint in own.joints)

    def detail(rate: fmpq) -> float:
        along = nearest(rate) * longest
        return sqrt(2 * along * own.crossings) + along / 8 + 2 * turning * longest

    first = max(LEAST, ceil(detail(fastest) / 2))
    return first, max(ceil(1.5 * detail(max(fastest, kappa_max or fastest))) + 24, first)


def _laws(made: JointsPlan, amplitudes: tuple[float, ...]) -> RuntimeLaws:
    spaces = [joint.space for joint in made.plan.joints]
    functions: dict[str, tuple[Function, ...]] = {
        name: tuple(value for space in spaces for value in _flat(getattr(space, name)))
        for name in ("rates", "pushed", "shown", "passed")
    }
    functions |= {
        "push": tuple(port.push for space in spaces for port in space.ports),
        "held": tuple(track.held for track in made.plan.tracks),
        "begun": tuple(value for space in spaces for value in space.begun),
        "weight": tuple(value for space in spaces for value in space.weights),
        "impedance": tuple(port.impedance for space in spaces for port in space.ports),
        "strength": _strengths(made),
        "gain": tuple(wave.gain for _, wave in made.heard),
    }
    return RuntimeLaws(made.free.fields, functions, amplitudes)


def _flat(matrix: Any) -> list[Any]:
    if isinstance(matrix, fmpq_mat):  # of what no parameter changes
        return list(matrix.entries())
    return [value for row in matrix for value in row]


def _strengths(made: JointsPlan) -> tuple[Function, ...]:
    return tuple(dict.fromkeys(push.strength for push in made.pushes))


def _constants(made: JointsPlan, laws: RuntimeLaws, real: Real) -> dict[str, float]:
    plan = made.plan
    states = [len(joint.space.weights) for joint in plan.joints]
    points = [len(joint.forces) for joint in plan.joints]
    cycle, span = plan.cycle
    return {
        "windows": plan.windows,
        "panels": len(plan.panels),
        "joints": len(plan.joints),
        "points": sum(points),
        "states": sum(states),
        "squares": sum(count * count for count in states),
        "widest": max(*states, *points),
        "ports": sum(len(joint.space.ports) for joint in plan.joints),
        "tracks": len(plan.tracks),
        "slots": sum(track.steps + 1 for track in plan.tracks),
        "forces": plan.forces,
        "heard": len(made.heard),
        "strands": len(made.strands),
        "events": len(made.pushes),
        "lanes": sum(len(field.values) for field in laws.fields),
        "sections": len(made.sections) - 1,
        "groups": (len(made.sections) - 1) * len(plan.outputs),
        "cycle": cycle,
        "span": real.nearest(fmpq(span)),
        "step": real.nearest(plan.step),
        "unit": 2 * nearest(real.roundoff),
    }


def _tables(made: JointsPlan, laws: RuntimeLaws, real: Real) -> dict[str, tuple[float, ...]]:
    """Joints and their ends, rings, panels, changes of loads, sections, strands and the waves they are made of."""
    plan, pushes = made.plan, made.pushes
    spaces = [joint.space for joint in plan.joints]
    strengths = _strengths(made)
    terms = [term for strand in made.strands for term in strand.terms]
    sections, outputs = len(made.sections) - 1, len(plan.outputs)
    heard = [[made.listening(section, output) for output in range(outputs)] for section in range(sections)]
    listening = [strands for section in heard for strands in section]
    windows = [plan.step * phase for phase in range(plan.cycle[0])]
    starts = [begin + strand.start for begin in windows for strand in made.strands]

    reals = real.table

    return {
        "first_point": firsts(len(joint.forces) for joint in plan.joints),
        "first_state": firsts(len(space.weights) for space in spaces),
        "first_port": firsts(len(space.ports) for space in spaces),
        **{
            f"at_{name}": firsts(len(_flat(getattr(space, name))) for space in spaces)
            for name in ("rates", "pushed", "shown", "passed")
        },
        "point_of": tuple(port.point for space in spaces for port in space.ports),
        "ratio": reals(port.ratio for space in spaces for port in space.ports),
        "arrive": tuple(track for joint in plan.joints for track in joint.arrive),
        "send": tuple(track for joint in plan.joints for track in joint.sends),
        "steps": tuple(track.steps for track in plan.tracks),
        "ring": firsts(track.steps + 1 for track in plan.tracks),
        "is_mass": (*_masses(made), 0),
        "half_length": reals(panel.length / 2 for panel in plan.panels),
        "since_panel": reals(panel.start - other.start for panel in plan.panels for other in plan.panels),
        "force_on": tuple(force for joint in plan.joints for force in joint.forces),
        "event_window": tuple(push.window for push in pushes),
        "event_panel": tuple(push.panel for push in pushes),
        "event_force": tuple(push.force for push in pushes),
        # of a load that is told anew 3 more
        "event_power": tuple(push.power + 3 * push.anew for push in pushes),
        "event_weight": reals(push.weight for push in pushes),
        "event_strength": tuple(strengths.index(push.strength) for push in pushes),
        "event_load": tuple(push.load for push in pushes),
        "from": (
            *(real.not_below(begin + at) for begin in windows for at in made.sections[:-1]),
            real.nearest(fmpq(plan.cycle[1])),
        ),
        "first_strand": firsts(map(len, listening)),
        "strand_at": tuple(strand for group in listening for strand in group),
        **reading_tables(made.strands, heard),
        "strand_start": reals(starts),
        "strand_excess": reals(rational(real.nearest(start)) - start for start in starts),
        "strand_scale": reals(1 / strand.half for strand in made.strands),
        "first_term": firsts(len(strand.terms) for strand in made.strands),
        "term_heard": tuple(term.heard for term in terms),
        "term_track": tuple(term.wave.track for term in terms),
        "term_back": tuple(term.stretch.back for term in terms),
        "term_panel": tuple(term.stretch.panel for term in terms),
        "term_summed": tuple(int(term.wave.summed) for term in terms),
        "term_low": reals(term.low for term in terms),
        "term_high": reals(term.high for term in terms),
        "heard_output": tuple(output for output, _ in made.heard),
        "silent": tuple(map(int, made.silent)),
    }


def _masses(made: JointsPlan) -> Iterator[int]:
    """Of each state whether it is the velocity of a mass: these come first in a joint."""
    for joint in made.plan.joints:
        if isinstance(rows := joint.space, JointRows):  # others have no state
            yield from (int(n < rows.masses) for n in range(len(rows.weights)))
