"""What is marched: the nodes in the light cone, the panels of a window, the loads and what is read; all exact.

The law of a node, inertia q' + g q = alpha a + beta b + load with g = damping + (alpha + beta)/2, is divided by g:

    q'/rate + q = p    (a body, rate = g/inertia),        q = p    (no inertia),        p = alpha a + beta b + load.

Every window [n, n + 1) is cut into the same panels, at the fractional parts of the load times, so that on a panel every
wave is smooth. A wave that is sent on a panel arrives on the same panel of the next window.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, reduce
from itertools import pairwise
from math import inf

from flint import fmpq, fmpq_poly

from wavesym.errors import SpacingError
from wavesym.exact.joints.node_rules import node_rule
from wavesym.fields.numbers import decimal_text
from wavesym.mechanics.gauge import Sum
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.mechanics.node import RAMPS, Node
from wavesym.numbers.doubles import fraction, nearest, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.march.load_events import LoadEvent, load_changes, load_events

LEFT, RIGHT, LOAD = 0, 1, 2
"""What is heard: waves that nodes send, or loads."""

MOST_PANELS = 16
HELPS = "fewer samples, modes, or for what does not jump NumPy or run"
"""Beside another spacing, where loads leave more panels."""
# of the sum of what polynomials miss, errors at fronts were seen to be up to about so many times as much
_ESTIMATED = 100
_LONG = 30  # characters of a number that nobody reads
_ZERO, _ONE = fmpq(0), fmpq(1)


@dataclass(frozen=True)
class MarchPanel:
    """Part of every window: from `start` on, `length` long."""

    start: fmpq
    length: fmpq


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
class Channel:
    """A load that can be given while it runs: `gain` times it (`order` 0) or its integral from 0 on (1) is the force.

    `name` is M1, M2 ... (a moment) or a (the base acceleration).
    """

    name: str
    force: int
    gain: fmpq
    order: int


@dataclass(frozen=True)
class Stretch:
    """Where in a window what arrives is smooth: from t = `start` (it may be < 0) on, t the time since the window began.

    It was sent on `panel`, `back` windows ago (0 or 1), as that panel's polynomial in t - start.
    """

    start: fmpq
    back: int
    panel: int


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
    panels: tuple[MarchPanel, ...]
    junctions: tuple[Junction, ...]
    rods: tuple[fmpq, ...]  # half the initial velocity of the rods left of each column, and of that right of the last
    loaded: tuple[int, ...]  # the column of each force
    events: tuple[LoadEvent, ...]  # of loads divided by g
    channels: tuple[Channel, ...]
    outputs: tuple[Watched, ...]
    tau_max: float
    first: int  # the node at column 0
    valid: float  # until when no node outside of the light cone can be felt
    tolerance: float  # of the scene, but no less than what rounding makes of loads that are given
    trusted: float  # what polynomials may miss in all, of the largest wave, before the programs say so

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

    def scaled(self, factor: fmpq) -> Plan:
        """The same with all that moves it `factor` times as large; every motion is, then."""
        return replace(
            self,
            junctions=tuple(replace(node, motion=factor * node.motion) for node in self.junctions),
            rods=tuple(factor * velocity for velocity in self.rods),
            events=tuple(event.times(factor) for event in self.events),
            channels=tuple(replace(channel, gain=factor * channel.gain) for channel in self.channels),
        )

    def changes(self, panel: int) -> Iterator[tuple[int, int, tuple[fmpq, fmpq, fmpq]]]:
        """Window, force and powers of what is new with each event on a panel."""
        for event, powers in load_changes(self.events, [each.start for each in self.panels], _ONE):
            if event.panel == panel:
                yield event.window, event.force, powers

    def stretches(self, delay: fmpq) -> tuple[Stretch, ...]:
        """Those of a wave that arrives `delay` after it was sent, 0 <= delay <= 1, in order; they cover the window."""
        found = []
        for back in (1, 0):
            for number, panel in enumerate(self.panels):
                start = delay + panel.start - back
                if start < 1 and start + panel.length > 0:
                    found.append(Stretch(start, back, number))
        return tuple(found)


def plan(model: Model, real: Real = DOUBLE, windows: int = 0) -> Plan:
    """The plan of a model in `real` numbers; what can matter on the first `windows` is part of it too.

    CostError where load times have too many different fractional parts.
    """
    model.refuse_damping()
    tau_max = model.horizon(real)
    columns = model.light_cone(rational(max(tau_max, float(windows))))
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
        tuple(_channels(nodes, loaded)),
        tuple(
            Watched(probe.name, tuple(_heard(model, terms, columns.start, loaded)))
            for probe, terms in model.sums.items()
        ),
        tau_max,
        columns.start,
        inf if len(columns) == model.named.m + 1 else max(tau_max, float(windows)),
        nearest(max(model.tolerance, 64 * real.roundoff)),
        # no less than what the arithmetic of so many nodes loses on all windows
        nearest(max(model.tolerance / _ESTIMATED, real.roundoff * len(nodes) * (int(tau_max) + 1))),
    )


def panels(times: Sequence[fmpq], helps: str = HELPS) -> tuple[MarchPanel, ...]:
    """The parts of every window between which loads begin or bend. SpacingError where there are too many, with what
    helps beside another spacing.
    """
    cuts = sorted({fmpq(0), fmpq(1)} | {time - time.floor() for time in times})
    if len(cuts) - 1 > MOST_PANELS:
        raise SpacingError(
            f"load: times at a spacing of {told(common(times))} have {len(cuts) - 1} different fractional parts, at "
            f"most {MOST_PANELS} expected in a march ({suiting(times)}, {helps}, helps)"
        )
    return tuple(MarchPanel(low, high - low) for low, high in pairwise(cuts))


def common(times: Iterable[fmpq]) -> fmpq:
    """What all times are multiples of."""
    return reduce(fmpq.gcd, times, _ZERO)


def suiting(times: Iterable[fmpq], step: fmpq = _ONE) -> str:
    """The spacing nearest to that of some times whose multiples have few enough remainders of a step."""
    parts = fraction(common(times) / step).limit_denominator(MOST_PANELS)
    return f"a spacing of {told(step * rational(parts or Fraction(1, MOST_PANELS)))}"


def told(exact: fmpq) -> str:
    """A number to be read: all of it, or 17 digits where it is long."""
    text = decimal_text(fraction(exact))
    return text if len(text) < _LONG else f"{nearest(exact):.17g}"


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
    nodes: Sequence[Node], loaded: Sequence[int], loads: Sequence[Applied], panels: Sequence[MarchPanel]
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


def power_of_two(numbers: Iterable[fmpq]) -> fmpq:
    """About the largest absolute value of some numbers; 1 where all are 0."""
    size = max(map(abs, numbers), default=fmpq(0))
    return fmpq(2) ** (int(size.p).bit_length() - int(size.q).bit_length()) if size else fmpq(1)


def _channels(nodes: Sequence[Node], loaded: Sequence[int]) -> Iterator[Channel]:
    for force, column in enumerate(loaded):
        for load in nodes[column].loads:
            if load.kind not in RAMPS:  # a ramp of the acceleration is an acceleration
                order = len(load.coefficients) - 1
                gain = load.coefficients[order] * _share(nodes[column])
                yield Channel(load.source, force, gain, order)


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
