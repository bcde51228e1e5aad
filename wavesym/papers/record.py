"""A claim and how it is judged: tried as printed, tried as corrected, and tried with faults put in.

What a formula means as transcribed, what it should mean, and what it becomes with a fault in it are *readings*: values
of one type R, which the claim's `cases` turns into comparisons of a printed value with a true one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Generic, Literal, TypeVar

from flint import fmpq

R = TypeVar("R")

Slipped = Literal["misprint", "unreadable", "convention", "model"]
Verdict = Literal["holds", "misprint", "unreadable", "convention", "model", "untested"]

VERDICTS: dict[Verdict, str] = {
    "holds": "right as transcribed",
    "misprint": "has a meaning as transcribed, which is wrong; the correction holds in every case tried",
    "unreadable": "has no meaning as transcribed, or not the one meant beyond doubt: the scan is garbled at the spot; "
    "the reading given holds in every case tried",
    "convention": "holds under the convention given, and only under that",
    "model": "holds as mathematics, but does not say what the text says it does",
    "untested": "no case could have turned it, or no correction that holds is known",
}


@dataclass(frozen=True)
class Case:
    """One comparison: where (parameters and indices), the value as printed, the true value.

    `telling`: whether it says anything (0 = 0 does not).
    """

    at: Mapping[str, object]
    printed: object
    true: object
    telling: bool = True

    @property
    def agrees(self) -> bool:
        return self.printed == self.true

    def __str__(self) -> str:
        where = ", ".join(f"{name} = {shown(value)}" for name, value in self.at.items())
        return f"{where}: printed {shown(self.printed)}, true {shown(self.true)}"


@dataclass(frozen=True)
class Slip(Generic[R]):
    """What is wrong as transcribed: the right formula, its reading, and how sure that is (or which convention)."""

    kind: Slipped
    corrected: str
    reading: R
    note: str


@dataclass(frozen=True)
class Claim(Generic[R]):
    """A formula or statement of the paper.

    `printed` is the literal transcription, `scan` what the scanned text has where that reads otherwise; `ranges` are
    its variables. `cases` come in order of size, the smallest first.
    `mutations` are faults in the reading that holds, by what was changed. `difference`, where it can be written, is
    printed minus derived. `mathematics` are the cases in which a `model` holds nevertheless.
    """

    id: str
    where: str
    printed: str
    ranges: str
    against: str
    cases: Callable[[R], Iterable[Case]]
    reading: R
    mutations: Mapping[str, R]
    slip: Slip[R] | None = None
    difference: Callable[[R], str] | None = None
    mathematics: Callable[[R], Iterable[Case]] | None = None
    note: str = ""
    observed: Callable[[], str] | None = None
    scan: str | None = None


@dataclass(frozen=True)
class Record:
    """A claim with its verdict; `cases` counts those that told something, `problems` is empty where all is well."""

    id: str
    where: str
    printed: str
    ranges: str
    against: str
    verdict: Verdict
    corrected: str | None
    evidence: str
    cases: int
    mutations: Mapping[str, bool]
    counterexample: Case | None = None
    difference: str | None = None
    problems: tuple[str, ...] = field(default=())
    scan: str | None = None


def judge(claim: Claim[R]) -> Record:
    """The verdict on a claim, with its evidence."""
    tried = _Trial(claim.cases(claim.reading))
    slip = claim.slip
    problems: list[str] = []
    right = claim.reading
    evidence: list[str] = []
    verdict: Verdict = "holds"
    settled = tried
    if slip:
        right, verdict = slip.reading, slip.kind
        settled = _Trial(claim.cases(right))
        if tried.wrong is None:
            problems.append("called wrong, yet no case shows it")
        if settled.wrong:
            problems.append(f"the correction fails at {settled.wrong}")
        if tried.wrong:
            evidence.append(f"fails at {tried.wrong}.")
        evidence.append(f"As corrected it holds in {settled.telling} cases. {slip.note}".strip())
        if claim.mathematics:
            proved = _Trial(claim.mathematics(claim.reading))
            if proved.wrong or not proved.telling:
                problems.append(f"does not hold as mathematics either: {proved.wrong}")
            evidence.append(f"As mathematics it holds in {proved.telling} cases.")
    elif tried.wrong:
        problems.append(f"fails at {tried.wrong}, no correction known")
    else:
        evidence.append(f"holds in {tried.telling} cases.")
    turned = {
        change: _Trial(claim.cases(reading), stop=True).wrong is not None for change, reading in claim.mutations.items()
    }
    problems += [f"not turned by a fault: {change}" for change, seen in turned.items() if not seen]
    if not settled.telling:
        problems.append("no case tells anything")
    if not turned:
        problems.append("no fault was tried")
    difference = None
    if claim.difference:
        difference = claim.difference(claim.reading)
        if claim.difference(right) != "0":
            problems.append(f"printed minus derived is {claim.difference(right)} where it is said to hold")
    if claim.observed:
        evidence.append(claim.observed())
    if claim.note:
        evidence.append(claim.note)
    return Record(
        claim.id,
        claim.where,
        claim.printed,
        claim.ranges,
        claim.against,
        "untested" if problems else verdict,
        slip.corrected if slip else None,
        " ".join(evidence + problems),
        settled.telling,
        turned,
        tried.wrong,
        difference,
        tuple(problems),
        claim.scan,
    )


class _Trial:
    """Cases gone through: how many told something, and the first that failed."""

    def __init__(self, cases: Iterable[Case], stop: bool = False) -> None:
        self.telling = 0
        self.wrong: Case | None = None
        for case in cases:
            self.telling += case.telling
            if not case.agrees and self.wrong is None:
                self.wrong = case
                if stop:
                    break


def shown(value: object) -> str:
    """A value in a sentence: exact numbers as they are, measured ones to four digits."""
    match value:
        case bool():
            return "yes" if value else "no"
        case None:
            return "nothing"
        case float():
            return f"{value:.4g}"
        case Fraction() | fmpq() | int() | str():
            return str(value)
        case dict():
            return "(" + ", ".join(f"{key} = {shown(part)}" for key, part in value.items()) + ")"
        case tuple() | list() | range():
            return "(" + ", ".join(map(shown, value)) + ")"
        case set() | frozenset():
            return "{" + ", ".join(sorted(map(shown, value))) + "}"
    return str(value)


def by_size(sizes: Iterable[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """Pairs such as (m, n), the smallest first."""
    return iter(sorted(sizes, key=lambda pair: (sum(pair), pair)))
