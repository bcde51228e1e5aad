"""Extremes that cannot be told from 0: one rule for what is found by samples, by models and for many records."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array


def is_near_zero(values: Array, bounds: Array | float, others: Array | None = None) -> NDArray[np.bool_]:
    """Which values are within the bound of 0; none where the bound is no part of an output's largest value.

    Args:
        values: the least and the greatest value of outputs, (..., 2).
        bounds: of the error of values, relative to an output's largest value; they are broadcast to (..., 2).
        others: other values of these outputs, in place of the extremes, broadcast to (..., 2).
    """
    limit = np.where(np.asarray(bounds) < 1, bounds, 0.0) * np.abs(values).max(axis=-1, keepdims=True)
    near: NDArray[np.bool_] = np.abs(values if others is None else others) <= limit
    return near


def zero_within(values: Array, taus: Array, bounds: Array | float, first: Array | float) -> None:
    """Set extremes that are within the bound of 0 to 0, at the `first` tau at which the output is that near to 0.

    Args:
        values: as of `is_near_zero`; changed in place.
        taus: when, (..., 2); changed in place.
        bounds: as of `is_near_zero`.
        first: broadcast to (..., 2).
    """
    near = is_near_zero(values, bounds)
    values[near], taus[near] = 0.0, np.broadcast_to(first, taus.shape)[near]
