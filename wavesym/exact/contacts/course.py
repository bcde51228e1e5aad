"""A joint on its way: moved stretch by stretch, and what its corners do decided at each breakpoint.

A joint is moved no further than to the next breakpoint that is known, nor further than the shortest delay beside it
reaches. As nobody has read beyond that, a corner that changes its branch on the way cuts the stretch there.
`docs/contacts.md` has the argument.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import product
from typing import TYPE_CHECKING

from flint import fmpq

from wavesym.exact.contacts.branches import Branch, Branches, Change
from wavesym.exact.contacts.breakaway import Breakaway
from wavesym.exact.contacts.cluster import subsets
from wavesym.exact.contacts.corner import Corner
from wavesym.exact.contacts.friction import Friction
from wavesym.exact.contacts.guards import BranchEnd
from wavesym.exact.contacts.joint_stretch import MOST_SWING, JointStretch, SwingError
from wavesym.exact.contacts.touching_waves import Stage
from wavesym.exact.joints.enclosure import Enclosure

if TYPE_CHECKING:
    from wavesym.exact.contacts.search import Search

CHATTER = 8
"""What changes its branch so often within a moment goes on for ever."""
# how much longer each next stretch is on which it is left open what a contact does, in bits
_LONGER = 3
# and after those that are so many times the first: what leaves rest is as fast as their square
_LONGEST, _MANY = 12, 1 << 24


class UndecidedError(Exception):
    """A contact whose branch so many bits do not show; or one that `chatters`, as no number of bits would show."""

    def __init__(self, link: int, closed: bool, tau: fmpq, chatters: bool = False) -> None:
        super().__init__()
        self.link, self.closed, self.tau, self.chatters = link, closed, tau, chatters


@dataclass
class _Doubt:
    """Since when it is not certain what a corner does, until when that was left open; how long next, and at first."""

    low: fmpq
    high: fmpq
    next: fmpq
    first: fmpq


class Course:
    """A joint of a search: its present stretch, which is known from its start to its `reach`, and those before.

    It is moved no further at a time than `shortest`: nobody reads what is sent before; and not beyond its last instant
    by more than so much: until then it is known what comes to it. UndecidedError where bits do not show what it does.
    """

    def __init__(self, search: Search, number: int, beyond: fmpq, corners: Sequence[Corner]) -> None:
        network = search.waves.network
        self.number, self.last, self.reach = number, search.last[number], fmpq(0)
        self.stages: list[Stage] = []
        delays = (network.bars[end.bar].delay for end, _ in network.joints[number].ends)
        self.shortest = min(delays, default=self.last + 1)
        self._search, self._joint, self._corners = search, search.waves.joints[number], corners
        self._breakpoints, self._end = search.breakpoints[number], self.last + beyond
        self._start = fmpq(0)
        self._stretch: JointStretch | None = None
        self._doubt: _Doubt | None = None
        # how far off the end of the last stretch may be, where a corner may change, and how late that may be seen
        self._spread: fmpq | None = None
        self._late = fmpq(0)
        self._lately: dict[int, deque[fmpq]] = {}
        self._arriving: tuple[tuple[fmpq, fmpq], Sequence[Enclosure]] | None = None

    def advance(self) -> None:
        """From where the motion is known up to the next limit, or to where a corner may change."""
        time, self._arriving = self.reach, None
        is_new = self._pass_breakpoints(time)
        limit = min([time + self.shortest, self._end, *self._breakpoints[:1]])
        if self._stretch is not None:
            if not is_new and self._extend(self._stretch, time, limit):
                return
            self._take(self._stretch)
            self._stretch = None
        self._begin(time, limit)

    def _pass_breakpoints(self, time: fmpq) -> bool:
        """Whether there is a breakpoint at an instant; it and all before are done with."""
        found = False
        while self._breakpoints and self._breakpoints[0] <= time:
            found = heappop(self._breakpoints) == time or found
        return found

    def _extend(self, stretch: JointStretch, time: fmpq, limit: fmpq) -> bool:
        """Go on with a stretch beyond `time`, unless its series would have to bear too much."""
        since, known = self._start, time - self._start
        if stretch.swing * (limit - since) > MOST_SWING:
            return False
        tried = self._move(since, limit - since, stretch.branches, trial=True)
        if tried.length <= known:
            return False
        moved, end = self._cut(since, tried, known)
        if end is None and moved.length < tried.length:
            return False
        self._keep(moved, end)
        return True

    def _move(self, start: fmpq, length: fmpq, branches: Branches, *, trial: bool = False) -> JointStretch:
        """On a stretch, or on as much of it as a series bears; as a `trial`, if all stay on these branches so long."""
        try:
            arriving = self._arrive(start, length)
            return self._joint.move(arriving, start, length, branches, relaxing=self._search.relaxing, trial=trial)
        except SwingError as error:
            return self._move(start, error.longest, branches, trial=trial)

    def _arrive(self, start: fmpq, length: fmpq) -> Sequence[Enclosure]:
        """What comes on a stretch; the last is kept, as many choices are tried on one."""
        if self._arriving is None or self._arriving[0] != (start, length):
            self._arriving = ((start, length), self._search.waves.arriving(self.number, start, length))
        return self._arriving[1]

    def _cut(self, start: fmpq, moved: JointStretch, low: fmpq) -> tuple[JointStretch, BranchEnd | None]:
        """As much of a stretch as all corners are certainly on their branches, as they are up to `low`."""
        end = self._branch_end(moved, low)
        if end is None and not self._joint.springs:
            return moved, None
        length = moved.length if end is None else end.length
        if length > 0:
            moved = self._move(start, length, moved.branches)
        return moved, end if length in (0, moved.length) else None

    def _branch_end(self, moved: JointStretch, low: fmpq) -> BranchEnd | None:
        """How long all corners are certainly on their branches; None: all the way."""
        found = (corner.end(moved, low, self._search.resolution) for corner in self._corners)
        ends = [end for end in found if end is not None]
        if not ends:
            return None
        first = min(ends, key=lambda end: end.length)
        if first.spread is not None:  # an instant with a short denominator
            grid = self._search.resolution / 4
            aligned = ((self._start + first.length) / grid).floor() * grid - self._start
            if aligned > low:
                return BranchEnd(fmpq(aligned), max(end.spread or first.spread for end in ends))
        return first

    def _begin(self, start: fmpq, limit: fmpq) -> None:
        """A new stretch: what is closed on it? Until that is certain, it is left open, a little longer each time."""
        for corner in self._corners:  # what moves as is given may jump
            if isinstance(corner, Friction | Breakaway):
                rate = self._joint.rate_on_motion(corner.link, start)
                if rate is not None:
                    corner.meet(rate)
        found = self._decide(start, limit) if self._spread is None else None
        if found is None:
            if not self._joint.touches:
                raise UndecidedError(self._corners[0].link, self._corners[0].now.closed, start)
            self._drift(start, limit)
            return
        moved, end = found
        for corner in self._corners:
            before = corner.branch
            corner.take(moved)
            if corner.branch != before and (start > 0 or not corner.branch.closed):  # else it does so from the start
                self._note_change(corner, before, start, moved)
        self._start, self._late = start, fmpq(0)
        self._add_stage(start, moved)
        self._keep(moved, end)

    def _note_change(self, corner: Corner, before: Branch, start: fmpq, moved: JointStretch) -> None:
        """Note that a corner has left a branch. UndecidedError where it does so for ever."""
        doubt = self._doubt
        low = doubt.low if doubt is not None and doubt.high == start else start - max(self._late, corner.late)
        high = start + corner.unseen_time(moved, self._search.resolution)
        self._search.changes.append(Change(corner.link, before, corner.branch, low, high))
        lately = self._lately.setdefault(corner.link, deque(maxlen=CHATTER))
        lately.append(start)
        if len(lately) == CHATTER and start - lately[0] <= self._search.moment:
            raise UndecidedError(corner.link, corner.now.closed, start, chatters=True)

    def _decide(self, start: fmpq, limit: fmpq) -> tuple[JointStretch, BranchEnd | None] | None:
        """The motion under the choice of branches that is certainly right just after `start`, and its end."""
        for branches in self._choices():
            if not self._joint.may_join(branches.closed_links, start):
                continue
            moved = self._move(start, limit - start, branches, trial=True)
            if all(corner.begins(moved) for corner in self._corners):
                moved, end = self._cut(start, moved, fmpq(0))
                if moved.doubts and not all(corner.lasts(moved) for corner in self._corners):
                    return None  # a force that is not known may end another branch
                return (moved, end) if end is None or end.length > 0 else None
        return None

    def _choices(self) -> list[Branches]:
        """What may be closed, and slide: with the fewest changes first, then with as much closed as may be."""
        found = []
        for closed in sorted(subsets(each.link for each in self._corners if each.may_close), key=len, reverse=True):
            others = [corner for corner in self._corners if corner.link not in closed]
            for signs in product(*(corner.ways for corner in others)):
                sliding = {each.link: sign for each, sign in zip(others, signs, strict=True) if sign}
                found.append(Branches(closed, sliding))
        return sorted(
            found, key=lambda branches: sum(branches.of_link(each.link) != each.now for each in self._corners)
        )

    def _add_stage(self, start: fmpq, moved: JointStretch) -> None:
        self.stages.append(Stage(start, moved.branches))
        self._search.cost.add(self.number, start, moved, len(self._search.changes))

    def _keep(self, moved: JointStretch, end: BranchEnd | None) -> None:
        """A stretch all the way, or up to its `end`, where a corner may change."""
        length = moved.length if end is None else end.length
        self._stretch, self.reach = moved, self._start + length
        if length > 0:
            self._send(self._start, moved)
        if end is not None:
            if length > 0:
                self._take(moved)
            self._stretch, self._spread, self._late = None, end.spread, end.late

    def _take(self, moved: JointStretch) -> None:
        """The joint goes to the end of its stretch; gaps become what they are there."""
        self._joint.take(moved)
        for corner in self._corners:
            corner.advance(moved)

    def _send(self, start: fmpq, moved: JointStretch) -> None:
        """What a joint sends is kept; what begins there is a breakpoint at the other ends of its bars."""
        search, network = self._search, self._search.waves.network
        begun = search.waves.record(self.number, start, moved)
        for (end, _), new in zip(network.joints[self.number].ends, begun, strict=True):
            other = network.joint_of[network.point_at(network.opposite_end(end))]
            time = start + network.bars[end.bar].delay
            if new and other in search.last and time <= search.last[other]:
                heappush(search.breakpoints[other], time)

    # where it is left open what contacts do

    def _drift(self, start: fmpq, limit: fmpq) -> None:
        """Over a short stretch, on which it is left open what some corners do."""
        length, doubt, width = limit - start, self._doubt, self._search.width
        if doubt is None or start - doubt.high > 16 * (doubt.high - doubt.low):
            first = max(self._search.first, 4 * (self._spread or fmpq(0)))
            doubt = self._doubt = _Doubt(start, start, first, first)
        if length > width:
            if doubt.next > width:
                unclear = (corner for corner in self._corners if corner.is_unclear)
                worst = next(unclear, self._corners[0])
                raise UndecidedError(worst.link, worst.now.closed, start)
            length = min(length, doubt.next)
            doubt.next *= 1 << (_LONGER if doubt.next < _MANY * doubt.first else _LONGEST)
        else:  # what is not known came with a front: it takes about as long again
            doubt.next = max(doubt.next, 4 * length)
        moved = self._move_vague(start, length)
        self._add_stage(start, moved)
        self._send(start, moved)
        self._take(moved)
        doubt.high = self.reach = start + length
        self._spread = None

    def _move_vague(self, start: fmpq, length: fmpq) -> JointStretch:
        """The motion, with all contacts vague that are not certainly open or closed all the time.

        Friction of masses that is not certain to slide all the time is held: that is no further from the truth than
        the energy that is lost by it, where what is vague may have any force. What has come to rest and is certainly
        pulled beyond its limit goes on from rest that way, as it is. What rubs without mass may slide as soon as a mass
        that moves may touch it.
        """
        arriving = self._search.waves.arriving(self.number, start, length)
        vague = frozenset(corner.link for corner in self._corners if corner.is_unclear)
        held: frozenset[int] = frozenset()
        turned: dict[int, int] = {}
        while True:
            steady = [corner for corner in self._corners if corner.link not in vague | turned.keys()]
            closed = held | frozenset(corner.link for corner in steady if corner.is_held)
            rubbing = [corner for corner in steady if isinstance(corner, Friction)]
            inert = {each.link for each in rubbing if each.inert}
            light = frozenset(each.link for each in rubbing if not each.inert)
            if closed & light and not self._joint.may_join(closed | vague, start):
                vague |= closed & light
                continue
            sliding = {each.link: each.now.sign for each in steady if each.now.sign and each.link not in closed}
            moved = self._joint.move(arriving, start, length, Branches(closed, sliding | turned, vague))
            turning = {each.link: sign for each in rubbing if (sign := each.leaving(moved))}
            if turning:
                turned |= turning
                continue
            wrong = frozenset(corner.link for corner in steady if not corner.lasts(moved))
            if not wrong:
                return moved
            held |= wrong & inert
            if not wrong & inert:  # what one does while the other slides on, wrongly, says nothing of it
                vague |= wrong
