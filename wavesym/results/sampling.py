"""Extremes of outputs that are known only by values: the largest of many samples, then ever finer ones around it.

A sample that is above both its neighbours has a top between them. The tops that may be the highest are looked at with
_FINER samples at a time, in a part that shrinks to the two steps around the largest one. Nothing here is proved: a top
that is narrower than a step is not seen. Every value is one that the output takes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array
from wavesym.results.near_zero import zero_within

Evaluate = Callable[[Array], Array]

_FINER = 65
_ROUNDS = 2  # each makes a part 1/32 as wide; a march goes over the whole horizon in each
_TOPS = 3  # of an output and a side that are looked at
_TWINS = 1e-15  # relative: neighbouring doubles
_EQUAL = 1e-14  # of the largest value: rounding makes no later instant of a plateau higher


def sampled_extremes(
    taus: Array, values: Array, each: Evaluate | None = None, bound: Array | float = 0.0
) -> tuple[Array, Array]:
    """Values and tau, each (outputs, 2), of the least and the greatest value; the first of equal ones.

    `values` (outputs, taus) are those at `taus`, which are in order. What lies between is looked at where there is
    `each`, which gives each output at instants of its own, (outputs, n). What is within the `bound` of the error of
    values (relative to an output's largest, one for all or (outputs, 1)) of 0 is 0, at the first sample that is, too.
    """
    both = np.stack([-values, values], axis=1)  # (outputs, sides, taus): greatest values are looked for in each
    equal = _EQUAL * np.abs(values).max(axis=1)[:, None]
    at = (both >= both.max(axis=2, keepdims=True) - equal[:, :, None]).argmax(axis=2)
    best, when = np.take_along_axis(both, at[:, :, None], axis=2)[:, :, 0], taus[at]
    if each is not None and taus.size > 2:
        for found, tau in _refine(each, taus, _tops(both)):
            better = found > best + equal
            best[better], when[better] = found[better], tau[better]
    best = best * [-1.0, 1.0] + 0.0
    near = np.abs(values) <= bound * np.abs(best).max(axis=1)[:, None]
    first = np.where(near.any(axis=1), taus[near.argmax(axis=1)], np.inf)
    zero_within(best, when, bound, np.minimum(when, first[:, None]))
    return best, when


def _tops(both: Array) -> NDArray[np.intp]:
    """The highest samples that no neighbour is above, of each output and side: (outputs, sides, tops).

    A parabola through three samples rises above the middle one by at most an eighth of its height over the lower one.
    What would have to rise by all of that, and does not reach the highest sample then, gives its place to that one.
    """
    inner, before, after = both[:, :, 1:-1], both[:, :, :-2], both[:, :, 2:]
    top = np.where((inner >= before) & (inner > after), inner, -np.inf)
    kept = min(_TOPS, inner.shape[2])
    at = np.argpartition(top, -kept, axis=2)[:, :, -kept:]
    reach = np.take_along_axis(2 * inner - np.minimum(before, after), at, axis=2)
    highest = top.argmax(axis=2)[:, :, None]
    return np.asarray(np.where(reach < np.take_along_axis(inner, highest, axis=2), highest, at)) + 1


def _neighbours(taus: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The sample before each and the one after it: of the two sides of what may jump not the other side."""
    place = np.arange(taus.size)
    twins = np.diff(taus) <= _TWINS * np.abs(taus[1:])
    before, after = place - 1, place + 1
    before[1:][twins] -= 1
    after[:-1][twins] += 1
    return np.maximum(before, 0), np.minimum(after, taus.size - 1)


def _refine(each: Evaluate, taus: Array, tops: NDArray[np.intp]) -> Iterator[tuple[Array, Array]]:
    """Of ever finer samples around the `tops` the highest values, top by top, (outputs, sides), and their tau."""
    before, after = _neighbours(taus)
    low, high = taus[before[tops]], taus[after[tops]]
    for _ in range(_ROUNDS):
        finer = np.linspace(low, high, _FINER, axis=3)  # (outputs, sides, tops, finer)
        values = each(finer.reshape(len(finer), -1)).reshape(finer.shape) * np.array([-1.0, 1.0])[:, None, None]
        place = values.argmax(axis=3)[:, :, :, None]
        found, tau = (np.take_along_axis(each, place, axis=3)[:, :, :, 0] for each in (values, finer))
        yield from ((found[:, :, k], tau[:, :, k]) for k in range(tops.shape[2]))
        step = (high - low) / (_FINER - 1)
        low, high = np.maximum(tau - step, low), np.minimum(tau + step, high)
