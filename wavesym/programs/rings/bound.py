"""How far the march of a chain can be from the truth: an a-posteriori bound, proved. docs/march.md has each step.

The energy of a chain, sum of Z * integral of wave**2 over all waves in bars + sum of M q**2 / 2 + sum of K z**2 / 2 (z
the lengthening of a spring), does not grow where nothing is loaded. So the error of the march is at most the sum, over
windows and panels, of what each adds anew, in the norm E, the root of that energy:

- Truncation. On a panel of length h the computed state misses its equation by R = eps (T_(d+1) -+ 1). With g the norm
  of the joint's rates that adds at most 2 |eps| (sqrt(g h) + (1 + g h)/sqrt(2)).
- Rounding, from the absolute values of the matrices. In L2 over a panel a series has at most sqrt(pi h) / 2 times its
  norm (2 c_0**2 + c_1**2 + ...)**0.5. Underflow loses up to the smallest number in each product.

From energy to values: a wave is in L2 at most E/sqrt(Z), the velocity of a free point at most
E ((5 + 2 h) [(C + M)^-1])**0.5, and the true ones are polynomials of degree K up to some tail (tail.py of the march).

All of it holds to first order in u, and a margin of 1 % is added for the rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from math import pi, sqrt

import numpy as np
from flint import fmpq, fmpq_mat
from numpy.typing import NDArray

from wavesym.exact.joints.joint import JointLaw
from wavesym.exact.silence import silent
from wavesym.numbers.doubles import nearest, not_below, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.march.bound import MARGIN, Verdict, reading_weights
from wavesym.programs.march.plan import power_of_two
from wavesym.programs.march.tail import Tail, tail_of
from wavesym.programs.rings.answer import NEGLIGIBLE
from wavesym.programs.rings.plan import Heard, MarchedJoint, RingPlan, largest_number
from wavesym.programs.rings.tables import RingTables
from wavesym.programs.schemes.rings import JointGroup, MarchingRings, RingScheme, RunningLoads, WindowBlock

Array = NDArray[np.float64]

SAMPLES = 16
"""Instants in a window at which the generator looks for an output's largest value."""
# roundings of a product in a sum, besides those of the sum: of factors, pushes, loads and their times
_SPARE = 24
# square roots of exact numbers, rounded a few times
_ABOVE = 1 + 1e-12


@dataclass(frozen=True)
class RingVerdict(Verdict):
    """What else is known of each output: what its values (`heights`) and their slopes over tau do not exceed.

    True waves are polynomials of degree `smooth` on each panel, up to a tail.
    """

    smooth: int = 0
    heights: tuple[float, ...] = ()
    slopes: tuple[float, ...] = ()


def judge(plan: RingPlan, degree: int, real: Real) -> RingVerdict:
    """March once over the horizon at `degree` for a program in `real` numbers, and bound its errors.

    All is divided by the size of what moves it, so that no square of a wave underflows here. OverflowError where waves
    grow beyond what programs take.
    """
    scale = power_of_two([largest_number(plan)])
    verdict = _judge(plan.scaled(1 / scale), degree, real, scale)
    errors, sizes, heights, slopes = (
        tuple(nearest(scale) * value for value in of)
        for of in (verdict.errors, verdict.sizes, verdict.heights, verdict.slopes)
    )
    return replace(verdict, errors=errors, sizes=sizes, heights=heights, slopes=slopes)


