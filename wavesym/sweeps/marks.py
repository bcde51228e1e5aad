"""Marks of what is done: a file for each batch, named by a hash of all that goes in, put in its place by rename.

A mark holds the hashes of its chunks, and the reason of each of its cases that failed.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FOLDER = "done"


@dataclass(frozen=True)
class Marks:
    """The marks in the folder of a sweep."""

    folder: Path

    def put(self, name: str, mark: dict[str, Any]) -> None:
        """Mark a batch as done."""
        place = self.folder / FOLDER / f"{name}.json"
        draft = place.with_suffix(".part")
        draft.write_text(json.dumps(mark, indent=1) + "\n", encoding="utf-8")
        os.replace(draft, place)

    def get(self, name: str) -> dict[str, Any] | None:
        """The mark of a batch; None where there is none, or one that the disk has not kept."""
        return _read(self.folder / FOLDER / f"{name}.json")

    def names(self) -> set[str]:
        """Of all batches that have one."""
        return {path.stem for path in (self.folder / FOLDER).glob("*.json")}

    def every(self) -> Iterator[dict[str, Any]]:
        """All marks, in the order of their batches."""
        found = (_read(path) for path in (self.folder / FOLDER).glob("*.json"))
        yield from sorted((mark for mark in found if mark), key=lambda mark: mark["batch"])


def _read(path: Path) -> dict[str, Any] | None:
    try:
        mark = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    return mark if _whole(mark) else None


def _whole(mark: object) -> bool:
    """Whether it is what was put there, as far as others build on it."""
    if not isinstance(mark, dict):
        return False
    kinds = {"batch": int, "cases": int, "chunks": dict, "failed": list}
    return all(isinstance(mark.get(key), kind) for key, kind in kinds.items()) and all(
        isinstance(each, dict) and each.keys() >= {"case", "values", "reason"} and isinstance(each["values"], dict)
        for each in mark["failed"]
    )
