"""How much a load that is linear between instants can excite an oscillator of high frequency."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import gcd, lcm

import numpy as np
from flint import fmpq

from wavesym.numbers.doubles import nearest
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.modal import Numbers

_MORE = 1 + 1e-9  # for the roundings of this file
_LONGEST = 1 << 14  # samples of a transform
_FINE = 8  # samples of a transform for each term


@dataclass(frozen=True)
class Roughness:
    """The changes of slope of one load: `kinks` at `times`, in doubles, `steps` times a common measure where there is
    one; `steepest` is its largest slope."""

    times: Numbers
    kinks: Numbers
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
            earlier = total[:-step] * np.exp(-rate * (self.times[step:] - self.times[:-step]))
            total = np.append(total[:step], total[step:] + earlier)
            step *= 2
        return float(np.max(total, initial=0.0) * _MORE)


@dataclass(frozen=True)
class ScaledRoughness(Roughness):
    """That of a load that is `by` times another one in as many times as long steps: what both share is found once."""

    unit: Roughness
    by: float
    apart: float

    @cached_property
    def in_step(self) -> float:
        return self.unit.in_step * self.by * _MORE if self.kinks.any() else 0.0

    def fading(self, rate: float) -> float:
        """As of any load; here kinks are equally far apart."""
        total, step, apart = np.abs(self.kinks), 1, self.apart
        while step < len(total):
            earlier = total[:-step] * np.exp(-rate * apart * step * (1 - 1e-12))
            total[step:] += earlier
            step *= 2
        return float(np.max(total, initial=0.0) * _MORE)


def of_samples(samples: Numbers) -> Roughness:
    """Of a load that is 0 until tau = 0, has these `samples` one unit of tau apart, the first of them 0, and then 0."""
    slopes = np.diff(samples, append=0.0)
    kinks = np.diff(slopes, prepend=0.0, append=0.0)
    rounding = 4 * np.finfo(float).eps * np.abs(samples).max(initial=0.0)
    kinks += np.where(kinks == 0, 0.0, np.copysign(rounding, kinks))
    return Roughness(
        np.arange(float(len(kinks))), kinks, tuple(range(len(kinks))), float(np.abs(slopes).max(initial=0.0)) * _MORE
    )


def scaled(unit: Roughness, begin: float, spacing: float, factor: float, until: float) -> ScaledRoughness:
    """The same load from `begin` on, `factor` times as high, its samples `spacing` apart; what is felt by `until`."""
    by = abs(factor) / spacing * _MORE
    times = begin + spacing * unit.times
    felt = times <= until
    kinks = by * unit.kinks[felt]
    steepest = by * unit.steepest if kinks.any() else 0.0
    return ScaledRoughness(times[felt], kinks, unit.steps, steepest, unit=unit, by=by, apart=spacing)


def _partial(terms: Numbers) -> float:
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
    over = lcm(*{int(gap.q) for gap in since})
    if int(since[-1] * over) >= _LONGEST * (common := gcd(*(int(gap * over) for gap in since))):
        return None
    return tuple(int(gap * over) // common for gap in since)
