"""NAME.json: what was generated from what, with the bound of each output."""

from __future__ import annotations

import json

from wavesym.programs.program import Program, ProgramOutput
from wavesym.targets.description import Description

SCHEMA_VERSION = 3
# What NAME.c compiles to besides its tables, with clang -Os for a Cortex-M4: no more than this; a test compiles it.
SMALL_TARGET = "Cortex-M4, -Os"
CODE_AT_MOST = {
    "closed": 1024,
    "pieces": 4096,
    "march": 8192,
    "hats": 0,
    "modes": 4096,
    "stream": 10240,
}


def manifest(description: Description, program: Program) -> str:
    """The manifest as JSON text. Numbers that are exact in the scene are strings, doubles are numbers."""
    model = program.provenance.model
    system: dict[str, object] = dict(model.labels.system)
    for parameter, numbers in model.letters.items():
        system[parameter] = {str(index): str(value) for index, value in numbers.items()}
    clock, size = model.clock, {"target": SMALL_TARGET, "data": program.bytes}
    events = [{"x": event.x, "kind": event.kind, "tau": event.digits} for event in description.events]
    content = {
        "schema_version": SCHEMA_VERSION,
        "generator": "wavesym",
        "name": model.name,
        "command": description.command,
        "scene_sha256": model.labels.sha256,
        "system": system,
        "load": [{"source": p.source, "time": str(p.time), "weight": str(p.weight)} for p in model.loads],
        "until": str(model.until),
        "tolerance": str(model.tolerance),
        "evaluator": program.evaluator,
        "reason": description.reason,
        **({"shortfall": description.shortfall} if description.shortfall else {}),
        "precision": program.real.name,
        # code grows with the laws where parameters come at run time
        "size": size if program.laws else size | {"code_at_most": CODE_AT_MOST[program.kernel]},
        "tau_max": program.tau_max,
        **({} if program.laws else {"error_bound": program.error_bound}),
        **({"seconds_per_tau": str(clock.seconds)} if clock else {}),
        "outputs": [_output(output, program) for output in program.outputs],
        **_stream_entry(program),
        **_runtime(program),
        "contact_end": {contact.position: contact.digits for contact in description.contacts},
        **({"events": events} if description.event_count else {}),
    }
    return json.dumps(content, indent=2) + "\n"


def _output(output: ProgramOutput, program: Program) -> dict[str, object]:
    """An output, with its unit in a scene that has units; of a strain it is empty."""
    model = program.provenance.model
    units = {probe.name: probe.unit for probe in model.probes}
    unit = {"unit": units[output.name]} if model.clock else {}
    bound = {} if program.laws else {"error_bound": output.bound}
    return {"name": output.name, **bound, **unit}


def _runtime(program: Program) -> dict[str, object]:
    """The parameters that come at run time, with what they are in the scene, what there is besides values, and the
    largest degree and kappa.
    """
    if program.laws is None:
        return {}
    given = {
        field.name: {label: str(value) for label, value in zip(field.labels, field.values, strict=True)}
        for field in program.laws.fields
    }
    units = {
        field.name: [unit.text for unit in field.units]
        for field in program.laws.fields
        if any(unit.text for unit in field.units)
    }
    entries: dict[str, object] = {"runtime": given, **({"runtime_units": units} if units else {})}
    entries["with"] = list(program.parts)
    return entries | {name: program.constants[name] for name in ("degree", "kappa_max") if name in program.constants}


def _stream_entry(program: Program) -> dict[str, object]:
    """The loads of a stream with the units of their samples, and the time between these, or how long a panel is."""
    if not program.step:
        return {}
    described: dict[str, object] = {} if program.proved else {"proved": False}
    if not program.has_equal_steps:
        pairs = zip(program.outputs, program.direct, strict=True)
        described["direct"] = {output.name: [program.sources[j] for j in of] for output, of in pairs if of}
    return {program.step: program.constants[program.step], "loads": list(program.sources), **described}
