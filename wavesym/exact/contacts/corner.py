"""A corner as time goes on: on which branch it is, how long it certainly stays there; first of all, a contact.

Each branch has a guard, a function of time that must not be negative: the force of what is closed, the gap of what is
open (at first, the rate at which it grows). Where its guard ends a branch, another one is its successor. A guard is
known as a polynomial within an error, sometimes exactly; what is said here of its sign is certain.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from flint import arb, fmpq

from wavesym.exact.contacts.branches import Branch
from wavesym.exact.contacts.guards import BranchEnd, begins_with, is_not_negative, lasts_until
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.joints.enclosure import Enclosure


@dataclass
class Corner(ABC):
    """A link whose law has a corner, as time goes on.

    Args:
        link: its number.
        branch: the branch on which it was last decided to be.
        now: that on which it certainly is; neither closed nor sliding where that is not certain.
    """

    link: int
    branch: Branch
    now: Branch

    @property
    @abstractmethod
    def may_close(self) -> bool:
        """Whether a stretch may begin on which it is closed."""

    @property
    def is_held(self) -> bool:
        """Whether it is closed on a short stretch on which it is not left open what it does."""
        return self.may_close

    @property
    @abstractmethod
    def is_unclear(self) -> bool:
        """Whether nothing is certain of the branch that it is on."""

    @property
    def ways(self) -> tuple[int, ...]:
        """The signs with which it may slide where it is not closed; 0 of what does not rub."""
        return (0,)

    @property
    def late(self) -> fmpq:
        """How long it has been open which branch it is on, where it is on none meanwhile."""
        return fmpq(0)

    def unseen_time(self, moved: JointStretch, resolution: fmpq) -> fmpq:
        """How long after the start of a stretch it is not yet seen that it is on its branch."""
        return fmpq(0)

    @abstractmethod
    def begins(self, moved: JointStretch) -> bool:
        """Whether its branch on a stretch is certainly right just after the start."""

    @abstractmethod
    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """How long its branch certainly lasts on a stretch, as it does up to `low`; None: all the way."""

    @abstractmethod
    def lasts(self, moved: JointStretch) -> bool:
        """Whether its branch is certainly right on all of a short stretch."""

    @abstractmethod
    def advance(self, moved: JointStretch) -> None:
        """Go to the end of a stretch on which its branch was right, or of a short one on which it was left open."""

    def take(self, moved: JointStretch) -> None:
        """Be on the branch that a stretch begins with."""
        self.now = self.branch = moved.branches.of_link(self.link)

    def _is_closed(self, moved: JointStretch) -> bool:
        """Whether it is closed on a stretch."""
        return self.link in moved.branches.closed_links


@dataclass
class Contact(Corner):
    """A contact as time goes on: how wide its gap is, exactly (a fraction) or as far as that is known."""

    gap: fmpq | arb

    @classmethod
    def begin(cls, link: int, gap: fmpq) -> Contact:
        """At the start, where what touches is taken for closed."""
        return cls(link, Branch(gap == 0), Branch(gap == 0), gap)

    @property
    def may_close(self) -> bool:
        """Its gap is 0; or it was closed, and it is not known whether it has a gap by now."""
        return self.is_held or (self.now.closed and self.is_unclear)

    @property
    def is_held(self) -> bool:
        """Its gap is 0."""
        return isinstance(self.gap, fmpq) and self.gap == 0

    @property
    def is_unclear(self) -> bool:
        """It is not known whether it has a gap."""
        return not self.is_held and not self.gap > 0

    def begins(self, moved: JointStretch) -> bool:
        """Whether its force is not negative, or its gap grows, just after the start.

        Where it is not known whether it has a gap, its force has to be 0 throughout: then the gap stays as it is.
        """
        if self._is_closed(moved):
            force = moved.pushes[self.link]
            return begins_with(force, 0) if self.is_held else force.is_zero
        return bool(self.gap > 0) or begins_with(moved.rates[self.link], 1)

    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """How long its force, or its gap, is certainly not negative."""
        if self._is_closed(moved):
            force = moved.pushes[self.link]
            if not self.is_held:
                return None if force.is_zero else BranchEnd(low, None)
            return lasts_until(force, low, moved.length, resolution)
        rate = moved.rates[self.link]
        if isinstance(self.gap, fmpq) and rate.exact is not None:
            gap = Enclosure.from_polynomial(rate.exact.integral() + self.gap)
            return lasts_until(gap, low, moved.length, resolution)
        if not self.gap > 0 and low == 0:  # it opens: as long as it grows it is open
            grows = lasts_until(rate, low, moved.length, resolution)
            if grows is None or grows.length == 0:
                return grows
            low = grows.length
        error = (rate.error * arb(moved.length)).upper()
        gap = Enclosure(rate.polynomial.integral() + arb(self.gap), error)
        return lasts_until(gap, low, moved.length, resolution)

    def lasts(self, moved: JointStretch) -> bool:
        """Whether its branch is certainly right on all of a short stretch."""
        if self._is_closed(moved):
            return is_not_negative(moved.pushes[self.link], moved.length)
        return bool(arb(self.gap) + arb(moved.length) * moved.rates[self.link].evaluate_on(moved.span) > 0)

    def advance(self, moved: JointStretch) -> None:
        """Know its gap at the end of a stretch, or of a short one on which it was left open."""
        if self._is_closed(moved):
            return
        rate, h = moved.rates[self.link], arb(moved.length)
        if self.link in moved.branches.vague:
            rates = rate.evaluate_on(moved.span)
            closes = rates < 0 and self.gap + h * rates < 0
            pushes = closes and moved.pushes[self.link].evaluate_on(moved.span) > 0
            self.gap = fmpq(0) if pushes else _gap_within(self.gap + h * rates.union(arb(0)))
        elif isinstance(self.gap, fmpq) and rate.exact is not None:
            self.gap = self.gap + rate.exact.integral()(moved.length)
        else:
            self.gap = _gap_within(rate.polynomial.integral()(h) + arb(self.gap) + arb(0, (rate.error * h).upper()))


def _gap_within(gap: arb) -> arb:
    """A gap, which is not negative, whatever its ball says."""
    return gap if gap >= 0 else arb(0).union(gap.upper().max(arb(0)))
