"""How a verdict comes about: a record tried as printed, tried as corrected, and tried with faults put in.

What is printed is what is judged: a reading is made from the strings of the record, and in no other way.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, Literal

from flint import fmpq

from wavesym.papers.difference import subtract
from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.exact_numbers import Exponentials
from wavesym.papers.mutations import ends, mutations
from wavesym.papers.reader import UnreadableError, read_formula, read_range
from wavesym.papers.tree import Tree, latex

Verdict = Literal["holds", "misprint", "unreadable", "convention", "model", "depends", "incomplete", "untested"]

VERDICTS: dict[Verdict, str] = {
    "holds": "right as printed",
    "misprint": "has a meaning as printed, which is wrong; the correction holds in every case tried",
    "unreadable": "has no value as printed wherever it fails: the reading given holds in every case tried",
    "convention": "holds under the convention given, and only under that",
    "model": "holds as mathematics, but does not say what the text says it does",
    "depends": "depends on data that the text does not give: true for some of what was tried, false for others",
    "incomplete": "true only under a hypothesis that is not printed",
    "untested": "no case could have turned it, or no correction that holds is known",
}


@dataclass(frozen=True)
class Reproduction:
    """Where a case can be seen: a scene, the command that shows it, and what to look at."""

    scene: str
    command: str
    look: str


@dataclass(frozen=True)
class Case:
    """One comparison: where (parameters and indices), the value as printed, the true value.

    `telling`: whether it says anything (0 = 0 does not). `example` makes the scene that shows it.
    """

    place: Mapping[str, object]
    printed_value: object
    true_value: object
    is_telling: bool = True
    example: Callable[[], Reproduction] | None = field(default=None, compare=False)

    @property
    def agrees(self) -> bool:
        return bool(self.printed_value == self.true_value)

    def __str__(self) -> str:
        where = ", ".join(f"{name} = {format_value(value)}" for name, value in self.place.items())
        match self.printed_value, self.true_value:
            case bool(), bool():
                sentence = f"what is printed is {'' if self.agrees else 'not '}so"
            case printed, true:
                verb = "has" if isinstance(printed, NoValue) else "gives"
                sentence = f"what is printed {verb} {format_value(printed)}; it should be {format_value(true)}"
        return f"With {where}, {sentence}" if where else sentence[0].upper() + sentence[1:]


@dataclass(frozen=True, eq=False)
class NoValue:
    """What a formula gives where it means nothing: the reason. Equal to no value."""

    why: str

    def __str__(self) -> str:
        return f"no value ({self.why})"


def case(
    at: Mapping[str, object],
    printed: Callable[[], object],
    true: object,
    telling: bool = True,
    example: Callable[[], Reproduction] | None = None,
) -> Case:
    """A case whose printed value may have no meaning."""
    try:
        value = printed()
    except MeaninglessError as error:
        value = NoValue(str(error))
    return Case(at, value, true, telling, example)


@dataclass(frozen=True)
class Sentence:
    """A sentence of the controlled English that prose is judged in: its pattern, and the words in its places."""

    pattern: str
    words: Mapping[str, str]

    def __hash__(self) -> int:
        return hash((self.pattern, tuple(self.words.items())))


@dataclass(frozen=True)
class Reading:
    """What a record says: its formula and its ranges (those printed, then those inferred), as read from its strings."""

    formula: Any
    ranges: tuple[Tree, ...] = ()


def reading(printed: str, ranges: Iterable[str]) -> Reading:
    """The reading of a formula; UnreadableError."""
    return Reading(read_formula(printed), tuple(map(read_range, ranges)))


def faults(
    right: Reading,
    of_formula: Callable[[Any], Iterable[tuple[str, Any]]] = mutations,
    kept_ranges: Collection[Tree] = (),
) -> Iterator[tuple[str, Reading]]:
    """Every fault in the formula, and both ends of every range but the kept ones; no two have the same name."""
    named = set()
    for change, formula in of_formula(right.formula):
        named.add(change)
        yield change, Reading(formula, right.ranges)
    for place, range_ in enumerate(right.ranges):
        for change, wrong in ends(range_) if range_ not in kept_ranges else ():
            name = f"{change}, in {latex(range_)}" if change in named else change
            named.add(name)
            yield name, Reading(right.formula, (*right.ranges[:place], wrong, *right.ranges[place + 1 :]))


@dataclass(frozen=True)
class Test:
    """How records of a kind are tried. `cases` come in order of size, the smallest first.

    `reference` is what they are compared with. `read` makes a reading of strings, `faults` puts faults into one.
    `is_subtracted`: whether printed less corrected is shown, term by term. `mathematics` are the cases in which a
    `model` holds nevertheless; `conventions` are those of what is printed under something that the text may mean, by
    what that is. `variation` is what the cases differ by, where the text does not give it. `observation` is what was
    measured, in a sentence.
    """

    __test__ = False  # not pytest's

    reference: str
    cases: Callable[[Reading], Iterable[Case]]
    read: Callable[[str, Iterable[str]], Reading] = reading
    faults: Callable[[Reading], Iterable[tuple[str, Reading]]] = faults
    is_subtracted: bool = False
    mathematics: Callable[[Reading], Iterable[Case]] | None = None
    conventions: Mapping[str, Callable[[Reading], Iterable[Case]]] = field(default_factory=dict)
    variation: str = ""
    observation: Callable[[], str] | None = None


Adapter = Callable[[PaperEntry], Test]


@dataclass(frozen=True)
class Mutations:
    """Faults tried and turned, and those that no case turned, each with the reason."""

    count: int = 0
    turned_count: int = 0
    survivors: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Record:
    """An entry with its verdict; `cases` counts those that told something, `problems` is empty where all is well.

    `evidence` is computed.
    """

    entry: PaperEntry
    reference: str
    verdict: Verdict
    evidence: tuple[str, ...]
    cases: int
    mutations: Mutations
    counterexample: Case | None = None
    difference: str | None = None
    problems: tuple[str, ...] = ()

    @property
    def id(self) -> str:
        return self.entry.id

    @property
    def note(self) -> str:
        """What is said of it beside the evidence: our reading, which nothing computes."""
        return " ".join(note for note in (self.entry.slip and self.entry.slip.note, self.entry.note) if note)

    @property
    def correction(self) -> str | None:
        """The whole formula or sentence as it should be, where what is printed does not hold."""
        return self.entry.slip.correction if self.entry.slip else None


def judge(entry: PaperEntry, test: Test, problems: Iterable[str] = ()) -> Record:
    """The verdict on an entry, with its evidence. `problems` are those of its transcription."""
    found = list(problems)
    slip = entry.slip
    stop_at: Literal["", "value"] = "value" if slip and not test.variation else ""
    settled = printed = _Trial.run(test, *entry.printed_strings, stop_at)
    evidence: list[str] = []
    verdict: Verdict = "holds"
    if slip:
        settled = _Trial.run(test, *entry.right_strings)
        if printed.wrong is None:
            found.append("called wrong, yet no case shows it")
        else:
            evidence.append(f"{printed.wrong}.")
        if settled.wrong:
            found.append(f"the correction fails: {settled.wrong}")
        evidence.append(f"As corrected it holds in {_all(settled.telling_count)}.")
        verdict, why = _kind(entry, test, printed)
        evidence.append(why)
    elif printed.wrong:
        found.append(f"fails, and no correction is known: {printed.wrong}")
    else:
        evidence.append(f"It holds in {_all(printed.telling_count)}.")
    if not settled.telling_count:
        found.append("no case tells anything")
    turned, unturned = _faulty(entry, test) if settled.wrong is None else (Mutations(), ())
    found += unturned
    difference = None
    if test.is_subtracted and slip and not settled.wrong:
        difference = _difference(test, entry.statement, slip.correction)
    if test.observation:
        evidence.append(test.observation())
    return Record(
        entry,
        test.reference,
        "untested" if found else verdict,
        tuple(evidence),
        settled.telling_count,
        turned,
        printed.wrong,
        difference,
        tuple(found),
    )


def _kind(entry: PaperEntry, test: Test, printed: _Trial) -> tuple[Verdict, str]:
    """What kind of slip the cases show, and by what."""
    under: list[tuple[Verdict, str, Callable[[Reading], Iterable[Case]]]] = []
    if test.mathematics:
        under.append(("model", "As mathematics", test.mathematics))
    under += [("convention", f"Where {meaning},", cases) for meaning, cases in test.conventions.items()]
    for verdict, words, cases in under:
        trial = _Trial.run(replace(test, cases=cases), *entry.printed_strings, stop_at="failure")
        if trial.telling_count and trial.wrong is None:
            return verdict, f"{words} it holds as printed in {_all(trial.telling_count)}."
    if printed.false is None:
        return "unreadable", "Wherever it fails it has no value."
    if test.variation and printed.agreeing_count:
        return "depends", f"It is so under some of the {test.variation} that were tried, and not under others."
    if _adds(entry):
        return "incomplete", "The correction adds a hypothesis and changes nothing else."
    return "misprint", "Where it fails it has a value, which is wrong."


def _adds(entry: PaperEntry) -> bool:
    """Whether what is right is what is printed and something more: ranges, or words in one place."""
    slip, before = entry.slip, entry.statement
    assert slip
    if slip.correction == before:
        return slip.ranges is not None and {*entry.ranges} < {*slip.ranges}
    cuts = ((before[:at], before[at:]) for at in range(len(before) + 1))
    right = slip.correction if entry.english else ""
    return any(right.startswith(start) and right.endswith(end) for start, end in cuts)


def _difference(test: Test, printed: str, corrected: str) -> str | None:
    """Printed less corrected, where both can be read and differ."""
    try:
        return subtract(test.read(printed, ()).formula, test.read(corrected, ()).formula) or None
    except UnreadableError:
        return None


def _faulty(entry: PaperEntry, test: Test) -> tuple[Mutations, tuple[str, ...]]:
    """The faults tried in what holds; and what is wrong with them."""
    reasons = dict(entry.equivalent)
    tried, problems, survived = 0, [], []
    for change, wrong in test.faults(test.read(*entry.right_strings)):
        tried += 1
        turned = _Trial.is_turned(test, wrong)
        if turned and change in reasons:
            problems.append(f"called equivalent, yet a case turns it: {change}")
        elif not turned and change not in reasons:
            problems.append(f"not turned by a fault: {change}")
        if not turned:
            survived.append((change, reasons.pop(change, "")))
        else:
            reasons.pop(change, None)
    problems += [f"called equivalent, yet no such fault: {change}" for change in reasons]
    if not tried:
        problems.append("no fault was tried")
    return Mutations(tried, tried - len(survived), tuple(survived)), tuple(problems)


class _Trial:
    """Cases gone through: how many told something and how many of these agreed, and the first that failed.

    `false` is the first that failed with a value. What to `stop_at` is a failure, or one with a value.
    """

    def __init__(self, cases: Iterable[Case], stop_at: Literal["", "failure", "value"] = "") -> None:
        self.telling_count = self.agreeing_count = 0
        self.wrong: Case | None = None
        self.false: Case | None = None
        try:
            for tried in cases:
                self.telling_count += tried.is_telling
                self.agreeing_count += tried.is_telling and tried.agrees
                if not tried.agrees:
                    self.wrong = self.wrong or tried
                    if not isinstance(tried.printed_value, NoValue):
                        self.false = self.false or tried
                    if stop_at == "failure" or (stop_at == "value" and self.false):
                        break
        except MeaninglessError as error:
            self.wrong = self.wrong or Case({}, NoValue(str(error)), "a value")

    @classmethod
    def run(cls, test: Test, text: str, ranges: Iterable[str], stop_at: Literal["", "failure", "value"] = "") -> _Trial:
        """A string tried, to its end or to the first case that fails; one that cannot be read fails."""
        try:
            read = test.read(text, ranges)
        except UnreadableError as error:
            return cls(iter([Case({}, NoValue(str(error)), "a formula")]))
        return cls(test.cases(read), stop_at)

    @classmethod
    def is_turned(cls, test: Test, read: Reading) -> bool:
        """Whether a faulty reading is seen."""
        return cls(test.cases(read), stop_at="failure").wrong is not None


def format_value(value: object) -> str:
    """A value in a sentence: exact numbers as they are, measured ones to four digits."""
    match value:
        case bool():
            return "yes" if value else "no"
        case None:
            return "nothing"
        case float():
            return f"{value:.4g}"
        case Fraction() | fmpq() | int() | str() | Exponentials():
            return str(value)
        case dict():
            return "(" + ", ".join(f"{key} = {format_value(part)}" for key, part in value.items()) + ")"
        case tuple() | list() | range():
            return "(" + ", ".join(map(format_value, value)) + ")"
        case set() | frozenset():
            return "{" + ", ".join(sorted(map(format_value, value))) + "}"
    return str(value)


def _all(cases: int) -> str:
    return "the one case" if cases == 1 else f"all {cases} cases"


def by_size(sizes: Iterable[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """Pairs such as (m, n), the smallest first."""
    return iter(sorted(sizes, key=lambda pair: (sum(pair), pair)))
