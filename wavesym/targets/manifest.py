"""NAME.json: what was generated from what, with the bound of each output."""

from __future__ import annotations

import json

from wavesym.model.model import Model
from wavesym.programs.choice import Evaluator
from wavesym.programs.march.evaluator import MarchEvaluator
from wavesym.targets.description import Description

SCHEMA_VERSION = 1
# What NAME.c compiles to besides its tables, with clang -Os for a Cortex-M4: no more than this; a test compiles it.
SMALL_TARGET = "Cortex-M4, -Os"
CODE_AT_MOST = {"closed": 1024, "pieces": 4096, "march": 8192}


def manifest(model: Model, description: Description, evaluator: Evaluator, name: str) -> str:
    """The manifest as JSON text. Numbers that are exact in the scene are strings, doubles are numbers."""
    system: dict[str, object] = dict(model.labels.system)
    for parameter, numbers in model.felt.items():
        system[parameter] = {str(index): str(value) for index, value in numbers.items()}
    content = {
        "schema_version": SCHEMA_VERSION,
        "generator": "wavesym",
        "name": model.name,
        "command": description.command,
        "system": system,
        "load": [{"source": p.source, "time": str(p.time), "weight": str(p.weight)} for p in model.loads],
        "until": str(model.until),
        "tolerance": str(model.tolerance),
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
