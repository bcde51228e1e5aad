"""An output as one function of tau: the sum of the increments that arrive at its place.

The two wave functions of its rod, all pieces of the loads and the quantity's own factors are merged exactly. What is
left is a list of arrivals: from `time` on, the output contains sum_g exp(-g w) sum_k F[g,k] w**k with w = tau - time.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Protocol

from flint import fmpq

from wavesym.errors import CostError
from wavesym.exact.increments import Increment, combined, integrated
from wavesym.exact.increments import start as start_of
from wavesym.exact.network_response import RuledNetwork
from wavesym.exact.table import Function, Part, Rules, unit_response
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


class Ruled(Protocol):
    """A chain with laws that run."""

    def parts(self, probe: Probe) -> Sequence[Part]:
        """The wave functions that an output is made of."""

    def motion(self, probe: Probe) -> Increment:
        """The part of an output that is not wave."""

    def acting(self, loads: Sequence[Applied]) -> Sequence[Applied]:
        """All that makes waves."""

    def responses(
        self, source: str, reach: Mapping[Function, fmpq], most: float = inf
    ) -> Mapping[Function, Iterable[tuple[fmpq, Increment]]]:
        """What a unit of `source` gives each function on its clock, in order, until the time that is wanted of it."""


def signals(model: Model, most: float = inf, real: Real = DOUBLE) -> tuple[Signal, ...]:
    """The outputs of a model on its horizon in `real` numbers, exact.

    CostError where the tables would have more than `most` numbers.
    """
    return observed(_ruled(model), model.probes, model.loads, rational(model.horizon(real)), most)


def _ruled(model: Model) -> RuledChain | RuledNetwork:
    return RuledNetwork(model.network) if model.chain is None else RuledChain(model.chain)


def refuse_many(model: Model, most: float) -> None:
    """CostError where loads would bring increments to the outputs more than about `most` times.

    The first load of each source is not counted: what that costs is known from its table.
    """
    if (arrivals := _ruled(model).arrivals(model.probes, model.loads, model.until)) > most:
        raise CostError(
            f"load: {arrivals:.1e} increments would arrive at the outputs, at most {most:.1e} expected (fewer load "
            "times or outputs, or a shorter horizon, help)"
        )


class RuledChain:
    """A named chain and its rules, derived as they are needed; functions are on the clocks of Table 1."""

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.rules = Rules(chain)

    def parts(self, probe: Probe) -> tuple[Part, Part]:
        """dU/dx = g' - f', dU/dtau = f' + g' + v, U = f + g + v tau, each on the clocks of (4.2)."""
        rod = self.chain.rod(probe.rod)
        offset = probe.x - rod.x0
        right, left = probe.weights
        return (
            Part(right, Function("f", probe.rod), rod.tau0 + offset),
            Part(left, Function("g", probe.rod), rod.tau0 - offset),
        )

    def motion(self, probe: Probe) -> Increment:
        """The part of an output that is not wave: v, or v tau."""
        v = self.chain.rod(probe.rod).velocity * fmpq(sum(probe.weights), 2)
        if v == 0:
            return {}
        return {fmpq(0): [v] if probe.order == 0 else [fmpq(0), v]}

    def acting(self, loads: Sequence[Applied]) -> Sequence[Applied]:
        """The loads; an impact is one of them."""
        return loads

    def arrivals(self, probes: Sequence[Probe], loads: Sequence[Applied], until: fmpq) -> float:
        """How many increments all loads but the first of each source bring to outputs, at most."""
        first = {load.source: load.time for load in reversed(loads)}
        later = [load.time for load in loads if first[load.source] < load.time <= until]
        return 2 * len(probes) * sum(nearest(until - time) + 1 for time in later)

    def responses(
        self, source: str, reach: Mapping[Function, fmpq], most: float = inf
    ) -> dict[Function, Sequence[tuple[fmpq, Increment]]]:
        """The increments of functions until the time that is wanted of each, with the starts of their intervals."""
        interval = self.rules.interval
        wanted = {function: int((until / interval).floor()) + 1 for function, until in reach.items()}
        refuse_large(self.chain, interval, wanted, [source], "output.until", most)
        response = unit_response(self.rules, source, wanted)
        starts = {function: enumerate(response.get(function, ())) for function in wanted}
        return {function: [(fmpq(interval * n), each) for n, each in found] for function, found in starts.items()}


def observed(
    ruled: Ruled,
    probes: Sequence[Probe],
    loads: Sequence[Applied],
    until: fmpq,
    most: float = inf,
) -> tuple[Signal, ...]:
    """The signals at `probes` until tau = `until` under `loads`."""
    parts = [ruled.parts(probe) for probe in probes]
    loads = ruled.acting(loads)
    responses = {}
    for source in dict.fromkeys(load.source for load in loads):
        start = min(load.time for load in loads if load.source == source)
        reach: dict[Function, fmpq] = {}
        for part in (part for group in parts for part in group):
            reach[part.function] = max(until - start - part.delay, reach.get(part.function, fmpq(-1)))
        responses[source] = ruled.responses(source, reach, most)
    signals = []
    for probe, group in zip(probes, parts, strict=True):
        gains: dict[fmpq, list[tuple[fmpq, Increment]]] = defaultdict(list)
        for load in loads:
            for part in group:
                start = load.time + part.delay
                for time, increment in responses[load.source].get(part.function, ()):
                    if increment and start + time <= until:
                        gains[start + time].append((part.factor * load.weight, increment))
        signals.append(_signal(probe, gains, ruled.motion(probe), until))
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
