"""The highest of many tops: steps of records looked at closely, each for one output, and the best of them twice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array
from wavesym.programs.modes.records import RecordResponse

Places = NDArray[np.intp]

_NEARER = 8  # times, in the second look at a top


@dataclass(frozen=True)
class SuspectSteps:
    """What is looked at, each an array over steps: the `group` that it is one of, the `step` and the `output`, the
    `sign` of what is high, how long the step is, and what is known `inside` it (steps, numbers)."""

    group: Places
    step: Places
    output: Places
    sign: Array
    length: Array
    samples: Array


def tops(response: RecordResponse, steps: SuspectSteps, points: int) -> tuple[Array, Array]:
    """Of each group, in order, the greatest value times its sign, as it is, and when, since records begin."""
    values = _signed_values(response, steps, points)
    before, here, after = values[:, :-2], values[:, 1:-1], values[:, 2:]
    bend = 2 * here - before - after
    top = (bend > 0) & (np.abs(after - before) <= 2 * bend)  # within a point of the middle one
    estimate = values.copy()
    estimate[:, 1:-1] += np.where(top, (after - before) ** 2 / (8 * np.where(top, bend, 1.0)), 0.0)
    order = np.lexsort((steps.step, -estimate.max(axis=1), steps.group))
    _, firsts = np.unique(steps.group[order], return_index=True)
    row = order[firsts]
    length, output, sign, inside = steps.length[row], steps.output[row], steps.sign[row], steps.samples[row]
    point, each = estimate[row].argmax(axis=1), np.arange(len(row))
    apart, values = length / (points - 1), values[row]
    s, value = point * apart, values[each, point]

    near = np.clip(point, 1, points - 2)
    shift = _vertex(values[each, near - 1], values[each, near], values[each, near + 1])
    finer = apart / _NEARER
    middle = np.clip((near + shift) * apart, finer, length - finer)
    thrice = np.concatenate([middle + k * finer for k in (-1, 0, 1)])
    trio = np.tile(sign, 3) * response.value_at(np.tile(inside, (3, 1)), thrice, np.tile(output, 3))
    trio = trio.reshape(3, -1)
    last = middle + _vertex(*trio) * finer
    for at, found in ((middle, trio[1]), (last, sign * response.value_at(inside, last, output))):
        better = found > value
        value, s = np.where(better, found, value), np.where(better, at, s)
    return sign * value, steps.step[row] * response.spacing + s


def _signed_values(response: RecordResponse, steps: SuspectSteps, points: int) -> Array:
    """Values times their sign at equally spaced instants of each step, its ends included: (steps, points)."""
    made = np.empty((len(steps.step), points))
    for length in np.unique(steps.length).tolist():
        reads = response.reads(length * np.arange(points) / (points - 1))
        of_length = steps.length == length
        for output in range(reads.shape[2]):
            rows = np.flatnonzero(of_length & (steps.output == output))
            made[rows] = steps.samples[rows] @ reads[:, :, output].T
    made *= steps.sign[:, None]
    return made


def _vertex(before: Array, here: Array, after: Array) -> Array:
    """Where a parabola through three values has its top, in steps from the middle one; 0 where it has none there."""
    bend = 2 * here - before - after
    safe = np.where(bend > 0, bend, 1.0)
    return np.clip(np.where(bend > 0, (after - before) / (2 * safe), 0.0), -1.0, 1.0)
