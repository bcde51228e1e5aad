"""The scenes of the atlas: small drives, buildings and chains, made from a few numbers."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from wavesym.scene import Scene

TOLERANCE = Fraction(1, 10**10)
"""What an evaluator must prove to be one that would be used."""

AIM = Fraction(1, 10**13)
"""What pieces are fitted to: they are as good as they are asked to be, the others as good as they can."""

LEGEND = "filled: proved to stay below 1e-10; hollow: refused, drawn all the same; cross: no value"
"""How to read an evaluator's curve."""


def drive(kappa: Sequence[Fraction], inertia: Sequence[Fraction | int], until: int, **outputs: Any) -> Scene:
    """A drive that a unit moment on its first body sets in motion; the strain in the middle of shaft 1 is watched."""
    system = {"type": "drive", "m": len(kappa), "kappa": list(kappa), "inertia": list(inertia)}
    load = [{"body": 1, "times": [0], "steps": [1]}]
    return atlas_scene(system, load, until, **(outputs or {"strain": ["1/2"]}))


def chain(parts: Sequence[Any], until: Fraction | int, **outputs: Any) -> Scene:
    """A chain on whose first part, a node with the name "first", a unit force acts from tau = 0 on."""
    return atlas_scene(
        {"type": "chain", "parts": list(parts)}, [{"at": "first", "times": [0], "steps": [1]}], until, **outputs
    )


def atlas_scene(system: dict[str, Any], load: Sequence[dict[str, Any]], until: Fraction | int, **outputs: Any) -> Scene:
    """A scene with the atlas's tolerance."""
    output = {"until": until, "tolerance": TOLERANCE, **outputs}
    return Scene.model_validate({"name": "atlas", "system": system, "load": list(load), "output": output})


def with_tolerance(scene: Scene, tolerance: Fraction) -> Scene:
    """A scene with another tolerance."""
    return scene.model_copy(update={"output": scene.output.model_copy(update={"tolerance": tolerance})})
