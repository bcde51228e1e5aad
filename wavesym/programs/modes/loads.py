"""The loads of a model as functions that are linear between instants, exact."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import gcd, lcm

from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.loads import Applied

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

    def spacing(self, until: fmpq, told: fmpq | None = None) -> fmpq:
        """The step of a stream: `told`, where all times but the first lie so far apart, or their common measure."""
        lengths, kind = self.distinct
        gaps = [lengths[k] for k in set(kind if self.times[1:] and any(self.samples[1]) else kind[1:])]
        if not gaps:
            return told or until / _STEPS_OF_ONE
        over = lcm(*(int(gap.q) for gap in gaps))
        common = fmpq(gcd(*(int(gap * over) for gap in gaps)), over)
        return told if told and (common / told).q == 1 else common


def linear_loads(
    loads: Sequence[Applied], sources: Sequence[tuple[str, str]], until: fmpq, told: Callable[[Applied], str]
) -> LinearLoads:
    """Loads j made of unit steps and ramps, whose names are sources[j], as far as they are felt by `until`.

    UnservedError for a load that jumps; `told` is what is said of that step.
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
                f"load: {told(load)}, no jump expected in modes (a steep ramp in place of a step helps, or "
                "`start`, one spacing, of a record)"
            )
        if load.time != times[-1]:
            after = load.time - times[-1]
            samples.append(tuple(v + b * after for v, b in zip(samples[-1], slope, strict=True)))
            times.append(load.time)
        slope[place[load.source]] += load.weight
    return LinearLoads(tuple(times), tuple(samples), tuple(slope))
