"""Where fronts with a jump of velocity can pass, so that an acceleration would be an impulse.

A front passes a joint with what its law does at once: a point with mass keeps its velocity, C q = s of the others, and
n q - a goes back into an end. Each front is followed alone, to where it first comes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush

from flint import fmpq

from wavesym.derivation.factors import joint_rule
from wavesym.errors import WavesymError
from wavesym.exact.joints.joint_law import JointLaw, exact_sum, joint_ends
from wavesym.mechanics.gauge import Gauge
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import End, Network

_ZERO = fmpq(0)


def refuse_jumps(model: Model, until: fmpq) -> None:
    """WavesymError where an acceleration is read, by then, where a front with a jump of velocity can pass."""
    readings = [(probe, reading) for probe, terms in model.sums.items() for _, reading in terms if reading.order > 0]
    if not readings:
        return
    first = readings[0][0].name
    if model.network.corners:
        raise WavesymError(
            f"output.acceleration: {first} has no mass, and contacts that close make velocities jump (write a "
            "place with mass)"
        )
    fronts = _fronts(model)
    for probe, reading in readings:
        if (found := fronts.first_front(reading)) is not None and found[0] <= until:
            cause = "the chain starts with a jump of velocity" if found[1] is None else model.describe_step(found[1])
            raise WavesymError(
                f"output.acceleration: {probe.name}: a front with a jump of velocity can pass there ({cause}) "
                "(write a place with mass, or loads that do not jump)"
            )


@dataclass(frozen=True)
class _Fronts:
    """When a jump first leaves each end, and each point first jumps; with the load that makes it, None at the start."""

    network: Network
    end_fronts: Mapping[End, tuple[fmpq, AppliedLoad | None]]
    point_fronts: Mapping[int, tuple[fmpq, AppliedLoad | None]]

    def first_front(self, reading: Gauge) -> tuple[fmpq, AppliedLoad | None] | None:
        """When one first passes what is read, if it does."""
        if reading.point is not None:
            return self.point_fronts.get(reading.point)
        if reading.place in (0, 1):
            return self.point_fronts.get(self.network.point_at(End(reading.rod - 1, int(reading.place))))
        delay, coming = self.network.bars[reading.rod - 1].delay, []
        for side, way in ((0, reading.place), (1, 1 - reading.place)):
            if (end := End(reading.rod - 1, side)) in self.end_fronts:
                coming.append((self.end_fronts[end][0] + way * delay, self.end_fronts[end][1]))
        return min(coming, key=lambda each: each[0], default=None)


def _fronts(model: Model) -> _Fronts:
    network = model.network
    answers = [_Answer(network, number) for number in range(len(network.joints))]
    sent: dict[End, tuple[fmpq, AppliedLoad | None]] = {}
    moved: dict[int, tuple[fmpq, AppliedLoad | None]] = {}
    count = 0
    coming: list[tuple[fmpq, int, End, AppliedLoad | None]] = []

    def leave(time: fmpq, cause: AppliedLoad | None, jumps: Mapping[int, fmpq], waves: Mapping[End, fmpq]) -> None:
        nonlocal count
        for point, jump in jumps.items():
            if jump != 0 and (point not in moved or time < moved[point][0]):
                moved[point] = time, cause
        for end, jump in waves.items():
            if jump != 0:
                heappush(coming, (time, count := count + 1, end, cause))

    for answer in answers:
        leave(_ZERO, None, *answer.start())
        for load, acts in answer.loads(model):
            leave(load.time, load, *answer.respond({}, acts))
    while coming:
        time, _, end, cause = heappop(coming)
        if end in sent:
            continue
        sent[end] = time, cause
        there = network.opposite_end(end)
        answer = answers[network.joint_of[network.point_at(there)]]
        leave(time + network.bars[end.bar].delay, cause, *answer.respond({there: fmpq(1)}, {}))
    return _Fronts(network, sent, moved)


class _Answer:
    """What a joint does at once."""

    def __init__(self, network: Network, number: int) -> None:
        self._network, self._joint = network, network.joints[number]
        self._ends = joint_ends(network, self._joint)

    @cached_property
    def _law(self) -> JointLaw:
        return JointLaw.assemble(self._network, self._joint)

    def loads(self, model: Model) -> Iterator[tuple[AppliedLoad, dict[int, fmpq]]]:
        """The first load of each source that jumps here, and what it does to which point."""
        for point in self._joint.points:
            for unit in self._network.points[point].loads:
                here = self._network.points[point]
                jump = here.action(unit)[0]
                if jump != 0 and (here.mass == 0 or here.motion is not None):
                    acting = [load for load in model.loads if load.source == unit.source]
                    if acting:
                        yield min(acting, key=lambda each: each.time), {point: jump}

    def start(self) -> tuple[dict[int, fmpq], dict[End, fmpq]]:
        """The jumps at tau = 0, when all goes on that is held."""
        network, points, bars = self._network, self._network.points, self._network.bars
        if network.at_rest(self._joint):
            return {}, {}
        held = {end: bars[end.bar].initial_wave(1 - end.side, _ZERO) for end, *_ in self._ends}
        kept = {
            point: points[point].velocity
            for point in self._joint.points
            if points[point].mass != 0 or points[point].motion is not None
        }
        moved, sent = self.respond(held, kept)
        return (
            {point: q - points[point].velocity for point, q in moved.items()},
            {
                end: wave - bar.initial_wave(end.side, bar.delay)
                for end, wave in sent.items()
                for bar in [bars[end.bar]]
            },
        )

    def respond(self, waves: Mapping[End, fmpq], acts: Mapping[int, fmpq]) -> tuple[dict[int, fmpq], dict[End, fmpq]]:
        """How points and the waves that are sent jump when waves arrive, and loads jump.

        `acts` has forces on points that are free and have no mass, of the others velocities.
        """
        law, points = self._law, self._joint.points
        forces = [joint_rule().load * acts.get(point, _ZERO) for point in points]
        for each in self._ends:
            forces[each.place] += each.force * waves.get(each.end, _ZERO)
        q = {k: acts.get(point, _ZERO) for k, point in enumerate(points) if k not in law.light}
        q |= law.light_velocities(forces, q, exact_sum)
        sent = {each.end: each.ratio * q[each.place] - waves.get(each.end, _ZERO) for each in self._ends}
        return {point: q[k] for k, point in enumerate(points)}, sent
