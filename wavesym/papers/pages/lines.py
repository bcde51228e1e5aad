"""What a page shows in a line: words, code and formulas, each of them perhaps marked as different."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher

from wavesym.papers.difference import mark_differences, mark_range_differences
from wavesym.papers.reader import UnreadableError, read_formula, read_range
from wavesym.papers.record import Record
from wavesym.papers.tree import Tree


@dataclass(frozen=True)
class Code:
    """A string as it stands in the data, a scan or a scene."""

    text: str


@dataclass(frozen=True)
class Formula:
    """A string that is read as a formula or a range."""

    text: str
    tree: Tree


@dataclass(frozen=True)
class Different:
    """A part of a sentence that another version of it does not have."""

    part: str | Code | Formula


Inline = str | Code | Formula | Different
Line = tuple[Inline, ...]

_TOKENS = re.compile(r"(\$[^$]*\$|\s+)")
_SIGNS = {"dots": "...", "leq": "≤", "geq": "≥", "langle": "⟨", "rangle": "⟩"}


def formula(text: str) -> Formula | Code:
    """A string that is no prose; code where it cannot be read."""
    for read in (read_formula, read_range):
        try:
            return Formula(text, read(text))
        except UnreadableError:
            continue
    return Code(text)


def range_of_values(text: str) -> Formula | Code:
    """A range; code where it cannot be read."""
    try:
        return Formula(text, read_range(text))
    except UnreadableError:
        return Code(text)


def prose(text: str) -> Line:
    """A sentence; what stands between dollar signs is a formula."""
    return tuple(map(_token, filter(None, _TOKENS.split(text))))


def _token(text: str) -> str | Formula:
    if not text.startswith("$"):
        return readable(text)
    found = formula(text.strip("$"))
    return found if isinstance(found, Formula) else readable(text.strip("$"))


def readable(text: str) -> str:
    """Words with the letters and signs that they have as LaTeX written out."""
    return re.sub(r"\\([a-z]+)(?![A-Za-z])", _sign, text)


def _sign(command: re.Match[str]) -> str:
    if command[1] in _SIGNS:
        return _SIGNS[command[1]]
    try:
        return unicodedata.lookup(f"GREEK SMALL LETTER {command[1].upper()}")
    except KeyError:
        return command[0]


def statement(record: Record) -> tuple[Line, ...]:
    """What is judged of a record, as it is printed: the formula or sentence, and its ranges; differences marked."""
    return _versions(record)[0]


def correction(record: Record) -> tuple[Line, ...]:
    """What is right of a record that has a slip, and its ranges; differences marked."""
    return _versions(record)[1]


def _versions(record: Record) -> tuple[tuple[Line, ...], tuple[Line, ...]]:
    entry, slip = record.entry, record.entry.slip
    if slip is None:
        own = prose(entry.english) if entry.english else (formula(entry.printed),)
        return (own, *((range_of_values(range_),) for range_ in entry.ranges)), ()
    if entry.english:
        sentences = _compared_words(entry.english, slip.correction)
    else:
        one, other = formula(entry.printed), formula(slip.correction)
        if isinstance(one, Formula) and isinstance(other, Formula):
            trees = mark_differences(one.tree, other.tree)
            one, other = (Formula(f.text, tree) for f, tree in zip((one, other), trees, strict=True))
        sentences = (one,), (other,)
    right = entry.ranges if slip.ranges is None else slip.ranges
    ranges = [list(map(range_of_values, texts)) for texts in (entry.ranges, right)]
    if slip.ranges is not None and all(isinstance(range_, Formula) for side in ranges for range_ in side):
        before, after = ([range_.tree for range_ in side if isinstance(range_, Formula)] for side in ranges)
        differences = mark_range_differences(before, after)
        ranges = [list(map(Formula, *side)) for side in zip((entry.ranges, slip.ranges), differences, strict=True)]
    first, second = ((sentence, *((r,) for r in side)) for sentence, side in zip(sentences, ranges, strict=True))
    return first, second


def _compared_words(before: str, after: str) -> tuple[Line, Line]:
    """Two sentences, word by word; blanks are never marked, as a line may be broken there."""
    one, other = _TOKENS.split(before), _TOKENS.split(after)
    blocks = SequenceMatcher(a=one, b=other, autojunk=False).get_opcodes()

    def side(tokens: Iterable[tuple[str, bool]]) -> Line:
        return tuple(
            Different(_token(token)) if differs and not token.isspace() else _token(token)
            for token, differs in tokens
            if token
        )

    return (
        side((token, tag != "equal") for tag, start, end, _, _ in blocks for token in one[start:end]),
        side((token, tag != "equal") for tag, _, _, start, end in blocks for token in other[start:end]),
    )


def join_lines(lines: Sequence[Line], separator: str = ", ") -> Line:
    """Lines as one."""
    return tuple(part for number, line in enumerate(lines) for part in ((separator, *line) if number else line))
