"""What section 4 says of the solutions in words.

The patterns of the sentences (sentences.py) are in sayings.toml; listed.py and dependence.py have the cases that their
words give.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from wavesym.papers.entries import PaperEntry
from wavesym.papers.pielorz1979 import dependence, listed
from wavesym.papers.pielorz1979.listed import Words
from wavesym.papers.record import Case, Reading, Test
from wavesym.papers.sentences import SentencePattern, sentence_reader


@cache
def sayings() -> Mapping[str, tuple[SentencePattern, str]]:
    """The patterns of sentences, each with what it is compared with, by name."""
    return {
        name: (SentencePattern(name, said["text"], said["words"]), said["against"]) for name, said in _sayings().items()
    }


@cache
def _sayings() -> Mapping[str, Any]:
    return tomllib.loads(Path(__file__).with_name("sayings.toml").read_text(encoding="utf-8"))


def solution(entry: PaperEntry) -> Test:
    """Adapter: a sentence about the solutions."""
    reader = sentence_reader(pattern for pattern, _ in sayings().values())
    told = entry.slip.corrected if entry.slip else entry.statement
    against = next((against for pattern, against in sayings().values() if pattern.match(told)), "nothing known")

    def cases(reading: Reading) -> Iterator[Case]:
        return CASES[reading.formula.pattern](reading.formula.words)

    said = next((pattern.name for pattern, _ in sayings().values() if pattern.match(entry.statement)), None)
    meant = _sayings()[said].get("convention", {}) if said else {}

    def as_meant(reading: Reading) -> Iterator[Case]:
        return CASES[reading.formula.pattern]({**reading.formula.words, **meant["words"]})

    return Test(against, cases, reader.read, reader.faults, conventions={meant["meaning"]: as_meant} if meant else {})


CASES: Mapping[str, Callable[[Words], Iterator[Case]]] = {
    "lengths": dependence.lengths,
    "entier": dependence.entier,
    "table_2": listed.table("I"),
    "table_3": listed.table("II"),
    "table_4": listed.table("III"),
    "count": listed.count,
    "others": listed.others,
    "indices_4_9": listed.index_roles("I"),
    "indices_4_10": listed.index_roles("II"),
    "indices_4_12": listed.index_roles("III"),
    "moments": dependence.acting_moments,
    "unlisted": dependence.unlisted,
    "masses": dependence.masses,
    "series": dependence.series,
    "connected": dependence.connected,
    "meetings": dependence.meetings,
    "earlier": dependence.earlier,
    "changes_1": dependence.changes_1,
    "changes_3": dependence.changes_3,
    "parts": dependence.parts,
    "fields": dependence.by_4_2,
    "slopes": dependence.slopes,
}
"""What is tried for the words of a saying, by its name."""
