"""An output as one function of tau: the sum of the increments that arrive at its place.

The two wave functions of its rod, all pieces of the loads and the quantity's own factors are merged exactly. What is
left is a list of arrivals: from `time` on, the output contains sum_g exp(-g w) sum_k F[g,k] w**k with w = tau - time.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from flint import fmpq

from wavesym.errors import CostError
from wavesym.exact.increments import Increment, combined, integrated
from wavesym.exact.increments import start as start_of
from wavesym.exact.table import Function, Rules, unit_response
from wavesym.exact.table_size import refuse_large
from wavesym.model.chain import Chain
from wavesym.model.loads import Applied
from wavesym.model.model import Model
from wavesym.model.probe import Probe
from wavesym.numbers.doubles import nearest, rational
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


class Part(NamedTuple):
    """A wave function in an output: `sign` times its derivative (or the function itself), `delay` later."""

    sign: int
    function: Function
    delay: fmpq


def signals(model: Model, most: float = inf, real: Real = DOUBLE) -> tuple[Signal, ...]:
    """The outputs of a model on its horizon in `real` numbers, exact.

    CostError where the tables would have more than `most` numbers.
    """
    return observed(RuledChain(model.named), model.probes, model.loads, rational(model.horizon(real)), most)


def refuse_many(model: Model, most: float) -> None:
    """CostError where loads would bring increments to the outputs more than about `most` times.

    The first load of each source is not counted: what that costs is known from its table.
    """
    first = {load.source: load.time for load in reversed(model.loads)}
    later = [load.time for load in model.acting(model.until) if first[load.source] < load.time]
    windows = sum(nearest(model.until - time) + 1 for time in later)
    if (arrivals := 2 * len(model.probes) * windows) > most:
        raise CostError(
            f"load: {arrivals:.1e} increments would arrive at the outputs, at most {most:.1e} expected (fewer load "
            "times or outputs, or a shorter horizon, help)"
        )


class RuledChain:
    """A chain and its rules, derived as they are needed."""

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.rules = Rules(chain)


def observed(
    ruled: RuledChain,
    probes: Sequence[Probe],
    loads: Sequence[Applied],
    until: fmpq,
    most: float = inf,
) -> tuple[Signal, ...]:
    """The signals at `probes` until tau = `until` under `loads`."""
    parts = [_parts(ruled.chain, probe) for probe in probes]
    waves = [part for group in parts for part in group]
    responses = {}
    for source in dict.fromkeys(load.source for load in loads):
        start = min(load.time for load in loads if load.source == source)
        wanted: dict[Function, int] = defaultdict(int)
        for part in waves:
            reach = (until - start - part.delay) / ruled.rules.interval
            wanted[part.function] = max(wanted[part.function], int(reach.floor()) + 1)
        refuse_large(ruled.chain, ruled.rules.interval, wanted, [source], "output.until", most)
        responses[source] = unit_response(ruled.rules, source, wanted)
    signals = []
    for probe, group in zip(probes, parts, strict=True):
        gains: dict[fmpq, list[tuple[fmpq, Increment]]] = defaultdict(list)
        for load in loads:
            for part in group:
                start = load.time + part.delay
                increments = responses[load.source].get(part.function, [])
                for time, increment in _arrivals(start, ruled.rules.interval, increments, until):
                    gains[time].append((part.sign * load.weight, increment))
        signals.append(_signal(probe, gains, _motion(ruled.chain, probe), until))
    return tuple(signals)


def _signal(probe: Probe, gains: dict[fmpq, list[tuple[fmpq, Increment]]], moving: Increment, until: fmpq) -> Signal:
    merged = {time: combined(group) for time, group in sorted(gains.items())}
    if probe.order < 0:
        merged = {time: integrated(increment) for time, increment in merged.items()}
    if moving:
        merged[fmpq(0)] = combined([(fmpq(1), merged.get(fmpq(0), {})), (fmpq(1), moving)])
    if until in merged and start_of(merged[until]) == 0:
        del merged[until]  # of what begins at the end of the horizon only the first value is seen
    return Signal(probe.name, tuple(Arrival(time, merged[time]) for time in sorted(merged) if merged[time]))


def _arrivals(
    start: fmpq, interval: int, increments: Iterable[Increment], until: fmpq
) -> Iterator[tuple[fmpq, Increment]]:
    for n, increment in enumerate(increments):
        if increment and start + interval * n <= until:
            yield start + interval * n, increment


def _parts(chain: Chain, probe: Probe) -> tuple[Part, Part]:
    """dU/dx = g' - f', dU/dtau = f' + g' + v, U = f + g + v tau, each on the clocks of (4.2)."""
    rod = chain.rod(probe.rod)
    offset = probe.x - rod.x0
    right, left = probe.weights
    return (
        Part(right, Function("f", probe.rod), rod.tau0 + offset),
        Part(left, Function("g", probe.rod), rod.tau0 - offset),
    )


def _motion(chain: Chain, probe: Probe) -> Increment:
    """The part of an output that is not wave: v, or v tau."""
    v = chain.rod(probe.rod).velocity * fmpq(sum(probe.weights), 2)
    if v == 0:
        return {}
    return {fmpq(0): [v] if probe.order == 0 else [fmpq(0), v]}
