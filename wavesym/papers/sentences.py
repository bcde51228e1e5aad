"""Prose that can be judged: sentences of a controlled English, read by patterns with places for words.

A pattern says what may stand in each of its places; the words that do are the reading, and every other word that may
stand there is a fault to be tried.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope, holds
from wavesym.papers.mutations import mutations
from wavesym.papers.reader import UnreadableError, read_formula, read_range
from wavesym.papers.record import Adapter, Case, Reading, Sentence, Test, faults
from wavesym.papers.tree import latex

Words = Mapping[str, str]
LIST = "; "
"""What stands between the words of a list."""


@dataclass(frozen=True)
class SentencePattern:
    """A sentence with places in braces, such as "the {quantity} at x = {place} rises", and the words for each.

    A place whose words include "" may be left out, with a space or comma of its own inside the words. One for which no
    words are given takes a formula. After a sentence may stand `list_opening`, and a list of some words. `data` is what
    else is known of it.
    """

    name: str
    text: str
    words: Mapping[str, Sequence[str]]
    list_opening: str = ""
    list_words: Sequence[str] = ()
    data: Mapping[str, Any] = field(default_factory=dict, hash=False)

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
        return re.compile(pattern + (f"({re.escape(self.list_opening)}(?P<listed>.*))?" if self.list_opening else ""))

    def match(self, sentence: str) -> Sentence | None:
        """The sentence with its words, where it is one of this pattern; UnreadableError for a list of other words."""
        match = self._expression.fullmatch(sentence)
        if not match:
            return None
        words = {place: word for place, word in match.groupdict().items() if word is not None}
        if unknown := sorted(set(words.get("listed", "").split(LIST)) - {*self.list_words, ""}):
            raise UnreadableError(f"nothing is called {', '.join(unknown)}")
        return Sentence(self.name, words)

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
        own = sentence.words.get("listed")
        for word in self.list_words if own is not None else ():
            names = own.split(LIST) if own else []
            change = f"not under {word}" if word in names else f"under {word} too"
            names = [name for name in names if name != word] if word in names else [*names, word]
            yield change, Sentence(self.name, {**sentence.words, "listed": LIST.join(names)})


class SentenceReader:
    """What reads sentences of some patterns, and puts faults into them."""

    def __init__(self, patterns: Iterable[SentencePattern]) -> None:
        self.patterns = {pattern.name: pattern for pattern in patterns}

    def sentence(self, text: str) -> Sentence:
        """A sentence with its words; UnreadableError where no pattern has it."""
        for pattern in self.patterns.values():
            if sentence := pattern.match(text):
                return sentence
        raise UnreadableError(f"no pattern has the sentence: {text}")

    def read(self, printed: str, ranges: Iterable[str]) -> Reading:
        """The reading of a sentence; UnreadableError where no pattern has it."""
        return Reading(self.sentence(printed), tuple(map(read_range, ranges)))

    def faults(self, right: Reading) -> Iterator[tuple[str, Reading]]:
        """Every other word in every place, and both ends of every range."""
        return faults(right, self.patterns[right.formula.pattern].others)

    def pattern_data(self, text: str) -> Mapping[str, Any]:
        """What else is known of a sentence's pattern; nothing where no pattern has it."""
        try:
            return self.patterns[self.sentence(text).pattern].data
        except UnreadableError:
            return {}


def read_patterns(path: Path) -> tuple[SentencePattern, ...]:
    """The patterns of a TOML file, by name: `text`, `words`, and what else is said of them."""
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    return tuple(SentencePattern(name, known["text"], known["words"], data=known) for name, known in data.items())


def sentence_test(
    patterns: Iterable[SentencePattern], cases: Mapping[str, Callable[[Words], Iterable[Case]]]
) -> Adapter:
    """How sentences are tried, those of the `patterns` whose names `cases` have.

    Of the cases those count that are within the ranges of a sentence. A pattern says what it is compared with, and may
    have a convention: other words that the text may mean.
    """
    reader = SentenceReader(pattern for pattern in patterns if pattern.name in cases)

    def cases_in_range(reading: Reading) -> Iterator[Case]:
        none = True
        for case in cases[reading.formula.pattern](reading.formula.words):
            if all(holds(range_, Scope(case.place)) for range_ in reading.ranges):
                none = False
                yield case
        if none:
            raise MeaninglessError("nothing is within its ranges")

    def test(entry: PaperEntry) -> Test:
        against = reader.pattern_data(entry.right_strings[0]).get("reference", "nothing known")
        meant = reader.pattern_data(entry.statement).get("convention")

        def intended_cases(reading: Reading) -> Iterator[Case]:
            words = {**reading.formula.words, **(meant["words"] if meant else {})}
            return cases_in_range(Reading(Sentence(reading.formula.pattern, words), reading.ranges))

        conventions = {meant["meaning"]: intended_cases} if meant else {}
        return Test(against, cases_in_range, reader.read, reader.faults, conventions=conventions)

    return test
