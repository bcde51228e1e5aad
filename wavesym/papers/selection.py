"""Where a printed string stands in the lines of its passage: without layout, and with its edits.

A record does not repeat the text of its passage. Its `printed` string and its ranges, without what only lays them out,
are looked for in the passage, which is read in the same way after the record's edits; what was found is its scan.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

Edits = Iterable[tuple[str, str, str]]
"""From, to, and why."""

_LAYOUT: Sequence[tuple[re.Pattern[str], str]] = tuple(
    (re.compile(pattern), instead)
    for pattern, instead in (
        (r"(?s)&(?=(?:(?!\\begin\{).)*\\end\{cases\})", " , "),
        (r"\\(?:begin|end)\{cases\}", " "),
        (r"\\begin\{aligned\}|\\end\{aligned\}|\\left\.|\\right\.|\$|&|\\\\|\\quad", " "),
        (r"\\left(?=[\W_])|\\right(?=[\W_])", " "),
        (r"\\text\{([^}]*)\}", r"\1"),
        (r"(^|\s)dla(\s|$)", " , "),
        (r"\s+", ""),
        (r",+", ","),
    )
)


@dataclass(frozen=True)
class TracedText:
    """A text that was changed; `spans` are the start and end in the source of each of its characters."""

    text: str
    spans: tuple[tuple[int, int], ...]

    @classmethod
    def from_source(cls, source: str) -> TracedText:
        """A source as it stands."""
        return cls(source, tuple((place, place + 1) for place in range(len(source))))

    def replace(self, pattern: re.Pattern[str], instead: str) -> TracedText:
        """Every match replaced; each character of what stands there instead has the span of the whole match."""
        text, spans, end = "", list[tuple[int, int]](), 0
        for match in pattern.finditer(self.text):
            new, start = match.expand(instead), match.start()
            text += self.text[end:start] + new
            spans += self.spans[end:start]
            end = match.end()
            spans += [(self.spans[start][0], self.spans[end - 1][1])] * len(new)
        return TracedText(text + self.text[end:], (*spans, *self.spans[end:]))

    def edit(self, before: str, after: str) -> TracedText:
        """Plain text put for other plain text; where that is nothing, the next character has its place."""
        start = self.text.find(before)
        if after or start < 0:
            return self.replace(re.compile(re.escape(before)), after.replace("\\", r"\\"))
        end = start + len(before)
        first = self.spans[start][0], self.spans[end][1]
        return TracedText(self.text[:start] + self.text[end:], (*self.spans[:start], first, *self.spans[end + 1 :]))


@lru_cache(maxsize=64)
def _without_layout(source: str) -> TracedText:
    traced = TracedText.from_source(source)
    for pattern, instead in _LAYOUT:
        traced = traced.replace(pattern, instead)
    return traced


def plain(text: str) -> str:
    """A formula without what only lays it out: spaces, alignment, braces of cases, sizes of brackets.

    "dla" (for), and what stands for it in cases, is a comma.
    """
    return _without_layout(text).text.strip(",.;")


def position(
    source: str, strings: Sequence[str], edits: Edits = (), used: Iterable[tuple[int, int]] = ()
) -> tuple[int, int] | None:
    """Where a source has some strings, one after another, once it is edited.

    Args:
        source: the lines of a passage.
        strings: what is printed, and its ranges.
        edits: what is read otherwise than it stands.
        used: parts that are selected already: where the strings stand more than once, another part comes first.

    Returns:
        The start and the end of the part; None where there is none.
    """
    traced, searched = _without_layout(source), plain(",".join(strings))
    for before, after, _ in edits:
        traced = traced.edit(plain(before), plain(after))
    if not searched:
        return None
    starts = [match.start() for match in re.finditer(f"(?={re.escape(searched)})", traced.text)]
    spans = [
        _extend_span(source, traced.spans[start][0], traced.spans[start + len(searched) - 1][1], strings[-1])
        for start in starts
    ]
    taken = set(used)
    return next((span for span in spans if span not in taken), spans[0] if spans else None)


def _extend_span(source: str, start: int, end: int, printed: str) -> tuple[int, int]:
    """A part, longer by the end of cases that it begins, the dollar signs around it, and its last full stop."""
    part = source[start:end]
    if part.count(_CASES_BEGIN) > part.count(_CASES_END):
        end = source.index(_CASES_END, end) + len(_CASES_END)
    start -= bool(_DOLLAR.match(source, start - 1)) if start else 0
    end += bool(_DOLLAR.match(source, end))
    stop = re.compile(rf"\s*{re.escape(printed[-1])}").match(source, end) if printed[-1] in ".:,;" else None
    return start, stop.end() if stop else end


_CASES_BEGIN, _CASES_END, _DOLLAR = r"\begin{cases}", r"\end{cases}", re.compile(r"(?<!\$)\$(?!\$)")
