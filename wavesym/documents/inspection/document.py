"""`wavesym inspect`: what one stage of the compiler makes of a scene, or a summary of all, as text or JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping

from wavesym.documents.inspection.laws import law_sections
from wavesym.documents.inspection.model import model_sections
from wavesym.documents.inspection.program import program_sections
from wavesym.documents.inspection.scene import scene_sections
from wavesym.documents.inspection.section import Section, plain
from wavesym.documents.inspection.summary import summary_sections
from wavesym.documents.inspection.table import table_sections
from wavesym.documents.inspection.text import section_lines
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import named_chain, sources

SUMMARY = "summary"
_STAGES: Mapping[str, Callable[[Scene], Iterable[Section]]] = {
    SUMMARY: lambda scene: summary_sections(lower(scene), named_chain(scene), sources(scene), scene.physical),
    "scene": scene_sections,
    "model": lambda scene: model_sections(lower(scene), named_chain(scene)),
    "laws": lambda scene: law_sections(lower(scene), named_chain(scene)),
    "table": lambda scene: table_sections(lower(scene), named_chain(scene)),
    "program": lambda scene: program_sections(lower(scene), sources(scene)),
}


def inspection(scene: Scene, stage: str = SUMMARY, format: str = "text") -> str:
    """A stage ("scene", "model", "laws", "table", "program") or the summary of a scene, as "text" or "json"."""
    return "".join(inspection_lines(scene, stage, format))


def inspection_lines(scene: Scene, stage: str, format: str) -> Iterator[str]:
    """The same as it is known: of text, what the model is before programs are tried."""
    sections = _STAGES[stage](scene)
    if format == "json":
        content = {"name": scene.name, "stage": stage, **{section.key: plain(section) for section in sections}}
        yield json.dumps(content, indent=2, allow_nan=False) + "\n"
        return
    yield from (f"{line}\n" for line in _lines(scene.name, stage, sections))


def _lines(name: str, stage: str, sections: Iterable[Section]) -> Iterator[str]:
    yield f"{name}: {stage}"
    for section in sections:
        yield from section_lines(section)
