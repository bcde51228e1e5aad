"""Extremes of many records through one structure, also between samples, by modes that all of them share.

Outputs are known at the samples and halfway between, by `RecordResponse`. How far they bend there tells how much higher
a top in between may be; the steps that may have the highest one are looked at closely. Nothing of that is proved, as in
`sampled`. That the modes are enough is: for each record.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.programs.modes.records import RecordResponse
from wavesym.programs.modes.roughness import Roughness, scaled
from wavesym.programs.modes.system import modal_chain

Numbers = NDArray[np.float64]
Places = NDArray[np.intp]

_PARTS = 2
_PER_STEP, _PER_CROSSING = 16, 4  # samples of a closer look, as of `stepping`
_SAFE = 2.0  # of how much higher than the samples a top may be
_NEARER = 8  # times, in the second look at a top
_EQUAL = 1e-14
_AT_ONCE = 1 << 18  # numbers of an array: what a cache holds
_ROUNDING = 64 * 2.0**-53
_ATTEMPTS, _MOST_MODES = 4, 600


@dataclass(frozen=True)
class ManyRecords:
    """Records for a model with one load: `samples` (records, n) as the model takes them, the first of them 0 at tau =
    `begin`, and `spacing` apart; `rough` are theirs, of samples 1 apart and `factor` times smaller."""

    samples: Numbers
    begin: float
    spacing: float
    rough: Sequence[Roughness]
    factor: float


@dataclass(frozen=True)
class RecordedExtremes:
    """The least and the greatest value of outputs and their tau, (records, outputs, 2), and of each record the bound of
    the error of values, relative to each output's largest; of those whose bound is too large nothing is to be used."""

    values: Numbers
    taus: Numbers
    bounds: Numbers
    modes: int


def recorded_extremes(model: Model, records: ManyRecords) -> RecordedExtremes:
    """Those of a model under each of many records; its own load is one of them, or any other that does not jump.

    UnservedError for what modes do not serve, ToleranceError as for `modal_system`.
    """
    chain, tolerance = modal_chain(model), nearest(model.tolerance)
    count = chain.fewest
    for attempt in range(_ATTEMPTS):
        known = chain.shares(count)
        system = chain.system(known, count)
        values, taus = _extremes(RecordResponse(system, records.spacing, _PARTS), model, records)
        largest = np.abs(values).max(axis=2)
        errors = np.array(
            [
                chain.errors(
                    known, count, [scaled(rough, records.begin, records.spacing, records.factor, model.horizon())]
                )
                for rough in records.rough
            ]
        ) + _ROUNDING * largest * np.sqrt(records.samples.shape[1])
        errors[:, np.array(chain.silent)] = 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            bounds = np.where(errors > 0, errors / np.maximum(largest - errors, 0.0), 0.0).max(axis=1, initial=0.0)
        # a record that needs far more modes than the others is better off alone
        worst = float(bounds[bounds < inf].max(initial=0.0))
        most = min(_MOST_MODES, chain.most)
        if worst <= tolerance or count >= most or attempt == _ATTEMPTS - 1:
            break
        count = min(ceil(count * min(max(1.1 * (worst / tolerance) ** 0.6, 1.3), 8.0)), max(most, count))
    return RecordedExtremes(values, taus, bounds, count)


