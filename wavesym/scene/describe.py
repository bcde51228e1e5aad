"""A scene in a line, for people: what it is, how large, what acts on it, and until when."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from wavesym.fields.loads import Load, SampledLoad
from wavesym.fields.shapes import ShapedLoad
from wavesym.records.load import RecordedLoad
from wavesym.systems import SystemTable

_ELEMENTS = {"building": ("storey", "storeys"), "drive": ("shaft", "shafts")}
_RODS = ("rod", "rods")
_MOST_LOADS = 1  # that are described; of several there is the number


def describe(name: str, system: SystemTable, loads: Sequence[Load], until: str) -> str:
    """The name, the system and its size, the loads and the horizon of a scene, if it has one, with commas between."""
    return ", ".join([repr(name), *_parts(system, loads), *([f"until {until}"] if until else [])])


def _parts(system: SystemTable, loads: Sequence[Load]) -> Iterator[str]:
    yield system.type
    count = sum(len(stations) - 1 for stations in system.lines.values())
    yield f"{count} {_ELEMENTS.get(system.type, _RODS)[count != 1]}"
    if len(loads) > _MOST_LOADS:
        yield f"{len(loads)} loads"
    else:
        yield from map(_load, loads)


def _load(load: Load) -> str:
    if isinstance(load, RecordedLoad):
        return f"record of {len(load.record.samples)} samples"
    if isinstance(load, ShapedLoad):
        return f"{load.shape} load"
    if isinstance(load, SampledLoad):
        return f"load of {len(load.samples)} samples"
    changes = len({unit.time for unit in load.units()})
    return f"load of {changes} change{'s' * (changes != 1)}"
