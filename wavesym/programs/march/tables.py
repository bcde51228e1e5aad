"""A march as flat tables and single numbers: what schemes/march.py and templates/c/march/march.c are run from."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from flint import arb, ctx, fmpq

from wavesym.numbers.doubles import middle, rational
from wavesym.numbers.reals import Real
from wavesym.programs.flat import firsts
from wavesym.programs.march.given import SMOOTH
from wavesym.programs.march.plan import Plan, Stretch

if TYPE_CHECKING:
    from wavesym.programs.march.evaluator import MarchEvaluator


def march_tables(evaluator: MarchEvaluator) -> dict[str, tuple[float, ...]]:
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
        "first_heard": firsts(map(len, heard)),
        "way": tuple(each.way for of in heard for each in of),
        "sender": tuple(each.column for of in heard for each in of),
        "gain": reals(each.gain for of in heard for each in of),
        "summed": tuple(int(each.summed) for of in heard for each in of),
        "delay": tuple(delays.index(each.delay) for of in heard for each in of),
        "first_stretch": firsts(map(len, stretches)),
        "from": tuple(_counts_from(stretch, real) for stretch in flat),
        "start": reals(stretch.start for stretch in flat),
        "excess": reals(rational(real.nearest(stretch.start)) - stretch.start for stretch in flat),
        "back": tuple(stretch.back for stretch in flat),
        "panel_of": tuple(stretch.panel for stretch in flat),
    }


def march_constants(evaluator: MarchEvaluator) -> dict[str, float]:
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
