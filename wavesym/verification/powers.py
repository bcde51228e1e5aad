"""The powers of `documents.derivation.highest_powers`, proved as upper bounds for all i, n, m, from the derived laws.

The functions of a system are found one after the other from their laws. Let a function have a family's letter T at most
max(0, 1 + floor(budget/period)) times and be 0 unless since >= 0; that holds for it when, for each term of its law,

    since >= since of the term,   budget >= budget of the term + (period, where the law gives another T),

and budget >= since where the law's own body is of the family, so that a first T is allowed for; and when both are at
least 0 where a load starts it. With the places of i, l and s written out by numbers that are not negative, each
difference is a sum of these with coefficients that are not negative; that is what is shown, term by term.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

from sympy import Expr, Integer, Symbol, expand

from wavesym.derivation.delay import COUNT, INDEX
from wavesym.derivation.delay_terms import exact
from wavesym.derivation.recurrence import RATE, CoefficientLaw, SymbolicTerm, recurrence
from wavesym.documents.derivation.highest_powers import BODY, INTERVAL, SOURCE, PowerFamily, PowerRow
from wavesym.mechanics.node import System

NUMBERS = tuple(Symbol(name, integer=True, nonnegative=True) for name in "abcd")
"""Numbers 0, 1, 2, ... by which i, m, l and s are written."""
_PLACE, _REST, _AWAY, _FAR = NUMBERS

Region = Mapping[Symbol, Expr]


@dataclass(frozen=True)
class Step:
    """One inequality of the induction: `slack` >= 0 for function `of` from `because`, body and source where `where`."""

    function: str
    because: str
    where: str
    slack: Expr

    @property
    def holds(self) -> bool:
        """Whether the slack is seen to be at least 0, whatever the numbers."""
        return all(value >= 0 for value in expand(self.slack).as_coefficients_dict().values()) and bool(
            self.slack.is_nonnegative
        )


def steps(system: System, family: PowerFamily) -> Iterator[Step]:
    """Every inequality of the proof for a family. LookupError where a function has no row."""
    for law in recurrence(system).laws:
        for places in _places(system, family, law):
            row, place = _row(family, law.function, law.rod, places)
            node = _evaluate_row(row.node, place, places)
            for body in _bodies(family, node, places):
                for source in _sources(family, node, places):
                    yield from _law_steps(family, law, {**places, **body, **source})


def _places(system: System, family: PowerFamily, law: CoefficientLaw) -> Iterator[Region]:
    """All i and m of a law, by numbers that are not negative: i alone, first, last, or in between."""
    if exact(law.first - law.last) == 0:
        m = family.smallest + system.step * _REST
        yield {COUNT: m, INDEX: exact(law.first.subs(COUNT, m))}
        return
    for before, after in product((Integer(0), 1 + _PLACE), (Integer(0), 1 + _REST)):
        i = exact(law.first + law.step * before)
        m = exact(i + law.step * after - law.last + COUNT)  # last is m less a number
        if not (m - family.smallest).is_negative:
            yield {COUNT: m, INDEX: i}


def _bodies(family: PowerFamily, node: Expr, places: Region) -> Iterator[Region]:
    """Where the body of the family is: nowhere where it is any of them, at its place, or about `node`."""
    first, last = (exact(value.subs(places)) for value in (family.first, family.last))
    if family.is_merged:
        yield {}
    elif first == last:
        yield {BODY: first}
    else:
        yield from _regions_around(BODY, node, first, last, family.step, _AWAY)


def _sources(family: PowerFamily, node: Expr, places: Region) -> Iterator[Region]:
    """Where the source is: at its place, or about `node`."""
    first, last = (exact(value.subs(places)) for value in family.sources)
    if first == last:
        yield {SOURCE: first}
    else:
        yield from _regions_around(SOURCE, node, first, last, 1, _FAR)


def _regions_around(symbol: Symbol, node: Expr, first: Expr, last: Expr, step: int, away: Symbol) -> Iterator[Region]:
    """`symbol` at a node, before and after it, as far as there is room between first and last."""
    before, after = exact(node - first), exact(last - node)
    if not before.is_nonpositive:
        yield {symbol: exact(node - step * (1 + away))}
    if not (before.is_negative or after.is_negative):
        yield {symbol: node}
    if not after.is_nonpositive:
        yield {symbol: exact(node + step * (1 + away))}


def _law_steps(family: PowerFamily, law: CoefficientLaw, at: Region) -> Iterator[Step]:
    row, place = _row(family, law.function, law.rod, at)
    since, budget = (_evaluate_row(value, place, at) for value in (row.start, row.budget))
    own = law.own.jump != 0 and _of_family(family, _evaluate_row(row.node, place, at), at)
    names = {
        "function": f"{law.function}_{law.rod}",
        "where": ", ".join(f"{name} = {value}" for name, value in at.items()),
    }
    for term in law.terms:
        other, there = _row(family, term.function, term.rod, at)
        earlier = {**at, INTERVAL: INTERVAL - term.back}
        visit = family.period if own and _adds_a_visit(law, term) else 0
        because = f"{term.function}_{term.rod}, {term.back} before"
        yield Step(
            because=f"since, {because}", slack=exact(since - _evaluate_row(other.start, there, earlier)), **names
        )
        yield Step(
            because=f"budget, {because}",
            slack=exact(budget - _evaluate_row(other.budget, there, earlier) - visit),
            **names,
        )
    if own:
        yield Step(because="a first visit", slack=exact(budget - since), **names)
    for load in law.loads:
        start = {**at, INTERVAL: Integer(load.back + 1)}
        if load.number is not None:
            start[SOURCE] = exact(load.number.subs(at))
            first, last = (exact(value.subs(at)) for value in family.sources)
            if (start[SOURCE] - first).is_negative or (last - start[SOURCE]).is_negative:
                continue
        for value in (row.start, row.budget) if own else (row.start,):
            yield Step(because=f"load {load.kind}", slack=_evaluate_row(value, place, start), **names)


def _row(family: PowerFamily, function: str, rod: Expr, at: Region) -> tuple[PowerRow, Expr]:
    """The row about a function of a rod, and the rod by numbers. LookupError."""
    place = exact(rod.subs(at))
    for row in family.rows:
        first, last = (exact(value.subs(COUNT, at[COUNT])) for value in (row.first, row.last))
        steps = exact((place - first) / row.step)
        inside = steps.is_nonnegative and steps.is_integer and exact(last - place).is_nonnegative
        if row.function == function and (steps == 0 or (row.rod == INDEX and inside)):
            return row, place
    raise LookupError(f"{function}_{place}, m = {at[COUNT]}")


def _evaluate_row(value: Expr, place: Expr, at: Region) -> Expr:
    """A formula of a row, whose i is `place`, by numbers."""
    return exact(value.xreplace({**at, INDEX: place}))


def _of_family(family: PowerFamily, node: Expr, at: Region) -> bool:
    if not family.is_merged:
        return bool(at[BODY] == node)
    first, last = (exact(value.subs(at)) for value in (family.first, family.last))
    return bool((node - first).is_nonnegative and (last - node).is_nonnegative)


def _adds_a_visit(law: CoefficientLaw, term: SymbolicTerm) -> bool:
    """(a D + b)/(D + q) = a + (b/q - a) T has a T unless b = a q."""
    q = law.own.same.subs(RATE, 0) / law.own.jump
    return bool(exact(term.weights.same.subs(RATE, q)) != 0)
