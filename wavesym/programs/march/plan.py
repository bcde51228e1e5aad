"""What is marched: one step, rings of windows for the waves, joints, loads and what is read; all exact.

The step h is the greatest common measure of the delays, so that what is sent on a window [n h, (n + 1) h) arrives at
the other end of its bar on window n + delay/h: every joint knows all that it needs when a window begins. A window is
cut into the same panels everywhere, at what load times leave over of h, so that on a panel every wave is smooth.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import sqrt
from typing import Any

from flint import fmpq, fmpq_poly

from wavesym.derivation.factors import joint_rule
from wavesym.errors import SpacingError
from wavesym.fields.numbers import decimal_text
from wavesym.mechanics.gauge import Sum
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End, Joint, Network, Point
from wavesym.mechanics.node import UnitLoad
from wavesym.mechanics.time_derivative import with_derivatives
from wavesym.mechanics.travel_times import step_of
from wavesym.numbers.doubles import common_measure, fraction, in_order, nearest, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.march.space import SHOWN, JointSpace, Port, joint_space

MOST_PANELS = 16
HIGHEST_DEGREE = 2000
HELPS = "fewer samples, modes, or for what does not jump NumPy or run"
"""Beside another spacing, where loads leave more panels."""

_LONG = 30  # characters of a number that nobody reads
_ZERO, _ONE = fmpq(0), fmpq(1)


@dataclass(frozen=True)
class LoadEvent:
    """From panel `panel` of window `window` on, load `force` has these `powers` of the time since then.

    `change` is what of them is new.
    """

    window: int
    panel: int
    force: int
    powers: tuple[fmpq, fmpq, fmpq]
    change: tuple[fmpq, fmpq, fmpq]

    def times(self, factor: fmpq) -> LoadEvent:
        """The same of a load that is `factor` times as large."""
        powers, change = (_three(factor * fmpq_poly(list(each))) for each in (self.powers, self.change))
        return replace(self, powers=powers, change=change)


@dataclass(frozen=True)
class Panel:
    """Part of every window: from `start` on, `length` long."""

    start: fmpq
    length: fmpq


@dataclass(frozen=True)
class Stretch:
    """Where in a window what arrives is smooth: from t = `start` (it may be < 0) on, t the time since the window began.

    It was sent on `panel`, `back` windows ago, as that panel's polynomial in t - start.
    """

    start: fmpq
    back: int
    panel: int


@dataclass(frozen=True)
class Track:
    """What is sent into one end of a bar (or a velocity or load that is watched): it arrives `steps` windows later.

    `initial_value` is what is on its way at tau = 0. `impedance` is 0 where no bar carries it. What is `prescribed` is
    a load, or a velocity that loads give.
    """

    steps: int
    initial_value: fmpq
    impedance: fmpq
    prescribed: bool = False


@dataclass(frozen=True)
class MarchedJoint:
    """A joint of the light cone: its laws, and of each port the tracks that `arrive` and that it `sends`.

    `forces` are the loads on its points, by number; -1 for none.
    """

    space: JointSpace
    arrive: tuple[int, ...]
    sends: tuple[int, ...]
    forces: tuple[int, ...]


@dataclass(frozen=True)
class OutputTerm:
    """One of the waves of an output: `gain` times a track, or times its integral, `delay` after it was sent."""

    track: int
    gain: fmpq
    delay: fmpq
    summed: bool


@dataclass(frozen=True)
class MarchOutput:
    """An output: a sum of waves and of integrals of waves over time."""

    name: str
    terms: tuple[OutputTerm, ...]

    def part(self, *, summed: bool) -> tuple[OutputTerm, ...]:
        """The waves, or those of whose integrals it is the sum."""
        return tuple(term for term in self.terms if term.summed == summed)


@dataclass(frozen=True)
class MarchPlan:
    """A model made ready to march."""

    model: Model = field(compare=False)
    step: fmpq
    panels: tuple[Panel, ...]
    tracks: tuple[Track, ...]
    joints: tuple[MarchedJoint, ...]
    forces: int
    events: tuple[LoadEvent, ...]
    outputs: tuple[MarchOutput, ...]
    tau_max: float
    loaded_points: tuple[int, ...]  # the point of each force

    @property
    def windows(self) -> int:
        """How many windows reach tau_max, one that starts there included."""
        return int((rational(self.tau_max) / self.step).floor()) + 1

    @cached_property
    def cycle(self) -> tuple[int, int]:
        """After so many windows, the first number, tau is an integer again, the second; or beyond the horizon."""
        windows, span = int(self.step.q), int(self.step.p)
        return (windows, span) if windows <= self.windows else (self.windows, int(self.tau_max) + 2)

    @property
    def crossings(self) -> int:
        """How often a front can have met a joint, at most."""
        shortest = min(track.steps for track in self.tracks if track.steps)
        return -(-self.windows // shortest)

    @cached_property
    def shortest(self) -> float:
        """The length of the shortest panel."""
        return min(nearest(panel.length) for panel in self.panels)

    @cached_property
    def longest(self) -> float:
        """That of the longest."""
        return max(nearest(panel.length) for panel in self.panels)

    @property
    def norm(self) -> float:
        """How fast anything in a joint is, at most."""
        return max((joint.space.norm for joint in self.joints), default=0.0)

    @property
    def turning(self) -> float:
        """About how fast bodies swing on their springs."""
        return max(joint.space.turning for joint in self.joints)

    def oscillations(self, rate: float) -> float:
        """Those on a panel of a front that has met bodies of some rate: like a Laguerre function's, sqrt(2 rate n)."""
        return sqrt(2 * rate * self.longest * self.crossings)

    def alter_joints(self, change: Callable[[int, JointSpace], JointSpace]) -> MarchPlan:
        """The same with other laws; `change` takes the number of a joint and its laws."""
        joints = (replace(joint, space=change(number, joint.space)) for number, joint in enumerate(self.joints))
        return replace(self, joints=tuple(joints))

    def scale(self, factor: fmpq) -> MarchPlan:
        """The same with all that moves it `factor` times as large; every motion is, then."""
        same = self.alter_joints(
            lambda _, space: replace(space, initial_state=tuple(factor * value for value in space.initial_state))
        )
        return replace(
            same,
            tracks=tuple(replace(track, initial_value=factor * track.initial_value) for track in self.tracks),
            events=tuple(event.times(factor) for event in self.events),
        )

    def stretches(self, delay: fmpq) -> tuple[Stretch, ...]:
        """Those of a wave that arrives `delay` after it was sent, in order; `start` counts from that of a window."""
        found = []
        windows = int((delay / self.step).floor())
        for back in (windows + 1, windows):
            for number, panel in enumerate(self.panels):
                start = delay + panel.start - back * self.step
                if start < self.step and start + panel.length > 0:
                    found.append(Stretch(start, back, number))
        return tuple(found)


