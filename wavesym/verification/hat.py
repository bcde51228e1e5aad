"""Records of any spacing by the march: its response to one hat load, added up at the samples.

A load that is linear between samples at k d, k = 0, 1, ..., is a sum of hats, each as high as a sample: 0 at (k - 1) d,
1 at k d, 0 at (k + 1) d. A hat bends at three times, so that its march has three panels at most, whatever d is. At the
samples the sum is a convolution. (Hats, not ramps: the second difference of a ramp's response loses its digits.)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from wavesym.errors import CostError, UnservedError
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest, not_below
from wavesym.programs.making import make
from wavesym.programs.request import Request

Values = NDArray[np.float64]

_ROUNDOFF = 2.0**-53
_MOST = 100_000  # samples


@dataclass(frozen=True)
class Sampled:
    """Outputs at the samples `taus` (samples,): `values` (outputs, samples), wrong by `allowed` (outputs,) at most."""

    taus: Values
    values: Values
    allowed: Values


def at_samples(model: Model) -> Sampled:
    """The outputs of a model at all samples of its loads up to the horizon.

    UnservedError for loads that jump after tau = 0, or do not change; ToleranceError, CostError of the march, or for
    too many samples.
    """
    spacing = reduce(fmpq.gcd, (load.time for load in model.loads), fmpq(0))
    if spacing == 0:
        raise UnservedError("load: no load that changes after tau = 0 given, samples or a record expected")
    count = int((model.until / spacing).floor()) + 1
    if count > _MOST:
        raise CostError(
            f"load: on the horizon there are {count} samples at a spacing of {nearest(spacing):g}, at most {_MOST} "
            "expected (a shorter horizon helps)"
        )
    taus = np.array([min(not_below(k * spacing), model.horizon()) for k in range(count)])
    values, allowed = np.zeros((len(model.probes), count)), np.zeros(len(model.probes))
    for (step, ramp), samples in _sampled(model, spacing, count).items():
        first = (
            Applied(step, fmpq(0), fmpq(1)),
            Applied(ramp, fmpq(0), -1 / spacing),
            Applied(ramp, spacing, 1 / spacing),
        )
        hat = tuple(Applied(ramp, k * spacing, weight / spacing) for k, weight in enumerate(map(fmpq, (1, -2, 1))))
        for loads, heights in ((first, samples[:1]), (hat, samples[1:])):
            if np.any(heights):
                program = make(replace(model, loads=loads), Request(evaluator="march"))
                response = program.evaluate(taus)
                values += _convolved(response, heights)[:, :count]
                wrong = np.array([output.bound * output.largest for output in program.outputs])
                sizes = np.linalg.norm(response, axis=1) * np.linalg.norm(heights)
                allowed += wrong * np.sum(np.abs(heights)) + 8 * np.log2(2 * count) * _ROUNDOFF * sizes
    return Sampled(taus, values, allowed)


def _sampled(model: Model, spacing: fmpq, count: int) -> Mapping[tuple[str, str], Values]:
    """The samples of each load, by the names of its unit step and ramp."""
    samples = {}
    pairs = tuple(_pairs(model))
    for other in {load.source for load in model.loads}.difference(*pairs):
        raise UnservedError(f"load: {other} given, which has no ramp, a load that is linear between samples expected")
    for step, ramp in pairs:
        slope, value = fmpq(0), fmpq(0)
        changes = {load.time: load.weight for load in model.loads if load.source == ramp}
        for load in model.loads:
            if load.source == step:
                value += load.weight
                if load.time != 0:
                    raise UnservedError(
                        f"load: {step} jumps at tau = {load.time}, a load that is linear between samples expected"
                    )
        heights = []
        for k in range(count):
            heights.append(nearest(value))
            slope += changes.get(k * spacing, 0)
            value += slope * spacing
        samples[step, ramp] = np.array(heights)
    return samples


def _pairs(model: Model) -> Iterator[tuple[str, str]]:
    """The names of a unit step and its ramp, for each load that acts."""
    acting = {load.source for load in model.loads}
    for point in model.network.points:
        by_powers = sorted(point.loads, key=lambda load: len(load.coefficients))
        for step, ramp in zip(by_powers[::2], by_powers[1::2], strict=False):
            if acting & {step.source, ramp.source}:
                yield step.source, ramp.source


def _convolved(response: Values, heights: Values) -> Values:
    """sum_k heights[k] response[:, n - k]: shape (outputs, n)."""
    size = response.shape[1] + len(heights) - 1
    return np.fft.irfft(np.fft.rfft(response, size) * np.fft.rfft(heights, size), size)
