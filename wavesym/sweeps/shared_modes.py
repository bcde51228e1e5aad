"""Damped structures that differ in their systems alone: modes of many found at once, under loads that they share.

Where all that is varied are numbers of modes (`mode_lanes`) cases are sets of `ModalSets`. Else each case is lowered by
itself, with next to no samples in its loads, so that whatever is varied may be: a height, the second moment of columns.
Cases whose networks have one pattern stand side by side, under the loads of the first case in the units of each.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil
from typing import Any

import numpy as np

from wavesym.errors import WavesymError
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.programs.mode_sets.modes import ModesOfSet, enough_modes, mode_sets
from wavesym.programs.mode_sets.network import pattern
from wavesym.programs.modes.loads import Numbers, Roughness, sampled_roughness
from wavesym.programs.modes.undamped import UndampedModes
from wavesym.results.many_records import ManyRecords, RecordedExtremes, SharedModes
from wavesym.results.statistics import RUNTIME_ARRAYS
from wavesym.running.mode_sets import ModalSets
from wavesym.scene import lower
from wavesym.scene.paths import steps
from wavesym.sweeps.batches import Place
from wavesym.sweeps.mode_lanes import ModeLanes, mode_lanes
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.single import instants, of_model, output_rows, spread_out
from wavesym.sweeps.values import CaseValues

_FEWEST = 8  # cases that are worth it
_MOST_MODES = 400
_MOST_SAMPLES = 1 << 20
_FEW = ["0", "1"]  # samples of a load that tell where it acts


def serves(plan: SweepPlan) -> bool:
    """Whether cases are damped structures under the same loads, and modes serve the first of them."""
    columns = [column for dimension in plan.dimensions for column in dimension.columns]
    return (
        plan.cases >= _FEWEST
        and set(plan.summary) <= set(RUNTIME_ARRAYS)
        and all(steps(column.path)[0] == "system" for column in columns)
        and _first_structure(plan) is not None
    )


def structure_cases(plan: SweepPlan, places: Sequence[Place]) -> Iterator[tuple[Place, CaseValues]]:
    """The cases that modes serve to the scene's tolerance; the others are left out."""
    if (first := _first_structure(plan)) is None:
        return
    if first.lanes:
        yield from _as_sets(plan, first, first.lanes, places)
        return
    alike: list[tuple[object, list[tuple[Place, Model]]]] = []
    for place in places:
        with suppress(WavesymError):  # by itself it says what is wrong
            model = lower(first.bare.scene(place))
            own = pattern(model.network)
            group = next((group for other, group in alike if other == own), None)
            if group is None:
                alike.append((own, group := []))
            group.append((place, model))
    for own, cases in alike:
        with suppress(WavesymError):
            fewest = (
                first.fewest if own == pattern(first.model.network) else enough_modes(lower(plan.scene(cases[0][0])))
            )
            yield from _side_by_side(plan, first, fewest, cases)


def _side_by_side(
    plan: SweepPlan, first: _Structure, fewest: int, cases: Sequence[tuple[Place, Model]]
) -> Iterator[tuple[Place, CaseValues]]:
    """Cases of one pattern."""
    sets = mode_sets([model for _, model in cases], fewest)
    for number, (place, model) in enumerate(cases):
        with suppress(WavesymError):
            records, spacing = first.records(model)
            shared = SharedModes(ModesOfSet(model.to_horizon(), sets, number), spacing)
            found = shared.extremes(records, instants(model, plan.histories) if plan.histories else ())
            if found.bounds[0] <= nearest(model.tolerance):
                yield place, _case(plan, model, found)


def _as_sets(
    plan: SweepPlan, first: _Structure, lanes: ModeLanes, places: Sequence[Place]
) -> Iterator[tuple[Place, CaseValues]]:
    """Cases that are numbers of the first one's modes."""
    tau = instants(first.model, plan.histories) if plan.histories else []
    for row, found in first.sets.responses(lanes.rows(plan, places), np.array(tau)):
        if found.bounds[0] <= nearest(first.model.tolerance):
            yield places[row], _case(plan, first.model, found)


