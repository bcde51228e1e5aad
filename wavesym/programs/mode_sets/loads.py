"""The loads of a model with modes by samples: each amplitude that may have a factor of its own is a column."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from flint import fmpq

from wavesym.errors import CostError
from wavesym.mechanics.loads import AppliedLoad, AppliedRecord
from wavesym.numbers.doubles import nearest
from wavesym.programs.mode_sets.parameters import ModeParameters
from wavesym.programs.modes.loads import Numbers, Roughness, linear_loads, sampled_roughness

_FEWEST_SAMPLES, _MOST_SAMPLES = 500, 1 << 20


@dataclass(frozen=True)
class SampledAmplitudes:
    """`samples` (n, amplitudes), the first of them 0 at tau = 0, `step` apart; of each which of the drivers `loads` it
    is of, and its roughness, of samples that are 1 apart."""

    step: fmpq
    samples: Numbers
    loads: tuple[int, ...]
    rough: tuple[Roughness, ...]


def sampled_amplitudes(parameters: ModeParameters, *, streamed: bool = False) -> SampledAmplitudes:
    """Those of a model up to its horizon: as a stream takes them, or so often that extremes are seen.

    CostError where they are too many.
    """
    like, model = parameters.like, parameters.model
    step = like.loads.spacing(model.until, model.spacing)
    step /= 1 if streamed else ceil(nearest(_FEWEST_SAMPLES * step / model.until))
    count = ceil(model.horizon() / nearest(step)) + 2
    if count > _MOST_SAMPLES:
        raise CostError(
            f"load: {count} samples, {nearest(step):g} apart in tau, the limit is {_MOST_SAMPLES} (times with a larger "
            "common measure, or a shorter horizon, help)"
        )
    every: Sequence[AppliedLoad] = parameters.amplitudes or [
        AppliedRecord(pair[1] or pair[0], fmpq(0), fmpq(1), tuple(x for x in model.loads if x.source in pair))
        for pair in like.sources
    ]
    samples, loads = np.zeros((count, len(every))), []
    for column, amplitude in zip(samples.T, every, strict=True):
        acting = linear_loads(amplitude.changes, like.sources, like.model.until, like.model.describe_step)
        loads.append(next(j for j, pair in enumerate(like.sources) if amplitude.source in pair))
        column[:] = acting.sample(step, count)[:, loads[-1]]
    return SampledAmplitudes(step, samples, tuple(loads), tuple(map(sampled_roughness, samples.T)))
