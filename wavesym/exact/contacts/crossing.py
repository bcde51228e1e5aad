"""Up to where a function is positive for certain: on polynomials in balls, and exactly where they are known."""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from flint import acb, arb, arb_poly, ctx, fmpq, fmpq_poly, fmpz_poly

from wavesym.exact.joints.enclosure import Enclosure, shorten
from wavesym.numbers.doubles import middle

_COARSE = 64  # bits that do, where the interval is no shorter than this part of the whole
_CLOSE, _NEAR = fmpq(1, 2**24), fmpq(1, 2**6)
_FINEST = fmpq(1, 2**60)  # parts of a stretch on which a function is looked at
TINY = 8
"""Errors: what is no farther from 0 may be so by rounding."""
_CLEAR = 2**10  # errors: what is farther from 0 stays so, though errors grow
_CLOSEST = 64  # resolutions in which a function may rise
_STEPS = 12  # of Newton's method: each doubles the bits
_SAFE_STEPS = 64  # where halving has to bring it near first


class _Course:
    """How a polynomial less an error goes on parts of [0, high]: with few bits where these are long."""

    def __init__(self, p: arb_poly, error: arb, high: fmpq) -> None:
        self.p, self.error, self._high = p, error, high
        self._near = [Enclosure(p, error)]
        with ctx.workprec(_COARSE):
            self._rough = shorten(Enclosure(p * arb(1), error), high)

    def sign_on(self, a: fmpq, b: fmpq) -> tuple[bool, int]:
        """As `_sign_on`."""
        half = (b - a) / 2
        positive, way = False, 0
        if b - a > self._high * _CLOSE:
            with ctx.workprec(_COARSE):
                positive, way = _sign_on(self._rough.polynomial, self._rough.error, a + half, half)
        if b - a <= self._high * _CLOSE or (b - a <= self._high * _NEAR and not positive and not way):
            near = self._shorten(b)
            positive, way = _sign_on(near.polynomial, near.error, a + half, half)
        return positive, way

    def _shorten(self, end: fmpq) -> Enclosure:
        """The same without the powers that count for nothing up to a place, or somewhat beyond."""
        level, reach = 0, self._high * _CLOSE
        while end <= reach:
            level, reach = level + 1, reach * _CLOSE
            if level == len(self._near):
                self._near.append(shorten(self._near[-1], reach / _CLOSE))
        return self._near[level]


def positive_until(p: arb_poly, error: arb, low: fmpq, high: fmpq, resolution: fmpq) -> fmpq | None:
    """Up to where p - error > 0 is certain, from `low` on.

    Args:
        p: a polynomial in the time w since some instant.
        error: what p is wrong by at most, everywhere.
        low, high: between which w it is looked for, dimensionless.
        resolution: how near the last such w is found.

    Returns:
        None where it is so up to `high`; `low` itself where nothing can be said there.
    """
    course = _Course(p, error, high)
    stack = [(low, high)]
    while stack:
        a, b = stack.pop()
        half = (b - a) / 2
        positive, way = course.sign_on(a, b)
        if positive:
            continue
        if way:  # the least value is at an end
            if not p(arb(a)) > error:
                return a
            if way > 0 or p(arb(b)) > error:
                continue
            return _last(p, error, a, b, resolution)
        if b - a <= resolution:
            return a
        if b - a <= high * _CLOSE and (touched := _last_of_convex(p, error, a, b, resolution)) is not None:
            return touched
        stack += [(a + half, b), (a, a + half)]
    return None


def _last_of_convex(p: arb_poly, error: arb, a: fmpq, b: fmpq, resolution: fmpq) -> fmpq | None:
    """The last place where what is convex is positive for certain before it touches 0; None where that is not seen.

    It falls up to any place at which its slope is certainly negative, so that no halving has to show it.
    """
    slope = p.derivative()
    bent = slope.derivative()
    if not p(arb(a)) > error or not bent(arb(a).union(arb(b))) > 0:
        return None
    x = (a + b) / 2
    for _ in range(_STEPS):
        x = min(max(x - middle(slope(arb(x)) / bent(arb(x))), a), b)
    if x <= a or p(arb(x)) > error:
        return None
    deep = (2 * (error - p(arb(x))).upper() / bent(arb(x))).upper().sqrt()
    near = x - middle(2 * deep)
    a = near if near > a and p(arb(near)) > error else a
    last = _last(p, error, a, x, resolution)
    return last if slope(arb(last)) < 0 else None