def march_plan(
    model: Model,
    real: Real = DOUBLE,
    space: Callable[[Network, Joint], JointSpace] = joint_space,
    helps: str = HELPS,
    *,
    or_pieces: bool = True,
) -> MarchPlan:
    """The plan of a chain in `real` numbers; `space` makes the laws of its joints.

    For refusals: what `helps` where load times do not fit, and whether pieces could be made instead (`or_pieces`).

    UnservedError for contacts; CostError where the step would be too small, or load times have too many remainders.
    """
    network = model.network
    network.refuse_corners()
    network.refuse_dead_loads()
    model.refuse_damping()
    model.refuse_polynomials()
    network.refuse_rodless("a march", "take pieces or modes" if or_pieces else "take modes")
    model = with_derivatives(model)
    network = model.network
    tau_max = model.horizon(real)
    until = rational(tau_max)
    reached = model.joints_in_reach(until)
    modelled = {end for number in reached for end, _ in network.joints[number].ends}
    bars = sorted({end.bar for end in modelled} | {read.rod - 1 for read in model.gauges if read.point is None})
    step = step_of([network.bars[bar].delay for bar in bars], or_pieces=or_pieces)
    track_of = {End(bar, side): 2 * k + side for k, bar in enumerate(bars) for side in (0, 1)}
    tracks = [
        Track(int(bar.delay / step), bar.initial_wave(side), bar.impedance)
        for bar in (network.bars[number] for number in bars)
        for side in (0, 1)
    ]
    loads = _Loads(model, until, reached)
    shown = sorted({read.point for read in model.gauges if read.point is not None})
    point_of = {point: len(tracks) + k for k, point in enumerate(shown)}
    tracks += [Track(0, _ZERO, _ZERO, network.points[point].motion is not None) for point in shown]
    pushed = {read.point for terms in model.sums.values() for _, read in terms if read.quantity == "load"}
    load_of = {point: len(tracks) + k for k, point in enumerate(p for p in sorted(loads.numbers) if p in pushed)}
    silent = len(tracks) + len(load_of)  # a track on which nothing is ever sent
    tracks += [Track(0, _ZERO, _ZERO, True)] * (len(load_of) + 1)
    panels = _panels([time for time, _, _ in loads.changes], step, helps)
    marched = []
    for number in reached:
        joint = network.joints[number]
        laws = space(network, joint)
        watched = [(k, point) for k, point in enumerate(joint.points) if point in point_of]
        ports = (*laws.ports, *(Port(k, _ZERO, _ONE, _ZERO) for k, _ in watched))
        sends = (*(track_of[end] for end, _ in joint.ends), *(point_of[point] for _, point in watched))
        arrive = (*(track_of[network.opposite_end(end)] for end, _ in joint.ends), *(silent for _ in watched))
        forces = tuple(loads.numbers.get(point, -1) for point in joint.points)
        marched.append(MarchedJoint(replace(laws, ports=ports), arrive, sends, forces))
    marched += [MarchedJoint(SHOWN, (silent,), (track,), (loads.numbers[point],)) for point, track in load_of.items()]
    return MarchPlan(
        model,
        step,
        panels,
        tuple(tracks),
        tuple(marched),
        len(loads.numbers),
        tuple(loads.events(panels, step)),
        tuple(
            MarchOutput(probe.name, tuple(_output_terms(model.network, terms, track_of, point_of, load_of)))
            for probe, terms in model.sums.items()
        ),
        tau_max,
        tuple(sorted(loads.numbers)),
    )


