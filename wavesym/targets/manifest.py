"""NAME.json: what was generated from what, with the bound of each output."""

from __future__ import annotations

import json

from wavesym.programs.choice import Evaluator
from wavesym.programs.march.evaluator import MarchEvaluator
from wavesym.scene import Building, Scene
from wavesym.targets.description import Description, parameters

SCHEMA_VERSION = 1
# What NAME.c compiles to besides its tables, with clang -Os for a Cortex-M4: no more than this; a test compiles it.
SMALL_TARGET = "Cortex-M4, -Os"
CODE_AT_MOST = {"closed": 1024, "pieces": 4096, "march": 8192}


def manifest(scene: Scene, description: Description, evaluator: Evaluator, name: str) -> str:
    """The manifest as JSON text. Numbers that are exact in the scene are strings, doubles are numbers."""
    system: dict[str, object] = {"type": scene.system.type}
    if isinstance(scene.system, Building):
        system["base"] = scene.system.base
    for parameter, numbers in parameters(scene).items():
        system[parameter] = {str(index): str(value) for index, value in numbers.items()}
    content = {
        "schema_version": SCHEMA_VERSION,
        "generator": "wavesym",
        "name": scene.name,
        "command": description.command,
        "system": system,
        "load": [{"source": p.source, "time": str(p.time), "weight": str(p.weight)} for p in scene.pieces],
        "until": str(scene.output.until),
        "tolerance": str(scene.output.tolerance),
        "evaluator": name,
        "reason": description.reason,
        "precision": evaluator.real.name,
        "size": {"target": SMALL_TARGET, "data": evaluator.bytes, "code_at_most": CODE_AT_MOST[name]},
        "tau_max": evaluator.tau_max,
        "error_bound": evaluator.error_bound,
        "outputs": [{"name": output.name, "error_bound": output.bound} for output in evaluator.outputs],
        **_driven(evaluator),
        "contact_end": {contact.position: contact.digits for contact in description.contacts},
    }
    return json.dumps(content, indent=2) + "\n"


def _driven(evaluator: Evaluator) -> dict[str, object]:
    """What is proved for loads that are given while a march runs."""
    given = evaluator.given if isinstance(evaluator, MarchEvaluator) else None
    if given is None:
        return {}
    errors = zip(evaluator.outputs, given.errors, strict=True)
    return {"windows": given.windows, "given_error": {output.name: error for output, error in errors}}
