"""Which cases can share a program whose parameters come at run time: those that differ in numbers of its fields alone.

That is looked at in the lowered models, so that it does not matter what was varied: a stiffness, or the diameter of a
shaft with units.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from wavesym.errors import WavesymError
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.programs.runtime.network import NAMES, RuntimeField, free_network
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import amplitudes

_EVERY = (*NAMES, "mass", "dashpot", "spring", "impedance")


@dataclass(frozen=True)
class RuntimeCase:
    """A model with its `fields` at run time; cases with the same `rest` share a program."""

    model: Model
    fields: tuple[RuntimeField, ...]
    rest: Any

    @classmethod
    def from_scene(cls, scene: Scene, names: tuple[str, ...]) -> RuntimeCase:
        """That of a scene. WavesymError where it has no such fields, or cannot be served."""
        scene = scene.in_lines
        model, given = lower(scene), amplitudes(scene) if "load" in names else ()
        own = free_network(model, names, given).fields
        rest = model.parameters.fixed_part(names)
        bare = replace(model, network=Network((), ()), preset=None)
        called = [(field.name, field.labels, field.units) for field in own]
        timed = [(load.source, load.time) for _, load in given]
        loads = () if "load" in names else model.loads
        return cls(model, own, (rest, replace(bare, labels=None, loads=loads), called, timed))  # type: ignore[arg-type]


def differing(first: Scene, second: Scene) -> Iterator[str]:
    """The fields in which two scenes differ."""
    for name in _EVERY:
        try:
            one, other = (RuntimeCase.from_scene(scene, (name,)).fields for scene in (first, second))
        except WavesymError:
            continue
        if [field.values for field in one] != [field.values for field in other]:
            yield name