def _judge(plan: RingPlan, degree: int, real: Real, scale: fmpq) -> RingVerdict:
    """The same for a plan whose motions are so many times as small as those of the program."""
    made = RingTables(plan, degree, DOUBLE)
    scheme = RingScheme(made.tables([False] * len(plan.outputs)), made.constants(), plan.tau_max, np.float64)
    unit, smallest = nearest(real.roundoff), not_below(real.smallest / scale)
    reach = nearest(min(real.reach / scale, DOUBLE.reach))
    losses = Losses(plan, made, scheme, unit, smallest)
    outputs, step = len(plan.outputs), nearest(plan.step)
    truncated, rounded, summed = 0.0, losses.begun, 0.0
    largest, reading, sums, held, height, slope = (np.zeros(outputs) for _ in range(6))
    shortest = min(nearest(panel.length) for panel in plan.panels)
    one, bent = np.ones(degree + 1), 2 / shortest * np.arange(degree + 1.0) ** 2
    for block in _blocks(scheme, plan.windows):
        lost, inexact = losses.of(block)
        truncated += lost
        rounded += inexact
        summed += block.count * (truncated + rounded)
        window = (block.first + np.arange(block.count))[:, None]
        taus = np.unique(np.minimum((window + np.linspace(0, 1, SAMPLES, endpoint=False)) * step, plan.tau_max))
        inside = np.isin(scheme.places(taus)[0], window)
        largest = np.maximum(largest, np.max(np.abs(block.read(taus[inside])), axis=1, initial=0.0))
        held = np.maximum(held, np.max(np.abs(block.totals), axis=1))
        for o, output in enumerate(plan.outputs):
            reading[o] = max(reading[o], _size(block, output.part(summed=False), reading_weights(degree, False)))
            sums[o] += block.count * _size(block, output.part(summed=True), reading_weights(degree, True))
            direct, gathered = (_size(block, output.part(summed=summed), one) for summed in (False, True))
            height[o] = max(height[o], direct + float(np.max(np.abs(block.totals[o]))) + step * gathered)
            slope[o] = max(slope[o], _size(block, output.part(summed=False), bent) + gathered)
        if not np.max(np.abs(block.waves)) < reach:
            raise OverflowError(f"waves beyond {nearest(real.reach):.1g}")
    smooth = smoothness(plan, degree)
    lost_reading = 8.0 * (degree + 3) ** 2 * smallest
    stretches = 2.0 * len(plan.panels) + 2
    errors = []
    for o, output in enumerate(plan.outputs):
        error = 0.0
        if of := output.part(summed=True):
            error += _felt(plan, of) * sqrt(step) * summed
            error += unit * (24 * stretches * step * sums[o] + len(of) * plan.windows * held[o])
            error += plan.windows * stretches * lost_reading * (1 + step) * max(1, len(of) / 2)
            error += _direct(losses, of) * step * plan.windows
        if of := output.part(summed=False):
            error += _felt(plan, of) * largest_wave(smooth, plan, truncated + rounded)
            error += (12 + max(2, len(output.heard))) * unit * reading[o] + lost_reading * max(1, len(of) / 2)
            error += _direct(losses, of)
        if 0 < len(output.part(summed=True)) < len(output.heard):
            error += len(output.heard) * unit * held[o]  # one is added to the other
        errors.append(MARGIN * float(error))
    # what rounding could have made may be nothing at all: programs then return exactly 0
    if any(size <= error for size, error in zip(largest, errors, strict=True)):
        for o, nothing in enumerate(silent(plan.model, rational(plan.tau_max))):
            if nothing:
                errors[o] = largest[o] = height[o] = slope[o] = 0.0
    sizes, heights, slopes = (tuple(of.tolist()) for of in (largest, height, slope))
    return RingVerdict(degree, tuple(errors), sizes, truncated, rounded, True, smooth.degree, heights, slopes)


def _size(block: WindowBlock, heard: Iterable[Heard], weights: Array) -> float:
    """The weighted absolute coefficients of what is heard, at most."""
    return sum(abs(nearest(each.gain)) * float(np.max(np.abs(block.waves[:, each.track]) @ weights)) for each in heard)


def _felt(plan: RingPlan, heard: Iterable[Heard]) -> float:
    """How large what is heard can be, in L2 over a window, where the norm of energy is 1."""
    return sum(abs(nearest(each.gain)) * size_of(plan, each.track) for each in heard)


def _direct(losses: Losses, heard: Iterable[Heard]) -> float:
    """How wrong what is heard may be by itself."""
    return sum(abs(nearest(each.gain)) * float(losses.direct[each.track]) for each in heard)


def _blocks(scheme: RingScheme, windows: int) -> Iterator[WindowBlock]:
    marching = MarchingRings(scheme)
    for first in range(0, windows, marching.most):
        yield marching.block(first, min(marching.most, windows - first))


def largest_wave(smooth: Tail, plan: RingPlan, energy: float) -> float:
    """The largest value of what is in L2 at most `energy`, and a polynomial up to a tail."""
    shortest = min(nearest(panel.length) for panel in plan.panels)
    return (smooth.degree + 1) / sqrt(2) * (sqrt(2 / shortest) * energy + sqrt(2) * smooth.size) + smooth.size


