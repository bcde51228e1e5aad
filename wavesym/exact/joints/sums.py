"""Sums of waves with exact factors, and all that stays known of them: that they are exact, begin as an exact function
does, lie on one side of one, or are one of a few functions at each instant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from math import prod

from flint import arb, arb_poly, fmpq, fmpq_poly

from wavesym.exact.joints.joint import Enclosed
from wavesym.exact.joints.network_waves import weighted
from wavesym.exact.joints.onset import Onset, combined

Terms = list[tuple[fmpq, Enclosed]]
"""A sum with exact factors."""

_CHOICES = 8  # of functions, that are told apart


def scaled(terms: Terms, factor: fmpq) -> Terms:
    """Each times a factor."""
    return [(factor * each, known) for each, known in terms] if factor != 0 else []


def together(terms: Terms) -> Enclosed:
    """A sum with exact factors; exact where all of it is. What is in it twice is one."""
    counted = collected(terms)
    number = prod(len(known.choices) or 1 for _, known in counted)
    if number == 1:
        return _added(counted)
    if number > _CHOICES:
        return weighted(counted)
    ways = product(*(known.choices or (known,) for _, known in counted))
    factored = [factor for factor, _ in counted]
    hull = told(weighted(counted), None, *_bounds(counted))
    return _one_of(hull, [_added(list(zip(factored, way, strict=True))) for way in ways])


def collected(terms: Terms) -> Terms:
    """Each known function once, and none whose factors cancel."""
    factors: dict[int, fmpq] = {}
    parts: dict[int, Enclosed] = {}
    for factor, known in terms:
        parts[id(known)] = known
        factors[id(known)] = factors.get(id(known), fmpq(0)) + factor
    return [(factor, parts[each]) for each, factor in factors.items() if factor != 0]


def _added(terms: Terms) -> Enclosed:
    exact = fmpq_poly()
    for factor, known in terms:
        if known.exact is None:
            if not any(other.onset or other.bounded for _, other in terms):
                return weighted(terms)
            begin = [(factor, begins) for factor, known in terms if (begins := known.begins) is not None]
            onset = combined(begin) if len(begin) == len(terms) else None
            return told(weighted(terms), onset, *_bounds(terms))
        exact += factor * known.exact
    return Enclosed.of(exact)


def _bounds(terms: Terms) -> tuple[fmpq_poly | None, fmpq_poly | None]:
    """What a sum is not below, and not above, as far as that is known exactly."""
    found: list[fmpq_poly | None] = []
    for side in (0, 1):
        parts = [(factor, known.bounds[side if factor > 0 else 1 - side]) for factor, known in terms]
        bounds = [factor * p for factor, p in parts if p is not None]
        found.append(sum(bounds, fmpq_poly()) if len(bounds) == len(terms) else None)
    return found[0], found[1]


def told(hull: Enclosed, onset: Onset | None, least: fmpq_poly | None, most: fmpq_poly | None) -> Enclosed:
    """What is within a hull, with what else is known of it."""
    if onset is None and least is None and most is None:
        return hull
    return replace(hull, onset=onset, least=least, most=most)


def _one_of(hull: Enclosed, functions: Sequence[Enclosed]) -> Enclosed:
    """What is within a hull and, at each instant, one of some functions; those that are known count once."""
    different: list[Enclosed] = []
    for each in functions:
        if each.exact is None or all(each.exact != other.exact for other in different):
            different.append(each)
    if len(different) == 1:
        return different[0]
    return replace(hull, choices=tuple(different) if len(different) <= _CHOICES else ())


def one_at_each_instant(functions: Sequence[Enclosed], span: arb) -> Enclosed:
    """One of these at each instant: all their values on a stretch."""
    hull = functions[0].over(span)
    for known in functions[1:]:
        hull = hull.union(known.over(span))
    return _one_of(
        Enclosed(arb_poly([hull.mid()]), hull.rad()),
        [each for known in functions for each in known.choices or (known,)],
    )
