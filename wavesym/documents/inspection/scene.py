"""The scene as the user said it, every number exact."""

from __future__ import annotations

from collections.abc import Iterator

from wavesym.documents.inspection.section import Display, Facts, Listing, Section
from wavesym.documents.inspection.text import value_text
from wavesym.scene import Scene


def scene_sections(scene: Scene) -> Iterator[Section]:
    """The tables of a scene, under its own keys."""
    fields = scene.model_dump(mode="json")
    if fields.get("units"):
        yield Facts("units", "How it counts", fields["units"])
    yield Facts("system", "The chain, as it was said", fields["system"])
    loads = fields.get("load", [])
    names = tuple(dict.fromkeys(name for load in loads for name in load))
    rows = [{name: Display(value, f"{name} = {value_text(value)}") for name, value in load.items()} for load in loads]
    yield Listing("load", "Its loads", rows, names)
    yield Facts("output", "What is wanted", fields["output"])
