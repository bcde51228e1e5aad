"""The march as C and as NumPy: its operators, nodes, loads and outputs as tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from flint import arb, ctx, fmpq

from wavesym.numbers.doubles import middle, rational
from wavesym.numbers.reals import Real
from wavesym.programs.march.evaluator import MarchEvaluator
from wavesym.programs.march.given import SMOOTH
from wavesym.programs.march.plan import Plan, Stretch
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import c_literal, firsts, lines

_QUANTITIES = ("strain", "velocity", "displacement")
_NOTHING = len(_QUANTITIES)  # 0 throughout

Lines = tuple[str, ...]


@dataclass(frozen=True)
class March:
    """What a march is, as text; every table as the lines between its brackets, in the templates' order."""

    degree: str
    panels: str
    nodes: str
    first_node: str
    forces: str
    sources: str
    source_names: str
    points: str
    events: str
    last_window: str
    last_tau: str
    whole: bool
    trusted: str
    smooth: str
    reach: str
    noise: str
    tolerance: str
    windows: str
    given_degree: str
    given_error: str
    bodies: bool
    point: Lines
    cosine: Lines
    half_length: Lines
    since: Lines
    alpha: Lines
    beta: Lines
    body: Lines
    force_on: Lines
    motion: Lines
    mass: Lines
    impedance: Lines
    rod: Lines
    ratio: Lines
    first: Lines
    last: Lines
    slack: Lines
    loss: Lines
    leak: Lines
    event_window: Lines
    event_panel: Lines
    event_force: Lines
    event_power: Lines
    source_force: Lines
    source_gain: Lines
    source_integral: Lines
    quantity: Lines
    left_node: Lines
    right_node: Lines
    left_delay: Lines
    right_delay: Lines
    first_stretch: Lines
    stretch_from: Lines
    stretch_start: Lines
    stretch_excess: Lines
    stretch_back: Lines
    stretch_panel: Lines


@dataclass(frozen=True)
class Program:
    """templates/c/march.c.j2, templates/c/march.h.j2 and templates/numpy/march.py.j2."""

    scene: Description
    march: March


def source(scene: Description, evaluator: MarchEvaluator) -> str:
    """NAME.c."""
    return render("c/march.c.j2", Program(scene, march_text(scene, evaluator, c_literal)))


def streaming(scene: Description, evaluator: MarchEvaluator) -> str:
    """What NAME.h declares besides: the march window by window."""
    return render("c/march.h.j2", Program(scene, march_text(scene, evaluator, c_literal)))


