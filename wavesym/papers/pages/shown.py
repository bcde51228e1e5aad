"""How a printed string is shown: as a formula where the reader can read it, else as it stands; and what differs."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from difflib import SequenceMatcher

from wavesym.papers.difference import marked, marked_ranges
from wavesym.papers.pages.findings import ranges_as_corrected
from wavesym.papers.reader import UnreadableError, read_formula, read_range
from wavesym.papers.record import Record
from wavesym.papers.tree import Tree


@dataclass(frozen=True)
class Words:
    """A sentence, or `code`, which is a string that the reader cannot read.

    Its parts are words and formulas, which stand between dollar signs, each with whether it is marked.
    """

    parts: tuple[tuple[str | Tree, bool], ...]
    code: bool = False


Shown = Tree | Words
_TOKENS = re.compile(r"(\$[^$]*\$|\s+)")
_SIGNS = {"dots": "...", "leq": "≤", "geq": "≥", "langle": "⟨", "rangle": "⟩"}


@dataclass(frozen=True)
class Stated:
    """What is stated, as printed or as corrected: the formula or sentence, and its ranges."""

    formula: Shown
    ranges: tuple[Shown, ...]


def printed(record: Record) -> Stated:
    """What is printed, alone; of prose the sentence in English that is judged."""
    entry = record.entry
    return Stated(_said(entry.statement, bool(entry.english)), tuple(map(_range, entry.ranges)))


def words(record: Record) -> Shown | None:
    """The words of prose as they are printed, in the language of the paper."""
    return _said(record.entry.printed, prose=True) if record.entry.english else None


def inferred(record: Record) -> tuple[Shown, ...]:
    """The ranges that are not printed."""
    return tuple(map(_range, record.entry.inferred))


def compared(record: Record) -> tuple[Stated, Stated] | None:
    """What is printed beside what is right, differences marked; None where it holds."""
    entry, before = record.entry, printed(record)
    if entry.slip is None:
        return None
    said: tuple[Shown, Shown] = before.formula, _said(entry.slip.corrected, bool(entry.english))
    ranges: tuple[tuple[Shown, ...], tuple[Shown, ...]]
    ranges = before.ranges, tuple(map(_range, ranges_as_corrected(entry.slip, entry)))
    match said:
        case _ if entry.english:
            said = _marked_words(entry.english, entry.slip.corrected)
        case (one, other) if not isinstance(one, Words) and not isinstance(other, Words):
            said = marked(one, other)
    trees = [[range_ for range_ in side if not isinstance(range_, Words)] for side in ranges]
    if list(map(len, trees)) == list(map(len, ranges)):
        ranges = marked_ranges(*trees)
    return Stated(said[0], ranges[0]), Stated(said[1], ranges[1])


def readable(text: str) -> str:
    """A sentence with the letters and signs that it has as LaTeX written out."""
    return re.sub(r"\\([a-z]+)(?![A-Za-z])", _sign, text)


def _sign(command: re.Match[str]) -> str:
    if command[1] in _SIGNS:
        return _SIGNS[command[1]]
    try:
        return unicodedata.lookup(f"GREEK SMALL LETTER {command[1].upper()}")
    except KeyError:
        return command[0]


def _said(text: str, prose: bool) -> Shown:
    return Words(_parts((token, False) for token in _TOKENS.split(text))) if prose else formula(text)


def formula(text: str) -> Shown:
    """A string that is not prose."""
    try:
        return read_formula(text)
    except UnreadableError:
        return _range(text)


def _range(text: str) -> Shown:
    try:
        return read_range(text)
    except UnreadableError:
        return Words(((text, False),), code=True)


def _marked_words(before: str, after: str) -> tuple[Words, Words]:
    """Two sentences, word by word."""
    one, other = _TOKENS.split(before), _TOKENS.split(after)
    blocks = SequenceMatcher(a=one, b=other, autojunk=False).get_opcodes()
    return (
        Words(_parts((token, tag != "equal") for tag, start, end, _, _ in blocks for token in one[start:end])),
        Words(_parts((token, tag != "equal") for tag, _, _, start, end in blocks for token in other[start:end])),
    )


def _parts(tokens: Iterable[tuple[str, bool]]) -> tuple[tuple[str | Tree, bool], ...]:
    """Formulas read, and blanks never marked: a line may be broken there."""
    return tuple((_part(token), differs and not token.isspace()) for token, differs in tokens if token)


def _part(token: str) -> str | Tree:
    said = formula(token.strip("$")) if token.startswith("$") else token
    return said if not isinstance(said, (str, Words)) else readable(token.strip("$"))
