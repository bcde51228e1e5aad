"""Scene -> Model: what the user said, as what is to be computed."""

from __future__ import annotations

import hashlib
import json

from flint import fmpq

from wavesym.model.loads import Applied, merged
from wavesym.model.model import Labels, Model
from wavesym.model.probe import Probe
from wavesym.numbers.doubles import rational
from wavesym.scene.outputs import Observable
from wavesym.scene.scene import Scene


def lower(scene: Scene) -> Model:
    """The model of a scene; every number in it is an fmpq."""
    output = scene.output
    return Model(
        name=scene.name,
        chain=scene.system.chain,
        loads=_loads(scene),
        probes=tuple(_probe(each, scene.system.m) for each in scene.outputs),
        until=rational(output.until),
        tolerance=rational(output.tolerance),
        labels=_labels(scene),
    )


def _labels(scene: Scene) -> Labels:
    canonical = json.dumps(scene.model_dump(mode="json"), sort_keys=True, separators=(",", ":"))
    return Labels(
        system={"type": scene.system.type, **scene.system.choices},
        loads=tuple(load.told for load in scene.load),
        sha256=hashlib.sha256(canonical.encode()).hexdigest(),
    )


def _loads(scene: Scene) -> tuple[Applied, ...]:
    """The loads, summed; sorted by time, and each source at a time once."""
    if not scene.system.load_kinds:
        return (Applied("impact", fmpq(0), fmpq(1)),)
    return merged(unit for load in scene.load for unit in load.units())


def _probe(output: Observable, m: int) -> Probe:
    """At a node the rod is the one on its left, where no side is asked for."""
    x = rational(output.x)
    after = int(x.ceil())
    rod = min(max(1, after + 1 if output.side > 0 else after), m)
    return Probe(output.name, output.quantity, rod, x - (rod - 1))
