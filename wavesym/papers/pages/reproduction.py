"""How to see a counterexample: its scene as a file, the command that shows it, and what to look at."""

from __future__ import annotations

import re
from dataclasses import dataclass

from wavesym.papers.record import Record


@dataclass(frozen=True)
class ReproducedPage:
    """What to type: a scene to save as `file`, a command, and what to look at; where there is no chain behind a
    counterexample, it is all in what is `said`."""

    said: str
    file: str = ""
    scene: str = ""
    command: str = ""
    look: str = ""


def reproduction(record: Record) -> ReproducedPage | None:
    """How to see a record's smallest counterexample; None where it has none."""
    wrong = record.counterexample
    if wrong is None:
        return None
    if wrong.example is None:
        return ReproducedPage(f"{wrong}. There is no chain behind it to run: these are all its numbers.")
    example, file = wrong.example(), _file(record.id)
    return ReproducedPage(f"{wrong}.", file, example.scene, example.command.replace("SCENE", file), example.look)


def _file(id: str) -> str:
    """The name of a file for a record, without what a shell would read."""
    return re.sub(r"[^\w.-]+", "_", re.sub(r"[()]", "", id)) + ".toml"
