"""How far a march can be from the truth: an a-posteriori bound, proved. docs/march.md has each step.

Take as the state at an instant all waves that are in the bars, the velocities of masses and how long springs have
become. Its energy, sum of Z * integral of wave**2 over all waves + sum of M q**2 / 2 + sum of K z**2 / 2, does not grow
where nothing is loaded. The equations are linear, so the error of the march is at most the sum, over windows and
panels, of what each adds anew, in the norm E, the root of that energy:

- Truncation. On a panel of length h the computed state misses its equation by R = eps (T_(d+1) -+ 1). For a body of
  rate g its error e solves e + L int e = R with L = g h / 2, whence |e| <= 2 |eps|, and the energy of what it sends and
  keeps is at most M eps**2 (4 g h + 2). For a block, g the norm of its rates, that adds at most
  2 |eps| (sqrt(g h) + (1 + g h)/sqrt(2)).
- Rounding, by running the recurrences of bodies, and the matrices of the others, on absolute values. In L2 over a panel
  a series has at most sqrt(pi h) / 2 times its norm (2 c_0**2 + c_1**2 + ...)**0.5, as (1 - u**2)**-0.5 >= 1. Underflow
  loses up to the smallest number in each product.

From energy to values: a wave is in L2 at most E/sqrt(Z), the velocity of a free point at most
E ((5 + 2 h) [(C + M)^-1])**0.5, and the true ones are polynomials of degree K up to some tail (tail.py), K for the
horizon and no lower than d. So their differences are, and a polynomial of degree K in [-1, 1] is nowhere larger than
(K + 1)/sqrt(2) times its L2 norm. Reading a value adds the rounding of Clenshaw's recurrence, at most
12 u sum ((k + 1)(k + 2) + d) |c_k| with that of the local variable. A displacement is an integral, so L2 will do.

All of it holds to first order in u, and a margin of 1 % is added for the rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from math import inf, sqrt

import numpy as np
from flint import fmpq, fmpq_mat

from wavesym.exact.arrivals import identically_zero
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest, not_below, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.march.losses import Losses
from wavesym.programs.march.plan import MarchedJoint, MarchPlan, OutputTerm, largest_number, power_of_two
from wavesym.programs.march.tables import MarchTables
from wavesym.programs.march.tail import Tail, tail_of
from wavesym.programs.schemes.march import Marching, MarchScheme, WindowBlock

SAMPLES = 16
"""Instants in a window at which the generator looks for an output's largest value."""
MARGIN = 1.01
READING = 12
"""Units of rounding that reading a wave adds for each unit of `reading_weights`, besides those of its gain and sum."""
# square roots of exact numbers, rounded a few times
_ABOVE = 1 + 1e-12


@dataclass(frozen=True)
class Verdict:
    """What a march at some degree is worth.

    `errors` and `sizes` are, for each output, a bound of its largest error and the largest value that was seen; of
    the energy norm of the error, `truncation_error` is the part of the degree, `rounding_error` that of the arithmetic.
    Values of an output do not exceed its `heights`, nor their slopes over tau its `slopes`. True waves are polynomials
    of degree `smooth` on each panel, up to a tail.
    """

    degree: int
    errors: tuple[float, ...]
    sizes: tuple[float, ...]
    truncation_error: float
    rounding_error: float
    smooth: int = 0
    heights: tuple[float, ...] = ()
    slopes: tuple[float, ...] = ()

    @property
    def largest(self) -> tuple[float, ...]:
        """Lower bounds of the largest true values."""
        return tuple(max(size - error, 0.0) for error, size in zip(self.errors, self.sizes, strict=True))

    @property
    def bounds(self) -> tuple[float, ...]:
        """Errors relative to the largest values; 0 for an output that is 0 throughout, inf where nothing is left."""
        return tuple(
            0.0 if error == 0 else error / largest if largest > 0 else inf
            for error, largest in zip(self.errors, self.largest, strict=True)
        )


def judge(plan: MarchPlan, degree: int, real: Real) -> Verdict:
    """March once over the horizon at `degree` for a program in `real` numbers, and bound its errors.

    All is divided by the size of what moves it, so that no square of a wave underflows here. OverflowError where waves
    grow beyond what programs take.
    """
    scale = power_of_two([largest_number(plan)])
    verdict = _judge(plan.scale(1 / scale), degree, real, scale)
    errors, sizes, heights, slopes = (
        tuple(nearest(scale) * value for value in of)
        for of in (verdict.errors, verdict.sizes, verdict.heights, verdict.slopes)
    )
    return replace(verdict, errors=errors, sizes=sizes, heights=heights, slopes=slopes)