def size_of(plan: RingPlan, track: int) -> float:
    """How large what is on a track can be, in L2 over a window, where the norm of energy is 1."""
    if impedance := plan.tracks[track].impedance:
        return 1 / sqrt(nearest(impedance))
    if plan.tracks[track].told:
        return 0.0
    number, point = next(
        (number, port.point)
        for number, joint in enumerate(plan.joints)
        for port, send in zip(joint.space.ports, joint.sends, strict=True)
        if send == track
    )
    network = plan.model.network
    reached = list(plan.model.reached(rational(plan.tau_max)))
    law = JointLaw.of(network, network.joints[reached[number]])
    free = [k for k, given in enumerate(law.given) if given is None]
    held = [law.damping[a][b] + (law.mass[a] if a == b else 0) for a in free for b in free]
    at = free.index(point)
    return _ABOVE * sqrt(nearest(fmpq_mat(len(free), len(free), held).inv()[at, at] * (5 + 2 * plan.step)))


def smoothness(plan: RingPlan, degree: int) -> Tail:
    """How near to polynomials of some degree, and no lower one, true waves are where the norm of energy is 1."""
    rate = max((joint.space.norm for joint in plan.joints), default=0.0)
    jumps = list(_jumps(plan, rate)) if rate else [0.0] * 3
    if not any(jumps):
        return Tail(max(degree, 3), 0.0)  # without a state waves are as the loads
    added = (plan.windows + 2) * len(plan.panels) / sqrt(2 * rate)
    return tail_of(degree, jumps, rate, plan.crossings, added, [nearest(panel.length) for panel in plan.panels])


def _jumps(plan: RingPlan, rate: float) -> Iterator[float]:
    """Those of order 0, 1, 2 that loads and start make, as waves (velocity times root of impedance), all added up."""
    strengths: dict[int, float] = {}
    begin = 0.0
    for joint in plan.joints:
        for point, force in enumerate(joint.forces):
            if force >= 0:  # where a load is read only it moves nothing
                strengths[force] = max(strength(joint, point, rate), strengths.get(force, 0.0))
        begin += started(plan, joint, rate)
    loads = [0.0] * 3
    for force, powers in plan.changes():
        for order, c in enumerate(powers):
            loads[order] += strengths[force] * abs(nearest(c)) * (2 if order == 2 else 1)
    loads[0] += begin
    yield from loads


def strength(joint: MarchedJoint, point: int, rate: float) -> float:
    """The jump of waves that a jump of what acts on a point counts as."""
    space = joint.space
    state = sum((weight * space.pushed[n, point] ** 2 for n, weight in enumerate(space.weights)), fmpq(0))
    sent = sum((port.impedance * (port.ratio * space.passed[port.point, point]) ** 2 for port in space.ports), fmpq(0))
    return _ABOVE * (sqrt(nearest(state) / rate) / 2 + sqrt(nearest(sent)))


def started(plan: RingPlan, joint: MarchedJoint, rate: float) -> float:
    """The same for the start: as if what was held in joint until tau = 0 were let go."""
    space = joint.space
    arriving = [plan.tracks[track].held for track in joint.arrive]
    acting = [fmpq(0)] * space.points
    for port, a in zip(space.ports, arriving, strict=True):
        acting[port.point] += port.push * a
    x, s = (fmpq_mat(len(values), 1, list(values)) for values in (space.begun, acting))
    moved, q = space.rates * x + space.pushed * s, space.shown * x + space.passed * s
    state = sum((weight * moved[n, 0] ** 2 for n, weight in enumerate(space.weights)), fmpq(0))
    sent = fmpq(0)
    for port, a, track in zip(space.ports, arriving, joint.sends, strict=True):
        sent += port.impedance * (port.ratio * q[port.point, 0] - a - plan.tracks[track].held) ** 2
    return _ABOVE * (sqrt(nearest(state) / rate) / 2 + sqrt(nearest(sent)))


