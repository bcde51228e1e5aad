"""Evaluator -> Program: its numbers as flat tables by name, each as it will be written.

Indices are ints, all else floats of the program's format. `first_...[g]` is where group g starts in a table, and
`first_...[g + 1]` where it ends.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import accumulate

from flint import arb, ctx, fmpq

from wavesym.numbers.doubles import middle, rational
from wavesym.numbers.reals import Real
from wavesym.programs.closed import ClosedForm
from wavesym.programs.hats.evaluator import HatMarch
from wavesym.programs.march.evaluator import MarchEvaluator
from wavesym.programs.march.given import SMOOTH
from wavesym.programs.march.plan import Plan, Stretch
from wavesym.programs.modes.evaluator import ModesEvaluator
from wavesym.programs.pieces import Pieces
from wavesym.programs.program import Driven, Program, Provenance
from wavesym.programs.rings.evaluator import RingMarch


def assemble(
    evaluator: ClosedForm | Pieces | MarchEvaluator | RingMarch | HatMarch | ModesEvaluator, provenance: Provenance
) -> Program:
    """The program of an evaluator, whatever its bound."""
    match evaluator:
        case ClosedForm():
            return _closed(evaluator, provenance)
        case Pieces():
            return _pieces(evaluator, provenance)
        case MarchEvaluator():
            return _march(evaluator, provenance)
        case RingMarch(tau_max=tau_max, outputs=outputs, tables=tables, constants=constants):
            return Program("rings", evaluator.real, tau_max, outputs, tables, constants, evaluator.bytes, provenance)
        case HatMarch(tau_max=tau_max, outputs=outputs, tables=tables, constants=constants):
            return Program(
                "hats",
                evaluator.real,
                tau_max,
                outputs,
                tables,
                constants,
                evaluator.bytes,
                provenance,
                numpy_only=evaluator.refusal,
            )
        case ModesEvaluator(tau_max=tau_max, outputs=outputs, tables=tables, constants=constants):
            return Program(
                "modes",
                evaluator.real,
                tau_max,
                outputs,
                tables,
                constants,
                evaluator.bytes,
                provenance,
                sources=evaluator.told_sources,
                proved=evaluator.proved,
            )


def _closed(form: ClosedForm, provenance: Provenance) -> Program:
    """Of output o the pulses first_pulse[o] ... in order of their start; of a pulse its families, of these the powers.

    `coefficient` has the powers of a family, lowest first.
    """
    pulses = [pulse for output in form.outputs for pulse in output.pulses]
    families = [family for pulse in pulses for family in pulse.families]
    tables: dict[str, tuple[float, ...]] = {
        "first_pulse": _firsts(len(output.pulses) for output in form.outputs),
        "start": tuple(pulse.start for pulse in pulses),
        "excess": tuple(pulse.excess for pulse in pulses),
        "first_family": _firsts(len(pulse.families) for pulse in pulses),
        "rate": tuple(family.rate for family in families),
        "first_power": _firsts(len(family.powers) for family in families),
        "coefficient": tuple(power for family in families for power in family.powers),
    }
    return Program("closed", form.real, form.tau_max, form.outputs, tables, {}, form.bytes, provenance)


def _pieces(form: Pieces, provenance: Provenance) -> Program:
    """Of grid g its outputs first_member[g] ..., its pieces, and at first_piece[g] + g their starts and the last end.

    The polynomials of piece p of all grids start at first_power[p] in `coefficient`: highest power first, of each power
    those of all members. To find tau's piece: from part[first_part[g] + int(tau * scale[g])] at most `steps` on.
    """
    grids = form.grids
    pieces = [piece for grid in grids for piece in grid.powers]
    tables: dict[str, tuple[float, ...]] = {
        "first_member": _firsts(len(grid.outputs) for grid in grids),
        "member": tuple(k for grid in grids for k in grid.outputs),
        "first_piece": _firsts(len(grid.centres) for grid in grids),
        "start": tuple(start for grid in grids for start in grid.starts),
        "centre": tuple(centre for grid in grids for centre in grid.centres),
        "first_part": _firsts(len(grid.first) for grid in grids),
        "scale": tuple(grid.scale for grid in grids),
        "part": tuple(piece for grid in grids for piece in grid.first),
        "first_power": _firsts(sum(map(len, piece)) for piece in pieces),
        "coefficient": tuple(c for piece in pieces for power in reversed([*zip(*piece, strict=True)]) for c in power),
    }
    constants: dict[str, float] = {"steps": max(grid.steps for grid in grids)}
    return Program("pieces", form.real, form.tau_max, form.outputs, tables, constants, form.bytes, provenance)


def _march(evaluator: MarchEvaluator, provenance: Provenance) -> Program:
    """A march remembers waves; what it is made of are tables of a window, and constants."""
    plan, given = evaluator.plan, evaluator.given
    return Program(
        "march",
        evaluator.real,
        plan.tau_max,
        evaluator.outputs,
        _march_tables(evaluator),
        _march_constants(evaluator),
        evaluator.bytes,
        provenance,
        sources=tuple(channel.name for channel in plan.channels),
        whole=math.isinf(plan.valid),
        driven=Driven(given.windows, given.errors) if given else None,
    )


def _march_tables(evaluator: MarchEvaluator) -> dict[str, tuple[float, ...]]:
    """Panels, nodes, the operators of bodies, changes of loads, loads to be given, outputs, and where waves arrive."""
    plan, real, degree = evaluator.plan, evaluator.real, evaluator.degree
    nodes, panels = plan.junctions, plan.panels
    rows = {step: row for row, step in enumerate(evaluator.operators)}
    operators = list(evaluator.operators.values())
    delays = sorted({each.delay for output in plan.outputs for each in output.heard})
    heard = [output.heard if made.bound else () for output, made in zip(plan.outputs, evaluator.outputs, strict=True)]
    stretches = [plan.stretches(delay) for delay in delays]
    flat = [stretch for group in stretches for stretch in group]
    forces = {column: force for force, column in enumerate(plan.loaded)}

    def reals(values: Iterable[fmpq]) -> tuple[float, ...]:
        return tuple(map(real.nearest, values))

    def rounded(values: Iterable[float]) -> tuple[float, ...]:
        return reals(map(rational, values))

    return {
        "point": reals(p.start + p.length * (1 - c) / 2 for p in panels for c in _cosines(degree)),
        "cosine": reals(_cosines(degree)),
        "half_length": reals(panel.length / 2 for panel in panels),
        "since": reals(panel.start - other.start for panel in panels for other in panels),
        "alpha": reals(node.alpha for node in nodes),
        "beta": reals(node.beta for node in nodes),
        "body": tuple(
            -1 if node.rate is None else rows[node.rate * panel.length] for panel in panels for node in nodes
        ),
        "force_on": tuple(forces.get(column, -1) for column in range(len(nodes))),
        "motion": reals(node.motion for node in nodes),
        "mass": reals(node.mass for node in nodes),
        "impedance": reals([*(node.left for node in nodes), nodes[-1].right]),
        "rod": reals(plan.rods),
        "ratio": rounded(value for operator in operators for value in operator.ratio),
        "first": rounded(value for operator in operators for value in operator.first),
        "last": rounded(value for operator in operators for value in operator.last),
        "slack": rounded(operator.slack for operator in operators),
        "loss": rounded(operator.loss for operator in operators),
        "leak": rounded(operator.leak for operator in operators),
        "event_window": tuple(event.window for event in plan.events),
        "event_panel": tuple(event.panel for event in plan.events),
        "event_force": tuple(event.force for event in plan.events),
        "event_power": reals(power for event in plan.events for power in event.powers),
        "source_force": tuple(channel.force for channel in plan.channels),
        "source_gain": reals(channel.gain for channel in plan.channels),
        "source_integral": tuple(channel.order for channel in plan.channels),
        "first_heard": _firsts(map(len, heard)),
        "way": tuple(each.way for of in heard for each in of),
        "sender": tuple(each.column for of in heard for each in of),
        "gain": reals(each.gain for of in heard for each in of),
        "summed": tuple(int(each.summed) for of in heard for each in of),
        "delay": tuple(delays.index(each.delay) for of in heard for each in of),
        "first_stretch": _firsts(map(len, stretches)),
        "from": tuple(_counts_from(stretch, real) for stretch in flat),
        "start": reals(stretch.start for stretch in flat),
        "excess": reals(rational(real.nearest(stretch.start)) - stretch.start for stretch in flat),
        "back": tuple(stretch.back for stretch in flat),
        "panel_of": tuple(stretch.panel for stretch in flat),
    }


def _march_constants(evaluator: MarchEvaluator) -> dict[str, float]:
    """Sizes, and what the program holds the loads and its own polynomials against."""
    plan, real, degree = evaluator.plan, evaluator.real, evaluator.degree
    constants: dict[str, float] = {
        "degree": degree,
        "panels": len(plan.panels),
        "nodes": len(plan.junctions),
        "first_node": plan.first,
        "forces": len(plan.loaded),
        "sources": len(plan.channels),
        "ways": plan.ways,
        "points": len(plan.panels) * (degree + 1),
        "events": len(plan.events),
        "last_window": _last_window(plan, real),
        "last_tau": real.nearest(rational(min(plan.valid, float(real.reach)))),
        "trusted": real.not_below(rational(plan.trusted)),
        "smooth": real.not_below(rational(plan.tolerance)),
        "reach": real.nearest(real.reach),
        # of coefficients that are sums of as many products, each rounded a few times
        "noise": real.nearest(4 * (degree + 8) * real.roundoff),
    }
    if evaluator.given:
        constants |= {
            "windows": evaluator.given.windows,
            "given_degree": SMOOTH,
            "given_error": real.not_below(rational(max(evaluator.given.errors))),
        }
    return constants


def _firsts(counts: Iterable[int]) -> tuple[int, ...]:
    """Where each group starts in a flat table, and where the last one ends."""
    return tuple(accumulate(counts, initial=0))


def _last_window(plan: Plan, real: Real) -> int:
    """The last window that real numbers can count, and on which all is modelled."""
    if math.isinf(plan.valid):
        return int(1 / real.roundoff) - 1
    return math.ceil(plan.valid) - 1 if plan.valid > plan.tau_max else int(plan.tau_max)


def _counts_from(stretch: Stretch, real: Real) -> float:
    """The first number that is not before the stretch: tau less the start of its window is exact, so this decides."""
    return real.not_below(max(stretch.start, fmpq(0)))


def _cosines(degree: int) -> Sequence[fmpq]:
    """cos(pi j / degree), to many more digits than are written."""
    with ctx.workprec(200):
        return [middle(arb.cos_pi_fmpq(fmpq(j, degree))) for j in range(degree + 1)]
