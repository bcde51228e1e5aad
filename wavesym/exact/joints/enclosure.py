"""Functions of time on a stretch, as polynomials in balls, and all that is known of them beyond that.

Balls cannot tell how a function leaves 0. But what is at rest, or moves as is known exactly, begins with powers that
are rational, whatever comes later: f(w) = c_0 + c_1 w + ... + c_(n-1) w^(n-1) + r, |r| <= beyond w^n. For small w the
first of these that is not 0 has the last word, and coarse bounds of derivatives tell how small (`joint_series`).

Sums with exact factors keep what is known: that they are exact, begin as an exact function does, lie on one side of
one, or are one of a few functions at each instant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import inf, perm, prod

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

ORDER = 6  # powers that are known of how a function begins, at first: each mass that it passes makes them one more
_LONGEST = 1 << 14  # bits of the denominator of what is known exactly: each joint adds some, and longer ones take long
_CHOICES = 8  # of functions, that are told apart
# of what is shortened: bits that bounds are computed with, and how many of the first powers tell its size
_COARSE, _FIRST = 32, 8


@dataclass(frozen=True)
class Onset:
    """How a function begins: f = powers + rests, the derivative of order k of the rest (k, b) being at most k! b.

    The powers below the least order are all there are; of a polynomial, which has no rests, all are.
    """

    powers: fmpq_poly
    rests: tuple[tuple[int, arb], ...] = ()

    @property
    def order(self) -> float:
        """How many powers are known."""
        return min((order for order, _ in self.rests), default=inf)

    def sign(self) -> int:
        """Just after the start; 0 where these powers do not tell."""
        first = self._first
        value = fmpq(0) if first is None else self.powers[first]
        return (value > 0) - (value < 0)

    @property
    def _first(self) -> int | None:
        """The first power that is not 0."""
        first = next((n for n, c in enumerate(self.powers.coeffs()) if c != 0), None)
        return first if first is not None and first < self.order else None

    def positive_until(self, length: fmpq) -> fmpq:
        """How long it is certainly positive, about; 0 where it does not begin so."""
        if self.sign() <= 0:
            return fmpq(0)
        first, c = self._first or 0, self.powers.coeffs()
        others = [(n, abs(arb(value))) for n, value in enumerate(c) if n > first] + list(self.rests)
        w = length
        while not arb(c[first]) > sum((size * arb(w) ** (n - first) for n, size in others), arb(0)):
            w /= 2
        return w

    def integral(self, start: fmpq) -> Onset:
        """That of what is `start` at first."""
        rests = tuple((order + 1, (bound / (order + 1)).upper()) for order, bound in self.rests)
        return Onset(self.powers.integral() + start, rests)

    def derivative(self, order: int, length: fmpq) -> arb:
        """A bound of a derivative; infinite where its order is higher than those that are known."""
        if order > self.order:
            return arb("inf")
        h, c = arb(length), self.powers.coeffs()
        total = sum((abs(arb(c[n] * perm(n, order))) * h ** (n - order) for n in range(order, len(c))), arb(0))
        return total.upper() + sum((b * perm(n, order) * h ** (n - order) for n, b in self.rests), arb(0)).upper()


@dataclass(frozen=True)
class Enclosure:
    """A function on a stretch: |function - polynomial| <= error.

    `exact` is the function, where it is known to be a polynomial. Where `choices` are given it is, at each instant, one
    of these. `onset` tells how it begins, where that is known. `least` and `most` are exact polynomials that it is
    never below, or above, where such are known.
    """

    polynomial: arb_poly
    error: arb
    exact: fmpq_poly | None = None
    choices: tuple[Enclosure, ...] = ()
    onset: Onset | None = None
    least: fmpq_poly | None = None
    most: fmpq_poly | None = None

    @property
    def is_zero(self) -> bool:
        """Whether it is certainly 0 throughout."""
        return self.exact is not None and self.exact.length() == 0

    @property
    def has_bounds(self) -> bool:
        """Whether such bounds are known."""
        return self.least is not None or self.most is not None

    @property
    def bounds(self) -> tuple[fmpq_poly | None, fmpq_poly | None]:
        """Exact bounds, of a polynomial too."""
        return (self.least, self.most) if self.exact is None else (self.exact, self.exact)

    @property
    def begins(self) -> Onset | None:
        """How it begins, of a polynomial too."""
        return self.onset if self.exact is None else Onset(self.exact)

    @classmethod
    def from_polynomial(cls, exact: fmpq_poly) -> Enclosure:
        """A polynomial that is known."""
        below = arb(exact.denom())  # fractions would be reduced one by one, which takes long where they are long
        return cls(arb_poly([arb(c) / below for c in exact.numer().coeffs()]), arb(0), exact)

    def evaluate(self, w: fmpq) -> arb:
        """An enclosure of its value."""
        value = self.polynomial(arb(w))
        return value + arb(0, self.error) if self.error != 0 else value

    def evaluate_on(self, span: arb) -> arb:
        """An enclosure of all values on a part of the stretch: those at its ends, where it goes one way."""
        p, ends = self.polynomial, (span.lower(), span.upper())
        one_way = p.length() > 2 and not p.derivative()(span).contains(0)
        return (p(ends[0]).union(p(ends[1])) if one_way else p(span)) + arb(0, self.error)


STILL = Enclosure(arb_poly(), arb(0), fmpq_poly())
UNIT = Enclosure.from_polynomial(fmpq_poly([1]))

Terms = list[tuple[fmpq, Enclosure]]
"""A sum with exact factors."""


def combine(terms: Sequence[tuple[fmpq, Onset]]) -> Onset:
    """A sum with exact factors."""
    total, rests = fmpq_poly(), dict[int, arb]()
    for factor, onset in terms:
        total += factor * onset.powers
        for order, beyond in onset.rests:
            rests[order] = (rests.get(order, arb(0)) + abs(arb(factor)) * beyond).upper()
    return Onset(total, tuple(sorted(rests.items())))


def weighted_sum(terms: Sequence[tuple[fmpq, Enclosure]]) -> Enclosure:
    """A sum with exact factors; what has the factor 0 is not in it."""
    polynomial, error = arb_poly(), arb(0)
    for factor, known in terms:
        if factor == 1:
            polynomial += known.polynomial
            error += known.error
        elif factor == -1:
            polynomial -= known.polynomial
            error += known.error
        elif factor != 0:
            size = arb(factor)
            polynomial += size * known.polynomial
            error += abs(size) * known.error
    return Enclosure(polynomial, error.upper())


def scale_terms(terms: Terms, factor: fmpq) -> Terms:
    """Each times a factor."""
    return [(factor * each, known) for each, known in terms] if factor != 0 else []


def add_terms(terms: Terms) -> Enclosure:
    """A sum with exact factors; exact where all of it is, and no fraction is very long. What is in it twice is one."""
    counted = collect(terms)
    number = prod(len(known.choices) or 1 for _, known in counted)
    if number == 1:
        return _add(counted)
    if number > _CHOICES:
        return weighted_sum(counted)
    ways = product(*(known.choices or (known,) for _, known in counted))
    factored = [factor for factor, _ in counted]
    hull = with_bounds(weighted_sum(counted), None, *_bounds(counted))
    return _one_of(hull, [_add(list(zip(factored, way, strict=True))) for way in ways])


def collect(terms: Terms) -> Terms:
    """Each known function once, and none whose factors cancel."""
    factors: dict[int, fmpq] = {}
    parts: dict[int, Enclosure] = {}
    for factor, known in terms:
        parts[id(known)] = known
        factors[id(known)] = factors.get(id(known), fmpq(0)) + factor
    return [(factor, parts[each]) for each, factor in factors.items() if factor != 0]


def _add(terms: Terms) -> Enclosure:
    exact = fmpq_poly()
    for factor, known in terms:
        if known.exact is None:
            if not any(other.onset or other.has_bounds for _, other in terms):
                return weighted_sum(terms)
            begin = [(factor, begins) for factor, known in terms if (begins := known.begins) is not None]
            onset = combine(begin) if len(begin) == len(terms) else None
            return with_bounds(weighted_sum(terms), onset, *_bounds(terms))
        exact += factor * known.exact
    known = Enclosure.from_polynomial(exact)
    return known if exact.denom().bit_length() <= _LONGEST else replace(known, exact=None)


def _bounds(terms: Terms) -> tuple[fmpq_poly | None, fmpq_poly | None]:
    """What a sum is not below, and not above, as far as that is known exactly."""
    found: list[fmpq_poly | None] = []
    for side in (0, 1):
        parts = [(factor, known.bounds[side if factor > 0 else 1 - side]) for factor, known in terms]
        bounds = [factor * p for factor, p in parts if p is not None]
        found.append(sum(bounds, fmpq_poly()) if len(bounds) == len(terms) else None)
    return found[0], found[1]


def with_bounds(hull: Enclosure, onset: Onset | None, least: fmpq_poly | None, most: fmpq_poly | None) -> Enclosure:
    """What is within a hull, with what else is known of it."""
    if onset is None and least is None and most is None:
        return hull
    return replace(hull, onset=onset, least=least, most=most)


def _one_of(hull: Enclosure, functions: Sequence[Enclosure]) -> Enclosure:
    """What is within a hull and, at each instant, one of some functions; those that are known count once."""
    different: list[Enclosure] = []
    for each in functions:
        if each.exact is None or all(each.exact != other.exact for other in different):
            different.append(each)
    if len(different) == 1:
        return different[0]
    return replace(hull, choices=tuple(different) if len(different) <= _CHOICES else ())


def one_at_each_instant(functions: Sequence[Enclosure], span: arb) -> Enclosure:
    """One of these at each instant: all their values on a stretch."""
    hull = functions[0].evaluate_on(span)
    for known in functions[1:]:
        hull = hull.union(known.evaluate_on(span))
    return _one_of(
        Enclosure(arb_poly([hull.mid()]), hull.rad()),
        [each for known in functions for each in known.choices or (known,)],
    )


def shift(known: Enclosure, by: fmpq, brief: fmpq | None = None) -> Enclosure:
    """The same function in the time since an instant that is `by` later.

    On a `brief` stretch it has Taylor's first powers, and what the others can add.
    """
    terms = 2 + ctx.prec // 64 if brief is not None else known.polynomial.length()
    is_long = known.polynomial.length() > terms and known.exact is None
    if not is_long and (by == 0 or (known.polynomial.length() <= 1 and not known.choices and not known.has_bounds)):
        return known
    if known.exact is not None:
        return Enclosure.from_polynomial(known.exact(fmpq_poly([by, 1])))
    choices = tuple(shift(each, by, brief) for each in known.choices)
    least, most = (None if p is None else p(fmpq_poly([by, 1])) for p in (known.least, known.most))
    polynomial, error = known.polynomial, known.error
    if brief is None or not is_long:
        polynomial = polynomial(arb_poly([arb(by), 1]))
    else:
        polynomial, rest = _expand(polynomial, by, brief, terms)
        error = (error + rest).upper()
    return Enclosure(polynomial, error, None, choices, None, least, most)


def _expand(polynomial: arb_poly, by: fmpq, length: fmpq, terms: int) -> tuple[arb_poly, arb]:
    """The first Taylor coefficients at a place, and what all others can add on a stretch from there on."""
    here, derivative, powers, share = arb(by), polynomial, [], arb(1)
    for n in range(1, terms):
        powers.append(derivative(here) * share)
        derivative, share = derivative.derivative(), share / n
    rest = abs(derivative(here.union(arb(by + length))) * share) * arb(length) ** (terms - 1)
    return arb_poly(powers), rest


def round_to_precision(known: Enclosure, length: fmpq) -> Enclosure:
    """The same at the working precision, without powers that count for nothing on a stretch."""
    return shorten(Enclosure(known.polynomial * arb(1), known.error, known.exact), length)


def shorten(known: Enclosure, length: fmpq) -> Enclosure:
    """Without the highest powers, as far as they count for less on a stretch than the last bit of the first ones."""
    powers = known.polynomial.coeffs()
    if known.exact is not None or len(powers) < 2:
        return known
    bits, count, rest = ctx.prec, len(powers), arb(0)
    with ctx.workprec(_COARSE):
        h = arb(length)
        size = max((abs(c) * h**k).upper() for k, c in enumerate(powers[:_FIRST]))
        least = size * arb(2) ** (-bits - 4)
        while count and (more := (rest + abs(powers[count - 1]) * h ** (count - 1)).upper()) <= least:
            rest = more
            count -= 1
    if count == len(powers):
        return known
    return replace(known, polynomial=arb_poly(powers[:count]), error=(known.error + rest).upper())
