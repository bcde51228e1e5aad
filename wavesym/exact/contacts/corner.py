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
from wavesym.exact.contacts.guards import (
    BranchEnd,
    begins_bearable,
    begins_to_grow,
    is_not_negative,
    lasts_until,
    value_range,
)
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.joints.enclosure import Enclosure


class Corner(ABC):
    """A link whose law has a corner, as time goes on; which way it slides, where it rubs and is certain to (`sign`)."""

    link: int
    closed: bool
    sign: int

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
    def lasts(self, moved: JointStretch, length: fmpq) -> bool:
        """Whether its branch is certainly right on all of a short stretch."""

    @abstractmethod
    def advance(self, moved: JointStretch, length: fmpq) -> None:
        """Go to the end of a stretch on which its branch was right, or of a short one on which it was left open."""

    @property
    @abstractmethod
    def branch(self) -> Branch:
        """That which was decided last."""

    @abstractmethod
    def take(self, moved: JointStretch) -> None:
        """Be on the branch that a stretch begins with."""


@dataclass
class Contact(Corner):
    """A contact as time goes on: how wide its gap is, as far as that is known, and its branch when last decided."""

    link: int
    gap: arb
    exact: fmpq | None
    closed: bool
    sign = 0

    @classmethod
    def begin(cls, link: int, gap: fmpq) -> Contact:
        """At the start, where what touches is taken for closed."""
        return cls(link, arb(gap), gap, gap == 0)

    @property
    def may_close(self) -> bool:
        """Its gap is 0; or it was closed, and it is not known whether it has a gap by now."""
        return self.is_held or (self.closed and not self.wide)

    @property
    def is_held(self) -> bool:
        """Its gap is 0."""
        return self.exact is not None and self.exact == 0

    @property
    def is_unclear(self) -> bool:
        """It is not known whether it has a gap."""
        return not self.is_held and not self.wide

    @property
    def branch(self) -> Branch:
        """Closed or open."""
        return Branch(self.closed)

    def take(self, moved: JointStretch) -> None:
        """Be closed or open."""
        self.closed = self.link in moved.branches.closed

    @property
    def wide(self) -> bool:
        """Its gap is certainly more than 0."""
        return self.exact > 0 if self.exact is not None else bool(self.gap > 0)

    def begins(self, moved: JointStretch) -> bool:
        """Whether its force is not negative, or its gap grows, just after the start.

        Where it is not known whether it has a gap, its force has to be 0 throughout: then the gap stays as it is.
        """
        if self.link in moved.branches.closed:
            force = moved.pushes[self.link]
            return begins_bearable(force) if self.is_held else force.is_zero
        return self.wide or begins_to_grow(moved.rates[self.link])

    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """How long its force, or its gap, is certainly not negative."""
        if self.link in moved.branches.closed:
            force = moved.pushes[self.link]
            if not self.is_held:
                return None if force.is_zero else BranchEnd(low, None)
            return lasts_until(force, low, moved.length, resolution)
        rate = moved.rates[self.link]
        if self.exact is not None and rate.exact is not None:
            gap = Enclosure.from_polynomial(rate.exact.integral() + self.exact)
            return lasts_until(gap, low, moved.length, resolution)
        if not self.wide and low == 0:  # it opens: as long as it grows it is open
            grows = lasts_until(rate, low, moved.length, resolution)
            if grows is None or grows.length == 0:
                return grows
            low = grows.length
        error = (rate.error * arb(moved.length)).upper()
        return lasts_until(Enclosure(rate.polynomial.integral() + self.gap, error), low, moved.length, resolution)

    def lasts(self, moved: JointStretch, length: fmpq) -> bool:
        """Whether its branch is certainly right on all of a short stretch."""
        if self.link in moved.branches.closed:
            return is_not_negative(moved.pushes[self.link], length)
        return bool(self.gap + arb(length) * value_range(moved.rates[self.link], length) > 0)

    def advance(self, moved: JointStretch, length: fmpq) -> None:
        """Go to the end of a stretch on which its branch was right, or of a short one on which it was left open."""
        if self.link in moved.branches.closed:
            return
        if self.link in moved.branches.vague:
            self._advance_vague(moved, length)
        else:
            self._grow(moved.rates[self.link], length)

    def _grow(self, rate: Enclosure, length: fmpq) -> None:
        h = arb(length)
        gap = rate.polynomial.integral()(h) + self.gap + arb(0, (rate.error * h).upper())
        if self.exact is not None and rate.exact is not None:
            self.exact = self.exact + rate.exact.integral()(length)
            self.gap = arb(self.exact)
        else:
            self.gap, self.exact = _gap_within(gap), None

    def _advance_vague(self, moved: JointStretch, length: fmpq) -> None:
        h, rate = arb(length), value_range(moved.rates[self.link], length)
        if rate < 0 and value_range(moved.pushes[self.link], length) > 0 and self.gap + h * rate < 0:
            self.gap, self.exact = arb(0), fmpq(0)
        else:
            self.gap, self.exact = _gap_within(self.gap + h * rate.union(arb(0))), None


def _gap_within(gap: arb) -> arb:
    """A gap, which is not negative, whatever its ball says."""
    return gap if gap >= 0 else arb(0).union(gap.upper().max(arb(0)))
