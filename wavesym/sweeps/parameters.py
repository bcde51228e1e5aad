"""Hundreds of sets of parameters at once, by a program whose parameters come at run time: one for each topology.

Cases share a program where their models differ in numbers of its fields alone (`topology`). For columns that are such
numbers themselves that is known beforehand (`lanes`); for others the model of each case is made and looked at.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from wavesym.errors import WavesymError
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest
from wavesym.programs.runtime.making import sets_program
from wavesym.results.statistics import RUNTIME_ARRAYS
from wavesym.running.model import RuntimeModel, compiled_model
from wavesym.scene import Scene
from wavesym.scene.lowering import amplitudes
from wavesym.sweeps.batches import Place
from wavesym.sweeps.lanes import lane
from wavesym.sweeps.plan import RECORD, SweepPlan
from wavesym.sweeps.single import instants, of_model, output_rows
from wavesym.sweeps.topology import RuntimeCase, differing
from wavesym.sweeps.values import CaseValues

_FEWEST = 8  # sets that are worth a program of their own
_HOW = "parameters at run time, errors estimated"


def shared_axes(plan: SweepPlan) -> tuple[bool, ...] | None:
    """Whether cases can differ in each dimension and still share a program; None where that is worth nothing."""
    if not set(plan.summary) <= set(RUNTIME_ARRAYS):
        return None
    names = [_varied_fields(plan, axis) for axis in range(len(plan.dimensions))]
    joined = tuple(map(bool, names))
    sets = np.prod([len(d) for d, some in zip(plan.dimensions, joined, strict=True) if some], initial=1)
    if not any(joined) or sets < _FEWEST:
        return None
    with suppress(WavesymError):
        RuntimeCase.from_scene(Scene(**plan.fields), _names(plan, joined))
        return joined
    return None


def parameters(plan: SweepPlan, places: Sequence[Place], joined: Sequence[bool]) -> Iterator[tuple[Place, CaseValues]]:
    """The cases of one topology, as far as its program serves them to the tolerance; the others are left out."""
    topology = tuple(0 if joins else k for k, joins in zip(places[0], joined, strict=True))
    if (made := _program(plan, topology, joined)) is None:
        return
    own, model = made
    served, given = _numbers(plan, places, joined, own, model)
    if not served:
        return
    rows, of_all = output_rows(plan, own.model), of_model(plan, own.model)
    peaks = model.peaks(**given)
    values = {name: getattr(peaks, name) for name in RUNTIME_ARRAYS}
    if plan.histories:
        values["history"] = model.values(instants(own.model, plan.histories), strict=True, **given)
    spread = {}
    for name, found in values.items():
        spread[name] = np.full((len(served), len(plan.outputs), *found.shape[2:]), np.nan)
        spread[name][:, rows] = found
    fine = (peaks.checks.status == 0) & (peaks.checks.estimate <= nearest(own.model.tolerance))
    for k in np.flatnonzero(fine).tolist():
        arrays: dict[str, Array | float] = {name: each[k] for name, each in spread.items()}
        yield served[k], CaseValues({**of_all, **arrays, "bound": float(peaks.checks.estimate[k])}, _HOW)


def _numbers(
    plan: SweepPlan, places: Sequence[Place], joined: Sequence[bool], own: RuntimeCase, model: RuntimeModel
) -> tuple[list[Place], dict[str, Array]]:
    """The cases that the program is for, and their numbers by field, (cases, numbers)."""
    if _plain(plan, joined):
        given = {name: np.tile(values, (len(places), 1)) for name, values in model.parameters.items()}
        for axis, dimension in enumerate(plan.dimensions):
            for column in dimension.columns if joined[axis] else ():
                at = lane(plan, column)
                assert at  # as all columns of this dimension are
                given[at.field][:, at.place] = [column.coordinate[place[axis]] for place in places]
        return list(places), given
    served, numbers = [], []
    for place in places:
        with suppress(WavesymError):  # by itself it says what is wrong
            case = RuntimeCase.from_scene(plan.scene(place), _names(plan, joined))
            if case.rest == own.rest:
                served.append(place)
                numbers.append([[nearest(value) for value in field.values] for field in case.fields])
    return served, {field.name: np.array([each[k] for each in numbers]) for k, field in enumerate(own.fields)}


class _TopologyProgram(NamedTuple):
    """A case of a topology, and the program of all of them."""

    case: RuntimeCase
    model: RuntimeModel


_PROGRAMS: dict[tuple[str, Place], _TopologyProgram | None] = {}


def _program(plan: SweepPlan, topology: Place, joined: Sequence[bool]) -> _TopologyProgram | None:
    """That of the first case of a topology; None where there is none. The last one is kept."""
    key = plan.sha256, topology
    if key not in _PROGRAMS:
        _PROGRAMS.clear()
        _PROGRAMS[key] = None
        with suppress(WavesymError):
            scene, names = plan.scene(topology), _names(plan, joined)
            case, given = RuntimeCase.from_scene(scene, names), amplitudes(scene) if "load" in names else ()
            _PROGRAMS[key] = _TopologyProgram(case, compiled_model(sets_program(case.model, names, given)))
    return _PROGRAMS[key]


def _names(plan: SweepPlan, joined: Sequence[bool]) -> tuple[str, ...]:
    """The fields that are varied."""
    return tuple(
        dict.fromkeys(name for axis, joins in enumerate(joined) if joins for name in _varied_fields(plan, axis))
    )


def _plain(plan: SweepPlan, joined: Sequence[bool]) -> bool:
    """Whether all that is varied are numbers of the program."""
    dimensions = (dimension for dimension, joins in zip(plan.dimensions, joined, strict=True) if joins)
    return all(lane(plan, column) for dimension in dimensions for column in dimension.columns)


_VARIED: dict[tuple[str, int], tuple[str, ...]] = {}


def _varied_fields(plan: SweepPlan, axis: int) -> tuple[str, ...]:
    """The fields of a program that a dimension varies; none where cases along it have programs of their own."""
    key = plan.sha256, axis
    if key not in _VARIED:
        dimension = plan.dimensions[axis]
        lanes = [lane(plan, column) for column in dimension.columns]
        if dimension.name == RECORD:
            _VARIED[key] = ()
        elif all(lanes):
            _VARIED[key] = tuple(each.field for each in lanes if each)
        else:
            _VARIED[key] = _differing_fields(_probes(plan, axis))
    return _VARIED[key]


def _differing_fields(probes: Sequence[Scene]) -> tuple[str, ...]:
    """The fields in which scenes differ, where that is all."""
    names = tuple(dict.fromkeys(name for other in probes[1:] for name in differing(probes[0], other)))
    if not names:
        return ()
    with suppress(WavesymError):
        first, *others = (RuntimeCase.from_scene(scene, names) for scene in probes)
        return names if all(other.rest == first.rest for other in others) else ()
    return ()


def _probes(plan: SweepPlan, axis: int) -> list[Scene]:
    """Cases along a dimension: the first, one in the middle, the last one, as far as they are scenes."""
    last, found = len(plan.dimensions[axis]) - 1, []
    for k in dict.fromkeys((0, last // 2, last)):
        with suppress(WavesymError):
            found.append(plan.scene(tuple(k if other == axis else 0 for other in range(len(plan.dimensions)))))
    return found
