"""Guards of branches, as functions of time on a stretch: whether they begin well, and until when they last.

A guard is known as a polynomial within an error, sometimes exactly; what is said here of its sign is certain.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from flint import arb, fmpq

from wavesym.exact.contacts.crossing import first_fall, positive_until, sign_after
from wavesym.exact.joints.enclosure import UNIT, Enclosure, add_terms
from wavesym.numbers.doubles import middle


class BranchEnd(NamedTuple):
    """How long a branch certainly lasts; and how far off its end may be, in time, unless that is exact.

    Or, how long it is taken to last, which is beyond its end by less than `late`.
    """

    length: fmpq
    spread: fmpq | None
    late: fmpq = fmpq(0)


def margins(limit: fmpq, force: Enclosure) -> list[Enclosure]:
    """What is left of a limit either way."""
    return [add_terms([(limit, UNIT), (fmpq(way), force)]) for way in (1, -1)]


def begins_with(known: Enclosure, sign: int) -> bool:
    """Whether its sign just after the start is certainly this (0 or 1) at least."""
    if known.least is not None and sign_after(known.least, fmpq(0)) >= sign:
        return True
    return all(
        _begins_positive(each) if each.exact is None else sign_after(each.exact, fmpq(0)) >= sign
        for each in known.choices or (known,)
    )


def first_end(guards: Iterable[Enclosure], low: fmpq, high: fmpq, resolution: fmpq) -> BranchEnd | None:
    """Up to where all of some functions that start well are certainly not negative; None: all the way."""
    ends = (lasts_until(guard, low, high, resolution) for guard in guards)
    return min((end for end in ends if end is not None), key=lambda end: end.length, default=None)


def lasts_until(known: Enclosure, low: fmpq, high: fmpq, resolution: fmpq) -> BranchEnd | None:
    """Up to where a function that starts well is certainly not negative; None: all the way."""
    if known.exact is None:
        if known.least is not None and first_fall(known.least, low, high) is None:
            return None
        if known.choices and all(lasts_until(each, low, high, resolution) is None for each in known.choices):
            return None
        if low == 0 and known.onset is not None:
            low = known.onset.positive_until(high)
            if low == high:
                return None
        end = positive_until(known.polynomial, known.error, low, high, resolution)
        return None if end is None else BranchEnd(end, spread(known, end))
    if known.evaluate_on(arb(low).union(arb(high))) > 0:
        return None
    fall = first_fall(known.exact, low, high)
    if not isinstance(fall, tuple):
        return None if fall is None else BranchEnd(fall, None)
    before, after = fall
    while after - before > resolution:
        half = (before + after) / 2
        before, after = (half, after) if known.exact(half) > 0 else (before, half)
    return BranchEnd(before, fmpq(0))


def _begins_positive(known: Enclosure) -> bool:
    return known.evaluate(fmpq(0)) > 0 or (known.onset is not None and known.onset.sign() > 0)


def spread(known: Enclosure, x: fmpq) -> fmpq:
    """How far off the place is where a function comes to 0, about; 0 where that is not known.

    It is the error over the slope; where that is nearly 0, too, some times the root of the error over the curvature.
    """
    slope = known.polynomial.derivative()
    error, rise, bent = (
        known.error + known.polynomial(arb(x)).rad(),
        abs(slope(arb(x))),
        abs(slope.derivative()(arb(x))),
    )
    found = [2 * error / rise.lower()] if rise.lower() > 0 else []
    if bent.lower() > 0:
        found.append(2 * ((2 * error / bent.lower()).sqrt() + 2 * rise.upper() / bent.lower()))
    return min(map(middle, found), default=fmpq(0))


def is_not_negative(known: Enclosure, length: fmpq) -> bool:
    """Whether a force is certainly not negative on a stretch."""
    if known.least is not None and first_fall(known.least, fmpq(0), length) is None:
        return True
    span = arb(0).union(arb(length))
    return all(
        each.evaluate_on(span) > 0 if each.exact is None else first_fall(each.exact, fmpq(0), length) is None
        for each in known.choices or (known,)
    )


def is_positive(known: Enclosure, length: fmpq) -> bool:
    """Whether a function is certainly positive on a short stretch, on which it may go one way."""
    return positive_until(known.polynomial, known.error, fmpq(0), length, length) is None