def _panels(times: list[fmpq], step: fmpq, helps: str) -> tuple[Panel, ...]:
    cuts = in_order([_ZERO, step, *(time - (time / step).floor() * step for time in times)])
    if len(cuts) - 1 > MOST_PANELS:
        raise SpacingError(
            f"load: times at a spacing of {readable(common_measure(times))} leave {len(cuts) - 1} different "
            f"remainders of the step {readable(step)}, the limit in a march is {MOST_PANELS} "
            f"({suitable_spacing(times, step)}, {helps}, helps)"
        )
    return tuple(Panel(low, high - low) for low, high in pairwise(cuts))


def suitable_spacing(times: Iterable[fmpq], step: fmpq = _ONE) -> str:
    """The spacing nearest to that of some times whose multiples have few enough remainders of a step."""
    parts = fraction(common_measure(times) / step).limit_denominator(MOST_PANELS)
    return f"a spacing of {readable(step * rational(parts or Fraction(1, MOST_PANELS)))}"


def readable(exact: fmpq) -> str:
    """A number to be read: all of it, or 17 digits where it is long."""
    text = decimal_text(fraction(exact))
    return text if len(text) < _LONG else f"{nearest(exact):.17g}"


class _Loads:
    """What acts on the points of the light cone, or moves them: polynomials from event to event."""

    def __init__(self, model: Model, until: fmpq, reached: dict[int, fmpq]) -> None:
        points = [point for number in reached for point in model.network.joints[number].points]
        self.changes: list[tuple[fmpq, int, fmpq_poly]] = []
        acting = model.loads_until(until)
        for number in points:
            point = model.network.points[number]
            units = {unit.source: fmpq_poly(list(unit_action(point, unit))) for unit in point.loads}
            for load in acting if units else ():
                if load.source in units:
                    self.changes.append((load.time, number, load.weight * units[load.source]))
            if point.motion is not None and point.velocity != 0:
                self.changes.append((_ZERO, number, fmpq_poly([point.velocity])))
        moved = {number for _, number, _ in self.changes}
        self.numbers = {point: force for force, point in enumerate(sorted(moved))}

    def events(self, panels: tuple[Panel, ...], step: fmpq) -> Iterator[LoadEvent]:
        """From each change on, the whole polynomial, in order."""
        gains: dict[tuple[fmpq, int], fmpq_poly] = defaultdict(fmpq_poly)
        for time, point, polynomial in self.changes:
            gains[time, self.numbers[point]] += polynomial
        return load_events(gains, (panel.start for panel in panels), step)


