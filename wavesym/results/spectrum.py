"""Response spectra of accelerations: what oscillators that stand there would do, and be too light to be felt.

An oscillator of period T and damping ratio z on a floor with the acceleration a obeys, with w = 2 pi / T,

    u'' + 2 z w u' + w^2 u = -a,    u = u' = 0 at tau = 0,

and its pseudo-acceleration is w^2 max |u| on the horizon. With r = w (-z + i sqrt(1 - z^2)), u is -1 / Im r times the
imaginary part of y, y' = r y + a, which is stepped exactly where a is linear. So all that is not exact is the straight
line between two values of a, and the top of u between two steps, through which a parabola is laid.

Both ask for short steps: 1/16 of the shortest period, and no more than 1/8 of the spacing of a record. (Floors
move with the modes of their rods, too; the shortest period is that of the first of these.) There are _LEAST steps at
least. Where a can jump a step ends. The same with every other value tells how much the step matters: the error of what
is told is about a third of that change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, factorial, floor, log10, pi, sqrt

import numpy as np
from flint import fmpq

from wavesym.errors import CostError, WavesymError
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import with_unit
from wavesym.numbers.arrays import Array, Complex
from wavesym.numbers.doubles import nearest
from wavesym.programs.hats import under_jumps
from wavesym.programs.making import make
from wavesym.programs.program import Program
from wavesym.results.presentation import OutputRows, csv_line
from wavesym.results.stepping import jumps, just_before, sample_program

PER_DECADE = 100  # periods, at numbers that are the same in all scenes; half as wide as peaks with 2 %
_SHORTEST = 2  # crossings of the shortest rod: the period of its own first mode
_PER_PERIOD, _PER_STEP = 16, 8
_TOLERANCE = fmpq(1, 10**6)
_LEAST, _MOST = 8_000, 2_000_000  # steps
_AT_ONCE = 64
_EACH = 4  # of so many periods one tells how much the step matters
_TOP = 0.8  # a parabola adds at most a quarter to the largest of its three values


@dataclass(frozen=True, repr=False, eq=False)
class Spectra(OutputRows):
    """Response spectra of a scene; `wavesym.spectrum` makes them. `spectra[NAME]` is that of one output, (n,).

    `values[k]` is the pseudo-acceleration of `outputs[k]` at `periods`, in its unit; periods in `time_unit`. `step` is
    how far values of the accelerations are apart, in tau, at most, and `change` what half as many of them change in any
    spectrum, relative to its largest value.
    """

    name: str
    outputs: tuple[str, ...]
    units: tuple[str, ...]
    time_unit: str | None
    damping: float
    periods: Array
    values: Array
    step: float
    change: float

    def __repr__(self) -> str:
        count, unit = len(self), self.time_unit or "tau"
        return (
            f"Spectra({self.name!r}, {count} output{'s' * (count != 1)} at {len(self.periods)} periods from "
            f"{self.periods[0]:g} to {self.periods[-1]:g} {unit}, damping {self.damping:g})"
        )

    def csv(self) -> list[str]:
        """Lines of CSV: one for each period, in the header what is of each output, at which damping, with its unit."""
        columns = [f"pseudo-acceleration of {name} at damping {self.damping:g}" for name in self.outputs]
        names = map(with_unit, columns, self.units)
        header = csv_line([with_unit("period", self.time_unit or ""), *names])
        rows = np.vstack([self.periods, self.values]).T.tolist()
        return [header, *map(csv_line, rows)]


def spectra(model: Model, damping: float, program: Program | None = None) -> Spectra:
    """The spectra of the outputs of quantity acceleration, by a `program` that has these, where there is one.

    WavesymError where there is none, or the horizon is too short; CostError for too many steps; ToleranceError,
    CostError where nothing could be generated either.
    """
    probes = tuple(probe for probe in model.probes if probe.quantity == "acceleration")
    if not probes:
        raise WavesymError("output.acceleration: none, and a response spectrum needs one; write acceleration = [PLACE]")
    watched = model.watching(probes).tolerating(max(model.tolerance, _TOLERANCE))
    per_tau = 1.0 if model.clock is None else nearest(model.clock.per_tau)
    periods = _periods(model, per_tau)
    shortest = periods[0] / per_tau
    until = nearest(model.until)
    steps = [shortest / _PER_PERIOD, until / _LEAST]
    step = min(steps if model.spacing is None else [*steps, nearest(model.spacing) / _PER_STEP])
    if (count := until / step) > _MOST:
        raise CostError(
            f"output.until: a response spectrum would take {count:.1e} steps of tau = {step:g}, the limit is "
            f"{_MOST:.1e} (a shorter horizon helps)"
        )
    program = program or make(watched)
    names = [output.name for output in program.outputs]
    rows = [names.index(probe.name) for probe in probes]
    stretches, every = zip(*_stretches(watched, program, step), strict=True)
    accelerations = [values[rows] for values in every]
    lengths = [(taus[-1] - taus[0]) / (len(taus) - 1) for taus in stretches]
    fine = _peaks(accelerations, lengths, periods / per_tau, damping)
    some = periods[::_EACH] / per_tau
    coarse = _peaks([a[:, ::2] for a in accelerations], [2 * h for h in lengths], some, damping)
    largest = np.maximum(fine.max(axis=1, keepdims=True), np.finfo(float).tiny)
    return Spectra(
        model.name,
        tuple(probe.name for probe in probes),
        tuple(probe.unit for probe in probes),
        None if model.clock is None else model.clock.unit,
        damping,
        periods,
        fine,
        max(lengths),
        float((np.abs(fine[:, ::_EACH] - coarse) / largest).max()),
    )


def line_spectrum(lines: Sequence[Array], periods: Array, damping: float) -> Array:
    """The spectrum of an acceleration that is known as polylines, a load for example.

    Args:
        lines: arrays of shape (n, 2), time and value; from one to the next it jumps.
        periods: shape (p,), in the same time.
        damping: the ratio of the oscillators.

    Returns:
        Their pseudo-accelerations, shape (p,), in the unit of the values.
    """
    step = min(periods) / _PER_PERIOD
    stretches = [np.linspace(line[0, 0], line[-1, 0], 2 * ceil(np.ptp(line[:, 0]) / (2 * step)) + 1) for line in lines]
    values = [np.interp(taus, *line.T)[None] for taus, line in zip(stretches, lines, strict=True)]
    lengths = [(taus[-1] - taus[0]) / (len(taus) - 1) for taus in stretches]
    return np.asarray(_peaks(values, lengths, periods, damping)[0])


def _periods(model: Model, per_tau: float) -> Array:
    """Periods in the time of results: between the shortest that a rod's own modes have and half the horizon."""
    shortest = _SHORTEST * nearest(model.network.shortest) * per_tau
    longest = nearest(model.until) * per_tau / 2
    first, last = ceil(PER_DECADE * log10(shortest)), floor(PER_DECADE * log10(longest))
    if first > last:
        horizon, unit = nearest(model.until) * per_tau, model.clock.unit if model.clock else "tau"
        raise WavesymError(
            f"output.until: {horizon:.6g} {unit} is too short for a response spectrum; write "
            f"{2 * 10 ** (first / PER_DECADE):.5g} {unit} or more"
        )
    return np.asarray(10.0 ** (np.arange(first, last + 1) / PER_DECADE))


