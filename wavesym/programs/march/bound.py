"""How far a march can be from the truth: an a-posteriori bound, proved.

Take as the state at an instant all waves that are in the rods, and the velocities of the bodies. Its energy,

    E**2 = sum over rods of Z * integral of both waves squared + sum over bodies of M q**2 / 2,

does not grow where nothing is loaded: M q' + (Z_l + Z_r) q = 2 Z_l a + 2 Z_r b makes what arrives,
Z_l a**2 + Z_r b**2, less what leaves, Z_l (q - a)**2 + Z_r (q - b)**2, the growth of M q**2 / 2; and a node without
inertia sends no more than arrives. The equations are linear, so the difference of two motions under the same loads does
not grow in E, and the error of the march is at most the sum, over windows and panels, of what each adds anew:

- Truncation. On a panel the computed q satisfies q + L int q = L int p + start up to R = eps (T_(d+1) -+ 1), with
  eps = x_(d+1) (q_d - p_d) and L = rate h / 2. Its error e solves e + L int e = R, whence |e| <= 2 |eps|.
- Rounding, by running the recurrences on absolute values: coefficients of q are wrong by at most u T |p| + u t |start|,
  with a matrix T and a vector t without negative entries, and q - a by u |q - a| more. In L2 over a panel a series has
  at most sqrt(pi h) / 2 times its norm (2 c_0**2 + c_1**2 + ...)**0.5, as (1 - u**2)**-0.5 >= 1.
- Underflow, which makes a product wrong by up to the smallest number instead, is run through the same recurrences.

From energy to values: the true wave on a panel is a polynomial of degree K up to some tail (tail.py), K for the
horizon and no lower than d; so its difference from the computed one is, and a polynomial of degree K in [-1, 1] is
nowhere larger than (K + 1)/sqrt(2) times its L2 norm. Reading a value adds the rounding of Clenshaw's recurrence, at
most 12 u sum ((k + 1)(k + 2) + d) |c_k| with that of the local variable; and 4 (d + 3)**2 of the smallest number. A
displacement is an integral, so L2 will do.

Errors are relative to the largest value on the horizon: of the last window only what tau_max reaches counts.

All of it holds to first order in u, and a margin of 1 % is added for the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, inf, log2, pi, sqrt
from typing import NamedTuple

import numpy as np
from flint import fmpq

from wavesym.exact.silence import silent
from wavesym.numbers.doubles import nearest, not_below, rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.march.operator import Array, PanelOperator
from wavesym.programs.march.plan import LEFT, LOAD, RIGHT, HeardWave, Plan, power_of_two
from wavesym.programs.march.run import Block, Run
from wavesym.programs.march.sampler import OutputSampler
from wavesym.programs.march.tail import Tail, tail

MARGIN = 1.01
_ONE = fmpq(1)
# products on the way to a coefficient of p or q that may underflow, besides those of a scan
_SPARE = 16.0


@dataclass(frozen=True)
class Verdict:
    """What a march at some degree is worth.

    `errors` and `sizes` are, for each output, a bound of its largest error and the largest value that was seen; of
    the energy norm of the error, `truncated` is the part of the degree, `rounded` that of the arithmetic. `quiet` says
    that the programs, which watch what their polynomials miss as they run, will not complain.
    """

    degree: int
    errors: tuple[float, ...]
    sizes: tuple[float, ...]
    truncated: float
    rounded: float
    quiet: bool

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


def judge(plan: Plan, degree: int, real: Real) -> Verdict:
    """March once over the horizon at `degree` for a program in `real` numbers, and bound its errors.

    All is divided by the size of what moves it, so that no square of a wave underflows here. OverflowError where waves
    grow beyond what programs take.
    """
    powers = (power for event in plan.events for power in event.powers)
    scale = power_of_two((*plan.rods, *(node.motion for node in plan.junctions), *powers))
    verdict = _judge(plan.scaled(1 / scale), degree, real, scale)
    errors, sizes = (tuple(nearest(scale) * value for value in of) for of in (verdict.errors, verdict.sizes))
    return replace(verdict, errors=errors, sizes=sizes)


def _judge(plan: Plan, degree: int, real: Real, scale: fmpq) -> Verdict:
    """The same for a plan whose motions are so many times as small as those of the program."""
    run = Run(plan, degree)
    unit, smallest = nearest(real.roundoff), not_below(real.smallest / scale)
    reach = nearest(min(real.reach / scale, DOUBLE.reach))
    roundings = Roundings(plan, run, real, scale)
    smooth = tail(plan, degree)
    samplers = [OutputSampler(plan, output, degree) for output in plan.outputs]
    weights, summing = (reading_weights(degree, displaced) for displaced in (False, True))
    truncated = rounded = summed = 0.0
    alarm = Alarm(plan.trusted)
    largest, reading, sums = (np.zeros(len(samplers)) for _ in range(3))
    loads = np.zeros(len(plan.junctions))
    for block in run.blocks():
        lost, inexact = roundings.of(block)
        truncated += float(np.sum(lost))
        rounded += float(np.sum(inexact))
        summed += len(lost) * (truncated + rounded)
        alarm.watch(block, roundings.leak)
        for o, sampler in enumerate(samplers):
            largest[o] = max(largest[o], float(np.max(np.abs(sampler.values(block)))))
            reading[o] = max(reading[o], float(np.max(sampler.size(block, weights, summed=False))))
            sums[o] += float(np.sum(sampler.size(block, summing, summed=True)))
        loads = np.maximum(loads, np.max(block.forces, axis=(0, 1)))
        if not np.max(np.abs(block.after)) < reach:
            raise OverflowError(f"waves beyond {nearest(real.reach):.1g}")
    errors = []
    lost_reading = 4.0 * (degree + 3) ** 2 * smallest
    stretches = 2.0 * len(plan.panels) + 2
    for o, output in enumerate(plan.outputs):
        error = 0.0
        if of := output.part(summed=True):
            held = largest[o] + reading[o]
            error += felt(plan, of) * summed + unit * (24 * stretches * sums[o] + len(of) * plan.windows * held)
            error += plan.windows * stretches * lost_reading * max(1, len(of) / 2)
        if of := output.part(summed=False):
            error += wave_error(smooth, plan, of, truncated + rounded) + (10 + max(2, len(of))) * unit * reading[o]
            error += sum(load_error(plan, each, loads, unit, smallest) for each in of if each.way == LOAD)
            error += lost_reading * max(1, len(of) / 2)
        errors.append(MARGIN * float(error))
    # what rounding could have made may be nothing at all: programs then return exactly 0
    if any(size <= error for size, error in zip(largest, errors, strict=True)):
        for o, nothing in enumerate(silent(plan.model, rational(plan.tau_max))):
            if nothing:
                errors[o] = largest[o] = 0.0
    return Verdict(degree, tuple(errors), tuple(map(float, largest)), truncated, rounded, not alarm.rung)


def reading_weights(degree: int, displaced: bool) -> Array:
    """What each coefficient of a wave adds to the rounding of a value, or to that of a displacement on a window."""
    k = np.arange(degree + 1)
    return k + 8 + degree / (k + 1.0) if displaced else (k + 1) * (k + 2.0) + degree


def largest_wave(smooth: Tail, plan: Plan, energy: float) -> float:
    """The largest value of a wave on a window whose L2 norm is `energy`, and whose tail is known."""
    shortest = min(nearest(panel.length) for panel in plan.panels)
    factor = (smooth.degree + 1) / sqrt(2)
    return factor * (sqrt(2 / shortest) * energy + sqrt(2) * smooth.size) + smooth.size


def felt(plan: Plan, heard: Sequence[HeardWave]) -> float:
    """How large what is heard can be, in L2 over a window, where the norm of energy is 1."""
    return sum(abs(nearest(each.gain)) / sqrt(_impedance(plan, each)) for each in heard if each.way != LOAD)


def wave_error(smooth: Tail, plan: Plan, heard: Sequence[HeardWave], energy: float) -> float:
    """The largest error of what is heard where that of all waves is in the norm of energy."""
    return sum(
        abs(nearest(each.gain)) * largest_wave(smooth, plan, energy / sqrt(_impedance(plan, each)))
        for each in heard
        if each.way != LOAD
    )


def load_error(plan: Plan, heard: HeardWave, loads: Array, unit: float, smallest: float) -> float:
    """How wrong the series of a load is that is heard, where loads on columns are at most so large."""
    size = float(loads[plan.loaded[heard.column]])
    return abs(nearest(heard.gain)) * (8 * unit * size + _SPARE * smallest)


def _impedance(plan: Plan, heard: HeardWave) -> float:
    """That of the rod that a wave is sent into."""
    node = plan.junctions[heard.column]
    return nearest(node.right if heard.way == RIGHT else node.left)


class Alarm:
    """What the programs watch: the sum of all leaks |eps|, which may be `trusted` of the largest velocity or mean of a
    wave so far.
    """

    def __init__(self, trusted: float) -> None:
        self._trusted = trusted
        self._leak = self._size = 0.0
        self.rung = False

    def watch(self, block: Block, leak: Array) -> None:
        """The windows of a block, with the leak per unit of `excess` of each panel and column."""
        leaks = self._leak + np.cumsum(np.sum(leak * np.abs(block.excess), axis=(1, 2)))
        means = np.max(np.abs(block.after[:, :LOAD, ..., 0]), axis=(1, 2, 3))
        sizes = np.maximum.accumulate(np.maximum(means, np.max(np.abs(block.ends), axis=(1, 2))))
        sizes = np.maximum(sizes, self._size)
        self.rung |= bool(np.any(leaks > self._trusted * sizes))
        self._leak, self._size = float(leaks[-1]), float(sizes[-1])


class Roundings:
    """What a window adds to the error, in energy: for all nodes at once.

    The program moves `scale` times as much as the plan.
    """

    def __init__(self, plan: Plan, run: Run, real: Real, scale: fmpq = _ONE) -> None:
        self._unit, self._smallest = nearest(real.roundoff), not_below(real.smallest / scale)
        nodes = plan.junctions
        constants = {step: _constants(operator) for step, operator in run.operators.items()}
        shape = len(plan.panels), len(nodes)
        self._q, self._start, self._end, self._end_start, self.leak = (np.zeros(shape) for _ in range(5))
        self._q_spare, self._end_spare, self._lost = (np.zeros(shape) for _ in range(3))
        self._q[:] = 4.0
        self._q_spare[:] = _SPARE * sqrt(run.degree + 2)
        for p, panel in enumerate(plan.panels):
            for c, node in enumerate(nodes):
                if node.rate is not None:
                    step = node.rate * panel.length
                    of = constants[step]
                    self._q[p, c], self._start[p, c], self._q_spare[p, c] = of.coefficients
                    self._end[p, c], self._end_start[p, c], self._end_spare[p, c] = of.end
                    self.leak[p, c] = run.operators[step].leak
                    self._lost[p, c] = nearest(node.mass * (4 * step + 2))  # M (rate h (2 eps)^2 + (2 eps)^2 / 2)
        self._length = np.array([[nearest(panel.length)] for panel in plan.panels])
        self._left = np.array([nearest(node.left) for node in nodes])
        self._right = np.array([nearest(node.right) for node in nodes])
        self._mass = np.array([nearest(node.mass) for node in nodes])
        self._alpha, self._beta = np.abs(run.alpha[:, 0]), np.abs(run.beta[:, 0])

    def of(self, block: Block) -> tuple[Array, Array]:
        """By truncation and by rounding; shape (windows,) each."""
        before, after = (np.sqrt(np.sum(w**2, axis=-1) + w[..., 0] ** 2) for w in (block.before, block.after))
        arriving = self._alpha * before[:, RIGHT, :, :-2] + self._beta * before[:, LEFT, :, 2:] + 2 * block.forces
        starts = np.abs(block.starts)
        q = self._unit * (self._q * arriving + self._start * starts) + self._smallest * self._q_spare
        end = self._unit * (self._end * arriving + self._end_start * starts) + self._smallest * self._end_spare
        missed = self.leak * (np.abs(block.excess) + q + 4 * self._unit * arriving)
        left = q + self._unit * after[:, LEFT, :, 1:-1]
        right = q + self._unit * after[:, RIGHT, :, 1:-1]
        waves = pi / 4 * self._length * (self._left * left**2 + self._right * right**2)
        inexact = np.sum(np.sqrt(np.sum(waves + self._mass / 2 * end**2, axis=-1)), axis=-1)
        return np.sum(np.sqrt(np.sum(self._lost * missed**2, axis=-1)), axis=-1), inexact


def _norm(matrix: Array) -> float:
    """An upper bound of the 2-norm of a matrix A without negative entries.

    For any positive x no eigenvalue of A^T A is larger than the largest (A^T A x)_i / x_i (Collatz).
    """
    x = np.ones(matrix.shape[1])
    for _ in range(20):
        y = matrix.T @ (matrix @ x)
        bound = float(np.max(y / x))
        x = y / np.max(y) + 1e-3
    return sqrt(bound)


class _Constants(NamedTuple):
    """How wrong the coefficients of q, and its value at the `end`, may be: per u |p|, per u |start|, and per smallest
    number that may be lost by underflow.
    """

    coefficients: tuple[float, float, float]
    end: tuple[float, float, float]


def _constants(operator: PanelOperator) -> _Constants:
    """Norms of T and t for the coefficients of q, and the same for its value at the end.

    Counts the roundings of the programs in C (one after the other) and in NumPy (scans and sums in pairs).
    """
    degree = len(operator.ratio) - 1
    levels = ceil(log2(degree + 1))
    ratio, first, last = (np.abs(np.array(table)) for table in (operator.ratio, operator.first, operator.last))
    slack, loss = operator.slack, operator.loss
    # columns: |p_0| ... |p_d|, |start|, and a last one that no value has: products that underflow
    given = np.eye(degree + 3)
    start, spare = given[-2], (_SPARE + levels) * given[-1]
    y, y_error = np.zeros((degree + 2, degree + 3)), np.zeros((degree + 2, degree + 3))
    for k in range(degree, 0, -1):
        difference = (2 if k == 1 else 1) * given[k - 1] + (given[k + 1] if k < degree else 0)
        y[k] = ratio[k] * (difference + y[k + 1])
        y_error[k] = 8 * y[k] + ratio[k] * y_error[k + 1] + spare
    y, y_error = y[:-1], y_error[:-1] + levels * y[:-1]
    counts = np.maximum(np.arange(degree + 1), levels) + 3.0
    summed = (degree + 4) * given[-1]
    begun, ended = start + first @ y, last @ y
    mean = (1 - slack) * begun
    mean_error = (1 - slack) * (first @ y_error + (first * counts) @ y + summed) + 3 * begun + spare
    end_error = abs(1 - loss) * mean_error + last @ y_error + (last * counts) @ y + 3 * ((1 + abs(loss)) * mean + ended)
    end_error += summed + spare
    q_error = np.empty_like(y_error)
    q_error[0] = mean_error
    q, error = 2 * mean, 2 * mean_error
    for k in range(1, degree + 1):
        q = y[k] + ratio[k] * q
        error = y_error[k] + ratio[k] * error + 3 * q + spare
        q_error[k] = error + levels * q
    # in the norm that counts c_0 twice
    q_error[0] *= sqrt(2)
    q_error[:, 0] /= sqrt(2)
    end_error[0] /= sqrt(2)
    return _Constants(
        (
            _norm(q_error[:, :-2]),
            float(np.linalg.norm(q_error[:, -2])),
            float(np.linalg.norm(q_error[:, -1])),
        ),
        (float(np.linalg.norm(end_error[:-2])), float(end_error[-2]), float(end_error[-1])),
    )