def shortfall(known: Enclosure, high: fmpq) -> arb:
    """How far below 0 a function may be on [0, high]: 0 where it is certainly not."""
    if known.exact is not None and first_fall(known.exact, fmpq(0), high) is None:
        return arb(0)
    low = fmpq(0) if known.onset is None else known.onset.positive_until(high)
    if low == high:
        return arb(0)
    p, error, worst = known.polynomial, known.error, arb(0)
    course, finest = _Course(p, error, high), high / fmpq(2) ** ctx.prec  # what rises as a power does is flat at first
    stack = [(low, high)]
    while stack:
        a, b = stack.pop()
        positive, way = course.sign_on(a, b)
        if positive:
            continue
        ends = p(arb(a)), p(arb(b))
        seen, off = ends[0].min(ends[1]), (error + ends[0].rad() + ends[1].rad()).upper()
        least = seen if way else _least_on(p, a, b)
        if way or least >= (-TINY * off).min(2 * seen) or b - a <= finest:
            worst = worst.max((error - least).upper())
            continue
        half = (b - a) / 2
        stack += [(a + half, b), (a, a + half)]
    return worst


def certain_fall(known: Enclosure, low: fmpq, high: fmpq, resolution: fmpq) -> tuple[fmpq, fmpq] | None:
    """Since when a function that is positive at `low`, or nearly, may be negative, and from where it certainly is.

    None where it is certainly negative nowhere before `high`. Both are the same where its sign changes at a rational.
    What is below 0 by some times its error alone may be so by rounding, and is not certain.
    """
    if known.exact is not None:
        fall = first_fall(known.exact, low, high)
        if not isinstance(fall, tuple):
            return None if fall is None else (fall, fall)
    p, error = known.polynomial, known.error
    course, allowed, safe = _Course(p, error, high), TINY * error, low
    stack = [(low, high)]
    while stack:
        a, b = stack.pop()
        positive, way = course.sign_on(a, b)
        if not positive and way < 0 and p(arb(b)) < -allowed:
            since = _last(p, error, a, b, resolution) if p(arb(a)) > error else safe
            return since, _certain_until(p, allowed, max(since, a), b, resolution)
        settled = positive or way != 0 or b - a <= high * _FINEST or _least_on(p, a, b) >= -allowed
        if not settled:
            half = (b - a) / 2
            stack += [(a + half, b), (a, a + half)]
        elif p(arb(b)) > error:
            safe = b
    return None


def certain_rise(known: Enclosure, high: fmpq, resolution: fmpq) -> fmpq | None:
    """From where on, about, a function that is not certainly positive at w = 0 is.

    Args:
        known: the function of the time w since some instant, and its error.
        high: up to where it is known, dimensionless.
        resolution: the first w that is tried is a part of it.

    Returns:
        0 where it is so at once, or nothing of it is unknown; None where it is not so before `high`.
    """
    p, error = known.polynomial, known.error
    if known.exact is not None or p(arb(0)) > error:
        return fmpq(0)
    if known.onset is not None and (seen := known.onset.positive_until(high)) > 0 and p(arb(seen)) > error:
        return fmpq(0)
    at = _CLOSEST * resolution
    while at < high:
        if p(arb(at)) > _CLEAR * error:
            return at
        at *= 2
    return None


def _certain_until(p: arb_poly, allowed: arb, low: fmpq, high: fmpq, resolution: fmpq) -> fmpq:
    """The first place, about, at which what falls steadily from `low` to `high` is certainly below what is allowed."""
    step = resolution
    at = (_last(p + 2 * allowed, arb(0), low, high, resolution) / resolution).ceil() * resolution
    while at + step < high:
        if p(arb(now := fmpq(at + step))) < -allowed:
            return now
        step *= 2
    return high


