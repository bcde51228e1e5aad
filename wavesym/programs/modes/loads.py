"""The loads of a model as functions that are linear between instants, exact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import gcd, lcm

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.loads import Applied
from wavesym.numbers.doubles import nearest

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

    @property
    def largest(self) -> fmpq:
        """The largest absolute value at one of the times."""
        return max((abs(value) for row in self.samples for value in row), default=fmpq(0))

    def spacing(self, until: fmpq, told: fmpq | None = None) -> fmpq:
        """The step of a stream: `told`, where all times but the first lie so far apart, or their common measure."""
        gaps = set(self.lengths if self.times[1:] and any(self.samples[1]) else self.lengths[1:])
        if not gaps:
            return told or until / _STEPS_OF_ONE
        over = lcm(*(int(gap.q) for gap in gaps))
        common = fmpq(gcd(*(int(gap * over) for gap in gaps)), over)
        return told if told and (common / told).q == 1 else common


def linear_loads(loads: Sequence[Applied], sources: Sequence[tuple[str, str]], until: fmpq) -> LinearLoads:
    """Loads j made of unit steps and ramps, whose names are sources[j], as far as they are felt by `until`.

    UnservedError for a load that jumps.
    """
    slopes: list[dict[fmpq, fmpq]] = [{} for _ in sources]
    place: Mapping[str, int] = {ramp: j for j, (_, ramp) in enumerate(sources)}
    steps = {step for step, _ in sources}
    for load in loads:
        if load.time > until:
            continue
        if load.source in steps:
            raise UnservedError(
                f"load: {load.source} jumps by {nearest(load.weight):g} at tau = {nearest(load.time):g}, no jump "
                "expected in modes (a steep ramp in place of a step, or a record that starts a step later, has none)"
            )
        slopes[place[load.source]][load.time] = load.weight
    times = sorted({fmpq(0), *(time for changes in slopes for time in changes)})
    slope = [fmpq(0)] * len(sources)
    value = list(slope)
    samples = []
    for k, time in enumerate(times):
        if k:
            value = [v + b * (time - times[k - 1]) for v, b in zip(value, slope, strict=True)]
        slope = [b + changes.get(time, 0) for b, changes in zip(slope, slopes, strict=True)]
        samples.append(tuple(value))
    return LinearLoads(tuple(times), tuple(samples), tuple(slope))
