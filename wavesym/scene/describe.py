"""A scene in a line, for people: what it is, how large, what acts on it, and until when."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wavesym.fields.loads import Load, SampledLoad
from wavesym.fields.shapes import ShapedLoad
from wavesym.numbers.doubles import rational
from wavesym.records.load import RecordedLoad

if TYPE_CHECKING:
    from wavesym.scene.scene import Scene

_ELEMENTS = {"building": ("storey", "storeys"), "drive": ("shaft", "shafts")}
_RODS = ("rod", "rods")
_MOST_LOADS = 1  # that are described; of several there is the number


def describe(scene: Scene) -> str:
    """The name, the system and its size, the loads and the horizon of a scene, with commas between."""
    return ", ".join([repr(scene.name), *_parts(scene)])


def _parts(scene: Scene) -> Iterator[str]:
    yield scene.system.type
    count = sum(len(stations) - 1 for stations in scene.system.lines.values())
    yield f"{count} {_ELEMENTS.get(scene.system.type, _RODS)[count != 1]}"
    if len(scene.load) > _MOST_LOADS:
        yield f"{len(scene.load)} loads"
    else:
        yield from map(_load, scene.load)
    until = scene.output.until
    yield f"until {scene.scale.clock.told(rational(until)) if scene.scale else f'tau = {until}'}"


def _load(load: Load) -> str:
    if isinstance(load, RecordedLoad):
        return f"record of {len(load.record.samples)} samples"
    if isinstance(load, ShapedLoad):
        return f"{load.shape} load"
    if isinstance(load, SampledLoad):
        return f"load of {len(load.samples)} samples"
    changes = len({unit.time for unit in load.units()})
    return f"load of {changes} change{'s' * (changes != 1)}"
