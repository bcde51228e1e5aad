"""What a page shows in a line: words, code and formulas, each of them perhaps marked as different."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from wavesym.papers.pages.marks import differences, differing_tokens
from wavesym.papers.reader import UnreadableError, read_formula, read_range
from wavesym.papers.record import Record
from wavesym.papers.tree import Tree, latex


@dataclass(frozen=True)
class Code:
    """A string as it stands in the data, a scan or a scene."""

    text: str


@dataclass(frozen=True)
class Formula:
    """A string that is read as a formula or a range; `differing` are the places of tokens that differ."""

    text: str
    tree: Tree
    differing: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Different:
    """A part of a sentence that another version of it does not have."""

    part: str | Code | Formula


@dataclass(frozen=True)
class Sentence:
    """Words with formulas among them: as plain text shows them, and in parts where formulas are set as such."""

    plain: str | Code
    parts: Line


Inline = str | Code | Formula | Different | Sentence
Line = tuple[Inline, ...]

_TOKENS = re.compile(r"(\$[^$]*\$|\s+)")
_SIGNS = {"dots": "...", "leq": "≤", "geq": "≥", "langle": "⟨", "rangle": "⟩"}
_GREEK = "alpha|gamma|kappa|tau"
_BRACES = r"\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\}"
_SCRIPT = rf"[_^](?:{_BRACES}|\([^()]+\)|[A-Za-z0-9]+)"
_NOTATION = re.compile(
    rf"((?<![\w.\\])(?:\\[a-z]+(?:{_BRACES})*'*(?:{_SCRIPT})*|(?:{_GREEK}|[A-Za-z])'*(?:{_SCRIPT})+)(?!\w))"
)
"""What words have of formulas: a letter with indices, \\tau or tau, and commands with what they take."""
_FAULT = re.compile(
    r"(,?\s*\b(?:the formula|a term|sign of|index|first|last|with|without|for|number|in)\b(?<!\\in)\s*)"
)
"""The words in what `mutations` calls a fault."""


def formula(text: str, readers: Sequence[Callable[[str], Tree]] = (read_formula, read_range)) -> Formula | Code:
    """A string that is no prose; code where none of the readers can read it."""
    for read in readers:
        try:
            return Formula(text, read(text))
        except UnreadableError:
            continue
    return Code(text)


def range_of_values(text: str) -> Formula | Code:
    """A range; code where it cannot be read."""
    return formula(text, (read_range,))


def prose(text: str) -> Line:
    """A sentence; what stands between dollar signs is a formula."""
    return tuple(map(_token, filter(None, _TOKENS.split(text))))


def _token(text: str) -> str | Formula:
    return formula_or_words(text.strip("$")) if text.startswith("$") else readable(text)


def formula_or_words(text: str, words: str = "") -> str | Formula:
    """A formula; where it cannot be read the words, which are the same text if there are no others."""
    found = formula(text)
    return found if isinstance(found, Formula) else readable(words or text)


def readable(text: str) -> str:
    """Words with the letters and signs that they have as LaTeX written out."""
    return re.sub(r"\\([a-z]+)(?![A-Za-z])", _sign, text)


def sentence(text: str) -> Sentence:
    """Words among which letters have indices, or commands of LaTeX, without dollar signs."""
    return Sentence(readable(text), tuple(map(_notation, filter(None, _NOTATION.split(text)))))


def _notation(text: str) -> str | Formula:
    """A formula as words have it, J_0i or tau_(0,i), where it can be read; else words."""
    if not _NOTATION.fullmatch(text):
        return readable(text)
    braced = re.sub(r"([_^])(?:\(([^()]+)\)|([A-Za-z0-9]+))", r"\1{\2\3}", re.sub(rf"^({_GREEK})", r"\\\1", text))
    return formula_or_words(braced, text)


def fault(change: str) -> Sentence:
    """What became what in a formula, as `mutations` names it; words where it is a fault in a sentence."""
    parts = [part for part in _FAULT.split(change) if part]
    limbs = [part for part in parts if not _FAULT.fullmatch(part)]
    if any(re.search(r"(?<![\\A-Za-z])[A-Za-z]{2}", limb) for limb in limbs):
        return Sentence(Code(change), (readable(change),))
    return Sentence(Code(change), tuple(formula_or_words(part) if part in limbs else part for part in parts))


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
        sentences = _compare_words(entry.english, slip.correction)
    else:
        one, other = _compare_formulas([formula(entry.printed)], [formula(slip.correction)])
        sentences = tuple(one), tuple(other)
    ranges = [list(map(range_of_values, texts)) for texts in (entry.ranges, entry.right_ranges)]
    if slip.ranges is not None:
        ranges = [*_compare_formulas(*ranges)]
    first, second = ((sentence, *((r,) for r in side)) for sentence, side in zip(sentences, ranges, strict=True))
    return first, second


Readable = list[Formula | Code]


def _compare_formulas(before: Readable, after: Readable) -> tuple[Readable, Readable]:
    """Two lists of formulas with what differs, unless one of them cannot be read."""
    one, other = ([each for each in side if isinstance(each, Formula)] for side in (before, after))
    if len(one) < len(before) or len(other) < len(after):
        return before, after
    places = differing_tokens(*([latex(each.tree) for each in side] for side in (one, other)))
    first, second = (
        [replace(each, differing=own) for each, own in zip(side, found, strict=True)]
        for side, found in zip((one, other), places, strict=True)
    )
    return [*first], [*second]


def _compare_words(before: str, after: str) -> tuple[Line, Line]:
    """Two sentences, word by word; blanks are never marked, as a line may be broken there."""
    texts = _TOKENS.split(before), _TOKENS.split(after)
    one, other = (
        tuple(
            Different(_token(token)) if place in differing and not token.isspace() else _token(token)
            for place, token in enumerate(side)
            if token
        )
        for side, differing in zip(texts, differences(*texts), strict=True)
    )
    return one, other


def join_lines(lines: Sequence[Line], separator: str = ", ") -> Line:
    """Lines as one."""
    return tuple(part for number, line in enumerate(lines) for part in ((separator, *line) if number else line))
