"""Derivatives of exact values by differences of the eighth order, and how far these may be off."""

from fractions import Fraction

import numpy as np

_EIGHTH = (Fraction(4, 5), Fraction(-1, 5), Fraction(4, 105), Fraction(-1, 280))
_SIXTH = (Fraction(3, 4), Fraction(-3, 20), Fraction(1, 60), Fraction(0))


def slope_of(values, at, step):
    """The derivative of `values`, arrays of doubles that are right to the last bit, at a number, and what it may be
    wrong by: the difference between two orders, and roundings.
    """
    step = Fraction(step)
    ahead, behind = ([values(at + side * k * step) for k in range(1, 5)] for side in (1, -1))
    found = [
        sum(float(factor / step) * (a - b) for factor, a, b in zip(of, ahead, behind, strict=True))
        for of in (_EIGHTH, _SIXTH)
    ]
    size = np.max(np.abs([*ahead, *behind]), axis=0)
    return found[0], np.abs(found[0] - found[1]) + 1e-15 * size / float(step)


def beyond(found, true, slack, estimate):
    """By how much errors are surely above an estimate, relative to the largest value of each row; 1 is as much."""
    largest = np.max(np.abs(true) + slack, axis=1)
    errors = np.max(np.maximum(np.abs(found - true) - slack, 0), axis=1)
    assert np.all(errors[largest == 0] == 0)
    return float(np.max(errors[largest > 0] / largest[largest > 0], initial=0.0)) / max(estimate, 1e-300)