def unit_action(point: Point, unit: UnitLoad) -> tuple[Any, ...]:
    """The force that a unit load makes of itself at a point, or the velocity that it prescribes, by powers of tau."""
    action = point.action(unit)
    return action if point.motion else tuple(joint_rule().load * each for each in action)


def _output_terms(
    network: Network, terms: Sum, track_of: dict[End, int], point_of: dict[int, int], load_of: dict[int, int]
) -> Iterator[OutputTerm]:
    for weight, reading in terms:
        summed = reading.order < 0
        if reading.point is None:
            for end, factor, delay in reading.waves(network):
                yield OutputTerm(track_of[end], weight * factor, delay, summed)
        elif (track := (load_of if reading.quantity == "load" else point_of).get(reading.point)) is not None:
            yield OutputTerm(track, weight, _ZERO, summed)


def power_of_two(numbers: Iterable[fmpq]) -> fmpq:
    """About the largest absolute value of some numbers; 1 where all are 0."""
    size = max(map(abs, numbers), default=_ZERO)
    return fmpq(2) ** (int(size.p).bit_length() - int(size.q).bit_length()) if size else _ONE


def largest_number(plan: MarchPlan) -> fmpq:
    """The largest of what moves it: about as large as its motion."""
    powers = (power for event in plan.events for power in event.powers)
    begun = (value for joint in plan.joints for value in joint.space.initial_state)
    return max(map(abs, (*(track.initial_value for track in plan.tracks), *begun, *powers)), default=_ZERO)


def least_numbers(plan: MarchPlan) -> Iterator[fmpq]:
    """What programs read as numbers that must not be too small for their format."""
    for joint in plan.joints:
        yield from joint.space.initial_state
        drive = joint.space.drive or _ONE
        if joint.space.is_body:  # ratios are no smaller than this
            yield from (joint.space.rate * panel.length / (8 * HIGHEST_DEGREE) for panel in plan.panels)
        for port in joint.space.ports:
            yield from (port.ratio, drive * port.push)
        yield drive
    for event in plan.events:
        yield from event.powers
    yield from (panel.length / 2 for panel in plan.panels)
    yield from (track.initial_value for track in plan.tracks)
    yield from (term.gain for output in plan.outputs for term in output.terms)
    yield plan.step


def load_events(gains: Mapping[tuple[fmpq, int], fmpq_poly], starts: Iterable[fmpq], step: fmpq) -> Iterator[LoadEvent]:
    """What forces are from each of their changes on, in order; `gains` has the changes by time and force.

    A window is a `step` long, and its panels have these `starts`, at which all changes are.
    """
    places = {start: number for number, start in enumerate(starts)}
    known: dict[int, tuple[fmpq, fmpq_poly]] = {}
    for (time, force), change in sorted(gains.items(), key=lambda item: item[0]):
        if change:
            since, load = known.get(force, (time, fmpq_poly()))
            known[force] = time, load(fmpq_poly([time - since, 1])) + change
            window = int((time / step).floor())
            yield LoadEvent(window, places[time - window * step], force, _three(known[force][1]), _three(change))


def _three(load: fmpq_poly) -> tuple[fmpq, fmpq, fmpq]:
    return load[0], load[1], load[2]