def march_text(scene: Description, evaluator: MarchEvaluator, text: Callable[[float, Real], str]) -> March:
    plan, real, degree = evaluator.plan, evaluator.real, evaluator.degree
    nodes, panels = plan.junctions, plan.panels
    rows = {step: row for row, step in enumerate(evaluator.operators)}
    operators = list(evaluator.operators.values())
    delays = sorted({output.delay for output in plan.outputs} | {1 - output.delay for output in plan.outputs})
    stretches = [plan.stretches(delay) for delay in delays]
    flat = [stretch for group in stretches for stretch in group]
    forces = {column: force for force, column in enumerate(plan.loaded)}

    def reals(values: Iterable[fmpq]) -> Lines:
        return lines(text(real.nearest(value), real) for value in values)

    def rounded(values: Iterable[float]) -> Lines:
        return reals(map(rational, values))

    return March(
        degree=str(degree),
        panels=str(len(panels)),
        nodes=str(len(nodes)),
        first_node=str(plan.first),
        forces=str(len(plan.loaded)),
        sources=str(len(plan.channels)),
        source_names=", ".join(channel.name for channel in plan.channels) or "none",
        points=str(len(panels) * (degree + 1)),
        events=str(len(plan.events)),
        last_window=_last_window(plan, real),
        last_tau=text(real.nearest(rational(min(plan.valid, float(real.reach)))), real),
        whole=math.isinf(plan.valid),
        trusted=text(real.not_below(rational(plan.trusted)), real),
        smooth=text(real.not_below(rational(plan.tolerance)), real),
        reach=text(real.nearest(real.reach), real),
        # of coefficients that are sums of as many products, each rounded a few times
        noise=text(real.nearest(4 * (degree + 8) * real.roundoff), real),
        tolerance=scene.tolerance,
        windows=str(evaluator.given.windows) if evaluator.given else "",
        given_degree=str(SMOOTH),
        given_error=text(real.not_below(rational(max(evaluator.given.errors))), real) if evaluator.given else "",
        bodies=bool(rows),
        point=reals(p.start + p.length * (1 - c) / 2 for p in panels for c in _cosines(degree)),
        cosine=reals(_cosines(degree)),
        half_length=reals(panel.length / 2 for panel in panels),
        since=reals(panel.start - other.start for panel in panels for other in panels),
        alpha=reals(node.alpha for node in nodes),
        beta=reals(node.beta for node in nodes),
        body=lines(
            str(-1 if node.rate is None else rows[node.rate * panel.length]) for panel in panels for node in nodes
        ),
        force_on=lines(str(forces.get(column, -1)) for column in range(len(nodes))),
        motion=reals(node.motion for node in nodes),
        mass=reals(node.mass for node in nodes),
        impedance=reals([*(node.left for node in nodes), nodes[-1].right]),
        rod=reals(plan.rods),
        ratio=rounded(value for operator in operators for value in operator.ratio),
        first=rounded(value for operator in operators for value in operator.first),
        last=rounded(value for operator in operators for value in operator.last),
        slack=rounded(operator.slack for operator in operators),
        loss=rounded(operator.loss for operator in operators),
        leak=rounded(operator.leak for operator in operators),
        event_window=lines(str(event.window) for event in plan.events),
        event_panel=lines(str(event.panel) for event in plan.events),
        event_force=lines(str(event.force) for event in plan.events),
        event_power=reals(power for event in plan.events for power in event.powers),
        source_force=lines(str(channel.force) for channel in plan.channels),
        source_gain=reals(channel.gain for channel in plan.channels),
        source_integral=lines(str(channel.order) for channel in plan.channels),
        quantity=lines(
            str(_QUANTITIES.index(output.quantity) if made.bound else _NOTHING)
            for output, made in zip(plan.outputs, evaluator.outputs, strict=True)
        ),
        left_node=lines(str(output.left) for output in plan.outputs),
        right_node=lines(str(output.right) for output in plan.outputs),
        left_delay=lines(str(delays.index(1 - output.delay)) for output in plan.outputs),
        right_delay=lines(str(delays.index(output.delay)) for output in plan.outputs),
        first_stretch=firsts(map(len, stretches)),
        stretch_from=lines(text(_counts_from(stretch, real), real) for stretch in flat),
        stretch_start=reals(stretch.start for stretch in flat),
        stretch_excess=reals(rational(real.nearest(stretch.start)) - stretch.start for stretch in flat),
        stretch_back=lines(str(stretch.back) for stretch in flat),
        stretch_panel=lines(str(stretch.panel) for stretch in flat),
    )


def _last_window(plan: Plan, real: Real) -> str:
    """The last window that can be counted, in an int and in real numbers, and on which all is modelled."""
    if math.isinf(plan.valid):
        return "INT_MAX - 1" if 1 / real.roundoff > 2**31 else str(int(1 / real.roundoff) - 1)
    return str(math.ceil(plan.valid) - 1 if plan.valid > plan.tau_max else int(plan.tau_max))


def _counts_from(stretch: Stretch, real: Real) -> float:
    """The first number that is not before the stretch: tau less the start of its window is exact, so this decides."""
    return real.not_below(max(stretch.start, fmpq(0)))


def _cosines(degree: int) -> Sequence[fmpq]:
    """cos(pi j / degree), to many more digits than are written."""
    with ctx.workprec(200):
        return [middle(arb.cos_pi_fmpq(fmpq(j, degree))) for j in range(degree + 1)]
