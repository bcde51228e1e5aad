"""Damped structures that differ in their systems alone, or in how large loads are: sets of numbers of one of them.

Where all that is varied are numbers of modes (`mode_lanes`) these are known at once. Else each case is lowered by
itself, with next to no samples in its loads, so that whatever is varied may be: a height, the second moment of columns.
It is a set of numbers of the first case that has the same layout, in the units of that one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from wavesym.errors import WavesymError
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.mode_sets.making import ModeSetsTables
from wavesym.programs.mode_sets.parameters import ModeParameters
from wavesym.programs.tables import Tables
from wavesym.results.near_zero import zero_within
from wavesym.results.statistics import RUNTIME_ARRAYS
from wavesym.running.mode_sets import ModalSets
from wavesym.running.toolchain import compiler
from wavesym.scene.paths import steps
from wavesym.sweeps.batches import Place
from wavesym.sweeps.mode_lanes import ModeLanes, mode_lanes, structure_parameters
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.single import extremes_and_history, instants
from wavesym.sweeps.values import CaseValues

_FEWEST = 8  # cases that are worth it
_MOST_MODES = 400
_FEW = ["0", "1"]  # samples of a load that tell where it acts
_SAME = (
    *("parent", "beside", "bar_rod", "bar_part", "bar_left", "bar_right", "bar_left_ratio", "bar_right_ratio"),
    *("link_left", "link_right", "link_ratio", "load_place", "first_term", "term_place"),
    *("output_order", "output_power", "output_bar", "output_side", "output_force"),
)
"""What cases that are numbers of one another have in common."""
_ROUNDED = 1e-13


def serves(plan: SweepPlan) -> bool:
    """Whether cases are damped structures under the same loads or multiples of them, and modes serve the first one."""
    columns = [column for dimension in plan.dimensions for column in dimension.columns]
    return (
        plan.cases >= _FEWEST
        and set(plan.summary) <= set(RUNTIME_ARRAYS)
        and (first := _first_structure(plan)) is not None
        and (first.lanes is not None or all(steps(column.path)[0] == "system" for column in columns))
    )


def structure_cases(plan: SweepPlan, places: Sequence[Place]) -> Iterator[tuple[Place, CaseValues]]:
    """The cases that modes serve to the scene's tolerance; the others are left out."""
    if (first := _first_structure(plan)) is None:
        return
    if first.lanes:
        yield from first.cases(places, [first.model] * len(places), first.lanes.rows(plan, places))
        return
    groups: list[tuple[_Structure, list[tuple[Place, Model, _Likeness]]]] = [(first, [])]
    for place in places:
        with suppress(WavesymError):  # by itself it says what is wrong
            own = structure_parameters(first.bare.scene(place))
            for structure, cases in groups:
                if likeness := structure.likeness(own):
                    cases.append((place, own.model, likeness))
                    break
            else:
                structure = _Structure(plan, structure_parameters(plan.scene(place)))
                if likeness := structure.likeness(own):
                    groups.append((structure, [(place, own.model, likeness)]))
    for structure, cases in groups:
        if cases:
            with suppress(WavesymError):
                some, models, found = zip(*cases, strict=True)
                yield from structure.cases(some, models, np.array([each.numbers for each in found]), found)


class _Likeness(NamedTuple):
    """A case as `numbers` of another's parameters, in the units of that one; its `tau` in that one's, and what
    `outputs` of these numbers are multiplied by."""

    numbers: Array
    tau: float
    outputs: Array


