"""Contacts as time goes on: joints are moved one after another, and what ends a branch of a contact cuts the stretch.

Joints are moved as in `network_waves`, but breakpoints become known only as time goes on: a joint is moved no further
than to the next one that is known, nor further than the shortest delay beside it reaches. As nobody has read beyond
that, a contact that opens or closes on the way cuts the stretch there. `docs/contacts.md` has the argument.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import product
from math import inf

from flint import arb, ctx, fmpq

from wavesym.exact.contacts.branches import Branch, Contact, Corner, Friction
from wavesym.exact.contacts.breakaway import Breakaway
from wavesym.exact.contacts.cluster import Closed, Sliding, subsets
from wavesym.exact.contacts.cost import Cost
from wavesym.exact.contacts.course import Course, Doubt
from wavesym.exact.contacts.engaging import Engaging
from wavesym.exact.contacts.guards import BranchEnd
from wavesym.exact.contacts.joint_stretch import MOST_SWING, JointStretch, SwingError, sliding_sign
from wavesym.exact.contacts.spring_branches import OneSided, Yielding
from wavesym.exact.contacts.touching_waves import Stage, TouchingWaves
from wavesym.exact.joints.enclosure import Enclosure
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import nearest

# an instant is known this closely, in shortest delays
_WIDTH = fmpq(1, 2**230)
# and joints are moved beyond their last instants by so much: past what comes to them then of such instants
_ECHO = fmpq(1, 2**214)
# what changes its branch so often within so many shortest delays goes on for ever
CHATTER, _MOMENT = 8, fmpq(1, 2**128)
# bits with which instants are had
_INSTANT_BITS = 320
# how much longer each next stretch is on which it is left open what a contact does, in bits
_LONGER = 3
# and after those that are so many times the first: what leaves rest is as fast as their square
_LONGEST, _MANY = 12, 1 << 24
# how much of the working precision is beyond the first of these stretches
_SPARE = 128


@dataclass(frozen=True)
class Change:
    """A corner (the number of its link) goes from one branch to another one between two instants, or at one."""

    link: int
    before: Branch
    after: Branch
    low: fmpq
    high: fmpq

    @property
    def closes(self) -> bool:
        """Whether it is closed then: touches, sticks, acts, holds."""
        return self.after.closed

    @property
    def instant(self) -> arb:
        """The ball between these, to as many digits as are had."""
        with ctx.workprec(_INSTANT_BITS):
            return arb(self.low) if self.low == self.high else arb(self.low).union(arb(self.high))


class UndecidedError(Exception):
    """A contact whose branch so many bits do not show; or one that `chatters`, as no number of bits would show."""

    def __init__(self, link: int, closed: bool, tau: fmpq, chatters: bool = False) -> None:
        super().__init__()
        self.link, self.closed, self.tau, self.chatters = link, closed, tau, chatters


class Search:
    """The joints of a network until their `last` instants, at the working precision.

    `changes` are those of branches so far. No stretch on which it is left open what a contact does is longer than
    `width`. Where it is `relaxing`, what decays fast is left out as soon as it is lost among rounding errors.
    UndecidedError where bits do not show what a contact does.
    """

    def __init__(
        self, network: Network, loads: Sequence[AppliedLoad], last: Mapping[int, fmpq], relaxing: bool
    ) -> None:
        shortest = network.shortest
        last = {number: until + shortest * _ECHO for number, until in last.items()}
        self.waves = TouchingWaves(network, last, loads)
        self.changes: list[Change] = []
        self.width = shortest * _WIDTH
        self._moment = shortest * _MOMENT
        self._lately: dict[int, deque[fmpq]] = {}
        self._network, self._relaxing = network, relaxing
        self._arriving: tuple[tuple[int, fmpq, fmpq], Sequence[Enclosure]] | None = None
        # the first stretch on which it is left open what a contact does
        self._least = shortest / fmpq(2) ** (ctx.prec - _SPARE)
        self._resolution = self._least / 4
        # a joint is not moved after its last instant: its last series has to bear what neighbours read of it later
        rates = [joint.law.fastest for joint in self.waves.joints.values()]
        self._beyond = min([shortest, *(MOST_SWING / rate for rate in rates if rate != 0)])
        self.courses = {number: self._course(number, until, loads) for number, until in last.items()}
        self._cost = Cost(network, loads, last)
        self._cost.refuse_many_moves({number: course.shortest for number, course in self.courses.items()})

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

    def _course(self, number: int, last: fmpq, loads: Sequence[AppliedLoad]) -> Course:
        network, joint = self._network, self._network.joints[number]
        far = [network.bars[end.bar].delay for end, _ in joint.ends]
        moving = self.waves.joints[number]
        contacts = tuple(self._corner(number, n) for n in (*moving.touches, *moving.springs.of_link))
        shortest = min(far, default=last + 1)
        course = Course(number, last, last + self._beyond, shortest, contacts, fmpq(0), fmpq(0))
        sources = {unit.source for point in joint.points for unit in network.points[point].loads}
        for load in loads:
            if load.source in sources and 0 < load.time <= last:
                heappush(course.breakpoints, load.time)
        return course

    def _corner(self, number: int, n: int) -> Corner:
        link, points = self._network.links[n], self._network.points
        if link.is_spring_with_corner:
            spring = self.waves.joints[number].springs.of_link[n]
            if spring.dashpot != 0:
                return Engaging.begin_damped(n, spring, self.waves.joints[number].slowing(n))
            return OneSided.begin(n, spring) if link.side else Yielding.begin(n, spring)
        if link.friction == 0:
            return Contact.begin(n, link.gap)
        joint = self.waves.joints[number]
        rate = arb(points[link.right].velocity - link.ratio * points[link.left].velocity)
        on_motion = joint.rate_on_motion(n, fmpq(0))
        rate = rate if on_motion is None else on_motion
        if link.breakaway != 0:
            return Breakaway.begin(n, (link.friction, link.breakaway), joint.forces.lightness(n), rate)
        touching = any(each.friction == 0 for each in joint.touches.values())
        return Friction.begin(n, link.friction, joint.is_inert(n), touching, rate)

    def steps(self) -> Iterator[float]:
        """Joints are moved in order of time: how much of it has passed, as a part of all, after each."""
        until = max(course.last for course in self.courses.values())
        coming = [(fmpq(0), number) for number in self.courses]
        while coming:
            time, number = heappop(coming)
            course = self.courses[number]
            if time <= course.last:
                self._advance(course, time)
                yield nearest(time / until) if until else 1.0
                heappush(coming, (course.reach, number))

    def _advance(self, course: Course, time: fmpq) -> None:
        """From where a joint's motion is known up to the next limit, or to where a contact may change."""
        self._arriving = None
        breakpoint, limit = course.pass_breakpoints(time), course.limit(time)
        if course.stretch is not None:
            if not breakpoint and self._extend(course, time, limit):
                return
            self._take(course, course.stretch)
            course.stretch = None
        self._begin(course, time, limit)

    def _extend(self, course: Course, time: fmpq, limit: fmpq) -> bool:
        """Go on with a stretch beyond `time`, unless its series would have to bear too much."""
        assert course.stretch is not None
        since, known = course.start, time - course.start
        if course.stretch.swing * (limit - since) > MOST_SWING:
            return False
        moved = self._move(
            course, since, limit - since, course.stretch.closed_links, course.stretch.sliding, trial=True
        )
        if moved.length <= known:
            return False
        trial = moved.length
        moved, end = self._cut(course, since, moved, known)
        if end is None and (moved.length <= known or moved.length < trial):
            return False
        self._keep(course, moved, end)
        return True

    def _move(
        self, course: Course, start: fmpq, length: fmpq, closed: Closed, sliding: Sliding, *, trial: bool = False
    ) -> JointStretch:
        """On a stretch, or on as much of it as a series bears; as a `trial`, if all stay on these branches so long."""
        joint = self.waves.joints[course.number]
        try:
            arriving = self._arrive(course.number, start, length)
            return joint.move(arriving, start, length, closed, sliding=sliding, relaxing=self._relaxing, trial=trial)
        except SwingError as error:
            return self._move(course, start, error.longest, closed, sliding, trial=trial)

    def _arrive(self, number: int, start: fmpq, length: fmpq) -> Sequence[Enclosure]:
        """What comes to a joint on a stretch; the last is kept, as many choices are tried on one."""
        key = (number, start, length)
        if self._arriving is None or self._arriving[0] != key:
            self._arriving = (key, self.waves.arriving(number, start, length))
        return self._arriving[1]

    def _cut(
        self, course: Course, start: fmpq, moved: JointStretch, low: fmpq
    ) -> tuple[JointStretch, BranchEnd | None]:
        """As much of a stretch as all contacts are certainly on their branches, as they are up to `low`."""
        end = self._end(course, moved, low)
        if end is not None and end.length == 0:
            return moved, end
        if end is None and not self.waves.joints[course.number].springs:
            return moved, None
        length = moved.length if end is None else end.length
        moved = self._move(course, start, length, moved.closed_links, moved.sliding)
        return moved, end if moved.length == length else None

    def _end(self, course: Course, moved: JointStretch, low: fmpq) -> BranchEnd | None:
        """How long all contacts are certainly on their branches; None: all the way."""
        found = (contact.end(moved, low, self._resolution) for contact in course.contacts)
        ends = [end for end in found if end is not None]
        if not ends:
            return None
        first = min(ends, key=lambda end: end.length)
        if first.spread is not None:  # an instant with a short denominator
            grid = self._resolution / 4
            aligned = ((course.start + first.length) / grid).floor() * grid - course.start
            if aligned > low:
                return BranchEnd(fmpq(aligned), max(end.spread or first.spread for end in ends))
        return first

    def _begin(self, course: Course, start: fmpq, limit: fmpq) -> None:
        """A new stretch: what is closed on it? Until that is certain, it is left open, a little longer each time."""
        self._meet_jumps(course, start)
        begun = self._decide(course, start, limit) if course.spread is None else None
        if begun is None and not self.waves.joints[course.number].touches:
            raise UndecidedError(course.contacts[0].link, course.contacts[0].closed, start)
        if begun is None:
            course.reach = self._drift(course, start, limit, course.spread or fmpq(0))
            course.spread = None
            return
        moved, end = begun
        for contact in course.contacts:
            before = contact.branch
            contact.take(moved)
            if contact.branch != before and (start > 0 or not contact.branch.closed):  # else it does so from the start
                doubt = course.doubt
                late = max(course.late, contact.late)
                low = doubt.low if doubt is not None and doubt.high == start else start - late
                high = start + contact.unseen_time(moved, self._resolution)
                self.changes.append(Change(contact.link, before, contact.branch, low, high))
                lately = self._lately.setdefault(contact.link, deque(maxlen=CHATTER))
                lately.append(start)
                if len(lately) == CHATTER and start - lately[0] <= self._moment:
                    raise UndecidedError(contact.link, contact.closed, start, chatters=True)
        course.start, course.late = start, fmpq(0)
        self._add_stage(course, Stage(start, moved.closed_links, frozenset(), moved.sliding), moved)
        self._keep(course, moved, end)

    def _meet_jumps(self, course: Course, start: fmpq) -> None:
        """Know how fast masses slide on what moves as is given, which may jump."""
        joint = self.waves.joints[course.number]
        for contact in course.contacts:
            if isinstance(contact, Friction | Breakaway):
                rate = joint.rate_on_motion(contact.link, start)
                if rate is not None:
                    contact.meet(rate)

    def _decide(self, course: Course, start: fmpq, limit: fmpq) -> tuple[JointStretch, BranchEnd | None] | None:
        """The motion under the choice of closed contacts that is certainly right just after `start`, and its end."""
        joint = self.waves.joints[course.number]
        for closed, sliding in self._choices(course):
            if not joint.may_join(closed, start):
                continue
            moved = self._move(course, start, limit - start, closed, sliding, trial=True)
            if all(contact.begins(moved) for contact in course.contacts):
                moved, end = self._cut(course, start, moved, fmpq(0))
                if moved.doubts and not all(contact.lasts(moved, moved.length) for contact in course.contacts):
                    return None  # a force that is not known may end another branch
                return (moved, end) if end is None or end.length > 0 else None
        return None

    @staticmethod
    def _choices(course: Course) -> list[tuple[Closed, Sliding]]:
        """What may be closed, and slide: with the fewest changes first, then with as much closed as may be."""
        shut = [contact.link for contact in course.contacts if contact.may_close]
        found = [
            (closed, sliding)
            for closed in sorted(subsets(shut), key=len, reverse=True)
            for sliding in _ways(contact for contact in course.contacts if contact.link not in closed)
        ]
        now = {contact.link: (contact.closed, contact.sign) for contact in course.contacts}
        return sorted(
            found,
            key=lambda choice: sum(
                (link in choice[0], sliding_sign(link, choice[1])) != branch for link, branch in now.items()
            ),
        )

    def _add_stage(self, course: Course, stage: Stage, moved: JointStretch) -> None:
        course.stages.append(stage)
        self._cost.add(course.number, stage.start, moved, len(self.changes))

    def _keep(self, course: Course, moved: JointStretch, end: BranchEnd | None) -> None:
        """A stretch all the way, or up to its `end`, where a contact may change."""
        since = course.start
        if end is None:
            course.stretch, course.reach = moved, since + moved.length
            self._send(course, since, moved)
            return
        if end.length > 0:
            self._send(course, since, moved)
            self._take(course, moved)
        course.stretch, course.reach = None, since + end.length
        course.spread, course.late = end.spread, end.late

    def _take(self, course: Course, moved: JointStretch) -> None:
        """The joint goes to the end of its stretch; gaps become what they are there."""
        self.waves.joints[course.number].take(moved)
        for contact in course.contacts:
            contact.advance(moved, moved.length)

    def _send(self, course: Course, start: fmpq, moved: JointStretch) -> None:
        """What a joint sends is kept; what begins there is a breakpoint at the other ends of its bars."""
        network = self._network
        begun = self.waves.record(course.number, start, moved)
        for (end, _), new in zip(network.joints[course.number].ends, begun, strict=True):
            other = self.courses.get(network.joint_of[network.point_at(network.opposite_end(end))])
            time = start + network.bars[end.bar].delay
            if new and other is not None and time <= other.last:
                heappush(other.breakpoints, time)

    # where it is left open what contacts do

    def _drift(self, course: Course, start: fmpq, limit: fmpq, spread: fmpq) -> fmpq:
        """Over a short stretch, on which it is left open what some contacts do; its end."""
        length = limit - start
        doubt = course.doubt
        if doubt is None or start - doubt.high > 16 * (doubt.high - doubt.low):
            first = max(self._least, 4 * spread)
            doubt = course.doubt = Doubt(start, start, first, first)
        if length > self.width:
            if doubt.next > self.width:
                unclear = (contact for contact in course.contacts if contact.is_unclear)
                worst = next(unclear, course.contacts[0])
                raise UndecidedError(worst.link, worst.closed, start)
            length = min(length, doubt.next)
            doubt.next *= 1 << (_LONGER if doubt.next < _MANY * doubt.first else _LONGEST)
        else:  # what is not known came with a front: it takes about as long again
            doubt.next = max(doubt.next, 4 * length)
        moved = self._move_vague(course, start, length)
        for contact in course.contacts:
            contact.advance(moved, length)
        self._add_stage(course, Stage(start, moved.closed_links, moved.vague, moved.sliding), moved)
        self._send(course, start, moved)
        self.waves.joints[course.number].take(moved)
        doubt.high = start + length
        return doubt.high

    def _move_vague(self, course: Course, start: fmpq, length: fmpq) -> JointStretch:
        """The motion, with all contacts vague that are not certainly open or closed all the time.

        Friction of masses that is not certain to slide all the time is held: that is no further from the truth than
        the energy that is lost by it, where what is vague may have any force. What has come to rest and is certainly
        pulled beyond its limit goes on from rest that way, as it is. What rubs without mass may slide as soon as a mass
        that moves may touch it.
        """
        joint, arriving = self.waves.joints[course.number], self.waves.arriving(course.number, start, length)
        vague = frozenset(contact.link for contact in course.contacts if contact.is_unclear)
        inert = {each.link for each in course.contacts if isinstance(each, Friction) and each.inert}
        held: frozenset[int] = frozenset()
        turned: dict[int, int] = {}
        while True:
            others = [contact for contact in course.contacts if contact.link not in vague | turned.keys()]
            closed = held | frozenset(contact.link for contact in others if contact.is_held)
            light = frozenset(each.link for each in others if isinstance(each, Friction) and not each.inert)
            if closed & light and not joint.may_join(closed | vague, start):
                vague |= closed & light
                continue
            sliding = frozenset((each.link, each.sign) for each in others if each.sign and each.link not in closed)
            moved = joint.move(arriving, start, length, closed, vague, sliding | turned.items())
            turning = {each.link: each.leaving(moved) for each in others if isinstance(each, Friction)}
            if any(turning.values()):
                turned |= {link: sign for link, sign in turning.items() if sign}
                continue
            steady = (contact for contact in course.contacts if contact.link not in vague | turned.keys())
            wrong = frozenset(contact.link for contact in steady if not contact.lasts(moved, length))
            if not wrong:
                return moved
            held |= wrong & inert
            if not wrong & inert:  # what one does while the other slides on, wrongly, says nothing of it
                vague |= wrong


def lasting(changes: Iterable[Change], width: fmpq) -> list[Change]:
    """Join the changes of a link between which its branch was certain for no time, or hardly any, into one.

    Args:
        changes: in order of time.
        width: what counts as close, in tau.

    Returns:
        In order of time; nothing of a link that is back on its branch within `width`.
    """
    kept: dict[int, list[Change]] = {}
    for change in changes:
        of_link = kept.setdefault(change.link, [])
        if of_link and change.low - of_link[-1].high <= width:
            last = of_link.pop()
            change = Change(last.link, last.before, change.after, last.low, change.high)
        if change.before != change.after:
            of_link.append(change)
    return sorted((each for of_link in kept.values() for each in of_link), key=lambda each: (each.low, each.link))


def _ways(contacts: Iterable[Corner]) -> Iterator[Sliding]:
    """How those that are not closed may slide."""
    every = [(contact.link, contact.ways) for contact in contacts]
    for signs in product(*(ways for _, ways in every)):
        yield frozenset((link, sign) for (link, _), sign in zip(every, signs, strict=True) if sign)
