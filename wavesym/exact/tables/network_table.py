"""Tables of any network: unit responses, each joint's law run for what arrives there, at exact instants, in fractions.

Waves are counted as increments are in the tables of named systems: f is sent into the left end of a bar and g into its
right end, each beyond what the bar holds at tau = 0. A point's velocity is counted beyond what it is then.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf

from flint import fmpq

from wavesym.derivation.factors import joint_rule
from wavesym.derivation.increments import Increment, add, combine, integrate, trim
from wavesym.derivation.table import Function, Part, Row, table_rows
from wavesym.derivation.table_size import refuse_size
from wavesym.exact.joints.fronts import departures
from wavesym.exact.tables.forecast import Forecast
from wavesym.exact.tables.network_joints import START, NetworkJoints, unit_at
from wavesym.mechanics.gauge import Gauge, readings
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import End, Network
from wavesym.mechanics.probe import Probe

POINT = "q"
"""The letter of a point's velocity among wave functions; its number stands for that of a rod."""
Timed = Sequence[tuple[fmpq, Increment]]
"""Increments with the tau at which they are gained, in order."""


def function_of(end: End) -> Function:
    """The wave that leaves an end."""
    return Function("fg"[end.side], end.bar + 1)


class RuledNetwork:
    """A network and the laws of its joints. UnservedError where one that matters has no exact tables."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.joints = NetworkJoints(network)
        self.forecast = Forecast(self.joints)

    def parts(self, reading: Gauge) -> tuple[Part, ...]:
        """dU/dx = (g' - f')/speed, dU/dtau = f' + g' + v, each wave as late as it comes from its end."""
        if reading.point is not None:
            return (Part(1, Function(POINT, reading.point), fmpq(0)),)
        return tuple(Part(weight, function_of(end), delay) for end, weight, delay in reading.waves(self.network))

    def motion(self, reading: Gauge) -> Increment:
        """The part of what is read that is not wave: what its bar, or the point, holds at tau = 0."""
        if reading.point is not None:
            held = self.network.points[reading.point].velocity
        else:
            bar = self.network.bars[reading.rod - 1]
            held = bar.strain if reading.quantity == "strain" else bar.velocity
        return trim({fmpq(0): {-1: [fmpq(0), held], 0: [held], 1: []}[reading.order]})

    def acting_loads(self, loads: Sequence[AppliedLoad]) -> Sequence[AppliedLoad]:
        """The loads, and the start where anything moves then."""
        return [AppliedLoad(START, fmpq(0), fmpq(1)), *loads] if START in self.joints.sources else loads

    def arrivals(self, probes: Sequence[Probe], loads: Sequence[AppliedLoad], until: fmpq) -> int:
        """How many increments all loads but the first of each source bring to outputs, at most."""
        sums = (readings(self.network, probe) for probe in probes)
        parts = [part for terms in sums for _, one in terms if one.quantity != "load" for part in self.parts(one)]
        first = {load.source: load.time for load in reversed(loads)}
        later = [load for load in loads if first[load.source] < load.time <= until]
        total = 0
        for source in {load.source for load in later}:
            left = until - first[source]
            times = self.forecast.times(source, self._last({part.function: left - part.delay for part in parts}))
            gained = {function_of(end): each for end, each in times.items()}
            for load in later:
                if load.source == source:
                    for part in parts:
                        total += bisect_right(gained.get(part.function, ()), until - load.time - part.delay)
        return total

    def responses(
        self, source: str, reach: Mapping[Function, fmpq], most: float | None = inf, key: str = "output.until"
    ) -> dict[Function, Timed]:
        """The increments that a unit of `source` gives each function until the tau that is wanted of it, with theirs.

        CostError where they would have more than `most` coefficients; None where that is known not to be so.
        """
        last = self._last(reach)
        if most is not None:
            refuse_size(self.forecast.size(source, last, most, key), key, most, "fewer parts")
        found: dict[Function, list[tuple[fmpq, Increment]]] = {function: [] for function in reach}

        def answer(number: int, time: fmpq, waves: Mapping[End, Increment]) -> Iterator[tuple[End, Increment]]:
            acts = source if time == 0 else ""
            velocities = self._velocities(number, acts, waves)
            for point in self.network.joints[number].points:
                if time <= reach.get(watched := Function(POINT, point), -1):
                    parts = [(fmpq(1), velocities.get(point, {}))]
                    if acts == START:
                        parts.append((fmpq(-1), {fmpq(0): [self.network.points[point].velocity]}))
                    if gained := combine(parts):
                        found[watched].append((time, gained))
            return self._outgoing_waves(number, acts, waves, velocities)

        starts = [(fmpq(0), number) for number in self.joints.acting_joints(source) if number in last]
        for time, end, wave in departures(self.network, starts, answer, last):
            if time <= reach.get(function := function_of(end), -1):
                found[function].append((time, wave))
        return dict(found)

    def _last(self, reach: Mapping[Function, fmpq]) -> dict[int, fmpq]:
        """The joints that matter to functions, and until when."""
        wanted: dict[int, fmpq] = {}
        for function, until in reach.items():
            number = self._joint(function)
            wanted[number] = max(until, wanted.get(number, fmpq(-1)))
        # backwards in time from there
        cone = self.network.first_times(((-time, number) for number, time in wanted.items()), fmpq(0))
        return {number: -time for number, time in cone.items()}

    def _joint(self, function: Function) -> int:
        if function.function == POINT:
            return self.network.joint_of[function.rod]
        end = End(function.rod - 1, "fg".index(function.function))
        return self.network.joint_of[self.network.point_at(end)]

    def _velocities(self, number: int, source: str, waves: Mapping[End, Increment]) -> dict[int, Increment]:
        """How the points of a joint move after `waves` arrived, and what a source did, if any."""
        law, joint = self.joints.law(number), self.network.joints[number]
        forces: dict[int, Increment] = defaultdict(dict)
        pushes: dict[int, fmpq] = {}
        given: dict[int, Increment] = {}
        for end, k, _, factor in self.joints.ends(number):
            add(forces[k], waves.get(end, {}), factor)
            if source == START:
                add(forces[k], {fmpq(0): [self.network.bars[end.bar].initial_wave(1 - end.side)]}, factor)
        for k, point in enumerate(self.network.points[number] for number in joint.points):
            unit = {fmpq(0): [point.velocity]} if source == START else unit_at(point, source)
            if law.motions[k] is not None:
                given[k] = unit
            elif source == START:
                pushes[k] = law.mass[k] * point.velocity
            else:
                add(forces[k], unit, joint_rule().load)
        for k, velocity in given.items():
            for other in (*law.heavy, *law.light):
                add(forces[other], velocity, -law.damping[other][k])
                add(forces[other], integrate(velocity), -law.stiffness[other][k])
        free = {k: trim(force) for k, force in forces.items() if law.motions[k] is None}
        moved = self.joints.response(number).velocities(free, pushes)
        return {joint.points[k]: trim(velocity) for k, velocity in {**moved, **given}.items()}

    def _outgoing_waves(
        self, number: int, source: str, waves: Mapping[End, Increment], velocities: Mapping[int, Increment]
    ) -> Iterator[tuple[End, Increment]]:
        """n q - a, beyond what the bar holds."""
        for end, point in self.network.joints[number].ends:
            bar = self.network.bars[end.bar]
            parts = [(bar.ratios[end.side], velocities.get(point, {})), (fmpq(-1), waves.get(end, {}))]
            if source == START:
                parts.append((fmpq(-1), {fmpq(0): [bar.velocity]}))
            if wave := combine(parts):
                yield end, wave


@dataclass(frozen=True)
class NetworkTable:
    """Increments of functions, per source: `responses[source][function]` are pairs of a tau and what is gained then."""

    network: Network
    responses: Mapping[str, Mapping[Function, Timed]]

    def rod(self, function: Function) -> int | str:
        """The name of a function's rod, or its number."""
        return self.network.bars[function.rod - 1].name or function.rod

    def rows(self) -> Iterator[Row]:
        """Every coefficient that is not 0, in the order function, rod, source, interval, rate, power."""
        return table_rows(self.responses, self.rod)


def network_table(network: Network, intervals: int | None, until: fmpq, most: float = inf) -> NetworkTable:
    """All waves of all rods, all sources: the first `intervals` of each, or those that leave their ends until `until`.

    UnservedError where a joint's polynomial does not split over the rationals; CostError beyond about `most`
    coefficients, or what half a minute makes.
    """
    ruled = RuledNetwork(network)
    for number in range(len(network.joints)):
        ruled.joints.response(number)
    every = [Function(letter, rod) for letter in "fg" for rod in range(1, len(network.bars) + 1)]
    responses = {}
    asked = "output.until" if intervals is None else "--intervals"
    for source in ruled.joints.sources:
        reach = dict.fromkeys(every, until)
        if intervals is not None:
            reach = {function_of(end): time for end, time in ruled.forecast.nth(source, intervals).items()}
        responses[source] = ruled.responses(source, reach, most, asked)
    return NetworkTable(network, responses)
