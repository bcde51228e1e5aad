"""The JSON schema of scenes, for editors that complete and check TOML: made from the tables that read scenes."""

from __future__ import annotations

import json
from typing import Any

from pydantic.json_schema import GenerateJsonSchema, models_json_schema

from wavesym.fields.table import SceneTable
from wavesym.scene.outputs import Output
from wavesym.scene.physical.chain import PhysicalChain
from wavesym.scene.physical.chain_parts import OTHERS, RODS
from wavesym.scene.physical.scale import UnitsTable
from wavesym.scene.report import ReportTable
from wavesym.systems import PHYSICAL, SYSTEMS
from wavesym.systems.parts import MARKS, ContactPart, JointPart, LinkPart, MassPart, MotionPart, RodPart

Tables = tuple[type[SceneTable], ...]
_SYSTEMS: Tables = (*SYSTEMS.values(), *PHYSICAL.values(), PhysicalChain)
_PARTS: Tables = (
    *(RodPart, MassPart, JointPart, MotionPart, LinkPart, ContactPart),
    *RODS.values(),
    *OTHERS.values(),
)


def scene_schema() -> str:
    """The schema, as JSON.

    It knows the keys of every table, which are needed, and what each is. What depends on other keys, and what numbers
    may be, is for `wavesym inspect` to say.
    """
    loads: Tables = tuple(dict.fromkeys(kind for system in SYSTEMS.values() for kind in system.load_kinds))
    every: Tables = (*_SYSTEMS, *_PARTS, *loads, Output, UnitsTable, ReportTable)
    found, shared = models_json_schema([(table, "validation") for table in every], schema_generator=GenerateJsonSchema)
    refs: dict[type[SceneTable], dict[str, Any]] = {table: found[table, "validation"] for table in every}
    parts = {"type": "array", "items": {"anyOf": [{"enum": [*MARKS]}, *(refs[table] for table in _PARTS)]}}
    definitions: dict[str, Any] = shared["$defs"]
    for table in definitions.values():
        properties = table.get("properties", {})
        if "parts" in properties:
            properties["parts"] = {**parts, "description": properties["parts"]["description"]}
        if "samples" in properties or "record" in properties:
            properties["unit"] = {"type": "string", "description": "of the samples, in a scene with [units]"}
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A scene of wavesym",
        "type": "object",
        "properties": {
            "name": {"type": "string", "description": "an identifier of C, the prefix of what is generated"},
            "units": refs[UnitsTable],
            "system": {"anyOf": [refs[table] for table in _SYSTEMS]},
            "load": {"type": "array", "items": {"anyOf": [refs[table] for table in loads]}},
            "output": refs[Output],
            "report": refs[ReportTable],
        },
        "required": ["name", "system"],
        "additionalProperties": False,
        "$defs": definitions,
    }
    return json.dumps(schema, indent=2, sort_keys=True) + "\n"
