"""Friction that bears more at rest than when it slides: from R_s on it breaks away, and then takes R_k.

Two such motions can part, so that every decision has to be certain: it is kept which branches the true motion may be on
(sticking, 0, or sliding one way, 1 or -1), and none is taken while there are two. It has left rest where it would be
held beyond R_s, had it stuck up to there: until it breaks away that is its motion.

N is what would hold it, the force on its right side: sticking, it breaks away the one way where N < -R_s, the other way
where N > R_s. Its rate r then has s r' = w (A - R_k), with A = -s N what drives it the way s that it slides, and w one
over its mass: it goes on until r comes to 0, and sticks unless N is beyond R_s there.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from flint import arb, fmpq

from wavesym.exact.contacts.branches import Branch
from wavesym.exact.contacts.corner import Corner
from wavesym.exact.contacts.crossing import certain_rise
from wavesym.exact.contacts.friction import sliding_branch
from wavesym.exact.contacts.guards import (
    BranchEnd,
    begins_with,
    first_end,
    is_not_negative,
    lasts_until,
    margins,
)
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.joints.enclosure import Enclosure, add_terms

_STUCK = frozenset({0})


@dataclass
class _Rest:
    """A motion on which it sticks, and what is left of its limit either way; `time` has passed since its start."""

    margins: dict[int, Enclosure]
    length: fmpq
    time: fmpq = field(default_factory=fmpq)

    @property
    def is_over(self) -> bool:
        """Whether it certainly has broken away by now, where that motion is known."""
        return self.time <= self.length and any(margin.evaluate(self.time) < 0 for margin in self.margins.values())


@dataclass
class Breakaway(Corner):
    """What rubs so, as time goes on: how fast its right side goes less its left one, and what it may do."""

    limit: fmpq
    most: fmpq
    lightness: fmpq
    rate: arb
    possible: frozenset[int]
    _breaks: int = field(default=0)  # the way that it breaks away at once, as its last trial of sticking shows
    _rest: _Rest | None = field(default=None)  # the last such trial, while it may still stick

    @classmethod
    def begin(cls, link: int, limits: tuple[fmpq, fmpq], lightness: fmpq, rate: arb) -> Breakaway:
        """At the start, with its limits sliding and at rest: what is at rest sticks."""
        now = sliding_branch(rate)
        return cls(link, now, now, *limits, lightness, rate, frozenset({now.sign}))

    @property
    def may_close(self) -> bool:
        """It sticks."""
        return self.now.closed

    @property
    def is_unclear(self) -> bool:
        """It may be on more than one branch."""
        return len(self.possible) > 1

    @property
    def ways(self) -> tuple[int, ...]:
        """That in which it slides; both from rest."""
        return (1, -1) if self.now.closed else tuple(sorted(self.possible - _STUCK))

    def meet(self, rate: arb) -> None:
        """Know how fast it slides on what moves as is given, which may jump."""
        if rate.overlaps(self.rate):
            return
        self.rate = rate
        sign = sliding_branch(rate).sign
        self._may_be_on(frozenset({sign}) if sign or rate.is_zero() else frozenset({-1, 0, 1}))

    def _may_be_on(self, possible: frozenset[int]) -> None:
        """Know on which branches it may be."""
        self.possible = possible
        sign = next(iter(possible)) if len(possible) == 1 else 0
        self.now = Branch(possible == _STUCK, sign)

    def begins(self, moved: JointStretch) -> bool:
        """Whether N is within its limits, or it certainly slides, just after the start; not while it is unclear."""
        if self.is_unclear:
            return False
        if self._is_closed(moved):
            left = self._margins(moved)
            self._rest = _Rest(left, moved.length)
            falls = {way: add_terms([(fmpq(-1), margin)]) for way, margin in left.items()}
            self._breaks = next((way for way, fall in falls.items() if begins_with(fall, 1)), 0)
            return all(begins_with(margin, 0) for margin in left.values())
        sign = moved.branches.sliding.get(self.link, 0)
        if self.now.closed:
            return sign == self._breaks
        return bool(sign * self.rate > 0) or begins_with(self._thrust(moved, sign), 1)

    def end(self, moved: JointStretch, low: fmpq, resolution: fmpq) -> BranchEnd | None:
        """Until when N is certainly within its limits, or it certainly goes the way it slides."""
        if self._is_closed(moved):
            self._rest = _Rest(self._margins(moved), moved.length)
            return first_end(self._rest.margins.values(), low, moved.length, resolution)
        sign, forward = self._forward(moved)
        if low == 0 and not sign * self.rate > 0:  # it has just broken away, and gets faster until that is seen
            risen = certain_rise(forward, moved.length, resolution)
            if risen is None or not self._thrust(moved, sign).evaluate_on(arb(0).union(arb(risen))) >= 0:
                return BranchEnd(fmpq(0), fmpq(0))
            low = risen
        return lasts_until(forward, low, moved.length, resolution)

    def lasts(self, moved: JointStretch) -> bool:
        """Whether it is on its branch on all of a short stretch."""
        if self._is_closed(moved):
            return all(is_not_negative(margin, moved.length) for margin in self._margins(moved).values())
        sign, forward = self._forward(moved)
        return any(known.evaluate_on(moved.span) > 0 for known in (forward, self._thrust(moved, sign)))

    def advance(self, moved: JointStretch) -> None:
        """Go to the end of a stretch: where it was left open, on all branches that it can have come to."""
        if self._rest is not None:
            self._rest.time += moved.length
            others = (moved.branches.closed_links | moved.branches.vague) - {self.link}
            if others or moved.branches.sliding:
                self._rest = None
        if self._is_closed(moved):
            self.rate = arb(0)
            return
        rate = moved.rates[self.link]
        after = rate.evaluate(moved.length) if rate.exact is None else arb(rate.exact(moved.length))
        if self.link in moved.branches.vague:
            self._may_be_on(self._reachable_branches(moved, after))
        elif after.is_zero():
            self._may_be_on(_STUCK)
        self.rate = after

    def take(self, moved: JointStretch) -> None:
        """Stick, or slide one way."""
        super().take(moved)
        self.possible = frozenset({self.now.sign})

    def _reachable_branches(self, moved: JointStretch, after: arb) -> frozenset[int]:
        """The branches that it can be on at the end of a short stretch, whatever it did on it."""
        least, most = arb(self.limit), arb(self.most)
        holding, h = moved.pushes[self.link], arb(moved.length)
        drive, last = holding.evaluate_on(moved.span), holding.evaluate(moved.length)
        drives = {way: -way * drive for way in (1, -1)}
        rested, again = self._rest is None or not self._rest.is_over, False
        rests = {way for way in self.possible - _STUCK if self._certainly_stops(way, drives[way], h)}
        reached, coming = set(self.possible), set(self.possible)
        while coming:
            way = coming.pop()
            if way and (drives[way] > least or (way in self.possible and self._certainly_goes_on(way, drives[way], h))):
                continue
            found = {other for other in (1, -1) if not drives[other] < most}
            if way and not abs(drive) > most:
                found.add(0)
                again = True
            for other in found - {way}:
                rests.discard(other)
                if other not in reached:
                    reached.add(other)
                    coming.add(other)
        gone = rests | ({0} if abs(last) > most or not (rested or again) else set())
        gone |= {way for way in (1, -1) if way * after < 0} | (set() if after.contains(0) else {0})
        return frozenset(reached - gone)

    def _certainly_stops(self, way: int, drive: arb, h: arb) -> bool:
        return bool(way * self.rate + h * self.lightness * (drive - self.limit) < 0)

    def _certainly_goes_on(self, way: int, drive: arb, h: arb) -> bool:
        return bool(way * self.rate + h * self.lightness * (drive - self.limit).min(arb(0)) > 0)

    def _margins(self, moved: JointStretch) -> dict[int, Enclosure]:
        """What is left of its limit at rest before it breaks away, either way."""
        return dict(zip((1, -1), margins(self.most, moved.pushes[self.link]), strict=True))

    def _forward(self, moved: JointStretch) -> tuple[int, Enclosure]:
        """The way that it slides, and how fast it goes that way."""
        sign = moved.branches.sliding.get(self.link, 0)
        return sign, add_terms([(fmpq(sign), moved.rates[self.link])])

    def _thrust(self, moved: JointStretch, sign: int) -> Enclosure:
        """What drives it the way it slides, beyond its friction: its mass times its acceleration."""
        return add_terms([(fmpq(-sign), moved.pushes[self.link])])
