"""How to see a counterexample: its scene as a file, the command that shows it, and what to look at."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from wavesym.papers.record import Record


@dataclass(frozen=True)
class Reproduction:
    """What to type: a scene to save as `file`, a command, and what to look at. `said` alone where there is no scene."""

    id: str
    said: str
    file: str = ""
    scene: str = ""
    command: str = ""
    look: str = ""


def reproduction(record: Record) -> Reproduction | None:
    """How to see a record's smallest counterexample; None where it has none."""
    wrong = record.counterexample
    if wrong is None:
        return None
    said = f"{wrong}."
    if wrong.example is None:
        return Reproduction(record.id, f"{said} There is no chain behind it to run: these are all its numbers.")
    example, file = wrong.example(), _file(record.id)
    return Reproduction(record.id, said, file, example.scene, example.command.replace("SCENE", file), example.look)


def reproductions(records: Iterable[Record]) -> list[Reproduction]:
    """Those of all records that have a counterexample."""
    return [found for record in records if (found := reproduction(record))]


def _file(id: str) -> str:
    """The name of a file for a record, without what a shell would read."""
    return re.sub(r"[^\w.-]+", "_", re.sub(r"[()]", "", id)) + ".toml"
