"""Hundreds of sets of parameters at once, by a program whose parameters come at run time: one for each topology.

A dimension can be run through so where its values are numbers of the program's own fields and nothing else of the scene
depends on them: kappa, inertia, a number of a chain's part, amplitudes of loads. (Velocities of bodies must fit each
other; a scene looks at that.)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from wavesym.errors import WavesymError
from wavesym.numbers.doubles import nearest, rational
from wavesym.programs.request import Request
from wavesym.programs.runtime.making import runtime_fields, runtime_program
from wavesym.programs.runtime.request import RuntimeField
from wavesym.running.model import RuntimeModel
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import amplitudes
from wavesym.scene.paths import changed, steps
from wavesym.sweeps.dimension import Column, number_of
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.single import instants, of_model, output_rows, spread_out
from wavesym.sweeps.values import CaseValues, Numbers

_FEWEST = 8  # sets that are worth a program of their own
_NAMES = ("kappa", "inertia")
_OF_PARTS = ("mass", "dashpot", "spring", "impedance")
_FROM_LISTS = ("steps", "ramps", "a", "b")  # of a load
_PROBES = (2, 3)  # values that a column takes to see which number of the program it is

Place = tuple[int, ...]


@dataclass(frozen=True)
class Lane:
    """A column whose values are number `place` of a field of the program."""

    field: str
    place: int


def together(plan: SweepPlan) -> tuple[bool, ...] | None:
    """Whether cases can differ in each dimension and still share a program; None where that is worth nothing."""
    if plan.time_unit is not None or "arrival" in plan.summary:
        return None
    joined = tuple(all(_lane(plan, column) for column in dimension.columns) for dimension in plan.dimensions)
    sets = np.prod([len(d) for d, lane in zip(plan.dimensions, joined, strict=True) if lane], initial=1)
    if not any(joined) or sets < _FEWEST:
        return None
    try:
        _fields(Scene(**plan.fields), _names(plan))
    except WavesymError:
        return None
    return joined


def parameters(plan: SweepPlan, places: Sequence[Place], joined: Sequence[bool]) -> Iterator[tuple[Place, CaseValues]]:
    """The cases of one topology, as far as its program serves them to the tolerance; the others are left out."""
    topology = tuple(0 if lane else k for k, lane in zip(places[0], joined, strict=True))
    scene, model = _program(plan, topology)
    given = {name: np.tile(values, (len(places), 1)) for name, values in model.parameters.items()}
    for axis, dimension in enumerate(plan.dimensions):
        if joined[axis]:
            for column in dimension.columns:
                lane = _lane(plan, column)
                assert lane  # as the dimension is joined
                given[lane.field][:, lane.place] = [_number(column, place[axis]) for place in places]
    lowered = lower(scene)
    rows, of_all = output_rows(plan, lowered), of_model(plan, lowered)
    peaks = model.peaks(**given)
    values = {"min": peaks.min, "max": peaks.max, "tau_min": peaks.tau_min, "tau_max": peaks.tau_max}
    if plan.histories:
        values["history"] = model.run(instants(lowered, plan.histories), **given)
    tolerance = nearest(lowered.tolerance)
    for k, place in enumerate(places):
        bound = float(peaks.checks.estimate[k])
        if peaks.checks.status[k] == 0 and bound <= tolerance:
            found: dict[str, Numbers | float] = {name: spread_out(plan, rows, each[k]) for name, each in values.items()}
            yield place, CaseValues({**of_all, **found, "bound": bound}, "parameters at run time, errors estimated")


_PROGRAMS: dict[tuple[str, Place], tuple[Scene, RuntimeModel]] = {}


def _program(plan: SweepPlan, topology: Place) -> tuple[Scene, RuntimeModel]:
    """The scene of the first case of a topology, and its program; the last one is kept."""
    key = plan.sha256, topology
    if key not in _PROGRAMS:
        _PROGRAMS.clear()
        scene, names = plan.scene(topology), _names(plan)
        given = amplitudes(scene) if "load" in names else ()
        program = runtime_program(lower(scene), Request(runtime=names), given)
        _PROGRAMS[key] = scene, RuntimeModel(program)
    return _PROGRAMS[key]


def _names(plan: SweepPlan) -> tuple[str, ...]:
    """The fields that are varied."""
    lanes = (_lane(plan, column) for dimension in plan.dimensions for column in dimension.columns)
    return tuple(dict.fromkeys(lane.field for lane in lanes if lane))


def _lane(plan: SweepPlan, column: Column) -> Lane | None:
    """The number of the program that a column varies, if it is one."""
    if any(number is None or number[1] for number in map(number_of, column.values)):
        return None
    way = steps(column.path)
    if way[0] == "system" and len(way) == 3 and way[1] in _NAMES:
        name = str(way[1])
    elif way[0] == "system" and "parts" in way and way[-1] in _OF_PARTS:
        name = str(way[-1])
    elif way[0] == "load" and len(way) == 4 and way[2] in _FROM_LISTS:
        name = "load"
    else:
        return None
    return _found(plan, column.path, name)


_LANES: dict[tuple[str, str], Lane | None] = {}


def _found(plan: SweepPlan, path: str, name: str) -> Lane | None:
    """Which number of a field changes with a path, and as it does."""
    key = plan.sha256, path
    if key not in _LANES:
        try:
            first, second = (_fields(Scene(**changed(plan.fields, path, value)), (name,)) for value in _PROBES)
        except WavesymError:
            return None
        before, after = (np.array([nearest(value) for value in each[0].values]) for each in (first, second))
        (differ,) = np.nonzero(before != after)
        fits = len(differ) == 1 and (before[differ[0]], after[differ[0]]) == _PROBES
        _LANES[key] = Lane(name, int(differ[0])) if fits else None
    return _LANES[key]


def _fields(scene: Scene, names: tuple[str, ...]) -> tuple[RuntimeField, ...]:
    given = amplitudes(scene) if "load" in names else ()
    return runtime_fields(lower(scene), names, given)


def _number(column: Column, k: int) -> float:
    found = number_of(column.values[k])
    assert found  # or there is no lane
    return nearest(rational(found[0]))
