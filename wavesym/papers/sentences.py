"""Prose that can be judged: sentences of a controlled English, read by patterns with places for words.

A pattern says what may stand in each of its places; the words that do are the reading, and every other word that may
stand there is a fault to be tried.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds
from wavesym.papers.mutations import ends, mutations
from wavesym.papers.reader import UnreadableError, read_formula, read_range
from wavesym.papers.record import Adapter, Case, Reading, Sentence, Test
from wavesym.papers.tree import latex

Words = Mapping[str, str]


@dataclass(frozen=True)
class SentencePattern:
    """A sentence with places in braces, such as "the {quantity} at x = {place} rises", and the words for each.

    A place whose words include "" may be left out, with a space or comma of its own inside the words. One for which no
    words are given takes a formula.
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
                pattern += f"(?P<{part}>{choices or '.+'})"
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
            if not choices:
                for change, formula in mutations(read_formula(sentence.words[place])):
                    yield change, Sentence(self.name, {**sentence.words, place: latex(formula)})
            for word in choices:
                if word != sentence.words[place]:
                    change = f"{word or 'nothing'} for {sentence.words[place] or 'nothing'}"
                    yield change, Sentence(self.name, {**sentence.words, place: word})


def sentence_reader(patterns: Iterable[SentencePattern]) -> _Reader:
    """What reads sentences of some patterns, and puts faults into them."""
    return _Reader(tuple(patterns))


class _Reader:
    def __init__(self, patterns: Sequence[SentencePattern]) -> None:
        self._patterns = {pattern.name: pattern for pattern in patterns}

    def read(self, printed: str, ranges: Iterable[str]) -> Reading:
        """The reading of a sentence; UnreadableError where no pattern has it."""
        for pattern in self._patterns.values():
            if sentence := pattern.match(printed):
                return Reading(sentence, tuple(map(read_range, ranges)))
        raise UnreadableError(f"no pattern has the sentence: {printed}")

    def faults(self, right: Reading) -> Iterator[tuple[str, Reading]]:
        """Every other word in every place, and both ends of every range."""
        for change, sentence in self._patterns[right.formula.pattern].others(right.formula):
            yield change, Reading(sentence, right.ranges)
        for place, range_ in enumerate(right.ranges):
            for change, wrong in ends(range_):
                yield change, Reading(right.formula, (*right.ranges[:place], wrong, *right.ranges[place + 1 :]))


def sayings(path: Path, cases: Mapping[str, Callable[[Words], Iterable[Case]]]) -> Adapter:
    """How sentences are tried: their patterns, with what they are compared with, are in a file, `cases` goes by name.

    Of the cases those count that are within the ranges of a sentence.
    """
    known = tomllib.loads(path.read_text(encoding="utf-8"))
    patterns = [SentencePattern(name, told["text"], told["words"]) for name, told in known.items()]
    reader = sentence_reader(patterns)

    def tried(reading: Reading) -> Iterator[Case]:
        none = True
        for case in cases[reading.formula.pattern](reading.formula.words):
            if all(holds(range_, Scope(case.at)) for range_ in reading.ranges):
                none = False
                yield case
        if none:
            raise MeaninglessError("nothing is within its ranges")

    def adapter(entry: PaperEntry) -> Test:
        said = next((p for p in patterns if p.match(entry.settled[0])), None)
        return Test(known[said.name]["against"] if said else "nothing known", tried, reader.read, reader.faults)

    return adapter