@dataclass(frozen=True)
class _Structure:
    """A case of a sweep, of whose modes others are numbers: cases have the same loads."""

    plan: SweepPlan
    parameters: ModeParameters

    @property
    def model(self) -> Model:
        return self.parameters.model

    @cached_property
    def bare(self) -> SweepPlan:
        """The sweep with next to no samples in its loads."""
        return replace(self.plan, fields=_without_samples(self.plan.fields))

    @cached_property
    def lanes(self) -> ModeLanes | None:
        """What the columns are of its numbers, if they are that."""
        return mode_lanes(self.plan, self.parameters, self.bare)

    @cached_property
    def _sets(self) -> ModalSets:
        return ModalSets(self.parameters)

    @cached_property
    def _tables(self) -> ModeSetsTables:
        return ModeSetsTables(self.parameters)

    def cases(
        self, places: Sequence[Place], models: Sequence[Model], numbers: Array, likeness: Sequence[_Likeness] = ()
    ) -> Iterator[tuple[Place, CaseValues]]:
        """Cases that are sets of its numbers."""
        plan = self.plan
        tau = np.array(instants(self.model, plan.histories) if plan.histories else [])
        found = self._sets.responses(numbers, tau)
        for k, (place, model) in enumerate(zip(places, models, strict=True)):
            if not found.estimate[k] <= nearest(self.model.tolerance):
                continue
            values, taus, histories = found.peaks[k, :, ::2].copy(), found.peaks[k, :, 1::2].copy(), found.values[k]
            zero_within(values, taus, found.estimate[k], 0.0)  # all are at rest at first
            if likeness:
                _, time, outputs = likeness[k]
                values, taus, histories = values * outputs[:, None], taus / time, histories * outputs[:, None]
            how, bound = "modes of many structures together, errors estimated", float(found.estimate[k])
            yield place, extremes_and_history(plan, model, bound, (values, taus), histories, how)

    def likeness(self, other: ModeParameters) -> _Likeness | None:
        """Another case as numbers of this one; None where it is none. Both have the impedance of the first rod as unit,
        and tau_here = r tau_there: masses there are r times as large here, stiffnesses 1/r times, forces 1/r times.
        """
        own, its = self._tables.layout, ModeSetsTables(other).layout
        damping = [each.damping and each.damping.modes for each in (self.model, other.model)]
        if damping[0] != damping[1] or [f.labels for f in self.parameters.fields] != [f.labels for f in other.fields]:
            return None
        pairs = [(own[name], its[name]) for name in _SAME]
        if not all(len(one) == len(that) and np.allclose(one, that, _ROUNDED, 0) for one, that in pairs):
            return None
        r = 1.0
        if self.model.clock and other.model.clock:
            r = nearest(other.model.clock.seconds / self.model.clock.seconds)
        sizes = []
        for o, (begin, end) in enumerate(pairwise(map(int, own["first_term"]))):
            ratios = np.divide(its["term_weight"][begin:end], own["term_weight"][begin:end])
            if own["output_bar"][o] >= 0:
                ratios = np.array([its["output_scale"][o] / own["output_scale"][o]])
            if np.ptp(ratios) > _ROUNDED * abs(ratios[0]):
                return None
            power = 1 if own["output_force"][o] and own["output_bar"][o] >= 0 else int(own["output_order"][o])
            sizes.append(ratios[0] * r**power)
        times = {"stiffness": 1 / r, "rod_mass": r, "mass": r}
        numbers = [
            float(value / theirs.size * ours.size) * times.get(field.name, 1.0)
            for field, there in zip(self.parameters.fields, other.fields, strict=True)
            if field.name != "load"
            for value, theirs, ours in zip(there.values, there.units, field.units, strict=True)
        ]
        return _Likeness(np.array([*numbers, *self._loads(other.model, its, r)]), r, np.array(sizes))

    def _loads(self, model: Model, its: Tables, r: float) -> Iterator[float]:
        """The loads of another case, which are this one's in its units, as numbers of this one's."""
        like = self.parameters.like
        values = [value for field in self.parameters.fields if field.name == "load" for value in field.values]
        for amplitude, value in zip(self.parameters.amplitudes, values, strict=True):
            load, pair = next((j, pair) for j, pair in enumerate(like.sources) if amplitude.source in pair)
            driver, input_name = like.drivers[load], pair[0] or pair[1]
            size = its["load_gain"][load] / nearest(driver.gain)
            if input_name in self.model.inputs:
                size *= nearest(self.model.inputs[input_name][0] / model.inputs[input_name][0])
            moves = like.cut.network.points[driver.point].motion is not None
            yield float(value) * size / (r * r if moves else r)


_STRUCTURES: dict[str, _Structure | None] = {}


def _first_structure(plan: SweepPlan) -> _Structure | None:
    """That of the first case; None where modes do not serve it. The last one is kept."""
    if plan.sha256 not in _STRUCTURES:
        _STRUCTURES.clear()
        _STRUCTURES[plan.sha256] = None
        with suppress(WavesymError):
            parameters = structure_parameters(plan.scene((0,) * len(plan.dimensions)))
            if parameters.model.damping is not None and parameters.fewest <= _MOST_MODES:
                compiler()
                _STRUCTURES[plan.sha256] = _Structure(plan, parameters)
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
