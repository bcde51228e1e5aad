"""Friction as time goes on: it sticks while its force is within R and -R, or slides one way while it goes that way."""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.contacts.branches import Branch
from wavesym.exact.contacts.corner import Corner
from wavesym.exact.contacts.crossing import sign_after
from wavesym.exact.contacts.guards import (
    BranchEnd,
    begins_with,
    first_end,
    is_not_negative,
    is_positive,
    lasts_until,
    margins,
    spread,
)
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.joints.enclosure import Enclosure, add_terms
from wavesym.numbers.doubles import middle

UNCLEAR = Branch(closed=False)
"""Friction of which it is not known whether it sticks, nor which way it slides."""


@dataclass
class Friction(Corner):
    """What rubs, as time goes on: how fast its right side goes less its left one, and which way it slid when decided.

    Where both sides have mass, or the ground is one of them, it is `inert`: it goes on sliding until it is at rest.
    Whatever it does for a moment, two motions under friction come no further apart, in energy, than they are: what is
    taken for stuck while it may be sliding yet is another motion, nearer than the energy that is lost sight of. So of
    what is inert it is the middle of what is known, itself a motion under friction, whose signs count.
    """

    limit: fmpq
    inert: bool
    touching: bool
    rate: arb

    @classmethod
    def begin(cls, link: int, limit: fmpq, inert: bool, touching: bool, rate: arb) -> Friction:
        """At the start: what is at rest sticks."""
        now = sliding_branch(rate)
        return cls(link, now, now, limit, inert, touching, rate)

    @property
    def may_close(self) -> bool:
        """Something without mass may stop at once."""
        return not self.inert or bool(self.rate.contains(0))

    @property
    def is_held(self) -> bool:
        """What is inert, and may be at rest; else what sticks for certain."""
        return bool(self.rate.contains(0)) if self.inert else self.now.sign == 0

    @property
    def is_unclear(self) -> bool:
        """It is not known whether it sticks, nor which way it slides."""
        return self.now == UNCLEAR and not (self.inert and self.is_held)

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
        if self._is_closed(moved):
            return all(begins_with(margin, 0) for margin in self._margins(moved))
        forward = self._forward(moved)
        if self.inert and self.now.closed and forward.begins is None:
            return sign_after(_middles(forward), fmpq(0)) > 0
        return begins_with(forward, 1)

    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """How long these are certainly not negative; what is inert sticks until its force is beyond its limits.

        Where it has just stopped, until it certainly is at rest: from then on it is known exactly how fast it is.
        """
        if not self._is_closed(moved):
            forward = self._forward(moved)
            if not self.inert or forward.begins is not None:
                return lasts_until(forward, low, moved.length, resolution)
            end = lasts_until(_without_start(forward), low, moved.length, resolution)
            if end is None:
                return None
            off = spread(forward, end.length)
            sure = end.length - 2 * off if self.touching else end.length
            return BranchEnd(sure if sure > low and forward.evaluate(sure) > 0 else end.length, off)
        end = first_end(self._margins(moved), low, moved.length, resolution)
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
        if not self.inert or not self.rate.is_zero() or not self._is_closed(moved):
            return 0
        force = moved.pushes[self.link].evaluate_on(moved.span)
        return int(force < -self.limit) - int(force > self.limit)

    def lasts(self, moved: JointStretch) -> bool:
        """Whether they are on all of a short stretch."""
        if self._is_closed(moved):
            return self.inert or all(is_not_negative(margin, moved.length) for margin in self._margins(moved))
        return is_positive(self._forward(moved), moved.length)

    def advance(self, moved: JointStretch) -> None:
        """Know how fast it slides at the end of a stretch."""
        if self._is_closed(moved) or self.link not in moved.rates:  # it may have done nothing but stick
            self.rate, self.now = arb(0), Branch(closed=True)
            return
        self.rate = moved.rates[self.link].evaluate(moved.length)
        sliding = moved.branches.of_link(self.link)
        if self.link in moved.branches.vague:
            self.now = UNCLEAR
        elif sliding.sign * self.rate > 0:  # it has certainly left rest
            self.now = sliding

    def _margins(self, moved: JointStretch) -> list[Enclosure]:
        """What is left of the limit either way."""
        return margins(self.limit, moved.pushes[self.link])

    def _forward(self, moved: JointStretch) -> Enclosure:
        """How fast it goes the way it slides."""
        return add_terms([(fmpq(moved.branches.sliding.get(self.link, 0)), moved.rates[self.link])])


def sliding_branch(rate: arb) -> Branch:
    """The branch of friction that slides at a rate; it sticks where that is not certain."""
    sign = int(rate > 0) - int(rate < 0)
    return Branch(sign == 0, sign)


def _middles(known: Enclosure) -> fmpq_poly:
    """The polynomial that is the middle of what is known."""
    return fmpq_poly([middle(c) for c in known.polynomial.coeffs()])


def _without_start(known: Enclosure) -> Enclosure:
    """A function with the signs of the middle of what is known, which is not 0 at the start."""
    powers = [c.mid() for c in known.polynomial.coeffs()]
    return Enclosure(arb_poly(powers[1:] if powers and powers[0] == 0 else powers), arb(0))
