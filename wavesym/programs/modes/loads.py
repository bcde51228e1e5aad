"""The loads of a model as functions that are linear between instants, and how much they excite high frequencies."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.loads import AppliedLoad
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import common_measure, nearest

_STEPS_OF_ONE = 1000  # of a horizon, where there is nothing else to tell a spacing


@dataclass(frozen=True)
class LinearLoads:
    """Loads that are 0 at tau = 0, `samples[i][j]` is load j at times[i], and linear between; the first time is 0.

    After the last they go on with `slopes`.
    """

    times: tuple[fmpq, ...]
    samples: tuple[tuple[fmpq, ...], ...]
    slopes: tuple[fmpq, ...]

    @cached_property
    def lengths(self) -> tuple[fmpq, ...]:
        """Of the panels between the times."""
        return tuple(after - before for before, after in pairwise(self.times))

    @cached_property
    def distinct(self) -> tuple[tuple[fmpq, ...], tuple[int, ...]]:
        """The different lengths of panels in order, and which of them each panel has. (An fmpq is slow to hash.)"""
        found: list[fmpq] = []
        kind = [0] * len(self.lengths)
        order = sorted(range(len(kind)), key=self.lengths.__getitem__)
        for k in order:
            if not found or self.lengths[k] != found[-1]:
                found.append(self.lengths[k])
            kind[k] = len(found) - 1
        return tuple(found), tuple(kind)

    @property
    def largest(self) -> fmpq:
        """The largest absolute value at one of the times."""
        return max((abs(value) for row in self.samples for value in row), default=fmpq(0))

    def sample(self, step: fmpq, count: int) -> Array:
        """Loads at multiples of a step that all times are: (count, loads)."""
        at, times = np.arange(count), np.array([nearest(time / step) for time in self.times])
        values = np.array([[nearest(value) for value in row] for row in self.samples])
        after = np.maximum(at - times[-1], 0.0)
        slopes = [nearest(slope * step) for slope in self.slopes]
        return np.stack([np.interp(at, times, v) + b * after for v, b in zip(values.T, slopes, strict=True)], axis=1)

    def spacing(self, until: fmpq, sampled: fmpq | None = None) -> fmpq:
        """The step of a stream: `sampled`, where all times but the first lie so far apart, or their common measure."""
        lengths, kind = self.distinct
        gaps = [lengths[k] for k in set(kind if self.times[1:] and any(self.samples[1]) else kind[1:])]
        if not gaps:
            return sampled or until / _STEPS_OF_ONE
        common = common_measure(gaps)
        return sampled if sampled and (common / sampled).q == 1 else common


def linear_loads(
    loads: Sequence[AppliedLoad],
    sources: Sequence[tuple[str, str]],
    until: fmpq,
    describe: Callable[[AppliedLoad], str],
) -> LinearLoads:
    """Loads j made of unit steps and ramps, whose names are sources[j], as far as they act by `until`.

    UnservedError for a load that jumps; `describe` says in words what that step is.
    """
    place: Mapping[str, int] = {ramp: j for j, (_, ramp) in enumerate(sources)}
    steps = {step for step, _ in sources}
    slope = [fmpq(0)] * len(sources)
    times, samples = [fmpq(0)], [tuple(slope)]
    for load in sorted(loads, key=lambda load: load.time):
        if load.time > until:
            break
        if load.source in steps:
            raise UnservedError(
                f"load: {describe(load)}, and modes support no jump (write a steep ramp, or `start`, one spacing, "
                "of a record; or --stream --step)"
            )
        if load.time != times[-1]:
            after = load.time - times[-1]
            samples.append(tuple(v + b * after for v, b in zip(samples[-1], slope, strict=True)))
            times.append(load.time)
        slope[place[load.source]] += load.weight
    return LinearLoads(tuple(times), tuple(samples), tuple(slope))


_MORE = 1 + 1e-9  # for the roundings of this file
_LONGEST = 1 << 14  # samples of a transform
_FINE = 8  # samples of a transform for each term


@dataclass(frozen=True)
class Roughness:
    """The changes of slope of one load: `kinks` at `times`, in doubles, `steps` times a common measure where there is
    one; `steepest` is its largest slope."""

    times: Array
    kinks: Array
    steps: tuple[int, ...] | None
    steepest: float

    @cached_property
    def in_step(self) -> float:
        """The largest |sum_{k <= n} kinks_k exp(-i w times_k)| for any n and any w, or what is not below it.

        Of a free oscillator without damping it is how far it swings, times w^3.
        """
        plain = float(np.sum(np.abs(self.kinks))) * _MORE
        if self.steps is None or len(self.kinks) < 8:
            return plain
        first = self.steps[0]
        dense = np.zeros(self.steps[-1] - first + 1)
        dense[np.array(self.steps) - first] = self.kinks
        return float(min(plain, _partial(dense) * _MORE))

    def swing(self, rate: float) -> float:
        """The largest |sum_{k <= n} kinks_k exp((i w - r) (tau - times_k))| for any n and w, and any r >= rate."""
        fading = self.fading(rate)
        worth_it = fading > 2 * float(
            np.max(np.abs(self.kinks), initial=0.0)
        )  # a sum in step is half of a kink at least
        return min(fading, 2 * self.in_step) if worth_it else fading

    def fading(self, rate: float) -> float:
        """The largest sum_{k <= n} |kinks_k| exp(-rate (times_n - times_k)) for any n."""
        total, step = np.abs(self.kinks), 1
        while step < len(total):  # so many kinks are summed up
            total[step:] += total[:-step] * self._decay(rate, step)
            step *= 2
        return float(np.max(total, initial=0.0) * _MORE)

    def _decay(self, rate: float, count: int) -> Array | float:
        """What is left of a kink when so many others have followed."""
        return np.asarray(np.exp(-rate * (self.times[count:] - self.times[:-count])))


@dataclass(frozen=True)
class ScaledRoughness(Roughness):
    """That of a load like another one, `unit`, with kinks `factor` times as high, `spacing` apart in place of 1."""

    unit: Roughness
    factor: float
    spacing: float

    @cached_property
    def in_step(self) -> float:
        return self.unit.in_step * self.factor * _MORE if self.kinks.any() else 0.0

    def _decay(self, rate: float, count: int) -> Array | float:
        return float(np.exp(-rate * self.spacing * count * (1 - 1e-12)))  # kinks are equally far apart


def sampled_roughness(samples: Array) -> Roughness:
    """Of a load that is 0 until tau = 0, has these `samples` one unit of tau apart, the first of them 0, and then 0."""
    slopes = np.diff(samples, append=0.0)
    kinks = np.diff(slopes, prepend=0.0, append=0.0)
    rounding = 4 * np.finfo(float).eps * np.abs(samples).max(initial=0.0)
    kinks += np.where(kinks == 0, 0.0, np.copysign(rounding, kinks))
    return Roughness(
        np.arange(float(len(kinks))), kinks, tuple(range(len(kinks))), float(np.abs(slopes).max(initial=0.0)) * _MORE
    )


def scaled_roughness(unit: Roughness, begin: float, spacing: float, factor: float, until: float) -> ScaledRoughness:
    """The same load from `begin` on, `factor` times as high, its samples `spacing` apart; what counts by `until`."""
    by = abs(factor) / spacing * _MORE
    times = begin + spacing * unit.times
    counted = times <= until
    kinks = by * unit.kinks[counted]
    steepest = by * unit.steepest if kinks.any() else 0.0
    return ScaledRoughness(times[counted], kinks, unit.steps, steepest, unit=unit, factor=by, spacing=spacing)


def _partial(terms: Array) -> float:
    """The largest |sum_{k <= n} terms_k z^k| for any n and |z| = 1, or a little more.

    A polynomial in z of degree d is nowhere on the circle larger than 1/cos(pi d/(2 M)) times its largest value at M
    points of equal distance (as |p|^2 is a cosine sum of degree d). Sums that end within a block are those of the
    block's start and of the block alone.
    """
    count = len(terms)
    if count <= 32:
        points = _FINE * count
        turns = np.exp(-2j * np.pi / points * np.outer(np.arange(points), np.arange(count)))
        return float(np.abs(np.cumsum(turns * terms, axis=1)).max() / np.cos(np.pi / (2 * _FINE)))
    length = int(np.sqrt(count)) if count <= 4096 else count // 64
    points = 1 << int(np.ceil(np.log2(_FINE * count)))
    largest, sum_before = 0.0, np.zeros(points, complex)
    at = np.arange(points)
    for start in range(0, count, length):
        block = terms[start : start + length]
        before = float(np.abs(sum_before).max() / np.cos(np.pi * count / (2 * points)))
        largest = max(largest, before + _partial(block))
        sum_before += np.fft.fft(block, points) * np.exp(-2j * np.pi / points * ((at * start) % points))
    return largest


def roughness(loads: LinearLoads) -> Iterator[Roughness]:
    """That of each load."""
    for number in range(len(loads.slopes)):
        times, kinks, slope, steepest = [], [], fmpq(0), fmpq(0)
        for k, time in enumerate(loads.times):
            last = k + 1 == len(loads.times)
            after = (
                loads.slopes[number]
                if last
                else (loads.samples[k + 1][number] - loads.samples[k][number]) / loads.lengths[k]
            )
            if after != slope:
                times.append(time)
                kinks.append(nearest(after - slope))
            slope, steepest = after, max(steepest, abs(after))
        yield Roughness(
            np.array([nearest(time) for time in times]), np.array(kinks), _in_steps(times), nearest(steepest)
        )


def _in_steps(times: list[fmpq]) -> tuple[int, ...] | None:
    """Times as multiples of their common measure (but for where they begin); None where those are too many."""
    if len(times) < 2:
        return None
    since = [time - times[0] for time in times]
    common = common_measure(since)
    return None if since[-1] >= _LONGEST * common else tuple(int(gap / common) for gap in since)
