"""Contacts as time goes on: the joints of a network, moved one after another in the order in which stretches start.

Joints are moved as in `network_waves`, but breakpoints become known only as time goes on (`course.py`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from heapq import heapify, heappop, heappush
from math import inf

from flint import arb, ctx, fmpq

from wavesym.exact.contacts.branches import Change
from wavesym.exact.contacts.breakaway import Breakaway
from wavesym.exact.contacts.corner import Contact, Corner
from wavesym.exact.contacts.cost import Cost
from wavesym.exact.contacts.course import Course
from wavesym.exact.contacts.friction import Friction
from wavesym.exact.contacts.joint_stretch import MOST_SWING
from wavesym.exact.contacts.spring_corners import Engaging, OneSided, Yielding
from wavesym.exact.contacts.touching_waves import TouchingWaves
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import nearest

# an instant is known this closely, in shortest delays
_WIDTH = fmpq(1, 2**230)
# and joints are moved beyond their last instants by so much: past what comes to them then of such instants
_ECHO = fmpq(1, 2**214)
# what changes its branch some times within so many shortest delays goes on for ever
_MOMENT = fmpq(1, 2**128)
# how much of the working precision is beyond the first of the stretches on which it is left open what a contact does
_SPARE = 128


class Search:
    """The joints of a network until their `last` instants, at the working precision.

    `changes` are those of branches so far, `breakpoints` those to come of each joint. No stretch on which it is left
    open what a contact does is longer than `width`; the `first` of them is as long as some times the `resolution` with
    which instants are found, and what changes its branch often within a `moment` does so for ever. Where it is
    `relaxing`, what decays fast is left out as soon as it is lost among rounding errors.
    UndecidedError where bits do not show what a contact does.
    """

    def __init__(
        self, network: Network, loads: Sequence[AppliedLoad], last: Mapping[int, fmpq], relaxing: bool
    ) -> None:
        shortest = network.shortest
        self.last = {number: until + shortest * _ECHO for number, until in last.items()}
        self.relaxing = relaxing
        self.waves = TouchingWaves(network, self.last, loads)
        self.changes: list[Change] = []
        self.width, self.moment = shortest * _WIDTH, shortest * _MOMENT
        self.first = shortest / fmpq(2) ** (ctx.prec - _SPARE)
        self.resolution = self.first / 4
        self.breakpoints = {number: self._load_times(number, loads) for number in self.last}
        self.cost = Cost(network, loads, self.last)
        # a joint is not moved after its last instant: its last series has to bear what neighbours read of it later
        rates = [joint.law.fastest for joint in self.waves.joints.values()]
        beyond = min([shortest, *(MOST_SWING / rate for rate in rates if rate != 0)])
        self.courses = {number: Course(self, number, beyond, self._corners(number)) for number in self.last}
        self.cost.refuse_many_moves({number: course.shortest for number, course in self.courses.items()})

    @property
    def has_relaxed(self) -> bool:
        """Whether what decays fast has been left out somewhere."""
        return any(joint.has_relaxed for joint in self.waves.joints.values())

    def known_bits(self) -> float:
        """To how many bits waves are known, relative to the largest, where they are known least.

        Stretches do not count that are as short as those on which it may be left open what a contact does.
        """
        stretches = [known for wave in self.waves.sent.values() for known in wave.stretches_beyond(self.width)]
        most = max((abs(known.polynomial[0]).upper() for known in stretches), default=arb(0))
        least = max((known.error for known in stretches), default=arb(0))
        return inf if least == 0 or most == 0 else float((most / least).log_base(2))

    def steps(self) -> Iterator[float]:
        """Joints are moved in order of time: how much of it has passed, as a part of all, after each."""
        until = max(self.last.values())
        coming = [(fmpq(0), number) for number in self.courses]
        while coming:
            time, number = heappop(coming)
            course = self.courses[number]
            if time <= course.last:
                course.advance()
                yield nearest(time / until) if until else 1.0
                heappush(coming, (course.reach, number))

    def _load_times(self, number: int, loads: Sequence[AppliedLoad]) -> list[fmpq]:
        """When loads begin or bend at a joint, as a heap."""
        points = self.waves.network.points
        sources = {unit.source for k in self.waves.network.joints[number].points for unit in points[k].loads}
        found = [load.time for load in loads if load.source in sources and 0 < load.time <= self.last[number]]
        heapify(found)
        return found

    def _corners(self, number: int) -> list[Corner]:
        """What has corners in a joint, at the start."""
        joint = self.waves.joints[number]
        return [self._corner(number, n) for n in (*joint.touches, *joint.springs.of_link)]

    def _corner(self, number: int, n: int) -> Corner:
        joint, points = self.waves.joints[number], self.waves.network.points
        link = self.waves.network.links[n]
        if link.is_spring_with_corner:
            spring = joint.springs.of_link[n]
            if spring.dashpot != 0:
                return Engaging.begin_damped(n, spring, joint.slowing(n))
            return OneSided.begin(n, spring) if link.side else Yielding.begin(n, spring)
        if link.friction == 0:
            return Contact.begin(n, link.gap)
        rate = joint.rate_on_motion(n, fmpq(0))
        if rate is None:
            rate = arb(points[link.right].velocity - link.ratio * points[link.left].velocity)
        if link.breakaway != 0:
            return Breakaway.begin(n, (link.friction, link.breakaway), joint.lightness(n), rate)
        touching = any(each.friction == 0 for each in joint.touches.values())
        return Friction.begin(n, link.friction, joint.is_inert(n), touching, rate)