def _extremes(response: RecordResponse, model: Model, records: ManyRecords) -> tuple[Numbers, Numbers]:
    """Values and tau, (records, outputs, 2)."""
    count, n = records.samples.shape
    each = max(1, _AT_ONCE // (n * _PARTS * len(model.probes)))
    end = (model.horizon() - records.begin) / records.spacing  # in steps
    states, candidates = [], []
    for first in range(0, count, each):
        coarse = response.respond(records.samples[first : first + each])
        states.append(coarse.states)
        candidates.append(_candidates(coarse.values[:, : int(end * _PARTS + 1e-9)]))
    steps = _looked_at(response, model, records, np.concatenate(states), np.concatenate(candidates), end)
    (least, early), (greatest, late) = (_tops(response, steps, count, sign) for sign in (-1.0, 1.0))
    values, taus = np.stack([-least, greatest], axis=2), records.begin + np.stack([early, late], axis=2)
    # never above rest, or below: at rest from the very start
    none = np.array([-1.0, 1.0]) * values <= _EQUAL * np.abs(values).max(axis=2, keepdims=True)
    values[none], taus[none] = 0.0, 0.0
    return values, taus


def _candidates(seen: Numbers) -> NDArray[np.bool_]:
    """The steps, (records, steps), that may have the least or the greatest value of an output."""
    whole = seen.shape[1] // _PARTS
    middle, end = seen[:, : whole * _PARTS : 2], seen[:, 1 : whole * _PARTS : 2]
    bent = np.empty_like(middle)
    np.add(end[:, 1:], end[:, :-1], out=bent[:, 1:])
    bent[:, 0] = end[:, 0]
    bent -= middle
    bent -= middle
    higher = _SAFE / 8 * np.maximum(bent.max(axis=1), -bent.min(axis=1))
    greatest = np.maximum(seen.max(axis=1), 0.0)
    least = np.minimum(seen.min(axis=1), 0.0)
    moved = greatest > least
    high = np.where(moved, greatest - higher, np.inf)[:, None]
    low = np.where(moved, least + higher, -np.inf)[:, None]
    found: NDArray[np.bool_] = np.any((seen >= high) | (seen <= low), axis=2)
    ends = found[:, 1 : whole * _PARTS : 2]
    steps: NDArray[np.bool_] = found[:, : whole * _PARTS : 2] | ends
    steps[:, 1:] |= ends[:, :-1]
    return steps


@dataclass(frozen=True)
class _Steps:
    """Steps of records that are looked at closely: what is `known` where they begin, how long they are, and the values
    at equally spaced points, ends included: (steps, points, outputs)."""

    record: Places
    step: Places
    known: Numbers
    length: Numbers
    values: Numbers


def _looked_at(
    response: RecordResponse,
    model: Model,
    records: ManyRecords,
    states: Numbers,
    candidates: NDArray[np.bool_],
    end: float,
) -> _Steps:
    """The candidates, and the last step, which may be a part of one."""
    samples, h = records.samples[:, :, None], records.spacing
    record, step = np.nonzero(candidates)
    whole = candidates.shape[1]
    length = np.full(len(record), h)
    if whole < end - 1e-9 and whole < samples.shape[1] - 1:
        rows = np.arange(len(samples))
        record, step = np.concatenate([record, rows]), np.concatenate([step, np.full(len(rows), whole)])
        length = np.concatenate([length, np.full(len(rows), (end - whole) * h)])
        order = np.argsort(record, kind="stable")
        record, step, length = record[order], step[order], length[order]
    known = response.inside(samples, states, record, step)
    crossing = nearest(min(bar.delay for bar in model.network.bars))
    points = max(_PER_STEP, ceil(h / (crossing / _PER_CROSSING))) + 1
    values = np.empty((len(record), points, len(model.probes)))
    for size in np.unique(length).tolist():
        rows = np.flatnonzero(length == size)
        reads = response.reads(size * np.arange(points) / (points - 1))
        values[rows] = np.tensordot(known[rows], reads, axes=(1, 1))
    return _Steps(record, step, known, length, values)


def _tops(response: RecordResponse, steps: _Steps, records: int, sign: float) -> tuple[Numbers, Numbers]:
    """The greatest value of each output of each record, times the sign, and when, since records begin."""
    values = sign * steps.values
    count, points, outputs = values.shape
    before, here, after = values[:, :-2], values[:, 1:-1], values[:, 2:]
    bend = 2 * here - before - after
    top = (bend > 0) & (np.abs(after - before) <= 2 * bend)  # within a point of the middle one
    safe = np.where(top, bend, 1.0)
    estimate = values.copy()
    estimate[:, 1:-1] += np.where(top, (after - before) ** 2 / (8 * safe), 0.0)
    highest = estimate.max(axis=1)
    best, when = np.zeros((records, outputs)), np.zeros((records, outputs))
    edges = np.searchsorted(steps.record, np.arange(records + 1))
    rows = np.zeros((records, outputs), np.intp)
    for record in range(records):
        low, high = edges[record], edges[record + 1]
        if low < high:
            rows[record] = low + highest[low:high].argmax(axis=0)
    there = np.repeat((edges[1:] > edges[:-1])[:, None], outputs, axis=1)
    if not count:
        return best, when
    row, output = rows[there], np.broadcast_to(np.arange(outputs), rows.shape)[there]
    point = estimate[row, :, output].argmax(axis=1)
    apart = steps.length[row] / (points - 1)
    s, value = point * apart, values[row, point, output]

    def looked(at: Numbers) -> Numbers:
        return sign * response.at(steps.known[row], at, output)

    near = np.clip(point, 1, points - 2)
    shift = _vertex(values[row, near - 1, output], values[row, near, output], values[row, near + 1, output])
    finer = apart / _NEARER
    middle = np.clip((near + shift) * apart, finer, steps.length[row] - finer)
    trio = [looked(middle + k * finer) for k in (-1, 0, 1)]
    last = middle + _vertex(*trio) * finer
    for at, seen in ((middle, trio[1]), (last, looked(last))):
        better = seen > value
        value, s = np.where(better, seen, value), np.where(better, at, s)
    best[there] = value
    when[there] = steps.step[row] * response.spacing + s
    return best, when


def _vertex(before: Numbers, here: Numbers, after: Numbers) -> Numbers:
    """Where a parabola through three values has its top, in steps from the middle one; 0 where it has none there."""
    bend = 2 * here - before - after
    safe = np.where(bend > 0, bend, 1.0)
    return np.clip(np.where(bend > 0, (after - before) / (2 * safe), 0.0), -1.0, 1.0)
