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

from wavesym.numbers.doubles import not_below, rational
from wavesym.rivals.problem import Array

_TERMS = 18  # of a series of exp, for what is at most 1: the next one is 1e-17
_AT_ONCE = 2048  # instants


@dataclass(frozen=True)
class Batch:
    """Systems that do not feel each other, at rest before the first event: x (batch, size).

    `matrix` has shape (batch, size, size); at event e x gains jumps[e], of shape (events, batch, size); outputs gain
    the sum of `shown` times x, (outputs, batch, size).
    """

    matrix: Array
    jumps: Array
    shown: Array


def stepped(batches: Sequence[Batch], events: Sequence[Fraction], until: float, step: float) -> tuple[Array, Array]:
    """Instants from 0 to `until`, and the outputs there, (outputs, instants); at an event they are what is after it.

    `events` are 0 = t_0 < t_1 < ... <= until. From one to the next instants are equally spaced, by `step` at most.
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
    values = np.zeros((len(batches[0].shown), firsts[-1] + 1))
    for batch in batches:
        shown = batch.shown.reshape(len(batch.shown), prod(batch.shown.shape[1:]))
        states, last = _at_events(batch, lengths, kind)
        values[:, -1] += shown @ last.ravel()
        for k, (length, count) in enumerate(zip(lengths, counts, strict=True)):
            here = np.flatnonzero(kind == k)
            leap = exponential(batch.matrix * (length / count))
            x, block = np.moveaxis(states[here], 0, -1), 1
            while block < count and block * len(here) < _AT_ONCE:
                x, leap, block = np.concatenate([x, leap @ x], axis=-1), leap @ leap, 2 * block
            for first in range(0, count, block):
                columns = (firsts[here] + first + np.arange(min(block, count - first))[:, np.newaxis]).ravel()
                values[:, columns] += shown @ x.reshape(shown.shape[1], x.shape[-1])[:, : len(columns)]
                x = leap @ x
    return np.concatenate([*spaced, [until]]), values


def _at_events(batch: Batch, lengths: Array, kind: NDArray[np.int_]) -> tuple[Array, Array]:
    """x after each event, (events, batch, size), and at the end; after event e comes a stretch of lengths[kind[e]]."""
    over = [exponential(batch.matrix * length) for length in lengths]
    states = np.empty_like(batch.jumps)
    x = np.zeros_like(batch.jumps[0])
    for e, k in enumerate(kind):
        states[e] = x + batch.jumps[e]
        x = (over[k] @ states[e][..., np.newaxis])[..., 0]
    return states, x


def exponential(matrix: Array) -> Array:
    """exp of matrices, (batch, size, size): a series of what is halved until it is small, then squared as often."""
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
