"""A derivation as a document: text for the terminal, LaTeX, JSON for machines."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass

from wavesym.derivation.notation import Latex, Text
from wavesym.derivation.statement import Statement, statements
from wavesym.emission.rendering import render


@dataclass(frozen=True)
class Document:
    """templates/text/derivation.txt.j2 and templates/latex/derivation.tex.j2."""

    systems: tuple[Statement, ...]


def derivation(name: str, m: int | None, format: str) -> str:
    """The derivation of a system as "text", "latex" or "json"."""
    if format == "latex":
        return render("latex/derivation.tex.j2", Document(statements(name, m, Latex())))
    made = statements(name, m, Text())
    if format == "json":
        return json.dumps(_plain(made), indent=2) + "\n"
    return render("text/derivation.txt.j2", Document(made))


def _plain(made: Iterable[Statement]) -> list[dict[str, object]]:
    return [asdict(statement) for statement in made]
