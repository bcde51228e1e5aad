"""Linear systems stepped exactly from event to event, by matrix exponentials; between events x' = matrix x.

What a load does is part of x: a polynomial in time is its value and its derivatives. So a system that is at rest, moves
freely, is damped as it dies or more than that needs no case of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import prod

import numpy as np
from numpy.typing import NDArray

from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import not_below, rational

_TERMS = 18  # of a series of exp, for what is at most 1: the next one is 1e-17
_AT_ONCE = 2048  # instants


@dataclass(frozen=True)
class Systems:
    """Systems that are not coupled, at rest before the first event: x (systems, size).

    `matrix` has shape (systems, size, size); at event e x gains jumps[e], of shape (events, systems, size). The
    readings are the sum of `readings` times x, (readings, systems, size).
    """

    matrix: Array
    jumps: Array
    readings: Array


def step_systems(
    every: Sequence[Systems], events: Sequence[Fraction], until: float, step: float
) -> tuple[Array, Array]:
    """Step systems, and add up their readings.

    Args:
        every: systems with the same number of events and readings.
        events: 0 = t_0 < t_1 < ... <= until.
        until: the horizon.
        step: the largest distance of instants, which are equally spaced from one event to the next.

    Returns:
        Instants from 0 to `until`, and the readings there, (readings, instants); at an event what is after it.
    """
    ends = [*events, Fraction(until)]
    kinds: dict[Fraction, int] = {}
    kind = np.array([kinds.setdefault(after - before, len(kinds)) for before, after in pairwise(ends)])
    lengths = np.array([float(length) for length in kinds])
    counts = np.maximum(1, np.ceil(lengths / step).astype(int))
    spaced = [
        not_below(rational(start)) + lengths[k] / counts[k] * np.arange(counts[k])
        for start, k in zip(events, kind, strict=True)
    ]
    firsts = np.append(0, np.cumsum(counts[kind]))
    values = np.zeros((len(every[0].readings), firsts[-1] + 1))
    for systems in every:
        readings = systems.readings.reshape(len(systems.readings), prod(systems.readings.shape[1:]))
        states, last = _at_events(systems, lengths, kind)
        values[:, -1] += readings @ last.ravel()
        for k, (length, count) in enumerate(zip(lengths, counts, strict=True)):
            here = np.flatnonzero(kind == k)
            leap = exponential(systems.matrix * (length / count))
            x, block = np.moveaxis(states[here], 0, -1), 1
            while block < count and block * len(here) < _AT_ONCE:
                x, leap, block = np.concatenate([x, leap @ x], axis=-1), leap @ leap, 2 * block
            for first in range(0, count, block):
                columns = (firsts[here] + first + np.arange(min(block, count - first))[:, np.newaxis]).ravel()
                values[:, columns] += readings @ x.reshape(readings.shape[1], x.shape[-1])[:, : len(columns)]
                x = leap @ x
    return np.concatenate([*spaced, [until]]), values


def _at_events(systems: Systems, lengths: Array, kind: NDArray[np.int_]) -> tuple[Array, Array]:
    """x after each event, (events, systems, size), and at the end; after event e come lengths[kind[e]] of time."""
    over = [exponential(systems.matrix * length) for length in lengths]
    states = np.empty_like(systems.jumps)
    x = np.zeros_like(systems.jumps[0])
    for e, k in enumerate(kind):
        states[e] = x + systems.jumps[e]
        x = (over[k] @ states[e][..., np.newaxis])[..., 0]
    return states, x


def exponential(matrix: Array) -> Array:
    """exp of matrices, (systems, size, size): a series of what is halved until it is small, then squared as often."""
    largest = np.max(np.sum(np.abs(matrix), axis=-2), axis=-1)
    halvings = np.ceil(np.log2(np.maximum(largest, 1.0)))[:, np.newaxis, np.newaxis]
    small = matrix / 2.0**halvings
    unit = np.broadcast_to(np.eye(matrix.shape[-1]), matrix.shape)
    total = unit
    for k in range(_TERMS, 0, -1):
        total = unit + small @ total / k
    for k in range(int(np.max(halvings, initial=0.0))):
        total = np.where(halvings > k, total @ total, total)
    return np.asarray(total)