def _judge(plan: MarchPlan, degree: int, real: Real, scale: fmpq) -> Verdict:
    """The same for a plan whose motions are so many times as small as those of the program."""
    made = MarchTables(plan, degree, DOUBLE)
    scheme = MarchScheme(made.tables([False] * len(plan.outputs)), made.constants(), plan.tau_max, np.float64)
    unit, smallest = nearest(real.roundoff), not_below(real.smallest / scale)
    reach = nearest(min(real.reach / scale, DOUBLE.reach))
    losses = Losses(plan, made, scheme, unit, smallest)
    outputs, step = len(plan.outputs), nearest(plan.step)
    truncated, rounded, summed = 0.0, losses.initial_error, 0.0
    largest, reading, sums, held, height, slope = (np.zeros(outputs) for _ in range(6))
    one, bent = np.ones(degree + 1), 2 / plan.shortest * np.arange(degree + 1.0) ** 2
    for block in _march_blocks(scheme, plan.windows):
        lost, inexact = losses.of_block(block)
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
    additions = most_additions(plan)
    errors = []
    for o, output in enumerate(plan.outputs):
        error = 0.0
        if of := output.part(summed=True):
            error += _influence(plan, of) * sqrt(step) * summed
            error += unit * (24 * additions * step * sums[o] + len(of) * plan.windows * held[o])
            error += plan.windows * additions * lost_reading * (1 + step) * max(1, len(of) / 2)
            error += _direct(losses, of) * step * plan.windows
        if of := output.part(summed=False):
            error += _influence(plan, of) * largest_wave(smooth, plan, truncated + rounded)
            error += (READING + max(2, len(output.terms))) * unit * reading[o] + lost_reading * max(1, len(of) / 2)
            error += _direct(losses, of)
        if 0 < len(output.part(summed=True)) < len(output.terms):
            error += len(output.terms) * unit * held[o]  # one is added to the other
        errors.append(MARGIN * float(error))
    # what rounding could have made may be nothing at all: programs then return exactly 0
    if doubtful := [o for o, (size, error) in enumerate(zip(largest, errors, strict=True)) if size <= error]:
        asked = plan.model.watching(plan.model.probes[o] for o in doubtful)
        for o, nothing in zip(doubtful, identically_zero(asked, rational(plan.tau_max)), strict=True):
            if nothing:
                errors[o] = largest[o] = height[o] = slope[o] = 0.0
    sizes, heights, slopes = (tuple(of.tolist()) for of in (largest, height, slope))
    return Verdict(degree, tuple(errors), sizes, truncated, rounded, smooth.degree, heights, slopes)


def _size(block: WindowBlock, terms: Iterable[OutputTerm], weights: Array) -> float:
    """The weighted absolute coefficients of the terms of an output, at most."""
    return sum(abs(nearest(each.gain)) * float(np.max(np.abs(block.waves[:, each.track]) @ weights)) for each in terms)


def reading_weights(degree: int, displaced: bool) -> Array:
    """What each Chebyshev coefficient of a wave adds to the error of an output, in units of rounding.

    Args:
        degree: that of the wave on a panel.
        displaced: whether the output is an integral of the wave, a displacement.

    Returns:
        (degree + 1,)
    """
    k = np.arange(degree + 1)
    return k + 8 + degree / (k + 1.0) if displaced else (k + 1) * (k + 2.0) + degree


def most_additions(plan: MarchPlan) -> float:
    """How many numbers an integral over a window is the sum of: at both ends of each stretch of the wave."""
    return 2.0 * len(plan.panels) + 2


def _influence(plan: MarchPlan, terms: Iterable[OutputTerm]) -> float:
    """How large the terms of an output can be, in L2 over a window, where the norm of energy is 1."""
    return sum(abs(nearest(each.gain)) * size_of(plan, each.track) for each in terms)


def _direct(losses: Losses, terms: Iterable[OutputTerm]) -> float:
    """How wrong the terms of an output may be by themselves."""
    return sum(abs(nearest(each.gain)) * float(losses.direct[each.track]) for each in terms)


def _march_blocks(scheme: MarchScheme, windows: int) -> Iterator[WindowBlock]:
    marching = Marching(scheme)
    for first in range(0, windows, marching.most):
        yield marching.block(first, min(marching.most, windows - first))


