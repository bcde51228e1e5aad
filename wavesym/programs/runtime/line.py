"""What is marched: the nodes in the light cone, the panels of a window, the loads and what is read; all exact.

The law of a node, inertia q' + g q = alpha a + beta b + load with g = damping + (alpha + beta)/2, is divided by g:

    q'/rate + q = p    (a body, rate = g/inertia),        q = p    (no inertia),        p = alpha a + beta b + load.

Every window [n, n + 1) is cut into the same panels, at the fractional parts of the load times, so that on a panel every
wave is smooth. A wave that is sent on a panel arrives on the same panel of the next window.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

from flint import fmpq, fmpq_poly

from wavesym.errors import SpacingError
from wavesym.exact.joints.node_rules import node_rule
from wavesym.mechanics.gauge import Sum
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.mechanics.node import Node
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.march.load_events import LoadEvent, load_events
from wavesym.programs.march.plan import HELPS, MOST_PANELS, Panel, Stretch, common, readable, suiting

LEFT, RIGHT, LOAD = 0, 1, 2
"""What is heard: waves that nodes send, or loads."""

_ZERO, _ONE = fmpq(0), fmpq(1)


@dataclass(frozen=True)
class Junction:
    """A node, its law divided by g. `rate` is None where it has no inertia.

    `left` and `right` are the impedances of its rods (0 where there is none), `mass` its inertia, all on one scale:
    mass * rate = (left + right) where nothing is damped. `motion` is the velocity of a body at tau = 0.
    """

    alpha: fmpq
    beta: fmpq
    rate: fmpq | None
    left: fmpq
    right: fmpq
    mass: fmpq
    motion: fmpq


@dataclass(frozen=True)
class HeardWave:
    """`gain` times the wave that the node at `column` sends to the LEFT or RIGHT, `delay` after it was sent; or the
    LOAD with the number `column`. Where it is `summed`, the integral of that.
    """

    way: int
    column: int
    delay: fmpq
    gain: fmpq
    summed: bool


@dataclass(frozen=True)
class Watched:
    """An output: a sum of waves and of integrals of waves."""

    name: str
    heard: tuple[HeardWave, ...]

    def part(self, *, summed: bool) -> tuple[HeardWave, ...]:
        """The waves, or those of whose integrals it is the sum."""
        return tuple(heard for heard in self.heard if heard.summed == summed)


@dataclass(frozen=True)
class Plan:
    """A model made ready to march; columns number the nodes of the light cone from 0."""

    model: Model = field(compare=False)
    panels: tuple[Panel, ...]
    junctions: tuple[Junction, ...]
    rods: tuple[fmpq, ...]  # half the initial velocity of the rods left of each column, and of that right of the last
    loaded: tuple[int, ...]  # the column of each force
    events: tuple[LoadEvent, ...]  # of loads divided by g
    outputs: tuple[Watched, ...]
    tau_max: float
    first: int  # the node at column 0

    @property
    def ways(self) -> int:
        """How many arrays of series there are: loads are one, where they are heard."""
        return LOAD + any(heard.way == LOAD for output in self.outputs for heard in output.heard)

    @property
    def windows(self) -> int:
        """How many windows reach tau_max, the one that starts at an integer tau_max included."""
        return int(self.tau_max) + 1

    @cached_property
    def rate(self) -> fmpq:
        """The largest rate of a body, 0 without one."""
        return max((node.rate for node in self.junctions if node.rate is not None), default=fmpq(0))

    def stretches(self, delay: fmpq) -> tuple[Stretch, ...]:
        """Those of a wave that arrives `delay` after it was sent, 0 <= delay <= 1, in order; they cover the window."""
        found = []
        for back in (1, 0):
            for number, panel in enumerate(self.panels):
                start = delay + panel.start - back
                if start < 1 and start + panel.length > 0:
                    found.append(Stretch(start, back, number))
        return tuple(found)


def plan(model: Model, real: Real = DOUBLE) -> Plan:
    """The plan of a model in `real` numbers.

    CostError where load times have too many different fractional parts.
    """
    model.refuse_damping()
    tau_max = model.horizon(real)
    columns = model.light_cone(rational(tau_max))
    nodes = [model.named.nodes[x] for x in columns]
    loads = model.acting(rational(tau_max))
    cut = panels([load.time for load in loads])
    loaded = tuple(column for column, node in enumerate(nodes) if node.loads)
    starts = [rod.velocity / 2 if rod else fmpq(0) for rod in (*(node.left for node in nodes), nodes[-1].right)]
    return Plan(
        model,
        cut,
        tuple(_junctions(nodes)),
        tuple(starts),
        loaded,
        tuple(_events(nodes, loaded, loads, cut)),
        tuple(
            Watched(probe.name, tuple(_heard(model, terms, columns.start, loaded)))
            for probe, terms in model.sums.items()
        ),
        tau_max,
        columns.start,
    )


def panels(times: Sequence[fmpq], helps: str = HELPS) -> tuple[Panel, ...]:
    """The parts of every window between which loads begin or bend. SpacingError where there are too many, with what
    helps beside another spacing.
    """
    cuts = sorted({fmpq(0), fmpq(1)} | {time - time.floor() for time in times})
    if len(cuts) - 1 > MOST_PANELS:
        raise SpacingError(
            f"load: times at a spacing of {readable(common(times))} have {len(cuts) - 1} different fractional parts, "
            f"at most {MOST_PANELS} expected in a march ({suiting(times)}, {helps}, helps)"
        )
    return tuple(Panel(low, high - low) for low, high in pairwise(cuts))


def _junctions(nodes: Sequence[Node]) -> Iterator[Junction]:
    """The impedances follow from rod to rod: at a node they are as alpha to beta."""
    impedance = fmpq(1)
    for node in nodes:
        rule = node_rule(node)
        alpha, beta, g = rule.left, rule.right, rule.same
        inertia = rule.raised.constant
        left = impedance if node.left else fmpq(0)
        if node.left and node.right:
            impedance *= beta / alpha
        right = impedance if node.right else fmpq(0)
        # alpha = 2 left / M, and inertia counts in units of M
        mass = inertia * (2 * right / beta if node.right else 2 * left / alpha) if inertia else fmpq(0)
        rate = g / inertia if inertia else None
        yield Junction(alpha / g, beta / g, rate, left, right, mass, node.velocity)


def _events(
    nodes: Sequence[Node], loaded: Sequence[int], loads: Sequence[Applied], panels: Sequence[Panel]
) -> Iterator[LoadEvent]:
    gains: dict[tuple[fmpq, int], fmpq_poly] = defaultdict(fmpq_poly)
    for load in loads:
        for force, column in enumerate(loaded):
            for unit in nodes[column].loads:
                if unit.source == load.source:
                    new = load.weight * _share(nodes[column]) * fmpq_poly(list(unit.coefficients))
                    gains[load.time, force] += new
    return load_events(gains, (panel.start for panel in panels), _ONE)


def _share(node: Node) -> fmpq:
    """What a load counts in a law that is divided by g."""
    rule = node_rule(node)
    return rule.load / rule.same


def _heard(model: Model, terms: Sum, first: int, loaded: Sequence[int]) -> Iterator[HeardWave]:
    for weight, reading in terms:
        if reading.point is None:
            right, left = (weight * sign for sign in reading.weights)
            yield HeardWave(RIGHT, reading.rod - 1 - first, reading.place, right, reading.order < 0)
            yield HeardWave(LEFT, reading.rod - first, 1 - reading.place, left, reading.order < 0)
        elif (column := reading.point - first) in loaded:
            node = model.named.nodes[reading.point]
            scale = model.network.points[reading.point].mass / node.inertia / _share(node)
            yield HeardWave(LOAD, loaded.index(column), fmpq(0), weight * scale, False)
