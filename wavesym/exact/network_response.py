"""Unit responses of any network: each joint's law run for what arrives there, at exact instants, in exact numbers.

Waves are counted as increments are in the tables of named systems: f is sent into the left end of a bar and g into its
right end, each beyond what the bar holds at tau = 0. How many coefficients there will be, and of how many digits, is
told first, by the same walk over the network with counts of powers in the place of coefficients.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache, cached_property
from itertools import product
from math import inf

from flint import fmpq

from wavesym.errors import CostError, UnservedError
from wavesym.exact.fronts import departures, needed, reachable
from wavesym.exact.increments import Increment, add, combined, integrated, trimmed
from wavesym.exact.joint import JointLaw
from wavesym.exact.joint_response import JointResponse, joint_polynomial, joint_response, rates, written
from wavesym.exact.node_rules import joint_rule
from wavesym.exact.table import Function, Part
from wavesym.exact.table_size import Size, mean_bits, refuse_size, response_size
from wavesym.model.loads import Applied
from wavesym.model.network import End, Network, Point
from wavesym.model.probe import Probe

START = "start"
"""The source of what moves at tau = 0."""
POINT = "q"
"""The letter of a point's velocity among wave functions; its number stands for that of a rod."""
MOST_FRONTS = 20_000
MOST_POINTS = 20  # of a joint whose determinant is made
MOST_NAMES = 3  # of one, in a message
Shape = Mapping[fmpq, int]
"""How many powers there are at each rate."""
Timed = Sequence[tuple[fmpq, Increment]]


def function_of(end: End) -> Function:
    """The wave that leaves an end."""
    return Function("fg"[end.side], end.bar + 1)


