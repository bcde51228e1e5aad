"""Where the records of a passage stand, by marks in its text; and what is printed there, in one line, with its edits.

A formula stands once in the data, in its passage: ⟦id: formula ¦range ¦range⟧. A part that several records share has
all their ids, and may hold other parts; a range that stands elsewhere is ⟦id¦: range⟧. What is not judged is
⟦[why] text⟧.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import accumulate
from typing import NamedTuple

Edits = Iterable[tuple[str, str, str]]
"""From, to, and why."""
Span = tuple[int, int]

_MARK = re.compile(r"⟦(?:\[(?P<why>[^\]]+)\]|(?P<ids>[^:⟧¦]+)(?P<range>¦?):) ?|¦|⟧")
_CASES = re.compile(r"(?s)(\\begin\{cases\}.*?\\end\{cases\})")
_LAYOUT = re.compile(
    r"(?s)\\(?:begin|end)\{aligned\}|\\right\.|\\left\.(?!(?:(?!\\left|\\right).)*\\right\|)|\$|&|\\\\|\\quad"
    r"|(?:^|(?<=\s))dla(?=\s|$)"
)
_SIZE = re.compile(r"\\(?:left|right)(?=[^\w.|])")
_WORDS = re.compile(r"\\text\{([^}]*)\}")


class Aside(NamedTuple):
    """A part of a passage that is not judged: a definition, an announcement, a reference."""

    scan: str
    why: str


@dataclass
class MarkedParts:
    """The parts of a text that are a record: its formula or sentence, and its ranges."""

    formulas: list[Span] = field(default_factory=list)
    ranges: list[Span] = field(default_factory=list)

    @property
    def span(self) -> Span:
        """From the first to the last of them."""
        starts, ends = zip(*self.formulas, *self.ranges, strict=True)
        return min(starts), max(ends)


@dataclass(frozen=True)
class MarkedText:
    """A text without its marks, what it has of each record, and what of it is not judged."""

    text: str
    records: Mapping[str, MarkedParts]
    asides: tuple[tuple[Span, str], ...]

    @property
    def rest(self) -> list[str]:
        """What stands outside of all marks."""
        spans = sorted([*(parts.span for parts in self.records.values()), *(span for span, _ in self.asides)])
        starts = [0, *accumulate((end for _, end in spans), max)]
        ends = [*(start for start, _ in spans), len(self.text)]
        return [self.text[start:end] for start, end in zip(starts, ends, strict=True) if start < end]


@dataclass(frozen=True)
class _Mark:
    """One that is open: what it marks, and from where."""

    ids: tuple[str, ...]
    is_range: bool
    why: str
    start: int


def read_marks(marked: str) -> MarkedText:
    """A text that is marked. ValueError where marks are not in pairs."""
    records: dict[str, MarkedParts] = {}
    asides: list[tuple[Span, str]] = []
    opened: list[_Mark] = []
    text, end = "", 0
    for found in _MARK.finditer(marked):
        text += marked[end : found.start()]
        end, here = found.end(), len(text)
        if found[0][0] == "⟦":
            ids = tuple((found["ids"] or "").split())
            records |= {id: MarkedParts() for id in ids if id not in records}
            opened.append(_Mark(ids, bool(found["range"]), found["why"] or "", here))
            continue
        if not opened:
            raise ValueError(f"{found[0]} stands outside of a record: {marked[: found.end()][-40:]}")
        mark = opened.pop()
        for parts in map(records.__getitem__, mark.ids):
            (parts.ranges if mark.is_range else parts.formulas).append((mark.start, here))
        if mark.why:
            asides.append(((mark.start, here), mark.why))
        if found[0] == "¦":
            opened.append(replace(mark, is_range=True, start=here))
    if opened:
        raise ValueError(f"{' '.join(opened[-1].ids) or opened[-1].why} has no end")
    return MarkedText(text + marked[end:], records, tuple(asides))


def formula_text(source: str, edits: Edits = ()) -> str:
    """A part of a source as it is read: in one line, without alignment, sizes of brackets and "dla" (for), edited."""
    parts = _CASES.split(_WORDS.sub(r"\1", source))
    text = "".join(part if number % 2 else _LAYOUT.sub(" ", part) for number, part in enumerate(parts))
    text = _one_line(_SIZE.sub("", text))
    for before, after, _ in edits:
        text = _one_line(_edit_pattern(before).sub(lambda _, after=after: after.replace("$", ""), text))  # type: ignore[misc]
    return text


def has_edit(source: str, before: str) -> bool:
    """Whether what is to be edited stands there."""
    return bool(_edit_pattern(before).search(formula_text(source)))


def _edit_pattern(before: str) -> re.Pattern[str]:
    """However it is spaced."""
    return re.compile(r"\s*".join(map(re.escape, re.sub(r"[\s$]", "", before))))


def _one_line(text: str) -> str:
    """Spaced alike: none before a comma, some around "=" that is not of an index."""
    return re.sub(r" ?=(?![^{}]*\}) ?", " = ", re.sub(r" (?=[,;])", "", " ".join(text.split()))).strip(" ,.;")
