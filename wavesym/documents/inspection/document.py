"""`wavesym inspect`: what one stage of the compiler makes of a scene, or a summary of all, as text or JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping

from wavesym.documents.inspection.laws import laws
from wavesym.documents.inspection.modelled import modelled
from wavesym.documents.inspection.programmed import programmed
from wavesym.documents.inspection.said import said
from wavesym.documents.inspection.section import Section, plain
from wavesym.documents.inspection.summary import summary
from wavesym.documents.inspection.tabled import tabled
from wavesym.documents.inspection.text import section_lines
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import named_chain, sources

SUMMARY = "summary"
_STAGES: Mapping[str, Callable[[Scene], Iterable[Section]]] = {
    SUMMARY: lambda scene: summary(lower(scene), named_chain(scene), sources(scene), scene.physical),
    "scene": said,
    "model": lambda scene: modelled(lower(scene), named_chain(scene)),
    "laws": lambda scene: laws(lower(scene), named_chain(scene)),
    "table": lambda scene: tabled(lower(scene), named_chain(scene)),
    "program": lambda scene: programmed(lower(scene), sources(scene)),
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
