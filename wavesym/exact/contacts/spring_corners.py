"""The branches of springs whose laws have corners, which go by the middles of what is known.

A spring keeps to its branch until that is certainly wrong: what is computed is right for another force, as near to the
true one as `springs.py` says. So there is always one choice, and one that goes on.

A spring with a dashpot engages and releases with a force that jumps, so that its branch is taken once certain.
Two motions of which one has engaged and the other has not may part, by as much as a dashpot gives to the one alone. So
it acts where it is certainly beyond its gap, and idles where it certainly is not. In doubt it idles, too, with a force
that is not known: anything that its spring and its dashpot may have then (`TouchingJoint.move`). That is for as short
as can be: from the last instant at which it was certain to where it is again, on either side. A stretch beyond the gap
that only touches 0 is such a stretch, and no event; the slower it is then the smaller is what is not known.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass, field, replace
from typing import Self

from flint import arb, fmpq, fmpq_poly

from wavesym.exact.contacts.branches import Branch
from wavesym.exact.contacts.corner import Corner
from wavesym.exact.contacts.crossing import TINY, certain_fall, certain_rise, sign_after
from wavesym.exact.contacts.guards import BranchEnd, lasts_until
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.contacts.springs import CornerSpring
from wavesym.exact.joints.enclosure import Enclosure
from wavesym.numbers.doubles import middle

_CLOSE = 64  # resolutions: a stretch is not shortened to less
_NEAR = arb(2) ** -64
_FINER = 2**112  # than what contacts are known by
_TURNED = 2**32  # errors: what yielded comes back at a rate that was known less closely than it is now
# of a spring with a dashpot
_LEAST = 64  # resolutions that a stretch in doubt has, at least
_LONGER = 4  # times as long in doubt as it should take
_CLEAR, _MOSTLY = 64, arb(7) / 8  # errors of its stretch, and the part of what is left of it that it may lose unseen
_NOTHING = arb(2) ** -200  # of the longest that it was
_FASTER = 4  # times as fast as at its start it may get longer at most on one


@dataclass
class _SpringCorner(Corner):
    """A spring with a corner, as time goes on: its stretch, and its branch when last decided."""

    spring: CornerSpring
    stretch: arb

    @property
    def is_held(self) -> bool:
        """It keeps to its branch."""
        return self.now.closed

    @property
    def is_unclear(self) -> bool:
        """Its branch is always taken."""
        return False

    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """Where a guard is certainly negative, or the stretch from or to where it may be so.

        What is not known of a force counts on all of a stretch: so those on which something is are short.
        """
        resolution = resolution / _FINER
        falls = [certain_fall(each, low, moved.length, resolution) for each in moved.spring_motions[self.link].guards]
        first = min((fall for fall in falls if fall is not None), key=lambda fall: fall[1], default=None)
        clears = moved.spring_motions[self.link].clears if low == 0 else ()
        rises = [certain_rise(each, moved.length, resolution) for each in clears]
        clear = max((rise for rise in rises if rise is not None), default=fmpq(0))
        if 0 < clear < (moved.length if first is None else first[0]):
            return BranchEnd(clear, None)
        if first is None:
            return None
        since, certain = first
        if since > low + _CLOSE * resolution and since < certain:
            return BranchEnd(since, None)
        return BranchEnd(certain, None, certain - since)

    def lasts(self, moved: JointStretch) -> bool:
        """Its branch is always taken."""
        return True

    def advance(self, moved: JointStretch) -> None:
        """Know its stretch at the end of one of time."""
        self.stretch = moved.spring_motions[self.link].stretch.evaluate(moved.length)


@dataclass
class OneSided(_SpringCorner):
    """A spring that only pulls, or only pushes: it acts (`closed`), or idles.

    Where it comes to rest at its gap nothing may tell on which side of that it is. Then it idles, with a force that is
    not known (`TouchingJoint.move`), and `branch` stays what it was.
    """

    @classmethod
    def begin(cls, link: int, spring: CornerSpring) -> Self:
        """At the start, where what is at its gap is taken for acting."""
        now = Branch(spring.gap <= 0)
        return cls(link, now, now, spring, arb(0))

    @property
    def may_close(self) -> bool:
        """Its stretch is not well within its gap."""
        return not _well_below(self.spring.side * self.stretch, arb(self.spring.gap))

    def begins(self, moved: JointStretch) -> bool:
        """Whether its guard does not become negative just after the start; where nothing tells, it idles."""
        if self._is_in_doubt(moved):
            return not self._is_closed(moved)
        return _begins(self._guard(moved), moved.length)

    def take(self, moved: JointStretch) -> None:
        """Be on the branch that a stretch begins with; in doubt, or at rest at its gap, still on the one before."""
        self.now = moved.branches.of_link(self.link)
        if not (self._is_in_doubt(moved) or self._guard(moved).is_zero):
            self.branch = self.now

    def unseen_time(self, moved: JointStretch, resolution: fmpq) -> fmpq:
        """How long after the start of a stretch it is not yet seen that it is on its branch."""
        return certain_rise(self._guard(moved), moved.length, resolution / _FINER) or fmpq(0)

    def _guard(self, moved: JointStretch) -> Enclosure:
        (guard,) = moved.spring_motions[self.link].guards
        return guard

    def _is_in_doubt(self, moved: JointStretch) -> bool:
        """Whether it is at its gap at first, and nothing tells which way it goes."""
        guard = self._guard(moved)
        near = abs(guard.polynomial(arb(0))) <= TINY * guard.error
        return guard.exact is None and bool(near) and leaning(guard, moved.length) == 0


@dataclass
class Yielding(_SpringCorner):
    """A spring that yields: it holds (`closed`), or gets longer or shorter with the force of its limit."""

    @classmethod
    def begin(cls, link: int, spring: CornerSpring) -> Yielding:
        """At the start it holds."""
        return cls(link, Branch(closed=True), Branch(closed=True), spring, arb(spring.start))

    @property
    def may_close(self) -> bool:
        """It may always come back."""
        return True

    @property
    def ways(self) -> tuple[int, ...]:
        """Those whose limit may be reached."""
        most, least = map(arb, self.spring.most)
        return (1,) * (not _well_below(self.stretch, most)) + (-1,) * (not _well_below(-self.stretch, -least))

    def begins(self, moved: JointStretch) -> bool:
        """Whether it is within its limits, or goes on the way that it yields, just after the start."""
        guards = moved.spring_motions[self.link].guards
        if not self._is_closed(moved):
            return leaning(guards[0], moved.length) > 0
        return all(_begins(guard, moved.length) or leaning(guard, moved.length, 1, _TURNED) > 0 for guard in guards)


@dataclass
class Engaging(OneSided):
    """A spring on one side with a dashpot: it acts (`closed`), idles, or it is in doubt, and may do either.

    It gets longer up to `slowing` times as fast without its dashpot; `doubt` is how long it has been in doubt.
    """

    slowing: fmpq = field(default_factory=lambda: fmpq(1))
    doubt: fmpq = field(default_factory=fmpq)
    longest: arb = field(default_factory=lambda: arb(0))

    @classmethod
    def begin_damped(cls, link: int, spring: CornerSpring, slowing: fmpq) -> Engaging:
        """At the start, where what is at its gap is taken for acting."""
        return replace(cls.begin(link, spring), slowing=slowing)

    @property
    def may_close(self) -> bool:
        """It is not certainly within its gap."""
        return not self._beyond < 0

    @property
    def is_held(self) -> bool:
        """It is certainly beyond its gap."""
        return bool(self._beyond > 0)

    @property
    def late(self) -> fmpq:
        """How long it has been in doubt."""
        return self.doubt

    @property
    def _beyond(self) -> arb:
        """How far beyond its gap it is."""
        return self.spring.side * self.stretch - arb(self.spring.gap)

    def begins(self, moved: JointStretch) -> bool:
        """Whether it acts or idles as it certainly does just after the start; in doubt it idles."""
        side = self._side(moved)
        if side == 0 and self._guard(moved).is_zero:
            return True
        return (side > 0) == self._is_closed(moved)

    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """How long it certainly does what it does; in doubt, until it should no longer be."""
        guard, resolution = self._guard(moved), resolution / _FINER
        if self._is_in_doubt(moved):
            return self._doubt_end(moved, low, resolution)
        if low == 0 and guard.begins is None and not guard.polynomial(arb(0)) > guard.error:
            return self._vague_end(moved, resolution)
        end = lasts_until(guard, low, moved.length, resolution)
        if end is not None and end.spread is not None and end.length <= _LEAST * resolution:
            return self._doubt_end(moved, low, resolution)
        return None if end is None else BranchEnd(end.length, None)

    def advance(self, moved: JointStretch) -> None:
        """Know its stretch at the end of one of time, and how long it may have been on its other branch.

        What is at rest at its gap, but for what counts for nothing, is on the branch that it was on before.
        """
        self.doubt = self.doubt + moved.length if self.link in moved.doubts else fmpq(0)
        super().advance(moved)
        self.longest = self.longest.max(abs(self.stretch).upper())
        if abs(self._beyond) < self.longest * _NOTHING:
            self.doubt = fmpq(0)

    def _side(self, moved: JointStretch) -> int:
        """1 where it is beyond its gap just after the start, -1 where it is not, 0 where neither is certain."""
        if self._beyond > 0 or self._beyond < 0:
            return 1 if self._beyond > 0 else -1
        guard, sign = self._guard(moved), 0
        if guard.exact is not None:
            sign = sign_after(guard.exact, fmpq(0))
        elif guard.onset is not None:
            sign = guard.onset.sign()
        return sign if self._is_closed(moved) else -sign

    def _is_in_doubt(self, moved: JointStretch) -> bool:
        return self._side(moved) == 0 and not self._guard(moved).is_zero

    def _vague_end(self, moved: JointStretch, resolution: fmpq) -> BranchEnd | None:
        """The same where its own stretch is known more closely at first than its guard is on a long one."""
        guard, length = self._guard(moved), moved.length
        slope, margin = guard.polynomial.derivative()(arb(0)), abs(self._beyond).lower()
        if slope > 0:
            rise = certain_rise(guard, length, resolution)
            return None if rise is None or rise >= length else BranchEnd(rise, None)
        if slope < 0 and margin > _CLEAR * self.stretch.rad():
            last = (middle(_MOSTLY * margin / abs(slope).upper()) / resolution).floor() * resolution
            if last > _LEAST * resolution:
                return BranchEnd(fmpq(last), None) if last < length else None
        return self._doubt_end(moved, fmpq(0), resolution)

    @staticmethod
    def _is_steady(rate: Enclosure, length: fmpq, fast: arb) -> bool:
        """Whether it gets longer at no more than some times as fast as at the start of a stretch."""
        return bool(rate.evaluate_on(arb(0).union(arb(length))).abs_upper() <= _FASTER * fast)

    def _doubt_end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """Where it should be certain, were it as slow as its dashpot makes it; or where it gets much faster.

        Where it is at rest, as far as is known, that is as long as it stays so.
        """
        rate, near = self.spring.rate(moved.velocities), abs(self._guard(moved).evaluate(fmpq(0))).upper()
        begins = rate.evaluate(fmpq(0))
        fast, last = abs(begins).upper(), moved.length
        if fast > 0:
            if not begins.contains(0):
                last = min(last, middle(_LONGER * arb(self.slowing) * near / fast))
            halves = range(int((last / resolution).ceil()).bit_length())
            last /= 1 << bisect_left(halves, True, key=lambda n: self._is_steady(rate, last / (1 << n), fast))
        last = max((last / resolution).ceil() * resolution, _LEAST * resolution, low)
        return BranchEnd(fmpq(last), None) if last < moved.length else None


def _begins(guard: Enclosure, length: fmpq) -> bool:
    """Whether a guard is more than 0 at the start, if only its middle, or does not become negative just after it."""
    return bool(guard.polynomial[0].mid() > 0) or leaning(guard, length) >= 0


def _well_below(value: arb, limit: arb) -> bool:
    """By more than rounding makes of either, on any stretch that is tried: what is nearer is looked at closely."""
    return bool(value + (abs(value) + abs(limit)) * _NEAR < limit)


def leaning(known: Enclosure, length: fmpq, first: int = 0, tiny: int = TINY) -> int:
    """The sign just after the start: of the first power, from `first` on, of more than `tiny` errors; else 0."""
    if known.exact is not None:
        return sign_after(fmpq_poly([fmpq(0)] * first + known.exact.coeffs()[first:]), fmpq(0))
    if first == 0 and known.onset is not None and (sign := known.onset.sign()):
        return sign
    allowed, h = tiny * known.error, arb(length)
    for n, c in enumerate(known.polynomial.coeffs()[first:], first):
        if abs(c) * h**n > allowed:
            return 1 if c > 0 else -1
    return 0
