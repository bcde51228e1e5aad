"""NAME.json: what was generated from what, with the bound of each output."""

from __future__ import annotations

import json
from collections.abc import Sequence

from wavesym.emission.description import Description
from wavesym.evaluators.closed import ClosedForm
from wavesym.scene import Scene

SCHEMA_VERSION = 1


def manifest(scene: Scene, description: Description, form: ClosedForm) -> str:
    """The manifest as JSON text. Numbers that are exact in the scene are strings, doubles are numbers."""
    content = {
        "schema_version": SCHEMA_VERSION,
        "generator": "wavesym",
        "name": scene.name,
        "system": {key: _exact(getattr(scene.system, key)) for key in type(scene.system).model_fields},
        "load": [{"source": p.source, "time": str(p.time), "weight": str(p.weight)} for p in scene.pieces],
        "until": str(scene.output.until),
        "tolerance": str(scene.output.tolerance),
        "evaluator": description.evaluator,
        "reason": description.reason,
        "precision": "double",
        "tau_max": form.tau_max,
        "error_bound": form.error_bound,
        "outputs": [
            {
                "name": output.name,
                "error_bound": output.bound,
                "pulses": len(output.pulses),
                "coefficients": sum(len(f.powers) for pulse in output.pulses for f in pulse.families),
            }
            for output in form.outputs
        ],
        "contact_end": {contact.position: contact.digits for contact in description.contacts},
    }
    return json.dumps(content, indent=2) + "\n"


def _exact(value: object) -> object:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [str(item) for item in value]
    return value
