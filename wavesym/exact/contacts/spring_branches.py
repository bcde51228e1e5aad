"""The branches of springs whose laws have corners, which go by the middles of what is known.

A spring keeps to its branch until that is certainly wrong: what is computed is right for another force, as near to the
true one as `springs.py` says. So there is always one choice, and one that goes on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from flint import arb, fmpq, fmpq_poly

from wavesym.exact.contacts.branches import Branch
from wavesym.exact.contacts.corner import Corner
from wavesym.exact.contacts.crossing import TINY, certain_fall, certain_rise, sign_after
from wavesym.exact.contacts.guards import BranchEnd
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.contacts.springs import CornerSpring
from wavesym.exact.joints.enclosure import Enclosure

_CLOSE = 64  # resolutions: a stretch is not shortened to less
_NEAR = arb(2) ** -64
FINER = 2**112
"""Finer than what contacts are known by."""
_TURNED = 2**32  # errors: what yielded comes back at a rate that was known less closely than it is now


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
        resolution = resolution / FINER
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
        return certain_rise(self._guard(moved), moved.length, resolution / FINER) or fmpq(0)

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
