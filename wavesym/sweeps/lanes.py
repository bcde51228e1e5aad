"""Numbers of a program that a column of plain numbers is, one for one: known without making the scene of each case.

kappa, inertia and amplitudes of loads, without units: nothing else of a scene depends on them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wavesym.errors import WavesymError
from wavesym.numbers.doubles import nearest
from wavesym.scene import Scene
from wavesym.scene.paths import replace_at_path, steps
from wavesym.sweeps.dimension import Column
from wavesym.sweeps.plan import SweepPlan
from wavesym.sweeps.topology import RuntimeCase

_NAMES = ("kappa", "inertia")
_FROM_LISTS = ("steps", "ramps", "a", "b")  # of a load
_PROBES = (2, 3)  # values that a column takes to see which number of the program it is


@dataclass(frozen=True)
class Lane:
    """A column whose values are number `place` of a field of the program."""

    field: str
    place: int


def lane(plan: SweepPlan, column: Column) -> Lane | None:
    """The number of the program that a column varies, if it is one and that is plain."""
    if plan.time_unit is not None or column.unit or not isinstance(column.coordinate[0], float):
        return None
    way = steps(column.path)
    if way[0] == "system" and len(way) == 3 and way[1] in _NAMES:
        name = str(way[1])
    elif way[0] == "load" and len(way) == 4 and way[2] in _FROM_LISTS:
        name = "load"
    else:
        return None
    return _varied_number(plan, column.path, name)


_LANES: dict[tuple[str, str], Lane | None] = {}


def _varied_number(plan: SweepPlan, path: str, name: str) -> Lane | None:
    """Which number of a field changes with a path, and as it does."""
    key = plan.sha256, path
    if key not in _LANES:
        try:
            both = (
                RuntimeCase.from_scene(Scene(**replace_at_path(plan.fields, path, value)), (name,)) for value in _PROBES
            )
            before, after = (np.array([nearest(value) for value in case.fields[0].values]) for case in both)
        except WavesymError:
            return None
        (differ,) = np.nonzero(before != after)
        fits = len(differ) == 1 and (before[differ[0]], after[differ[0]]) == _PROBES
        _LANES[key] = Lane(name, int(differ[0])) if fits else None
    return _LANES[key]
