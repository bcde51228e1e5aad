"""One structure with all its records: its modes are found once, and the records go through it together."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from wavesym.errors import WavesymError
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest, rational
from wavesym.programs.modes.evaluator import modal_model
from wavesym.programs.modes.loads import Roughness, sampled_roughness
from wavesym.records.load import RecordedLoad
from wavesym.results.many_records import ManyRecords, SharedModes
from wavesym.results.statistics import RUNTIME_ARRAYS
from wavesym.scene import Scene, lower
from wavesym.scene.paths import replace_at_path
from wavesym.sweeps.batches import Place
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.record_files import Unreadable
from wavesym.sweeps.single import extremes_and_history, instants
from wavesym.sweeps.values import CaseValues

_PROBES = {False: ["0", "1"], True: ["1", "1"]}
"""Samples of a record that tells what a scene makes of all records with the same spacing and units: of those whose
first sample is 0, and of those that begin with a jump."""


def serves(plan: SweepPlan) -> bool:
    """Whether records that share a structure can be computed together: true extremes and histories of one record."""
    loads = plan.fields.get("load", ())
    return (
        plan.records is not None
        and len(plan.records.values) > 1
        and set(plan.summary) <= set(RUNTIME_ARRAYS)
        and len(loads) == 1
    )


def record_cases(plan: SweepPlan, places: Sequence[Place]) -> Iterator[tuple[Place, CaseValues]]:
    """The cases of one structure, as far as modes serve them to the scene's tolerance; the others are left out."""
    values = plan.records.values  # type: ignore[union-attr]
    alike: dict[tuple[bool, str], list[Place]] = {}
    for place in places:
        record = values[place[-1]]
        if not isinstance(record, Unreadable):
            head = json.dumps({key: each for key, each in record.items() if key != "samples"}, sort_keys=True)
            alike.setdefault((doubles(key(record)).jumps, head), []).append(place)
    for (jumps, head), some in alike.items():
        if structure := _structure(plan, some[0], jumps, head):
            with suppress(WavesymError):
                yield from _share_structure(
                    plan, structure, [(place, doubles(key(values[place[-1]]))) for place in some]
                )


class _Structure(NamedTuple):
    """A model with one load, and its modes."""

    model: Model
    load: RecordedLoad
    modes: SharedModes


_STRUCTURES: dict[tuple[str, Place, bool, str], _Structure | None] = {}


def _structure(plan: SweepPlan, place: Place, jumps: bool, head: str) -> _Structure | None:
    """That of a case without its samples, of which is known whether they begin with a jump; None where modes do not
    serve it. The last one is kept."""
    name = plan.sha256, place[:-1], jumps, head
    if name not in _STRUCTURES:
        _STRUCTURES.clear()
        _STRUCTURES[name] = None
        with suppress(WavesymError):
            path = plan.records.path  # type: ignore[union-attr]
            scene = Scene(
                **replace_at_path(plan.fields_at(place), path, {**json.loads(head), "samples": _PROBES[jumps]})
            )
            model, (load,) = lower(scene), scene.load
            if isinstance(load, RecordedLoad):
                _STRUCTURES[name] = _Structure(
                    model, load, SharedModes(modal_model(model), nearest(rational(load.step)))
                )
    return _STRUCTURES[name]


def _share_structure(
    plan: SweepPlan, structure: _Structure, records: Sequence[tuple[Place, _Samples]]
) -> Iterator[tuple[Place, CaseValues]]:
    """Those of records that a structure takes alike."""
    model, load = structure.model, structure.load
    # a record begins with a jump, where its first sample is at tau = 0 and is not 0: nothing for modes, unless damping
    # lets it begin later
    late = load.begin > 0
    fit = [(place, each) for place, each in records if late or not each.jumps]
    if not fit:
        return
    h, begin = rational(load.step), rational(load.begin - load.step if late else load.begin)
    if begin >= model.until:
        return
    steps = ceil(Fraction(int((span := (model.until - begin) / h).p), int(span.q)))
    samples = np.zeros((len(fit), steps + 2, 1))
    for row, (_, each) in zip(samples, fit, strict=True):
        given = each.values if late else each.values[1:]
        count = min(len(given), steps + 1)
        row[1 : count + 1, 0] = given[:count]
    factor = nearest(rational(load.record.samples[1] * load.scale))
    rough = [[each.late if late else each.early] for _, each in fit]
    many = ManyRecords(factor * samples, nearest(begin), nearest(h), rough, np.full((len(fit), 1), factor))
    found = structure.modes.extremes(many, instants(model, plan.histories) if plan.histories else ())
    how = f"{found.modes} modes, all records of a structure together"
    for k, (place, _) in enumerate(fit):
        if found.bounds[k] <= nearest(model.tolerance):
            extremes, bound = (found.values[k], found.taus[k]), float(found.bounds[k])
            yield place, extremes_and_history(plan, model, bound, extremes, found.histories[k], how)


@dataclass(frozen=True)
class _Samples:
    """A record in doubles, whether its first sample is not 0, and its roughness where it begins at tau = 0 and where it
    rises to its first sample."""

    jumps: bool
    values: Array
    early: Roughness
    late: Roughness


def key(record: dict[str, Any]) -> tuple[str, ...]:
    return tuple(record["samples"])


@lru_cache(2048)
def doubles(written: tuple[str, ...]) -> _Samples:
    values = np.array([_double(each) for each in written])
    return _Samples(
        bool(values[0]), values, sampled_roughness(values), sampled_roughness(np.concatenate([[0.0], values]))
    )


def _double(written: str) -> float:
    """The double nearest to a ratio, as records are dumped: Python divides integers exactly, then rounds once."""
    above, _, below = written.partition("/")
    return int(above) / int(below or 1)
