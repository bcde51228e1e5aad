"""A derivation as a document: text for the terminal, LaTeX, JSON for machines."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

from wavesym.documents.derivation.network_statement import network_statement
from wavesym.documents.derivation.notation import Latex, Text
from wavesym.documents.derivation.statement import Statement, scene_statement, statements
from wavesym.rendering import render

if TYPE_CHECKING:
    from wavesym.derivation.symbolic import SymbolicChain
    from wavesym.mechanics.model import Model


def derivation(name: str, m: int | None, format: str) -> str:
    """The derivation of a system as "text", "latex", "fragment" (LaTeX to be \\input) or "json"."""
    return _write(statements(name, m, _notation(format)), format)


def scene_derivation(name: str, symbols: SymbolicChain, format: str) -> str:
    """The derivation of the system of a scene, with the families of its own parameters."""
    return _write((scene_statement(name, symbols, _notation(format)),), format)


def network_derivation(model: Model, format: str) -> str:
    """The law of each kind of joint of a chain that is written out."""
    made = network_statement(model.name, model.network, _notation(format))
    if format == "json":
        return json.dumps(asdict(made), indent=2) + "\n"
    return render(template("network", format), **vars(made))


def _notation(format: str) -> Text:
    return Latex() if format in ("latex", "fragment") else Text()


def _write(made: tuple[Statement, ...], format: str) -> str:
    if format == "json":
        return json.dumps([asdict(statement) for statement in made], indent=2) + "\n"
    return render(template("derivation", format), systems=made)


def template(name: str, format: str) -> str:
    """The template of a document as "text", "latex", or as a "fragment" of LaTeX."""
    endings = {"latex": "latex/{}.tex.j2", "fragment": "latex/{}_fragment.tex.j2", "text": "text/{}.txt.j2"}
    return endings[format].format(name)
