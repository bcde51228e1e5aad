"""An output as one function of tau: the sum of the increments that arrive at its place.

The two wave functions of its rod, all pieces of the loads and the quantity's own factors are merged exactly. What is
left is a list of arrivals: from `time` on, the output contains sum_g exp(-g w) sum_k F[g,k] w**k with w = tau - time.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from flint import fmpq

from wavesym.derivation.increments import Increment, combine, differentiate, integrate
from wavesym.derivation.increments import start as start_of
from wavesym.derivation.table import Function
from wavesym.errors import CostError
from wavesym.exact.joints.jumps import refuse_jumps
from wavesym.exact.tables.network_joints import unit_at
from wavesym.exact.tables.network_table import RuledNetwork
from wavesym.mechanics.gauge import readings
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, Real


@dataclass(frozen=True)
class Arrival:
    """What an output gains at tau = `time`."""

    time: fmpq
    increment: Increment


@dataclass(frozen=True)
class Signal:
    """One output: its arrivals in order of time. An output that is 0 throughout has none."""

    name: str
    arrivals: tuple[Arrival, ...]


def signals(model: Model, most: float = inf, real: Real = DOUBLE) -> tuple[Signal, ...]:
    """The outputs of a model on its horizon in `real` numbers, exact.

    CostError where the tables would have more than `most` numbers.
    """
    model.refuse_damping()
    until = rational(model.horizon(real))
    refuse_jumps(model, until)
    return signals_at(RuledNetwork(model.network), model.probes, model.loads, until, most)


def refuse_many(model: Model, most: float) -> None:
    """CostError where loads would bring increments to the outputs more than about `most` times.

    The first load of each source is not counted: what that costs is known from its table.
    """
    if (arrivals := RuledNetwork(model.network).arrivals(model.probes, model.loads, model.until)) > most:
        raise CostError(
            f"load: {arrivals:.1e} increments would arrive at the outputs, the limit is {most:.1e} (fewer load "
            "times or outputs, or a shorter horizon, help)"
        )


def signals_at(
    ruled: RuledNetwork,
    probes: Sequence[Probe],
    loads: Sequence[AppliedLoad],
    until: fmpq,
    most: float = inf,
) -> tuple[Signal, ...]:
    """The signals at `probes` until tau = `until` under `loads`."""
    read = [readings(ruled.network, probe) for probe in probes]
    loads = ruled.acting_loads(loads)
    parts = {
        reading: () if reading.quantity == "load" else tuple(ruled.parts(reading))
        for terms in read
        for _, reading in terms
    }
    responses = {}
    for source in dict.fromkeys(load.source for load in loads):
        start = min(load.time for load in loads if load.source == source)
        reach: dict[Function, fmpq] = {}
        for part in (part for group in parts.values() for part in group):
            reach[part.function] = max(until - start - part.delay, reach.get(part.function, fmpq(-1)))
        responses[source] = ruled.responses(source, reach, most)
    signals = []
    for probe, terms in zip(probes, read, strict=True):
        gains: dict[int, _Gains] = {order: defaultdict(list) for order in (0, -1, 1)}
        for weight, reading in terms:
            here = gains[reading.order]
            for load in loads:
                for part in parts[reading]:
                    start = load.time + part.delay
                    for time, increment in responses[load.source].get(part.function, ()):
                        if increment and start + time <= until:
                            here[start + time].append((weight * part.factor * load.weight, increment))
                if reading.point is not None and reading.quantity == "load" and load.time <= until:
                    acts = unit_at(ruled.network.points[reading.point], load.source)
                    here[load.time].append((weight * load.weight, acts))
        moving = combine((weight, ruled.motion(reading)) for weight, reading in terms if parts[reading])
        signals.append(_signal(probe, gains, moving, until))
    return tuple(signals)


_Gains = dict[fmpq, list[tuple[fmpq, Increment]]]
"""What is gained at each instant, with factors."""


def _signal(probe: Probe, every: dict[int, _Gains], moving: Increment, until: fmpq) -> Signal:
    """From what an output gains, and what that gains of which it is the integral, or the derivative; by order."""
    gains = every[0]
    for order, change in ((-1, integrate), (1, differentiate)):
        for time, group in every[order].items():
            gains[time].append((fmpq(1), change(combine(group))))
    merged = {time: combine(group) for time, group in sorted(gains.items())}
    if moving:
        merged[fmpq(0)] = combine([(fmpq(1), merged.get(fmpq(0), {})), (fmpq(1), moving)])
    if until in merged and start_of(merged[until]) == 0:
        del merged[until]  # of what begins at the end of the horizon only the first value is seen
    return Signal(probe.name, tuple(Arrival(time, merged[time]) for time in sorted(merged) if merged[time]))
