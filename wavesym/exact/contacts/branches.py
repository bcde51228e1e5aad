"""The branches of a contact, and what ends each.

A contact is on one of two branches: closed, while it pushes, or open, while it has a gap. Each has a guard, a function
of time that must not be negative: the force of what is closed, the gap of what is open (at first, the rate at which it
grows). Where its guard ends a branch, the other one is its successor. A guard is known as a polynomial within an error,
sometimes exactly; what is said here of its sign is certain.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from flint import arb, fmpq

from wavesym.exact.contacts.crossing import first_fall, positive_until, sign_after
from wavesym.exact.contacts.touching_joint import JointStretch
from wavesym.exact.joints.enclosed import Enclosed
from wavesym.numbers.doubles import middle


class BranchEnd(NamedTuple):
    """How long a branch certainly lasts; and how far off its end may be, in time, unless that is exact."""

    length: fmpq
    spread: fmpq | None


@dataclass
class Contact:
    """A contact as time goes on: how wide its gap is, as far as that is known, and its branch when last decided."""

    link: int
    gap: arb
    exact: fmpq | None
    closed: bool

    @classmethod
    def of(cls, link: int, gap: fmpq) -> Contact:
        """At the start, where what touches is taken for closed."""
        return cls(link, arb(gap), gap, gap == 0)

    @property
    def shut(self) -> bool:
        """Its gap is 0."""
        return self.exact is not None and self.exact == 0

    @property
    def wide(self) -> bool:
        """Its gap is certainly more than 0."""
        return self.exact > 0 if self.exact is not None else bool(self.gap > 0)

    def begins(self, moved: JointStretch) -> bool:
        """Whether its branch on a stretch is certainly right just after the start."""
        if self.link in moved.closed:
            force = moved.pushes[self.link]
            if force.least is not None and sign_after(force.least, fmpq(0)) >= 0:
                return True
            return all(
                _begins_positive(each) if each.exact is None else sign_after(each.exact, fmpq(0)) >= 0
                for each in force.choices or (force,)
            )
        if self.wide:
            return True
        rate = moved.rates[self.link]
        return all(
            _begins_positive(each) if each.exact is None else sign_after(each.exact, fmpq(0)) > 0
            for each in rate.choices or (rate,)
        )

    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """How long its branch certainly lasts on a stretch, as it does up to `low`; None: all the way."""
        if self.link in moved.closed:
            return _positive(moved.pushes[self.link], low, moved.length, resolution)
        rate = moved.rates[self.link]
        if self.exact is not None and rate.exact is not None:
            gap = Enclosed.of(rate.exact.integral() + self.exact)
            return _positive(gap, low, moved.length, resolution)
        if not self.wide and low == 0:  # it opens: as long as it grows it is open
            grows = _positive(rate, low, moved.length, resolution)
            if grows is None or grows.length == 0:
                return grows
            low = grows.length
        error = (rate.error * arb(moved.length)).upper()
        return _positive(Enclosed(rate.polynomial.integral() + self.gap, error), low, moved.length, resolution)

    def lasts(self, moved: JointStretch, length: fmpq) -> bool:
        """Whether its branch is certainly right on all of a short stretch."""
        if self.link in moved.closed:
            return _is_not_negative(moved.pushes[self.link], length)
        return bool(self.gap + arb(length) * _range(moved.rates[self.link], length) > 0)

    def advance(self, moved: JointStretch, length: fmpq) -> None:
        """Go to the end of a stretch on which its branch was right, or of a short one on which it was left open."""
        if self.link in moved.closed:
            self.gap, self.exact = arb(0), fmpq(0)
        elif self.link in moved.vague:
            self._advance_vague(moved, length)
        else:
            self._grow(moved.rates[self.link], length)

    def _grow(self, rate: Enclosed, length: fmpq) -> None:
        h = arb(length)
        gap = rate.polynomial.integral()(h) + self.gap + arb(0, (rate.error * h).upper())
        if self.exact is not None and rate.exact is not None:
            self.exact = self.exact + rate.exact.integral()(length)
            self.gap = arb(self.exact)
        else:
            self.gap, self.exact = _gap_within(gap), None

    def _advance_vague(self, moved: JointStretch, length: fmpq) -> None:
        h, rate = arb(length), _range(moved.rates[self.link], length)
        if rate < 0 and _range(moved.pushes[self.link], length) > 0 and self.gap + h * rate < 0:
            self.gap, self.exact = arb(0), fmpq(0)
        else:
            self.gap, self.exact = _gap_within(self.gap + h * rate.union(arb(0))), None


def _gap_within(gap: arb) -> arb:
    """A gap, which is not negative, whatever its ball says."""
    return gap if gap >= 0 else arb(0).union(gap.upper().max(arb(0)))


def _positive(known: Enclosed, low: fmpq, high: fmpq, resolution: fmpq) -> BranchEnd | None:
    """Up to where a function that starts well is certainly not negative; None: all the way."""
    if known.exact is None:
        if known.least is not None and first_fall(known.least, low, high) is None:
            return None
        if known.choices and all(_positive(each, low, high, resolution) is None for each in known.choices):
            return None
        if low == 0 and known.onset is not None:
            low = known.onset.positive_until(high)
            if low == high:
                return None
        end = positive_until(known.polynomial, known.error, low, high, resolution)
        return None if end is None else BranchEnd(end, _spread(known, end))
    if known.over(arb(low).union(arb(high))) > 0:
        return None
    fall = first_fall(known.exact, low, high)
    if not isinstance(fall, tuple):
        return None if fall is None else BranchEnd(fall, None)
    before, after = fall
    while after - before > resolution:
        half = (before + after) / 2
        before, after = (half, after) if known.exact(half) > 0 else (before, half)
    return BranchEnd(before, fmpq(0))


def _begins_positive(known: Enclosed) -> bool:
    return known.at(fmpq(0)) > 0 or (known.onset is not None and known.onset.sign() > 0)


def _spread(known: Enclosed, x: fmpq) -> fmpq:
    """How far off the place is where a function comes to 0; 0 where that is not known."""
    slope = abs(known.polynomial.derivative()(arb(x))).lower()
    if not slope > 0:
        return fmpq(0)
    return middle(2 * (known.error + known.polynomial(arb(x)).rad()) / slope)


def _range(known: Enclosed, length: fmpq) -> arb:
    """All values on a stretch."""
    return known.over(arb(0).union(arb(length)))


def _is_not_negative(known: Enclosed, length: fmpq) -> bool:
    """Whether a force is certainly not negative on a stretch."""
    if known.least is not None and first_fall(known.least, fmpq(0), length) is None:
        return True
    return all(
        _range(each, length) > 0 if each.exact is None else first_fall(each.exact, fmpq(0), length) is None
        for each in known.choices or (known,)
    )