def largest_wave(smooth: Tail, plan: MarchPlan, energy: float) -> float:
    """The largest value of what is in L2 at most `energy`, and a polynomial up to a tail."""
    return (smooth.degree + 1) / sqrt(2) * (sqrt(2 / plan.shortest) * energy + sqrt(2) * smooth.size) + smooth.size


def size_of(plan: MarchPlan, track: int) -> float:
    """How large what is on a track can be, in L2 over a window, where the norm of energy is 1."""
    if impedance := plan.tracks[track].impedance:
        return 1 / sqrt(nearest(impedance))
    if plan.tracks[track].prescribed:
        return 0.0
    number, point = next(
        (number, port.point)
        for number, joint in enumerate(plan.joints)
        for port, send in zip(joint.space.ports, joint.sends, strict=True)
        if send == track
    )
    network = plan.model.network
    reached = list(plan.model.joints_in_reach(rational(plan.tau_max)))
    law = JointLaw.assemble(network, network.joints[reached[number]])
    free = [k for k, given in enumerate(law.motions) if given is None]
    held = [law.damping[a][b] + (law.mass[a] if a == b else 0) for a in free for b in free]
    at = free.index(point)
    return _ABOVE * sqrt(nearest(fmpq_mat(len(free), len(free), held).inv()[at, at] * (5 + 2 * plan.step)))


def smoothness(plan: MarchPlan, degree: int) -> Tail:
    """How near to polynomials of some degree, and no lower one, true waves are where the norm of energy is 1."""
    rate = plan.norm
    jumps = list(_jumps(plan, rate)) if rate else [0.0] * 3
    if not any(jumps):
        return Tail(max(degree, 3), 0.0)  # without a state waves are as the loads
    added = (plan.windows + 2) * len(plan.panels) / sqrt(2 * rate)
    return tail_of(degree, jumps, rate, plan.crossings, added, [nearest(panel.length) for panel in plan.panels])


def _jumps(plan: MarchPlan, rate: float) -> Iterator[float]:
    """Those of order 0, 1, 2 that loads and start make, as waves (velocity times root of impedance), all added up."""
    strengths: dict[int, float] = {}
    begin = 0.0
    for joint in plan.joints:
        for point, force in enumerate(joint.forces):
            if force >= 0:  # where a load is read only it moves nothing
                strengths[force] = max(strength(joint, point, rate), strengths.get(force, 0.0))
        begin += start_jump(plan, joint, rate)
    loads = [0.0] * 3
    for event in plan.events:
        for order, c in enumerate(event.change):
            loads[order] += strengths[event.force] * abs(nearest(c)) * (2 if order == 2 else 1)
    loads[0] += begin
    yield from loads


def strength(joint: MarchedJoint, point: int, rate: float) -> float:
    """The jump of waves that a jump of what acts on a point counts as."""
    space = joint.space
    state = sum((weight * space.input_rates[n, point] ** 2 for n, weight in enumerate(space.weights)), fmpq(0))
    sent = sum(
        (port.impedance * (port.ratio * space.feedthrough[port.point, point]) ** 2 for port in space.ports), fmpq(0)
    )
    return _ABOVE * (sqrt(nearest(state) / rate) / 2 + sqrt(nearest(sent)))


def start_jump(plan: MarchPlan, joint: MarchedJoint, rate: float) -> float:
    """The same for the start: as if what was held in joint until tau = 0 were let go."""
    space = joint.space
    arriving = [plan.tracks[track].initial_value for track in joint.arrive]
    acting = [fmpq(0)] * space.points
    for port, a in zip(space.ports, arriving, strict=True):
        acting[port.point] += port.push * a
    x, s = (fmpq_mat(len(values), 1, list(values)) for values in (space.initial_state, acting))
    moved, q = space.rates * x + space.input_rates * s, space.state_velocities * x + space.feedthrough * s
    state = sum((weight * moved[n, 0] ** 2 for n, weight in enumerate(space.weights)), fmpq(0))
    sent = fmpq(0)
    for port, a, track in zip(space.ports, arriving, joint.sends, strict=True):
        sent += port.impedance * (port.ratio * q[port.point, 0] - a - plan.tracks[track].initial_value) ** 2
    return _ABOVE * (sqrt(nearest(state) / rate) / 2 + sqrt(nearest(sent)))
