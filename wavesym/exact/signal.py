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

from wavesym.exact.increments import Increment, combined, integrated
from wavesym.exact.increments import start as start_of
from wavesym.exact.table import Function, Rules, unit_response
from wavesym.exact.table_size import refuse_large
from wavesym.model.chain import Chain, chain
from wavesym.model.light_cone import rod_of
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.scene import Observable, Piece, Scene


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


def horizon(scene: Scene, real: Real = DOUBLE) -> float:
    """The last tau of a scene in `real` numbers: the smallest of them that is not below `until`."""
    return real.not_below(rational(scene.output.until))


def signals(scene: Scene, most: float = inf, real: Real = DOUBLE) -> tuple[Signal, ...]:
    """The outputs of a scene on its horizon in `real` numbers, exact.

    CostError where the tables would have more than `most` numbers.
    """
    return observed(Modelled(chain(scene)), scene.outputs, scene.pieces, rational(horizon(scene, real)), most)


class Modelled:
    """A chain and its rules, derived as they are needed."""

    def __init__(self, system: Chain) -> None:
        self.chain = system
        self.rules = Rules(system)


def observed(
    model: Modelled,
    outputs: Sequence[Observable],
    pieces: Sequence[Piece],
    until: fmpq,
    most: float = inf,
) -> tuple[Signal, ...]:
    """The signals at `outputs` until tau = `until` under the loads `pieces`."""
    parts = [_parts(model.chain, output) for output in outputs]
    waves = [part for group in parts for part in group]
    responses = {}
    for source in dict.fromkeys(piece.source for piece in pieces):
        start = min(rational(piece.time) for piece in pieces if piece.source == source)
        wanted: dict[Function, int] = defaultdict(int)
        for part in waves:
            reach = (until - start - part.delay) / model.rules.interval
            wanted[part.function] = max(wanted[part.function], int(reach.floor()) + 1)
        refuse_large(model.chain, model.rules.interval, wanted, [source], "output.until", most)
        responses[source] = unit_response(model.rules, source, wanted)
    signals = []
    for output, group in zip(outputs, parts, strict=True):
        gains: dict[fmpq, list[tuple[fmpq, Increment]]] = defaultdict(list)
        for piece in pieces:
            for part in group:
                start = rational(piece.time) + part.delay
                increments = responses[piece.source].get(part.function, [])
                for time, increment in _arrivals(start, model.rules.interval, increments, until):
                    gains[time].append((part.sign * rational(piece.weight), increment))
        signals.append(_signal(output, gains, _motion(model.chain, output), until))
    return tuple(signals)


def _signal(
    output: Observable, gains: dict[fmpq, list[tuple[fmpq, Increment]]], moving: Increment, until: fmpq
) -> Signal:
    displacement = output.quantity == "displacement"
    merged = {time: combined(group) for time, group in sorted(gains.items())}
    if displacement:
        merged = {time: integrated(increment) for time, increment in merged.items()}
    if moving:
        merged[fmpq(0)] = combined([(fmpq(1), merged.get(fmpq(0), {})), (fmpq(1), moving)])
    if until in merged and start_of(merged[until]) == 0:
        del merged[until]  # of what begins at the end of the horizon only the first value is seen
    return Signal(output.name, tuple(Arrival(time, merged[time]) for time in sorted(merged) if merged[time]))


def _arrivals(
    start: fmpq, interval: int, increments: Iterable[Increment], until: fmpq
) -> Iterator[tuple[fmpq, Increment]]:
    for n, increment in enumerate(increments):
        if increment and start + interval * n <= until:
            yield start + interval * n, increment


def _parts(system: Chain, output: Observable) -> tuple[Part, Part]:
    """dU/dx = g' - f', dU/dtau = f' + g' + v, U = f + g + v tau, each on the clocks of (4.2)."""
    number = rod_of(output)
    rod = system.rod(number)
    offset = rational(output.x) - rod.x0
    return (
        Part(-1 if output.quantity == "strain" else 1, Function("f", number), rod.tau0 + offset),
        Part(1, Function("g", number), rod.tau0 - offset),
    )


def _motion(system: Chain, output: Observable) -> Increment:
    """The part of an output that is not wave: v, or v tau."""
    v = fmpq(0) + system.rod(rod_of(output)).velocity
    if v == 0 or output.quantity == "strain":
        return {}
    return {fmpq(0): [v] if output.quantity == "velocity" else [fmpq(0), v]}
