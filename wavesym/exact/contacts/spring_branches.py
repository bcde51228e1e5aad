"""The branches of springs whose laws have corners, which go by the middles of what is known.

A spring keeps to its branch until that is certainly wrong: what is computed is right for another force, as near to the
true one as `springs.py` says. So there is always one choice, and one that goes on.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb, fmpq, fmpq_poly

from wavesym.exact.contacts.branches import BranchEnd, Corner
from wavesym.exact.contacts.crossing import TINY, certain_fall, sign_after
from wavesym.exact.contacts.joint_stretch import JointStretch, way
from wavesym.exact.contacts.springs import CornerSpring
from wavesym.exact.joints.enclosed import Enclosed


@dataclass
class _SpringCorner(Corner):
    """A spring with a corner, as time goes on: its stretch, and its branch when last decided."""

    link: int
    spring: CornerSpring
    stretch: arb
    closed: bool
    sign: int = 0

    @property
    def is_unclear(self) -> bool:
        """Its branch is always taken."""
        return False

    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """Where a guard is certainly negative, and since when it may have been."""
        falls = [certain_fall(each, low, moved.length, resolution) for each in moved.strained[self.link].guards]
        first = min((fall for fall in falls if fall is not None), key=lambda fall: fall[1], default=None)
        return None if first is None else BranchEnd(first[1], None, first[1] - first[0])

    def lasts(self, moved: JointStretch, length: fmpq) -> bool:
        """Its branch is always taken."""
        return True

    def advance(self, moved: JointStretch, length: fmpq) -> None:
        """Know its stretch at the end of one of time."""
        self.stretch = moved.strained[self.link].stretch.at(length)

    def take(self, moved: JointStretch) -> bool:
        """Be on the branch that a stretch begins with; whether that is another one."""
        before = self.sign, self.closed
        self.sign, self.closed = way(self.link, moved.sliding), self.link in moved.closed
        return before != (self.sign, self.closed)


@dataclass
class OneSided(_SpringCorner):
    """A spring that only pulls, or only pushes: it acts (`closed`), or idles."""

    @classmethod
    def begin(cls, link: int, spring: CornerSpring) -> OneSided:
        """At the start, where what is at its gap is taken for acting."""
        return cls(link, spring, arb(0), spring.gap <= 0)

    @property
    def may_close(self) -> bool:
        """Its stretch is not certainly within its gap."""
        return not self.spring.side * self.stretch < arb(self.spring.gap)

    def begins(self, moved: JointStretch) -> bool:
        """Whether its guard does not become negative just after the start."""
        (guard,) = moved.strained[self.link].guards
        return leaning(guard, moved.length) >= 0


@dataclass
class Yielding(_SpringCorner):
    """A spring that yields: it holds (`closed`), or gets longer or shorter with the force of its limit."""

    @classmethod
    def begin(cls, link: int, spring: CornerSpring) -> Yielding:
        """At the start it is unstrained."""
        return cls(link, spring, arb(0), True)

    @property
    def may_close(self) -> bool:
        """It may always come back."""
        return True

    @property
    def ways(self) -> tuple[int, ...]:
        """Those whose limit is reached."""
        most, least = map(arb, self.spring.most)
        return (1,) * (not self.stretch < most) + (-1,) * (not self.stretch > least)

    def begins(self, moved: JointStretch) -> bool:
        """Whether it is within its limits, or goes on the way that it yields, just after the start."""
        guards = moved.strained[self.link].guards
        if self.link not in moved.closed:
            return leaning(guards[0], moved.length) > 0
        return all(leaning(guard, moved.length) >= 0 or leaning(guard, moved.length, 1) > 0 for guard in guards)


def leaning(known: Enclosed, length: fmpq, first: int = 0) -> int:
    """The sign just after the start: of the first power, from `first` on, that is more than rounding; else 0."""
    if known.exact is not None:
        return sign_after(fmpq_poly([fmpq(0)] * first + known.exact.coeffs()[first:]), fmpq(0))
    allowed, h = TINY * known.error, arb(length)
    for n, c in enumerate(known.polynomial.coeffs()[first:], first):
        if abs(c) * h**n > allowed:
            return 1 if c > 0 else -1
    return 0
