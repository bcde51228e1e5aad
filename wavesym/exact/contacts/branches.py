"""The branches of links whose laws have corners, and what ends each.

A contact is on one of two branches: closed, while it pushes, or open, while it has a gap. Each has a guard, a function
of time that must not be negative: the force of what is closed, the gap of what is open (at first, the rate at which it
grows). What rubs is on one of three: it sticks, while its force is within R and -R, or slides one way or the other,
while it goes that way. Where its guard ends a branch, another one is its successor. A guard is known as a polynomial
within an error, sometimes exactly; what is said here of its sign is certain.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.contacts.crossing import sign_after
from wavesym.exact.contacts.guards import (
    BranchEnd,
    begins_bearable,
    begins_to_grow,
    is_not_negative,
    is_positive,
    lasts_until,
    margins,
    spread,
    value_range,
)
from wavesym.exact.contacts.joint_stretch import JointStretch, sliding_sign
from wavesym.exact.joints.enclosure import Enclosure, add_terms
from wavesym.numbers.doubles import middle


class Branch(NamedTuple):
    """What a link does: it is closed (touches, sticks, acts or holds), or not; then it may slide or yield one way."""

    closed: bool
    sign: int = 0


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
        self.closed = self.link in moved.closed_links

    @property
    def wide(self) -> bool:
        """Its gap is certainly more than 0."""
        return self.exact > 0 if self.exact is not None else bool(self.gap > 0)

    def begins(self, moved: JointStretch) -> bool:
        """Whether its force is not negative, or its gap grows, just after the start.

        Where it is not known whether it has a gap, its force has to be 0 throughout: then the gap stays as it is.
        """
        if self.link in moved.closed_links:
            force = moved.pushes[self.link]
            return begins_bearable(force) if self.is_held else force.is_zero
        return self.wide or begins_to_grow(moved.rates[self.link])

    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """How long its force, or its gap, is certainly not negative."""
        if self.link in moved.closed_links:
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
        if self.link in moved.closed_links:
            return is_not_negative(moved.pushes[self.link], length)
        return bool(self.gap + arb(length) * value_range(moved.rates[self.link], length) > 0)

    def advance(self, moved: JointStretch, length: fmpq) -> None:
        """Go to the end of a stretch on which its branch was right, or of a short one on which it was left open."""
        if self.link in moved.closed_links:
            return
        if self.link in moved.vague:
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


@dataclass
class Friction(Corner):
    """What rubs, as time goes on: how fast its right side goes less its left one, and which way it slid when decided.

    Where both sides have mass, or the ground is one of them, it is `inert`: it goes on sliding until it is at rest.
    Whatever it does for a moment, two motions under friction come no further apart, in energy, than they are: what is
    taken for stuck while it may be sliding yet is another motion, nearer than the energy that is lost sight of. So of
    what is inert it is the middle of what is known, itself a motion under friction, whose signs count.
    """

    link: int
    limit: fmpq
    inert: bool
    touching: bool
    rate: arb
    sign: int
    closed: bool
    _decision: Branch

    @classmethod
    def begin(cls, link: int, limit: fmpq, inert: bool, touching: bool, rate: arb) -> Friction:
        """At the start: what is at rest sticks."""
        sign = int(rate > 0) - int(rate < 0)
        return cls(link, limit, inert, touching, rate, sign, sign == 0, Branch(sign == 0, sign))

    @property
    def may_close(self) -> bool:
        """Something without mass may stop at once."""
        return not self.inert or bool(self.rate.contains(0))

    @property
    def is_held(self) -> bool:
        """What is inert, and may be at rest; else what sticks for certain."""
        return bool(self.rate.contains(0)) if self.inert else self.sign == 0

    @property
    def is_unclear(self) -> bool:
        """It is not known whether it sticks, nor which way it slides."""
        return not self.closed and self.sign == 0 and not (self.inert and self.is_held)

    @property
    def ways(self) -> tuple[int, ...]:
        """Both, unless it goes on sliding as it does."""
        if self.inert and not self.rate.contains(0):
            return (1,) if self.rate > 0 else (-1,)
        return (1, -1)

    def meet(self, rate: arb) -> None:
        """Know how fast it slides on what moves as is given, which may jump."""
        self.rate = rate

    def begins(self, moved: JointStretch) -> bool:
        """Whether its force is within its limits, or it goes the way it slides, just after the start."""
        if self.link in moved.closed_links:
            return all(map(begins_bearable, self._margins(moved)))
        forward = self._forward(moved)
        if self.inert and self.closed and forward.begins is None:
            return sign_after(_middles(forward), fmpq(0)) > 0
        return begins_to_grow(forward)

    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """How long these are certainly not negative; what is inert sticks until its force is beyond its limits.

        Where it has just stopped, until it certainly is at rest: from then on it is known exactly how fast it is.
        """
        if self.link not in moved.closed_links:
            forward = self._forward(moved)
            if not self.inert or forward.begins is not None:
                return lasts_until(forward, low, moved.length, resolution)
            end = lasts_until(_without_start(forward), low, moved.length, resolution)
            if end is None:
                return None
            off = spread(forward, end.length)
            sure = end.length - 2 * off if self.touching else end.length
            return BranchEnd(sure if sure > low and forward.evaluate(sure) > 0 else end.length, off)
        guards = self._margins(moved)
        ends = [end for guard in guards if (end := lasts_until(guard, low, moved.length, resolution)) is not None]
        end = min(ends, key=lambda end: end.length, default=None)
        if not self.rate.is_zero() and low == 0 < (rest := moved.rests.get(self.link, fmpq(0))):
            length = fmpq((rest / resolution).ceil() * resolution)
            if length < (moved.length if end is None else end.length):
                return BranchEnd(length, None)
        rested = moved.rests.get(self.link) == 0  # it sends what is known exactly, as long as it is certainly at rest
        if end is None or not self.inert or (end.spread is None and self.link in moved.exact_contacts) or rested:
            return end
        late = 4 * ((end.spread or fmpq(0)) + resolution)
        length = fmpq(((end.length + late) / resolution).ceil() * resolution)
        return BranchEnd(length, None, late + 2 * resolution) if low < length < moved.length else None

    def leaving(self, moved: JointStretch) -> int:
        """Which way it leaves rest at once, as it certainly bears more than its limit on all of a short stretch, or 0.

        It is inert, and its rate is 0 but for what is not known of it.
        """
        if not self.inert or not self.rate.is_zero() or self.link not in moved.closed_links:
            return 0
        force = value_range(moved.pushes[self.link], moved.length)
        return int(force < -self.limit) - int(force > self.limit)

    def lasts(self, moved: JointStretch, length: fmpq) -> bool:
        """Whether they are on all of a short stretch."""
        if self.link in moved.closed_links:
            return self.inert or all(is_not_negative(margin, length) for margin in self._margins(moved))
        return is_positive(self._forward(moved), length)

    def advance(self, moved: JointStretch, length: fmpq) -> None:
        """Know how fast it slides at the end of a stretch."""
        if self.link in moved.closed_links or self.link not in moved.rates:  # it may have done nothing but stick
            self.rate, self.sign, self.closed = arb(0), 0, True
            return
        self.rate = moved.rates[self.link].evaluate(length)
        if self.link in moved.vague:
            self.sign, self.closed = 0, False
        elif (sign := sliding_sign(self.link, moved.sliding)) * self.rate > 0:  # it has certainly left rest
            self.sign, self.closed = sign, False

    @property
    def branch(self) -> Branch:
        """It sticks, or slides one way, or that was left open."""
        return self._decision

    def take(self, moved: JointStretch) -> None:
        """Stick, or slide one way."""
        self.sign, self.closed = sliding_sign(self.link, moved.sliding), self.link in moved.closed_links
        self._decision = Branch(self.closed, self.sign)

    def _margins(self, moved: JointStretch) -> list[Enclosure]:
        """What is left of the limit either way."""
        return margins(self.limit, moved.pushes[self.link])

    def _forward(self, moved: JointStretch) -> Enclosure:
        """How fast it goes the way it slides."""
        return add_terms([(fmpq(sliding_sign(self.link, moved.sliding)), moved.rates[self.link])])


def _middles(known: Enclosure) -> fmpq_poly:
    """The polynomial that is the middle of what is known."""
    return fmpq_poly([middle(c) for c in known.polynomial.coeffs()])


def _without_start(known: Enclosure) -> Enclosure:
    """A function with the signs of the middle of what is known, which is not 0 at the start."""
    powers = [c.mid() for c in known.polynomial.coeffs()]
    return Enclosure(arb_poly(powers[1:] if powers and powers[0] == 0 else powers), arb(0))


def _gap_within(gap: arb) -> arb:
    """A gap, which is not negative, whatever its ball says."""
    return gap if gap >= 0 else arb(0).union(gap.upper().max(arb(0)))
