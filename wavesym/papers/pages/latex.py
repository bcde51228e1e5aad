"""The verdicts as LaTeX: an appendix that can be cited, for pdfLaTeX and LuaLaTeX."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable
from dataclasses import dataclass

from wavesym.papers.pages.document import Document, document
from wavesym.papers.pages.findings import Findings
from wavesym.papers.tree import Tree
from wavesym.papers.tree import latex as formula
from wavesym.rendering import render

_CHARACTERS = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    '"': r"\textquotedbl{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    "'": r"\textquotesingle{}",
    "`": r"\textasciigrave{}",
    **{character: f"\\{character}" for character in "#$%&_{}"},
    "ł": r"\l{}",
    "Ł": r"\L{}",
    "\N{EN DASH}": r"\textendash{}",
    "—": r"\textemdash{}",
    "…": r"\ldots{}",
    "\N{RIGHT SINGLE QUOTATION MARK}": "'",
    "\N{LEFT SINGLE QUOTATION MARK}": "`",
    "“": "``",
    "”": "''",
    "„": r"\quotedblbase{}",
    "⟨": r"\ensuremath{\langle}",
    "⟩": r"\ensuremath{\rangle}",
    "≤": r"\ensuremath{\leq}",
    "≥": r"\ensuremath{\geq}",
    "≈": r"\ensuremath{\approx}",
    "≠": r"\ensuremath{\neq}",
    "±": r"\ensuremath{\pm}",
    "\N{MULTIPLICATION SIGN}": r"\ensuremath{\times}",
    "·": r"\ensuremath{\cdot}",
    "\N{MINUS SIGN}": r"\ensuremath{-}",
    "✓": r"\ensuremath{\surd}",
    "✗": r"\ensuremath{\times}",
}
_RUSSIAN = {
    **dict(zip("абвгдеёзийклмнопрстуфыэ", "abvgdeeziiklmnoprstufye", strict=True)),
    "ж": "zh",
    "\N{CYRILLIC SMALL LETTER HA}": "kh",
    "ц": "ts",
    "ч": "ch",
    "ш": "sh",
    "щ": "shch",
    "ъ": "''",
    "ь": "'",
    "ю": "yu",
    "я": "ya",
}
"""As it is transliterated: what LaTeX needs for Cyrillic is not everywhere."""
_ACCENTS = {"\u0301": "'", "\u0300": "`", "\u0307": ".", "\u0328": "k", "\u0308": '"', "\u0302": "^", "\u030c": "v"}


@dataclass(frozen=True)
class _Context:
    document: Document
    formula: Callable[[Tree], str]
    tex: Callable[[str], str]


def page(findings: Findings) -> str:
    """The document; pure ASCII."""
    return render("papers/errata.tex.j2", _Context(document(findings, "latex"), formula, tex))


def tex(text: str) -> str:
    """Text as LaTeX sets it: what it would read as commands is written out, and so is what is no ASCII."""
    return "".join(map(_character, unicodedata.normalize("NFC", text))).replace("--", "-{}-")


def _character(character: str) -> str:
    if character in _CHARACTERS:
        return _CHARACTERS[character]
    if character.isascii():
        return character
    if character.lower() in _RUSSIAN:
        latin = _RUSSIAN[character.lower()].replace("'", _CHARACTERS["'"])
        return latin if character.islower() else latin.capitalize()
    parts = unicodedata.normalize("NFD", character)
    if len(parts) == 2 and parts[0].isascii() and parts[1] in _ACCENTS:
        return f"\\{_ACCENTS[parts[1]]}{{{parts[0]}}}"
    name = unicodedata.name(character, f"U+{ord(character):04X}")
    greek = name.removeprefix("GREEK SMALL LETTER ").lower()
    return rf"\ensuremath{{\{greek}}}" if name.startswith("GREEK SMALL LETTER ") else f"[{name.lower()}]"