def _least_on(p: arb_poly, a: fmpq, b: fmpq) -> arb:
    """A lower bound on an interval; a close one where it is convex there, and so above all its tangents."""
    half = (b - a) / 2
    local = p(arb_poly([arb(a + half), arb(half)]))
    slope = local.derivative()
    bent = slope.derivative()
    if not bent.length() or not bent[0] > sum(map(abs, bent.coeffs()[1:]), arb(0)):
        return arb((local[0] - sum(map(abs, local.coeffs()[1:]), arb(0))).lower())
    x = fmpq(0)
    for _ in range(_STEPS):
        x = min(max(x - middle(slope(arb(x)) / bent(arb(x))), fmpq(-1)), fmpq(1))
    falls = slope(arb(x))
    below = (falls * arb(x + 1)).upper().max((falls * arb(x - 1)).upper()).max(arb(0))  # of the tangent at either end
    return arb((local(arb(x)) - below).lower())


def _sign_on(p: arb_poly, error: arb, centre: fmpq, half: fmpq) -> tuple[bool, int]:
    """Whether p > error on an interval, and which way it goes there: 1 up, -1 down, 0 where that is not certain."""
    local = p(arb_poly([arb(centre), arb(half)])).coeffs() or [arb(0)]
    sizes = [abs(c).upper() for c in local[1:]]
    if local[0] - sum(sizes, arb(0)) > error:
        return True, 0
    if not sizes or not abs(local[1]) > sum((n * size for n, size in enumerate(sizes, 1) if n > 1), arb(0)):
        return False, 0
    return False, 1 if local[1] > 0 else -1


def _last(p: arb_poly, error: arb, low: fmpq, high: fmpq, resolution: fmpq) -> fmpq:
    """The same where p falls steadily, is above at `low` and may not be at `high`."""
    slope, x, first, end = p.derivative(), (low + high) / 2, low, high
    for _ in range(_SAFE_STEPS):
        value = p(arb(x))
        low, high = (x, high) if value > error else (low, x)
        step = middle((value - error) / slope(arb(x)))
        if abs(step) < resolution / 4:
            x -= step
            break
        x = middle(arb(x - step)) if low < x - step < high else (low + high) / 2
    for near in (x - resolution / 2, x - resolution):
        if near > first and p(arb(near)) > error and not p(arb(min(near + 2 * resolution, end))) > error:
            return near
    while high - low > resolution:
        x = (low + high) / 2
        low, high = (x, high) if p(arb(x)) > error else (low, x)
    return low


def sign_after(p: fmpq_poly, x: fmpq) -> int:
    """The sign of an exact function right after a place; 0 where it is 0 throughout."""
    local = p(fmpq_poly([x, 1])) if x != 0 else p
    first = next((c for c in local.numer().coeffs() if c != 0), 0)
    return (first > 0) - (first < 0)


def first_fall(p: fmpq_poly, low: fmpq, high: fmpq) -> fmpq | tuple[fmpq, fmpq] | None:
    """The first place in [low, high) right after which p < 0; None where there is none.

    A place that is no rational is told by a rational on either side, between which there is no other root.
    """
    if p.length() == 0:
        return None
    if sign_after(p, low) < 0:
        return low
    for before, after in _roots(p, low, high):
        if sign_after(p, after) < 0:
            return after if before == after else (before, after)
    return None


def _factors(p: fmpz_poly) -> list[fmpz_poly]:
    """The irreducible ones; long coefficients of a straight line need not be factored for it."""
    return [p] if p.degree() == 1 else [factor for factor, _ in p.factor()[1]]


def _roots(p: fmpq_poly, low: fmpq, high: fmpq) -> Iterator[tuple[fmpq, fmpq]]:
    """The roots in (low, high), in order: rationals on both sides of each, twice the same where it is one."""
    rational, other = [], []
    for factor in _factors(p.numer()):
        if factor.degree() == 1:
            rational.append(fmpq(-int(factor[0]), int(factor[1])))
        else:
            roots = cast("list[tuple[acb, int]]", factor.complex_roots())
            real = [z.real for z, _ in roots if z.imag == 0]
            other += [(fmpq_poly(factor), middle(x.lower()), middle(x.upper())) for x in real]
    inside = [(x, x) for x in rational if low < x < high]
    for number, (irreducible, a, b) in enumerate(other):
        # an irrational root is none of these: halving parts them
        places = [low, high, *rational, *(x for k, (_, *ends) in enumerate(other) if k != number for x in ends)]
        while any(a <= x <= b for x in places):
            half = (a + b) / 2
            a, b = (a, half) if (irreducible(a) > 0) != (irreducible(half) > 0) else (half, b)
        if low < a and b < high:
            inside.append((a, b))
    yield from sorted(inside)
