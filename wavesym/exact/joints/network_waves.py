"""The waves of a network: joints moved from breakpoint to breakpoint, in the order in which their stretches start."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from heapq import merge
from itertools import count, repeat

from flint import arb, fmpq, fmpq_poly

from wavesym.exact.joints.enclosure import (
    STILL,
    Enclosure,
    collect,
    round_to_precision,
    shift,
    shorten,
    weighted_sum,
)
from wavesym.exact.joints.joint_law import SWING, JointLaw, forces_on, joint_ends, outgoing_terms, scatter
from wavesym.exact.joints.joint_motion import JointMotion
from wavesym.exact.joints.relaxation import Relaxation
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import End, Joint, Network

# on a stretch that is shorter a few powers are enough
_BRIEF = fmpq(1, 2**64)


@dataclass
class SentWave:
    """The wave sent into a bar from one of its ends, stretch by stretch."""

    starts: list[fmpq] = field(default_factory=list)
    stretches: list[Enclosure] = field(default_factory=list)
    _place: int = 0

    def reader(self) -> SentWave:
        """The same wave with a place of its own, for whoever goes through it beside others."""
        return SentWave(self.starts, self.stretches)

    def locate(self, tau: fmpq) -> tuple[Enclosure, fmpq]:
        """The stretch that tau is in, and how long after its start. (Mostly the one asked for last, or the next.)"""
        starts, place = self.starts, self._place
        if tau < starts[place]:
            place = bisect_right(starts, tau, hi=place) - 1
        elif place + 1 < len(starts) and starts[place + 1] <= tau:
            place = bisect_right(starts, tau, lo=place + 1, hi=min(place + 3, len(starts))) - 1
            if place == self._place + 2:
                place = bisect_right(starts, tau, lo=place) - 1
        self._place = place
        return self.stretches[place], tau - starts[place]

    def stretches_beyond(self, length: fmpq) -> list[Enclosure]:
        """Those that are longer than this, and the last one."""
        parts = zip(self.starts, self.starts[1:], self.stretches, strict=False)
        return [known for start, end, known in parts if end - start > length] + self.stretches[-1:]

    def round_to_precision(self, last: fmpq) -> SentWave:
        """The same at the working precision, up to its `last` instant, without powers that count for nothing."""
        ends = [*self.starts[1:], last]
        return SentWave(
            self.starts,
            [
                round_to_precision(known, end - start)
                for start, end, known in zip(self.starts, ends, self.stretches, strict=True)
            ],
        )


class Waves:
    """What is sent into the bars of a network: at first what they hold; and the velocities that no bar shows.

    `rates` and `accelerations` are their derivatives.
    """

    def __init__(self, network: Network) -> None:
        self.network = network
        self.sent: dict[End, SentWave] = {}
        self.rates: dict[End, SentWave] = {}
        for number, bar in enumerate(network.bars):
            for side in (0, 1):
                held = fmpq_poly([bar.initial_wave(side, fmpq(0)), bar.initial_slope])
                known = Enclosure.from_polynomial(held) if held.length() else STILL
                self.sent[End(number, side)] = SentWave([-bar.delay], [known])
        shown = {network.point_at(end) for end in self.sent if network.bars[end.bar].ratios[end.side] == 1}
        self.velocities = {
            number: SentWave()
            for number, point in enumerate(network.points)
            if number not in shown or point.motion is not None
        }
        self.accelerations: dict[int, SentWave] = {}

    def is_bare(self, end: End, tau: fmpq) -> bool:
        """Whether nothing acts at an end of a bar from an instant on, so that it is not strained."""
        return self.network.is_free(end)

    def arriving(self, number: int, start: fmpq, length: fmpq | None = None) -> list[Enclosure]:
        """What comes to the ends at a joint from an instant on, in the time since then (and for so long)."""
        return self._arriving(self.sent, number, start, length)

    def _arriving(
        self, sent: Mapping[End, SentWave], number: int, start: fmpq, length: fmpq | None = None
    ) -> list[Enclosure]:
        waves = []
        for end, _ in self.network.joints[number].ends:
            known, offset = sent[self.network.opposite_end(end)].locate(start - self.network.bars[end.bar].delay)
            if length is None:
                waves.append(shift(known, offset))
            elif length < _BRIEF:
                waves.append(shift(known, offset, length))
            else:
                waves.append(shorten(shift(known, offset), length))
        return waves


def stretches_in_order(breakpoints: Mapping[int, Sequence[fmpq]]) -> Iterator[tuple[fmpq, int, int, fmpq]]:
    """The stretches of joints between breakpoints, as they start: their starts, joints, places and ends."""
    return merge(*(zip(times, repeat(n), count(), times[1:], strict=False) for n, times in breakpoints.items()))


class NetworkWaves(Waves):
    """The waves of the joints whose breakpoints are given, at the working precision; their `derivatives`, too."""

    def __init__(
        self,
        network: Network,
        breakpoints: Mapping[int, Sequence[fmpq]],
        loads: Sequence[AppliedLoad],
        terms: int,
        *,
        derivatives: bool = False,
    ) -> None:
        super().__init__(network)
        if derivatives:
            self.rates = {end: SentWave(list(wave.starts), [STILL]) for end, wave in self.sent.items()}
            self.accelerations = {point: SentWave() for point in self.velocities}
        self._terms = terms
        self._joints = {number: _MovingJoint(network, network.joints[number], loads) for number in breakpoints}
        for start, number, _, end in stretches_in_order(breakpoints):
            self._move(number, start, end - start)

    def _move(self, number: int, start: fmpq, length: fmpq) -> None:
        joint = self.network.joints[number]
        arriving, moving = self.arriving(number, start), self._joints[number]
        sent = moving.sends(arriving, start, length, self._terms)
        self._keep(self.sent, self.velocities, joint, start, sent, moving.velocities)
        if self.rates:
            arriving_rates = self._arriving(self.rates, number, start)
            rates, accelerations = moving.derivatives(sent, arriving, arriving_rates)
            self._keep(self.rates, self.accelerations, joint, start, rates, accelerations)

    @staticmethod
    def _keep(
        sent: Mapping[End, SentWave],
        points: Mapping[int, SentWave],
        joint: Joint,
        start: fmpq,
        waves: Sequence[Enclosure],
        velocities: Sequence[Enclosure],
    ) -> None:
        """What a joint sends from `start` on, and how the points move that no bar shows."""
        for (end, _), wave in zip(joint.ends, waves, strict=True):
            sent[end].starts.append(start)
            sent[end].stretches.append(wave)
        for point, velocity in zip(joint.points, velocities, strict=True):
            if point in points:
                points[point].starts.append(start)
                points[point].stretches.append(velocity)


class _MovingJoint:
    def __init__(self, network: Network, joint: Joint, loads: Sequence[AppliedLoad]) -> None:
        self._ends = joint_ends(network, joint)
        self._motion = JointMotion(
            JointLaw.assemble(network, joint),
            [arb(network.points[point].velocity) for point in joint.points],
            [arb(0)] * len(joint.points),
        )
        self._loads = [LoadPolynomial(network, point, loads) for point in joint.points]
        law = self._motion.law
        self._scatters = not (law.heavy or law.springs) and len(law.light) == len(joint.points)

    def sends(self, arriving: Sequence[Enclosure], start: fmpq, length: fmpq, terms: int) -> list[Enclosure]:
        """What goes back into the ends on a stretch.

        Where nothing has mass or springs factors are exact, so that an absorbing end sends back exactly 0.
        """
        self._acting = acting = [load.polynomial_from(start) for load in self._loads]
        forces = forces_on(self._ends, arriving, acting)
        if self._scatters:
            moving = scatter(self._motion.law, forces, {})
            self.velocities = [weighted_sum(collect(each)) for each in moving]
        else:
            self.velocities = self._move([weighted_sum(each) for each in forces], acting, length, terms)
            moving = [[(fmpq(1), each)] for each in self.velocities]
        return [
            weighted_sum(collect(outgoing_terms(end, moving[end.place], wave)))
            for end, wave in zip(self._ends, arriving, strict=True)
        ]

    def _move(
        self, forces: Sequence[Enclosure], acting: Sequence[fmpq_poly], length: fmpq, terms: int
    ) -> list[Enclosure]:
        """The velocities of the points; on a stretch that no series bears, without what has decayed before it."""
        motion = self._motion
        if motion.law.longest is None or length <= motion.law.longest:
            return motion.move(forces, acting, length, terms)
        relaxation = next(each for each in reversed(self._relaxations) if each.slow * length <= SWING)
        q, u, missed = motion.relax(relaxation, forces, acting, terms)
        motion.lose(missed)
        return motion.follow(q, u, forces, length)

    @cached_property
    def _relaxations(self) -> tuple[Relaxation, ...]:
        return Relaxation.separate(self._motion.law)

    def derivatives(
        self, sent: Sequence[Enclosure], arriving: Sequence[Enclosure], rates: Sequence[Enclosure]
    ) -> tuple[list[Enclosure], list[Enclosure]]:
        """Those of what was `sent` last, and of the points' velocities, from what arrived and its `rates`.

        A derivative is not told by a polynomial that is near a function: where it is not the function itself, the law
        of the joint has it.
        """
        if all(each.error == 0 for each in (*sent, *self.velocities)):
            return [_derivative(each) for each in sent], [_derivative(each) for each in self.velocities]
        forces = forces_on(self._ends, arriving, self._acting)
        force_rates = forces_on(self._ends, rates, [each.derivative() for each in self._acting])
        moving = self._motion.accelerations(
            [weighted_sum(each) for each in forces],
            [weighted_sum(each) for each in force_rates],
            self.velocities,
            self._acting,
        )
        return [
            weighted_sum([(end.ratio, moving[end.place]), (fmpq(-1), rate)])
            for end, rate in zip(self._ends, rates, strict=True)
        ], moving


def _derivative(known: Enclosure) -> Enclosure:
    """That of a polynomial."""
    exact = known.exact
    return Enclosure(known.polynomial.derivative(), arb(0), None if exact is None else exact.derivative())


class LoadPolynomial:
    """What acts on a point (or prescribes its velocity), as an exact polynomial in the time since some instant."""

    def __init__(self, network: Network, point: int, loads: Sequence[AppliedLoad]) -> None:
        here = network.points[point]
        units = {unit.source: fmpq_poly(list(here.action(unit))) for unit in here.loads}
        self._coming = sorted(
            ((load.time, load.weight * units[load.source]) for load in loads if load.source in units),
            key=lambda x: x[0],
        )
        self._coming.reverse()
        begin = here.velocity if here.motion is not None else fmpq(0)
        self._since, self._total = fmpq(0), fmpq_poly([begin])

    def polynomial_from(self, start: fmpq) -> fmpq_poly:
        """From `start` on; instants come in order."""
        self._total = self._total(fmpq_poly([start - self._since, 1]))
        self._since = start
        while self._coming and self._coming[-1][0] <= start:
            time, polynomial = self._coming.pop()
            self._total += polynomial(fmpq_poly([start - time, 1]))
        return self._total
