"""A march under loads that are given while it runs: what is proved of it before any of them is known.

Let the loads be, on every panel, polynomials of degree `SMOOTH` or less and nowhere larger than 1, and nothing else
move. Then the coefficients of their Chebyshev series are at most 4/pi (the mean at most 1). Motions add up, and so do
the bounds of bound.py, which are norms of what moves: the error is at most the sum, over windows, loads, panels and
Chebyshev polynomials, of the error under this polynomial alone. A load that acts on window w costs until the last one
what a load on the first window costs in as many windows; so it is enough to march once with a load on the first window,
all such polynomials side by side, and to add up what it has cost after 1, 2, ... windows.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import pi, prod, sqrt

import numpy as np
from flint import arb, fmpq

from wavesym.numbers.doubles import bound, nearest, not_below
from wavesym.numbers.reals import Real
from wavesym.programs.march.bound import MARGIN, Roundings, felt, load_error, reading_weights, wave_error
from wavesym.programs.march.operator import Array
from wavesym.programs.march.plan import LEFT, LOAD, RIGHT, Plan, power_of_two
from wavesym.programs.march.run import Block, Run
from wavesym.programs.march.sampler import OutputSampler
from wavesym.programs.march.tail import tail_after

SMOOTH = 4


@dataclass(frozen=True)
class Given:
    """For so many windows no output is wrong by more than its `errors` times the largest load.

    `settled` says that a higher degree would not mend much: of the errors, rounding is the larger part.
    """

    windows: int
    errors: tuple[float, ...]
    settled: bool


def batch_size(plan: Plan) -> int:
    """How many marches go side by side."""
    return len(plan.channels) * len(plan.panels) * (SMOOTH + 1)


def given(plan: Plan, degree: int, real: Real, windows: int) -> Given:
    """What is proved for `windows` windows at some degree."""
    scale = power_of_two(channel.gain for channel in plan.channels)
    made = _given(plan.scaled(1 / scale), degree, real, windows, scale)
    return replace(made, errors=tuple(bound(arb(error) * arb(scale)) for error in made.errors))


def _given(plan: Plan, degree: int, real: Real, windows: int, scale: fmpq) -> Given:
    """The same for a plan whose gains are so many times as small, before errors are rounded."""
    run = Run(plan, degree)
    unit = nearest(real.roundoff)
    roundings = Roundings(plan, run, real, scale)
    samplers = [OutputSampler(plan, output, degree) for output in plan.outputs]
    hearing, summing = (reading_weights(degree, displaced) for displaced in (False, True))
    # by windows: in energy, and what reading the outputs costs
    lost, inexact = np.zeros(windows), np.zeros(windows)
    read, sums = np.zeros((len(samplers), windows)), np.zeros((len(samplers), windows))
    loads = np.zeros(len(plan.junctions))
    weights = np.tile(np.where(np.arange(SMOOTH + 1) > 0, 4 / pi, 1.0), len(plan.channels) * len(plan.panels))
    for n, block in enumerate(_windows(plan, run, windows)):
        lost[n], inexact[n] = (float(weights @ part) for part in roundings.of(block))
        for o, sampler in enumerate(samplers):
            read[o, n] = weights @ sampler.size(block, hearing, summed=False)
            sums[o, n] = weights @ sampler.size(block, summing, summed=True)
        loads += weights @ np.max(block.forces, axis=1)
    smooth = tail_after(plan, degree, windows, [windows * jump for jump in _jumps(plan)])
    # loads of all windows: what each has cost so far, added up
    costs = np.cumsum(np.cumsum(lost + inexact))
    spare = not_below(real.smallest / scale)
    lost_reading = 4.0 * (degree + 3) ** 2 * spare
    stretches = 2.0 * len(plan.panels) + 2
    errors = []
    for o, output in enumerate(plan.outputs):
        error = 0.0
        if of := output.part(summed=True):
            summed = np.cumsum(sums[o])
            rounded = 24 * stretches * np.sum(summed) + len(of) * np.sum(np.arange(1, windows + 1) * summed)
            error += felt(plan, of) * float(np.sum(costs)) + unit * float(rounded)
            error += windows * stretches * lost_reading * max(1, len(of) / 2)
        if of := output.part(summed=False):
            error += wave_error(smooth, plan, of, float(costs[-1]))
            error += (10 + max(2, len(of))) * unit * float(np.sum(read[o])) + lost_reading * max(1, len(of) / 2)
            error += sum(load_error(plan, each, loads, unit, spare) for each in of if each.way == LOAD)
        errors.append(MARGIN * error)
    settled = float(np.sum(np.cumsum(lost))) <= float(np.sum(np.cumsum(inexact)))
    return Given(windows, tuple(errors), settled)


def _windows(plan: Plan, run: Run, windows: int) -> Iterator[Block]:
    """A march for each load, panel and Chebyshev polynomial that acts there on the first window; one Block a window."""
    columns, size, count = len(plan.junctions), run.degree + 1, batch_size(plan)
    series, rest = _loads(plan, size)
    before = np.zeros((count, plan.ways, len(plan.panels), columns + 2, size))
    forces_on = list(plan.loaded)
    q = np.zeros((count, columns))
    for n in range(windows):
        after = np.zeros_like(before)
        a, b = before[:, RIGHT, :, :-2], before[:, LEFT, :, 2:]
        balance = run.alpha * a + run.beta * b
        if n == 0:
            balance += series
            # made from values at the points, with a sum of as many terms
            forces = np.sum(np.abs(series), axis=-1) * (run.degree + 8) * sqrt(run.degree + 2)
            after[:, LOAD:, :, 1 : len(forces_on) + 1] = series[:, np.newaxis, :, forces_on]
        else:
            acting = np.repeat(rest[:, np.newaxis], len(plan.panels), axis=1)
            balance[..., 0] += acting
            # an integral is added to on every panel
            forces = np.abs(acting) * (n + 1) * (len(plan.panels) + 1)
            after[:, LOAD:, :, 1 : len(forces_on) + 1, 0] = acting[:, np.newaxis, :, forces_on]
        moved, starts, ends = run.moved(balance, q)
        q = ends[:, -1]
        excess = moved[..., -1] - balance[..., -1]
        after[:, LEFT, :, 1:-1] = moved - a
        after[:, RIGHT, :, 1:-1] = moved - b
        yield Block(before, after, starts, ends, excess, forces)
        before = after


def _loads(plan: Plan, size: int) -> tuple[Array, Array]:
    """What is added to p on the first window, (batch, panel, column, coefficient), and later, (batch, column)."""
    panels, columns = len(plan.panels), len(plan.junctions)
    series = np.zeros((len(plan.channels), panels, SMOOTH + 1, panels, columns, size))
    rest = np.zeros((len(plan.channels), panels, SMOOTH + 1, columns))
    for s, channel in enumerate(plan.channels):
        column, gain = plan.loaded[channel.force], nearest(channel.gain)
        for p, panel in enumerate(plan.panels):
            for k in range(SMOOTH + 1):
                if channel.order == 0:
                    series[s, p, k, p, column, k] = gain
                    continue
                shape = nearest(panel.length / 2) * np.polynomial.chebyshev.chebint(np.eye(SMOOTH + 1)[k], lbnd=-1)
                total = gain * float(np.sum(shape))
                series[s, p, k, p, column, : len(shape)] = gain * shape
                series[s, p, k, p + 1 :, column, 0] = total
                rest[s, p, k, column] = total
    return series.reshape(-1, panels, columns, size), rest.reshape(-1, columns)


def _jumps(plan: Plan) -> list[float]:
    """The jumps that the loads of one window make, by order."""
    jumps = [0.0] * (SMOOTH + 3)
    for channel in plan.channels:
        for panel in plan.panels:
            half = nearest(panel.length / 2)
            for order in range(SMOOTH + 1):
                steepest = sum(
                    4 / pi * prod((k * k - j * j) / (2 * j + 1) for j in range(order)) for k in range(SMOOTH + 1)
                )
                jumps[order + channel.order] += 2 * abs(nearest(channel.gain)) * steepest / half**order
    return jumps
