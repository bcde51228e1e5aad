"""Many records through one structure, by modes that all of them share: extremes, also between samples, and histories.

Outputs are known at the samples and halfway between, by `RecordResponse`. How far they bend there tells how much higher
a top in between may be; the steps that may have the highest one are looked at closely. Nothing of that is
proved, as in `sampling`. That the modes are enough is: for each record.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil, inf, prod
from threading import local
from typing import Any, NamedTuple

import numpy as np

from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.modes.loads import Roughness, scaled_roughness
from wavesym.programs.modes.records import Places, RecordResponse
from wavesym.programs.modes.truncation import ModalModel
from wavesym.results.near_zero import zero_within

_PARTS = 2
_PER_STEP, _PER_CROSSING = 16, 4  # samples of a closer look, as of `stepping`
_SAFE = 2.0  # of how much higher than the samples a top may be
_EQUAL = 1e-14
_AT_ONCE = 1 << 18  # numbers of an array: what a cache holds
_RECORDS = 64  # whose states are kept at a time
_ROUNDING = 64 * 2.0**-53
_ATTEMPTS, _MOST_MODES = 4, 600
_HARDEST = 3  # records that tell how many modes all of them need
_NEARER = 8  # times, in the second look at a top


@dataclass(frozen=True)
class ManyRecords:
    """Records of the loads of a model: `samples` (records, n, loads) as the model takes them, the first of them 0 at
    tau = `begin`, and `spacing` apart; `rough` are those of each record and load, of samples 1 apart and `factors`
    (records, loads) times smaller."""

    samples: Array
    begin: float
    spacing: float
    rough: Sequence[Sequence[Roughness]]
    factors: Array

    def select(self, which: Sequence[int]) -> ManyRecords:
        """Those of them."""
        rough, rows = [self.rough[k] for k in which], list(which)
        return ManyRecords(self.samples[rows], self.begin, self.spacing, rough, self.factors[rows])

    def roughness(self, record: int, until: float) -> list[Roughness]:
        """Those of the loads of a record, as the model takes them, by tau = `until`."""
        return [
            scaled_roughness(rough, self.begin, self.spacing, factor, until)
            for rough, factor in zip(self.rough[record], self.factors[record].tolist(), strict=True)
        ]

    @property
    def hardest(self) -> ManyRecords:
        """Those that are likely to need most modes: the roughest beside their size."""
        sizes = np.linalg.norm(self.samples, axis=(1, 2))
        kinks = np.linalg.norm(
            [[np.linalg.norm(rough.kinks) for rough in loads] for loads in self.rough] * np.abs(self.factors), axis=1
        )
        rough = np.divide(kinks, sizes, out=np.zeros_like(kinks), where=sizes > 0)
        return self.select(np.argsort(-rough, kind="stable")[:_HARDEST].tolist())


@dataclass(frozen=True)
class RecordedExtremes:
    """The least and the greatest value of outputs and their tau, (records, outputs, 2), and of each record the bound of
    the error of values, relative to each output's largest; of those whose bound is too large nothing is to be used.

    `histories` are the outputs at the instants that were asked for, (records, outputs, instants).
    """

    values: Array
    taus: Array
    bounds: Array
    modes: int
    histories: Array


class SharedModes:
    """The modes of a model under records with this spacing: its own loads are one of them, or any that do not jump.

    UnservedError for what modes do not serve.
    """

    def __init__(self, chain: ModalModel[Any], spacing: float) -> None:
        self._chain, self._spacing = chain, spacing
        self._known: dict[int, _Modes] = {}
        self._modes(self._chain.fewest)

    def _modes(self, count: int) -> _Modes:
        """The first modes, found once."""
        if count not in self._known:
            chain, known = self._chain, self._chain.project(count)
            response = RecordResponse(chain.system(known, count), self._spacing, _PARTS)
            self._known[count] = _Modes(chain, known, count, response)
        return self._known[count]

    def extremes(self, records: ManyRecords, instants: Sequence[float] = ()) -> RecordedExtremes:
        """Those under each of many records. ToleranceError as for `modal_system`."""
        found = _enough(self._modes, self._chain, records.hardest, self._chain.fewest)
        if len(records.samples) > _HARDEST:
            found = _enough(self._modes, self._chain, records, self._fewest(records.hardest, found))
        histories = _histories(self._modes(found.modes).response, records, np.array(instants, dtype=np.float64))
        return replace(found, histories=histories)

    def _fewest(self, records: ManyRecords, found: RecordedExtremes) -> int:
        """As few modes as leave half of the tolerance of what was found by more of them."""
        chain, known = self._chain, self._modes(found.modes).projection
        allowed = nearest(chain.model.tolerance) / 2 * np.abs(found.values).max(axis=2)
        rough = [records.roughness(k, chain.model.horizon()) for k in range(len(records.samples))]
        low, high = min(chain.least, found.modes) - 1, found.modes
        while high - low > 1:
            middle = (low + high) // 2
            enough = np.all([chain.errors(known, middle, each) for each in rough] <= allowed)
            low, high = (low, middle) if enough else (middle, high)
        return high


class _Modes(NamedTuple):
    """The first modes of a chain, and what records do to them."""

    chain: ModalModel[Any]
    projection: Any
    number: int
    response: RecordResponse


def _enough(
    modes: Callable[[int], _Modes], chain: ModalModel[Any], records: ManyRecords, count: int
) -> RecordedExtremes:
    """By as many modes as the tolerance needs, from `count` on, or as are worth it."""
    tolerance, most = nearest(chain.model.tolerance), min(_MOST_MODES, chain.most)
    for _ in range(_ATTEMPTS):
        found = _by_modes(modes(count), records)
        # a record that needs far more modes than the others is better off alone
        worst = float(found.bounds[found.bounds < inf].max(initial=0.0))
        if worst <= tolerance or count >= most:
            break
        count = min(ceil(count * min(max(1.1 * (worst / tolerance) ** 0.6, 1.3), 8.0)), max(most, count))
    return found


def _by_modes(modes: _Modes, records: ManyRecords) -> RecordedExtremes:
    """By some modes, with what those that are left out can add."""
    chain, known, count, response = modes
    model = chain.model
    parts = range(0, len(records.samples), _RECORDS)
    found = [_extremes(response, model, records.begin, records.samples[first : first + _RECORDS]) for first in parts]
    values, taus = (np.concatenate(each) for each in zip(*found, strict=True))
    largest = np.abs(values).max(axis=2)
    horizon = model.horizon()
    errors = np.array([chain.errors(known, count, records.roughness(k, horizon)) for k in range(len(records.samples))])
    errors += _ROUNDING * np.sqrt(records.samples.shape[1]) * largest
    errors[:, np.array(chain.zero_outputs)] = 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(errors == 0, 0.0, errors / np.maximum(largest - errors, 0.0))
    bounds = np.nan_to_num(relative, nan=inf, posinf=inf).max(axis=1, initial=0.0)
    zero_within(values, taus, bounds[:, None, None], 0.0)  # all are at rest at first
    return RecordedExtremes(values, taus, bounds, count, np.empty((*values.shape[:2], 0)))


def _histories(response: RecordResponse, records: ManyRecords, taus: Array) -> Array:
    """Values at tau, (records, outputs, instants)."""
    count, n, _ = records.samples.shape
    made = np.zeros((count, len(response.system.direct), len(taus)))
    if not len(taus):
        return made
    (later_instants,) = np.nonzero(taus > records.begin)
    since = taus - records.begin
    step = np.clip((since / records.spacing).astype(np.intp), 0, n - 2)
    later = np.maximum(since - step * records.spacing, 0.0)
    for first in range(0, count, _RECORDS):
        samples = records.samples[first : first + _RECORDS]
        known, rows = response.block_states(samples), np.arange(len(samples))
        for begin in range(0, len(later_instants), _RECORDS):
            at = later_instants[begin : begin + _RECORDS]
            record, steps = (each.ravel() for each in np.meshgrid(rows, step[at]))
            inside = response.step_states(samples, known, record, steps).reshape(len(at), len(rows), -1)
            made[first : first + _RECORDS, :, at] = (inside @ response.reads(later[at])).transpose(1, 2, 0)
    return made


def _extremes(response: RecordResponse, model: Model, begin: float, samples: Array) -> tuple[Array, Array]:
    """Values and tau, (records, outputs, 2), under samples (records, n, loads)."""
    records, n, _ = samples.shape
    end = (model.horizon() - begin) / response.spacing  # in steps
    known, outputs = response.block_states(samples), len(model.probes)
    each = max(1, _AT_ONCE // (n * _PARTS * outputs))
    parts = []
    for first in range(0, records, each):
        here = slice(first, first + each)
        shape = len(samples[here]), known.shape[1], outputs, _PARTS, response.steps
        number, *rest = _candidates(response.in_blocks(known[here], samples[here], _room("seen", shape)), end)
        parts.append((number + first, *rest))
    # and of all of them the last step, which may be a part of one
    if (whole := _whole(end)) < end - 1e-9 and whole < n - 1:
        number, output, side = (each.ravel() for each in np.indices((records, outputs, 2)))
        parts.append((number, output, side, np.full(len(number), whole)))
    record, output, side, step = (np.concatenate(each) for each in zip(*parts, strict=True))
    length = response.spacing * np.where(step < whole, 1.0, end - whole)
    crossing = nearest(model.network.shortest)
    points = max(_PER_STEP, ceil(response.spacing / (crossing / _PER_CROSSING))) + 1
    places, row = np.unique(record * n + step, return_inverse=True)
    inside = response.step_states(samples, known, *np.divmod(places, n))
    group = (record * outputs + output) * 2 + side
    best, when = _tops(response, _SuspectSteps(group, step, output, 2.0 * side - 1.0, length, inside[row]), points)
    values, taus = np.zeros((records, outputs, 2)), np.full((records, outputs, 2), begin)
    which = np.unique(group)
    values.ravel()[which] = best
    taus.ravel()[which] += when
    # never above rest, or below: at rest from the very start
    none = np.array([-1.0, 1.0]) * values <= _EQUAL * np.abs(values).max(axis=2, keepdims=True)
    values[none], taus[none] = 0.0, 0.0
    return values, taus


def _candidates(seen: Array, end: float) -> tuple[Places, Places, Places, Places]:
    """Of what is seen in blocks the record, the output, the side (0 the least value, 1 the greatest) and the step, for
    each step before the `end` that may have an extreme."""
    _, blocks, outputs, _, steps = seen.shape
    middle, last = seen[:, :, :, 0], seen[:, :, :, 1]
    number = np.arange(blocks * steps).reshape(blocks, 1, steps)
    whole = _whole(end)
    after = np.arange(blocks) >= end // steps
    for values, reached in ((middle, end - 0.5), (last, end - 1.0)):
        values[:, after] = np.where(number[after] <= reached + 1e-9, values[:, after], 0.0)
    bent = np.multiply(middle, -2.0, out=_room("bent", middle.shape))
    bent += last
    bent[..., 1:] += last[..., :-1]
    bent[:, 1:, :, 0] += last[:, :-1, :, -1]
    bent[:, after] = np.where(number[after] < whole, bent[:, after], 0.0)
    higher: Array = _SAFE / 8 * np.maximum(bent.max(axis=1), -bent.min(axis=1)).max(axis=-1)
    greatest = np.maximum(seen.max(axis=1).max(axis=(-2, -1)), 0.0)
    least = np.minimum(seen.min(axis=1).min(axis=(-2, -1)), 0.0)
    moved = greatest > least
    high = np.where(moved, greatest - higher, np.inf)[:, None, :, None, None]
    low = np.where(moved, least + higher, -np.inf)[:, None, :, None, None]
    keys = []
    for side, (compare, limit) in enumerate(((np.less_equal, low), (np.greater_equal, high))):
        found = compare(seen, limit, out=_room("found", seen.shape, np.bool_))
        record, block, output, part, place = np.unravel_index(np.flatnonzero(found), seen.shape)
        step = block * steps + place
        key = ((record * outputs + output) * 2 + side) * (blocks * steps)
        keys += [(key + step)[step < whole], (key + step + 1)[(part == 1) & (step + 1 < whole)]]
    group, step = np.divmod(np.unique(np.concatenate(keys)), blocks * steps)
    record, rest = np.divmod(group, outputs * 2)
    return record, *np.divmod(rest, 2), step


@dataclass(frozen=True)
class _SuspectSteps:
    """What is looked at, each an array over steps: the `group` that it is one of, the `step` and the `output`, the
    `sign` of what is high, how long the step is, and what is known `inside` it (steps, numbers)."""

    group: Places
    step: Places
    output: Places
    sign: Array
    length: Array
    samples: Array


def _tops(response: RecordResponse, steps: _SuspectSteps, points: int) -> tuple[Array, Array]:
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


def _signed_values(response: RecordResponse, steps: _SuspectSteps, points: int) -> Array:
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


_ROOMS = local()


def _room(name: str, shape: tuple[int, ...], kind: type[Any] = np.float64) -> Any:
    """An array in memory that the thread keeps: new memory may cost more than what is computed in it."""
    kept = getattr(_ROOMS, name, None)
    if kept is None or len(kept) < prod(shape):
        kept = np.empty(prod(shape), kind)
        setattr(_ROOMS, name, kept)
    return kept[: prod(shape)].reshape(shape)


def _whole(end: float) -> int:
    """The steps that end by then."""
    return int(end + 1e-9 / _PARTS)