def _case(plan: SweepPlan, model: Model, found: RecordedExtremes) -> CaseValues:
    rows = output_rows(plan, model)
    made: dict[str, Numbers | float] = {**of_model(plan, model), "bound": float(found.bounds[0])}
    for side, name in enumerate(("min", "max")):
        made[name] = spread_out(plan, rows, found.values[0, :, side])
        made[f"tau_{name}"] = spread_out(plan, rows, found.taus[0, :, side])
    if plan.histories:
        made["history"] = spread_out(plan, rows, found.histories[0])
    return CaseValues(made, "modes of many structures together, errors estimated")


@dataclass(frozen=True)
class _Structure:
    """The first case of a sweep, whose loads all others share, and as many modes as it needs; `bare` is the sweep with
    next to no samples in its loads."""

    plan: SweepPlan
    model: Model
    fewest: int

    @cached_property
    def bare(self) -> SweepPlan:
        return replace(self.plan, fields=_without_samples(self.plan.fields))

    @cached_property
    def lanes(self) -> ModeLanes | None:
        """What the columns are of its numbers, if they are that."""
        return mode_lanes(self.plan, self.model, self.bare)

    @cached_property
    def sets(self) -> ModalSets:
        """What computes sets of its numbers."""
        assert self.lanes
        return ModalSets(self.lanes.parameters, self.plan.cases)

    @cached_property
    def _like(self) -> UndampedModes:
        return UndampedModes(self.model.to_horizon())

    @cached_property
    def _sampled(self) -> tuple[float, Numbers, list[Roughness]]:
        """How far samples are apart in tau, the samples (n, loads), and their roughness."""
        step = self._like.loads.spacing(self.model.until, self.model.spacing)
        spacing = nearest(step)
        count = ceil(self.model.horizon() / spacing) + 3
        if count > _MOST_SAMPLES:
            raise MemoryError
        samples = self._like.loads.sampled(step, count)
        return spacing, samples, [sampled_roughness(column) for column in samples.T]

    def records(self, model: Model) -> tuple[ManyRecords, float]:
        """The loads as another case takes them, and how far their samples are apart in its tau."""
        spacing, samples, rough = self._sampled
        if model.clock and self.model.clock:
            spacing *= nearest(self.model.clock.seconds / model.clock.seconds)
        sizes = [
            nearest(self.model.inputs[source][0] / model.inputs[source][0]) if source in model.inputs else 1.0
            for source in (step or ramp for step, ramp in self._like.sources)
        ]
        return ManyRecords(samples[None] * sizes, 0.0, spacing, [rough], np.array([sizes])), spacing


_STRUCTURES: dict[str, _Structure | None] = {}


def _first_structure(plan: SweepPlan) -> _Structure | None:
    """That of the first case; None where modes do not serve it. The last one is kept."""
    if plan.sha256 not in _STRUCTURES:
        _STRUCTURES.clear()
        _STRUCTURES[plan.sha256] = None
        with suppress(WavesymError):
            model = lower(plan.scene((0,) * len(plan.dimensions)))
            if model.damping is not None and (fewest := enough_modes(model)) <= _MOST_MODES:
                _STRUCTURES[plan.sha256] = _Structure(plan, model, fewest)
    return _STRUCTURES[plan.sha256]


def _without_samples(fields: Mapping[str, Any]) -> dict[str, Any]:
    """The fields of a scene, its loads with next to no samples."""
    loads = []
    for load in fields["load"]:
        if isinstance(load.get("record"), Mapping):
            load = {**load, "record": {**load["record"], "samples": _FEW}}
        elif load.get("samples"):
            load = {**load, "samples": _FEW}
        loads.append(load)
    return {**fields, "load": loads}
