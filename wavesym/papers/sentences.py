"""Prose that can be judged: sentences of a controlled English, read by patterns with places for words.

A pattern says what may stand in each of its places; the words that do are the reading, and every other word that may
stand there is a fault to be tried.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from wavesym.papers.reader import UnreadableError
from wavesym.papers.record import Reading, Sentence


@dataclass(frozen=True)
class Pattern:
    """A sentence with places in braces, such as "the {quantity} at x = {place} rises", and the words for each.

    A place whose words include "" may be left out, with a space or comma of its own inside the words.
    """

    name: str
    text: str
    words: Mapping[str, Sequence[str]]

    @cached_property
    def _expression(self) -> re.Pattern[str]:
        parts = re.split(r"\{(\w+)\}", self.text)
        pattern = ""
        for number, part in enumerate(parts):
            if number % 2:
                choices = "|".join(re.escape(word) for word in sorted(self.words[part], key=len, reverse=True))
                pattern += f"(?P<{part}>{choices})"
            else:
                pattern += re.escape(part)
        return re.compile(pattern)

    def match(self, sentence: str) -> Sentence | None:
        """The sentence with its words, where it is one of this pattern."""
        found = self._expression.fullmatch(sentence)
        return Sentence(self.name, found.groupdict()) if found else None

    def others(self, sentence: Sentence) -> Iterator[tuple[str, Sentence]]:
        """The same sentence with one word changed, by what was changed."""
        for place, choices in self.words.items():
            for word in choices:
                if word != sentence.words[place]:
                    change = f"{word or 'nothing'} for {sentence.words[place] or 'nothing'}"
                    yield change, Sentence(self.name, {**sentence.words, place: word})


def sentence_reader(patterns: Iterable[Pattern]) -> _Reader:
    """What reads sentences of some patterns, and puts faults into them."""
    return _Reader(tuple(patterns))


class _Reader:
    def __init__(self, patterns: Sequence[Pattern]) -> None:
        self._patterns = {pattern.name: pattern for pattern in patterns}

    def read(self, printed: str, ranges: Iterable[str]) -> Reading:
        """The reading of a sentence; UnreadableError where no pattern has it."""
        for pattern in self._patterns.values():
            if sentence := pattern.match(printed):
                return Reading(sentence)
        raise UnreadableError(f"no pattern has the sentence: {printed}")

    def faults(self, right: Reading) -> Iterator[tuple[str, Reading]]:
        """Every other word in every place."""
        for change, sentence in self._patterns[right.formula.pattern].others(right.formula):
            yield change, Reading(sentence)
