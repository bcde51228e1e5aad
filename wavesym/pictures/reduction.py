"""Polylines with more vertices than a picture has columns, reduced to what is to be seen of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array


def reduce_vertices(points: Array, until: float, columns: int) -> Array:
    """The vertices that show in so many columns of [0, until]: in each the first, the least and the greatest of them.

    One that a column ends with goes where the next one goes on in its direction; the very last vertex stays. `points`
    (n, 2) has increasing first numbers. What has few vertices stays as it is.
    """
    if len(points) <= 3 * columns:
        return points
    column = columns_of(points[:, 0], until, columns)
    starts = np.flatnonzero(np.diff(column, prepend=-1))
    ends = np.append(starts[1:], len(points))
    values = points[:, 1]
    low, high = extremes_between(values, starts, ends)
    after = values[np.minimum(ends, len(points) - 1)]
    low = low[(low < ends - 1) | (after > values[low])]
    high = high[(high < ends - 1) | (after < values[high])]
    result: Array = points[np.unique(np.concatenate([starts, low, high, ends[-1:] - 1]))]
    return result


def columns_of(tau: Array, until: float, columns: int) -> NDArray[np.intp]:
    """The column that each instant lies in; one at an edge lies in that on its right."""
    # a hair more, so that an edge that was rounded down is no instant before it
    return np.minimum((tau / until * columns + 1e-6).astype(np.intp), columns)


def extremes_between(
    values: Array, starts: NDArray[np.intp], ends: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Where the least and the greatest value is in each part, from its start to before its end; the first of equals."""
    part = np.repeat(np.arange(len(starts)), ends - starts)
    found = []
    for extreme in (np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)):
        places = np.flatnonzero(values == extreme[part])
        found.append(places[np.unique(part[places], return_index=True)[1]])
    return found[0], found[1]
