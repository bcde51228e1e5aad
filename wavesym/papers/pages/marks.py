"""What is marked where two versions of a formula or a sentence differ: tokens that the other version does not have."""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterator, Sequence
from difflib import SequenceMatcher
from itertools import accumulate

_TOKENS = re.compile(r"\\(?:d?dot|bar|mathcal)\{[^{}]*\}|\\(?:begin|end)\{cases\}|\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|\S")
"""Of LaTeX; a letter is one token with its accent."""
_STRUCTURE = re.compile(r"[{}_^&]|\\(?:frac|sum|left|right|begin.*|end.*|\\)")
"""Tokens that say where others stand, which cannot be marked."""


Token = tuple[int, str]
"""How many braces it stands in, and what it is: an index and a term are not the same."""


def tokens(text: str) -> list[Token]:
    """The tokens of a formula in LaTeX, without spaces."""
    parts: list[Token] = []
    for token in _TOKENS.findall(text):
        depth = parts[-1][0] + (parts[-1][1] == "{") if parts else 0
        parts.append((depth - (token == "}"), token))
    return parts


def differences(one: Sequence[Hashable], other: Sequence[Hashable]) -> tuple[frozenset[int], frozenset[int]]:
    """The places in each of two sequences of what the other does not have, by the longest common blocks."""
    blocks = [block for block in SequenceMatcher(a=one, b=other, autojunk=False).get_opcodes() if block[0] != "equal"]
    return (
        frozenset(place for _, start, end, _, _ in blocks for place in range(start, end)),
        frozenset(place for _, _, _, start, end in blocks for place in range(start, end)),
    )


def differing_tokens(one: Sequence[str], other: Sequence[str]) -> tuple[list[frozenset[int]], list[frozenset[int]]]:
    """The places of the tokens that differ, in each formula of two lists in LaTeX; none where they share nothing."""
    lists = [[tokens(f"{text},") for text in texts] for texts in (one, other)]
    flat = [[token for each in rows for token in each] for rows in lists]
    shown = [{token for token in row if token[1] != "," and not _STRUCTURE.fullmatch(token[1])} for row in flat]
    if all(shown) and shown[0].isdisjoint(shown[1]):
        return [frozenset() for _ in one], [frozenset() for _ in other]
    first, second = (
        [
            frozenset(place - start for place in places if start <= place < start + len(row) - 1)
            for row, start in zip(rows, accumulate(map(len, rows), initial=0), strict=False)
        ]
        for rows, places in zip(lists, differences(*flat), strict=True)
    )
    return first, second


def mark(pieces: Sequence[str], places: frozenset[int]) -> list[str]:
    """A formula in LaTeX, in pieces, with \\marked{} around its tokens at some places."""
    number = -1

    def mark_piece(piece: str) -> Iterator[str]:
        nonlocal number
        end, before, closing = 0, "", ""
        for token in _TOKENS.finditer(piece):
            number += 1
            is_marked = number in places and not _STRUCTURE.fullmatch(token[0])
            if closing == "}}" or not is_marked:
                yield closing
                closing = ""
            yield piece[end : token.start()]
            if is_marked and not closing:
                is_script = before in ("^", "_")  # of one token
                closing = "}}" if is_script else "}"
                yield r"{\marked{" if is_script else r"\marked{"
            yield token[0]
            end, before = token.end(), token[0]
        yield closing + piece[end:]

    return ["".join(mark_piece(piece)) for piece in pieces]