class RuledNetwork:
    """A network and what its joints answer. UnservedError where one that is asked for has no exact tables."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self._rule = joint_rule()
        self._responses: dict[int, JointResponse] = {}

    # what an output is made of

    def parts(self, probe: Probe) -> tuple[Part, ...]:
        """dU/dx = (g' - f')/speed, dU/dtau = f' + g' + v, each wave as late as it comes from its end."""
        if probe.point is not None:
            return (Part(1, Function(POINT, probe.point), fmpq(0)),)
        bar = self.network.bars[probe.rod - 1]
        over = 1 / bar.speed if probe.quantity == "strain" else fmpq(1)
        right, left = probe.weights
        return (
            Part(right * over, Function("f", probe.rod), probe.place * bar.delay),
            Part(left * over, Function("g", probe.rod), (1 - probe.place) * bar.delay),
        )

    def motion(self, probe: Probe) -> Increment:
        """The part of an output that is not wave: what its bar holds at tau = 0."""
        if probe.point is not None:
            return {}
        bar = self.network.bars[probe.rod - 1]
        held = bar.strain if probe.quantity == "strain" else bar.velocity
        return trimmed({fmpq(0): [held] if probe.order == 0 else [fmpq(0), held]})

    def acting(self, loads: Sequence[Applied]) -> Sequence[Applied]:
        """The loads, and the start where anything moves then."""
        return [Applied(START, fmpq(0), fmpq(1)), *loads] if START in self.sources else loads

    @cached_property
    def sources(self) -> tuple[str, ...]:
        """The start, where not all stays as it is, and the unit loads."""
        units = (load.source for point in self.network.points for load in point.loads)
        return (*([START] if self._moving else []), *units)

    @cached_property
    def _moving(self) -> tuple[int, ...]:
        joints = enumerate(self.network.joints)
        return tuple(number for number, joint in joints if not self.network.at_rest(joint))

    def _begun(self, source: str) -> tuple[int, ...]:
        """The joints at which a source acts."""
        if source == START:
            return self._moving
        points = (number for number, point in enumerate(self.network.points) if _unit(point, source))
        return tuple(sorted({self.network.joint_of[number] for number in points}))

    # what joints answer

    def response(self, number: int) -> JointResponse:
        """What a joint answers. UnservedError, with its polynomial, where that does not split over the rationals."""
        if number not in self._responses:
            self._refuse_contact(number)
            law = self._law(number)
            if (count := len(law.mass)) > MOST_POINTS:
                raise UnservedError(
                    f"system: springs and dashpots hold {count} nodes together ({self.told(number)}), "
                    f"at most {MOST_POINTS} expected for exact tables (pieces and `run` serve it)"
                )
            if rates(law) is None:
                raise UnservedError(
                    f"system: the joint at {self.told(number)} has the polynomial {written(joint_polynomial(law))}, "
                    "one with factors s + g, g rational, expected for exact tables (pieces and `run` serve it)"
                )
            self._responses[number] = joint_response(law)
        return self._responses[number]

    def told(self, number: int) -> str:
        """What a scene calls the points of a joint that are free to move: their names or places, a few of them."""
        free = (*self._law(number).heavy, *self._law(number).light)
        points = [self.network.points[self.network.joints[number].points[k]] for k in sorted(free)]
        names = [point.name or f"x = {point.place}" for point in points]
        return ", ".join(names[:MOST_NAMES]) + (f" and {left} more" if (left := len(names) - MOST_NAMES) > 0 else "")

    def _law(self, number: int) -> JointLaw:
        return JointLaw.of(self.network, self.network.joints[number])

    def _refuse_contact(self, number: int) -> None:
        points = self.network.joints[number].points
        for link in self.network.links:
            if link.contact and link.left in points:
                raise UnservedError(
                    f"system: the contact at {link.place or self.told(number)} opens and closes, a chain without "
                    "contacts expected for exact tables (pieces and `run` serve it)"
                )

    def responses(
        self, source: str, reach: Mapping[Function, fmpq], most: float = inf, asked: str = "output.until"
    ) -> dict[Function, Timed]:
        """The increments that a unit of `source` gives each function until the tau that is wanted of it, with theirs.

        CostError where they would have more than `most` coefficients.
        """
        last = self._last(reach)
        refuse_size(self.size(source, last, asked), asked, most, "fewer parts")
        found: dict[Function, list[tuple[fmpq, Increment]]] = {function: [] for function in reach}

        def answer(number: int, time: fmpq, waves: Mapping[End, Increment]) -> Iterator[tuple[End, Increment]]:
            velocities = self._velocities(number, source if time == 0 else "", waves)
            for point in self.network.joints[number].points:
                watched = Function(POINT, point)
                if watched in reach and point in velocities and time <= reach[watched]:
                    found[watched].append((time, velocities[point]))
            return self._sent(number, source if time == 0 else "", waves, velocities)

        for time, end, wave in departures(self.network, self._in(last, source), answer, last):
            if time <= reach.get(function_of(end), -1):
                found[function_of(end)].append((time, wave))
        return dict(found)

    def _last(self, reach: Mapping[Function, fmpq]) -> dict[int, fmpq]:
        """The joints that matter to functions, and until when."""
        wanted: dict[int, fmpq] = {}
        for function, until in reach.items():
            number = self._joint(function)
            wanted[number] = max(until, wanted.get(number, fmpq(-1)))
        return needed(self.network, wanted)

    def _joint(self, function: Function) -> int:
        if function.function == POINT:
            return self.network.joint_of[function.rod]
        end = End(function.rod - 1, "fg".index(function.function))
        return self.network.joint_of[self.network.point_at(end)]

    def _in(self, last: Mapping[int, fmpq], source: str) -> list[int]:
        return [number for number in self._begun(source) if number in last]

    def _velocities(self, number: int, source: str, waves: Mapping[End, Increment]) -> dict[int, Increment]:
        """How the points of a joint move after `waves` arrived, and what a source did, if any."""
        law, joint = self._law(number), self.network.joints[number]
        forces: dict[int, Increment] = defaultdict(dict)
        pushes: dict[int, fmpq] = {}
        given: dict[int, Increment] = {}
        for end, k in self._placed_ends(number):
            bar = self.network.bars[end.bar]
            factor = self._rule.arrives[1 - end.side] * bar.ratios[end.side] * bar.impedance
            add(forces[k], waves.get(end, {}), factor)
            if source == START:
                add(forces[k], {fmpq(0): [bar.held(1 - end.side)]}, factor)
        for k, point in enumerate(self.network.points[number] for number in joint.points):
            if source == START:
                pushes[k] = law.mass[k] * point.velocity
            unit = {fmpq(0): [point.velocity]} if source == START else _unit(point, source)
            if law.given[k] is not None:
                given[k] = unit
            elif source != START:
                add(forces[k], unit, self._rule.load)
        for k, velocity in given.items():
            for other in (*law.heavy, *law.light):
                add(forces[other], velocity, -law.damping[other][k])
                add(forces[other], integrated(velocity), -law.stiffness[other][k])
        free = {k: trimmed(force) for k, force in forces.items() if law.given[k] is None}
        moved = self.response(number).velocities(free, {k: push for k, push in pushes.items() if k not in given})
        return {joint.points[k]: trimmed(velocity) for k, velocity in {**moved, **given}.items()}

    def _sent(
        self, number: int, source: str, waves: Mapping[End, Increment], velocities: Mapping[int, Increment]
    ) -> Iterator[tuple[End, Increment]]:
        """n q - a, beyond what the bar holds."""
        for end, point in self.network.joints[number].ends:
            bar = self.network.bars[end.bar]
            parts = [(bar.ratios[end.side], velocities.get(point, {})), (fmpq(-1), waves.get(end, {}))]
            if source == START:
                parts.append((fmpq(-1), {fmpq(0): [bar.velocity]}))
            if wave := combined(parts):
                yield end, wave

    # what is told before

    def size(self, source: str, last: Mapping[int, fmpq], asked: str = "output.until") -> Size:
        """How large the response to a source will be. CostError where fronts alone are too many."""
        found: set[fmpq] = set()
        counts: list[int] = []
        for _, _, shape in self._foreseen(source, last, asked):
            counts.append(sum(shape.values()))
            found |= shape.keys()
        return response_size(counts, mean_bits(found))

    def _times(self, source: str, reach: Mapping[Function, fmpq]) -> dict[Function, list[fmpq]]:
        """When fronts leave the ends of bars."""
        found: dict[Function, list[fmpq]] = defaultdict(list)
        for time, end, _ in self._foreseen(source, self._last(reach)):
            found[function_of(end)].append(time)
        return found

    def arrivals(self, probes: Sequence[Probe], loads: Sequence[Applied], until: fmpq) -> int:
        """How many increments all loads but the first of each source bring to outputs, at most."""
        parts = [part for probe in probes for part in self.parts(probe)]
        first: dict[str, fmpq] = {}
        for load in loads:
            first.setdefault(load.source, load.time)
        later = [load for load in loads if first[load.source] < load.time <= until]
        total = 0
        for source in {load.source for load in later}:
            times = self._times(source, {part.function: until - first[source] - part.delay for part in parts})
            for load in later:
                if load.source == source:
                    for part in parts:
                        left = until - load.time - part.delay
                        total += bisect_right(times.get(part.function, ()), left)
        return total

    def nth(self, source: str, count: int) -> dict[Function, fmpq]:
        """When the first `count` fronts have left each end that something leaves at all."""
        begun = {end for number in self._begun(source) for end in self._starts(number, source)}
        waiting = dict.fromkeys(reachable(self.network, begun, self._passes), count)
        found: dict[Function, fmpq] = {}
        for time, end, _ in self._foreseen(source, None, "--intervals"):
            if end in waiting:
                found[function_of(end)] = time
                waiting[end] -= 1
                if not waiting[end]:
                    del waiting[end]
            if not waiting:
                break
        return found

    def _foreseen(
        self, source: str, last: Mapping[int, fmpq] | None, asked: str = "output.until"
    ) -> Iterator[tuple[fmpq, End, Shape]]:
        """The walk of `responses` with the number of powers at each rate for the coefficients."""
        units = (_unit(point, source).get(fmpq(0), ()) for point in self.network.points)
        begun_with = max(1, *map(len, units))

        def answer(number: int, time: fmpq, waves: Mapping[End, Shape]) -> Iterator[tuple[End, Shape]]:
            shape = {fmpq(0): begun_with}
            for wave in waves.values():
                for rate, powers in wave.items():
                    shape[rate] = max(powers, shape.get(rate, 0))
            for pole in self.response(number).poles:
                shape[pole.rate] = shape.get(pole.rate, 0) + len(pole.residues)
            return ((end, shape) for end in self._leaves(number, source if time == 0 else "", waves))

        begun = self._begun(source) if last is None else self._in(last, source)
        for count, front in enumerate(departures(self.network, begun, answer, last), 1):
            if count > MOST_FRONTS:
                fewer = "a shorter horizon" if asked == "output.until" else "fewer intervals"
                raise CostError(
                    f"{asked}: fronts leave the ends of rods more than {MOST_FRONTS} times by tau = "
                    f"{float(front[0]):g}, at most {MOST_FRONTS} expected ({fewer} or fewer parts helps)"
                )
            yield front

    def _leaves(self, number: int, source: str, waves: Iterable[End]) -> set[End]:
        """The ends that something leaves, where waves arrive at some and a source acts, if any."""
        passes = self._passes(number)
        return set(self._starts(number, source) if source else ()).union(*(passes[end] for end in waves))

    @cache  # noqa: B019 - as long as this object
    def _passes(self, number: int) -> Mapping[End, frozenset[End]]:
        """Of what arrives at an end of a joint, which ends get something: none where it is absorbed."""
        law, response, ends = self._law(number), self.response(number), self._placed_ends(number)
        found: dict[End, set[End]] = {end: set() for end, _ in ends}
        for (end, j), (other, i) in product(ends, repeat=2):
            if law.given[j] is not None:
                goes = end == other
            else:
                one, two = self.network.bars[end.bar], self.network.bars[other.bar]
                arrives = self._rule.arrives[1 - end.side] * one.ratios[end.side] * one.impedance
                at_once = two.ratios[other.side] * response.direct.get((i, j), fmpq(0)) * arrives
                goes = (i, j) in response.later or at_once != int(end == other)
            if goes:
                found[end].add(other)
        return {end: frozenset(others) for end, others in found.items()}

    def _starts(self, number: int, source: str) -> set[End]:
        """The ends of a joint into which a source sends something at 0."""
        ends = self._placed_ends(number)
        if source == START:
            return {end for end, _ in ends}
        law, response, points = self._law(number), self.response(number), self.network.joints[number].points
        pushed = {k for k, point in enumerate(points) if _unit(self.network.points[point], source)}
        moved = {k for k in pushed if law.given[k] is not None}
        pushed = (pushed - moved).union(
            other for k in moved for other in range(len(points)) if law.damping[other][k] or law.stiffness[other][k]
        )
        moved |= {i for i, j in response.entries if j in pushed}
        return {end for end, k in ends if k in moved}

    def _placed_ends(self, number: int) -> list[tuple[End, int]]:
        """The ends of bars at a joint, each with the place of its point in the joint."""
        joint = self.network.joints[number]
        return [(end, joint.points.index(point)) for end, point in joint.ends]


def _unit(point: Point, source: str) -> Increment:
    """What a unit of a source does at a point: a force, or its velocity where that is prescribed."""
    total: Increment = {}
    for load in point.loads:
        if load.source == source:
            unit = {fmpq(0): list(load.coefficients)}
            add(total, integrated(unit) if point.motion == "acceleration" else unit)
    return total