def _stretches(model: Model, program: Program, step: float) -> list[tuple[Array, Array]]:
    """Stretches without jumps, each of an even number of equal steps: instants, and the outputs there."""
    if program.has_equal_steps or (program.hats and not jumps(under_jumps(program, model))):
        taus, values = sample_program(model, program, step)  # nothing jumps; steps of panels of one length are equal
        steps = np.diff(taus)
        cuts = np.flatnonzero(np.abs(np.diff(steps)) > 1e-6 * steps[:-1]) + 1
        ends = [0, *cuts.tolist(), len(steps)]
        return [(taus[low : high + 1], values[:, low : high + 1]) for low, high in pairwise(ends)]
    edges = [0.0, *jumps(model), program.tau_max]
    every = [_stretch(low, high, step) for low, high in pairwise(edges) if low < high]
    cuts = np.cumsum([len(taus) for taus in every])[:-1]
    return list(zip(every, np.split(program.evaluate(np.concatenate(every)), cuts, axis=1), strict=True))


def _stretch(low: float, high: float, step: float) -> Array:
    """Evenly from one jump to just before the next, in an even number of steps."""
    count = 2 * ceil((high - low) / (2 * step))
    taus = np.linspace(low, high, count + 1)
    taus[-1] = just_before(high)
    return taus


def _peaks(accelerations: Sequence[Array], lengths: Sequence[float], periods: Array, damping: float) -> Array:
    """Pseudo-accelerations (outputs, periods) from values (outputs, times) on stretches with steps of these lengths.

    What is stepped is y less what it takes of the present a, so that a step has one term.
    """
    w = 2 * pi / periods
    rate: Complex = np.asarray(w * complex(-damping, sqrt(1 - damping**2)))
    y = np.zeros((len(periods), len(accelerations[0])), complex)
    largest, term = np.zeros(y.shape), np.empty_like(y)
    for values, length in zip(accelerations, lengths, strict=True):
        turn, now, then = (each[:, None] for each in _step(rate * length))
        before, after = (now + turn * then) * length, then * length
        a = values.T
        y -= after * a[0]
        u = np.empty((_AT_ONCE + 2, *y.shape))
        u[:2] = y.imag + after.imag * a[0]
        for first in range(0, len(a) - 1, _AT_ONCE):
            steps = min(_AT_ONCE, len(a) - 1 - first)
            for k in range(steps):
                np.multiply(before, a[first + k], out=term)
                y *= turn
                y += term
                u[k + 2] = y.imag
            u[2 : steps + 2] += after.imag * a[first + 1 : first + steps + 1, None, :]
            _raise(largest, u[: steps + 2])
            u[:2] = u[steps : steps + 2]
        y += after * a[-1]
    return np.asarray((w * w / rate.imag)[:, None] * largest).T


def _step(x: Complex) -> tuple[Complex, ...]:
    """What becomes in one step of a state, and of the values of a before and after it, per length of the step."""
    series = sum(x**k / factorial(k + 2) for k in range(16))
    far = np.abs(x) > 1
    second = np.where(far, (np.exp(x) - 1 - x) / np.where(far, x, 1) ** 2, series)
    return np.exp(x), 1 + x * second - second, second


def _raise(largest: Array, u: Array) -> None:
    """Puts the largest |u| over the first axis into what is largest: the top of a parabola through three values."""
    highest = np.maximum(u.max(axis=0), -u.min(axis=0))
    near = highest > _TOP * largest
    largest[near] = np.maximum(largest[near], _tops(u[:, near]))


def _tops(u: Array) -> Array:
    """The largest |u| over the first axis, with a parabola through the largest value and its neighbours."""
    at = np.abs(u[1:-1]).argmax(axis=0)[None] + 1
    before, here, after = (np.take_along_axis(u, at + k, axis=0)[0] for k in (-1, 0, 1))
    bend = 2 * here - before - after
    inside = (np.abs(after - before) < np.abs(bend)) & (here * bend > 0)
    top = np.abs(here) + np.where(inside, (after - before) ** 2 / (8 * np.where(inside, np.abs(bend), 1.0)), 0.0)
    return np.asarray(np.maximum(top, np.abs(u).max(axis=0)))
