"""Records of the paper with some of their strings falsified."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wavesym.papers.entries import Passage
from wavesym.papers.pielorz1979.paper import ADAPTERS
from wavesym.papers.pielorz1979.transcript import entries
from wavesym.papers.record import Record, judge

ENTRIES = entries()


def judged(id: str, slip: Mapping[str, object] | None = None, **changes: object) -> Record:
    """The record of an entry whose strings are changed, those of its slip too."""
    entry = ENTRIES[id].model_copy(update=changes)
    if slip:
        assert entry.slip is not None
        entry = entry.model_copy(update={"slip": entry.slip.model_copy(update=slip)})
    return judge(entry, ADAPTERS[entry.kind](entry))


def changed_passage(passage: Passage, **changes: Any) -> Passage:
    """A passage with other data, whose records follow from these."""
    return Passage(**{name: changes.get(name, getattr(passage, name)) for name in Passage.model_fields})