class Losses:
    """What windows add to the error: in the norm of energy, and on tracks that carry none.

    `begun` is what the numbers of the start lose. `direct` is how wrong what is read of each track may be by itself.
    """

    def __init__(self, plan: RingPlan, made: RingTables, scheme: RingScheme, unit: float, smallest: float) -> None:
        self._scheme, self._unit, self._smallest = scheme, unit, smallest
        # of the same loads, how large what cancels may have been
        self._loads = RunningLoads(scheme, np.abs(scheme.event_power), np.abs(scheme.since))
        self._lengths = [nearest(panel.length) for panel in plan.panels]
        self._impedance = np.array([nearest(track.impedance) for track in plan.tracks])
        self._weights = np.array([nearest(weight) for joint in plan.joints for weight in joint.space.weights])
        first = [plan.joints[group.joints[0]] for group in scheme.groups]
        self._norms = [joint.space.norm for joint in first]
        self._missed = [[made.missed(joint, panel.length) for panel in plan.panels] for joint in first]
        self._pushes = max(group.send.shape[1] for group in scheme.groups)
        delays = nearest(plan.step) * np.array([track.steps for track in plan.tracks])
        self.begun = unit * sqrt(delays * self._impedance @ scheme.held**2 + self._weights @ scheme.begun**2 / 2)
        self.direct = np.zeros(len(plan.tracks))

    def of(self, block: WindowBlock) -> tuple[float, float]:
        """By truncation and by rounding, in all windows of a block."""
        panels = range(len(self._lengths))
        loads = np.array([[self._loads.on(block.first + n, panel) for panel in panels] for n in range(block.count)])
        lost = inexact = 0.0
        for panel in panels:
            truncation, rounding = np.zeros(block.count), np.zeros(block.count)
            for group, missed, norm in zip(self._scheme.groups, self._missed, self._norms, strict=True):
                a, sent = self._waves(block, group, panel)
                known, size = (np.zeros((*a.shape[:2], group.points.shape[1], group.size)) for _ in range(2))
                known[..., :3], size[..., :3] = block.acting[:, panel, group.points], loads[:, panel, group.points]
                if group.states.size:
                    x = block.starts[:, panel, group.states]
                    given = _joined(group.collect @ a + known, x)
                    sizes = _joined(np.abs(group.collect) @ np.abs(a) + size, np.abs(x))
                    truncation += self._truncated(missed[panel], norm * self._lengths[panel], given, sizes)
                    wrong, ends = self._answered(group, panel, sizes)
                    wrong = np.abs(group.spread) @ wrong + 3 * self._unit * (np.abs(sent) + np.abs(a))
                    rounding += np.sum(self._weights[group.states] / 2 * ends**2, axis=(1, 2))
                else:
                    sizes = np.swapaxes(np.concatenate([np.abs(a), size], axis=2), 2, 3)
                    wrong = np.swapaxes(self._products(group.columns[panel], sizes), 2, 3)
                wrong += 4 * self._smallest
                squares = np.sum(wrong**2, axis=-1) + wrong[..., 0] ** 2
                rounding += pi / 4 * self._lengths[panel] * np.sum(self._impedance[group.send] * squares, axis=(1, 2))
                np.maximum.at(self.direct, group.send, np.max(np.sum(wrong, axis=-1), axis=0))
            lost += float(np.sum(np.sqrt(truncation)))
            inexact += float(np.sum(np.sqrt(rounding)))
        return lost, inexact

    def _waves(self, block: WindowBlock, group: JointGroup, panel: int) -> tuple[Array, Array]:
        """What arrives at the joints and what they send, (windows, joints, ports, k)."""
        n = self._scheme.deepest + np.arange(block.count)[:, None, None]
        return block.waves[n - group.back, group.arrive, panel], block.waves[n, group.send, panel]

    def _products(self, columns: Array, sizes: Array) -> Array:
        """How wrong (..., rows) times (rows, columns) may be, from absolute values.

        What is multiplied is itself a sum of pushes, and so are the `sizes`.
        """
        size = np.abs(columns) + NEGLIGIBLE * np.max(np.abs(columns))
        count = len(columns) + self._pushes + _SPARE
        small = count * (1 + np.sum(size, axis=0)) + np.sum(sizes, axis=-1, keepdims=True)
        return np.asarray(self._unit * count * (sizes @ size) + self._smallest * small)

    def _answered(self, group: JointGroup, panel: int, sizes: Array) -> tuple[Array, Array]:
        """How wrong velocities (windows, joints, points, k) and states at the end may be."""
        columns, states = group.columns[panel], group.states.shape[1]
        wrong = self._products(columns, sizes)
        after = sizes[..., -states:] + sizes @ np.abs(columns[:, -states:])
        ends = wrong[..., -states:] + 2 * self._unit * after
        return wrong[..., :-states].reshape(*sizes.shape[:2], -1, group.size), ends

    def _truncated(self, missed: Array, turned: float, given: Array, sizes: Array) -> Array:
        """The squares of what is lost by truncation, (windows,)."""
        eps = np.linalg.norm(np.abs(given @ missed.T) + self._products(missed.T, sizes), axis=-1)
        return np.asarray(np.sum((2 * eps * (sqrt(turned) + (1 + turned) / sqrt(2))) ** 2, axis=1))


def _joined(acting: Array, x: Array) -> Array:
    """What the matrix of an answer is multiplied with, (windows, joints, columns)."""
    return np.concatenate([acting.reshape(*acting.shape[:2], -1), x], axis=2)
