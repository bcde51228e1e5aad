"""The verdicts as one HTML file: MathML, no script, nothing from the network."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from wavesym.papers.mathml import mathml
from wavesym.papers.pages.document import Document, document
from wavesym.papers.pages.findings import Findings
from wavesym.papers.tree import Tree
from wavesym.rendering import render


@dataclass(frozen=True)
class _Context:
    document: Document
    mathml: Callable[[Tree], str]


def page(findings: Findings) -> str:
    """The page; a browser shows it from the file."""
    return render("papers/errata.html.j2", _Context(document(findings, "html"), mathml))
