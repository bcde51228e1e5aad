"""III.1 ... III.22 one by one: each with the true values of the coefficients on its right, its guards, its range."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

from flint import fmpq

from wavesym.papers.exact_tables import Exact, building
from wavesym.papers.pielorz1979.building_alone import consequence
from wavesym.papers.pielorz1979.building_lines import CORRECTIONS, PRINTED
from wavesym.papers.pielorz1979.recurrence import At, Count, Factor, PrintedLine, PrintedTarget, PrintedTerm, with_terms
from wavesym.papers.record import Case, Claim, Slip, by_size

MOST_STOREYS, MOST_N = 7, 8
SOURCES = ("a", "b")


def claims() -> Iterator[Claim[PrintedLine]]:
    """The 22 lines."""
    for line in PRINTED:
        correction = CORRECTIONS.get(line.number)
        right = correction.line if correction else line
        yield Claim(
            id=f"III.{line.number}",
            where=f"section 4, coefficients of example III, line {line.number}",
            printed=line.printed,
            ranges="; ".join(filter(None, (line.ranges, "k = 0, ..., m_1; n = 0, 1, ...; m >= 3"))),
            against=f"exact tables with equal floors, m = 3 ... {MOST_STOREYS}, n = 0 ... {MOST_N}, values, ranges and "
            "the H of every term",
            cases=cases,
            reading=line,
            mutations=dict(_faults(right)),
            slip=Slip(correction.kind, correction.corrected, right, f"{correction.note} {consequence(line.number)}")
            if correction
            else None,
            difference=_minus(right),
            note=" ".join(
                (["H(0) = 1."] if any(term.guards for term in right.terms) else [])
                + (["Range and H are tested from n = 1 on; for n = 0 the text says g' = 0."] if line.strict else [])
            ),
            scan=line.scan,
        )


def coefficient(
    exact: Exact, source: str, term: PrintedTerm | PrintedTarget, rod: int, interval: int, power: int
) -> fmpq:
    """The true value of a coefficient; 0 where there is none."""
    rate, place = _place(exact, term.family, power)
    powers = exact.increment(source, term.letter, rod, interval).get(rate, [])
    return powers[place] if 0 <= place < len(powers) else fmpq(0)


def _place(exact: Exact, family: str, power: int) -> tuple[fmpq, int]:
    kappa = exact.chain.parameters.kappa
    return {
        "c": (fmpq(0), 0),
        "0": (fmpq(0), 1),
        "1": (2 * kappa[1], power),
        "m": (kappa[exact.m], power),
    }[family]


def cases(line: PrintedLine) -> Iterator[Case]:
    """All values first: a wrong one says more than a wrong range."""
    for exact, target, at in _places(line):
        for i in target.powers(at):
            yield from (_value(exact, line, target, replace(at, i=i), source) for source in SOURCES)
    for exact, target, at in _places(line):
        if at.n >= line.strict:
            if target.top:
                yield _range(exact, target, at)
            for i in target.powers(at):
                yield from _guards(exact, line, replace(at, i=i))


def _places(line: PrintedLine) -> Iterator[tuple[Exact, PrintedTarget, At]]:
    for m, n in by_size((m, n) for m in range(3, MOST_STOREYS + 1) for n in range(MOST_N + 1)):
        exact = building(m)
        for target in line.targets:
            for j in range(target.first(m), target.last(m) + 1) if n >= target.start else ():
                yield exact, target, At(m, n, j, 0, exact.chain.parameters.kappa)


def _range(exact: Exact, target: PrintedTarget, at: At) -> Case:
    rate, _ = _place(exact, target.family, 0)
    degree = exact.degree(target.letter, at.j, at.n + 1, rate)
    assert target.top
    claimed = max(target.top(at), -1)
    return Case({"m": at.m, "n": at.n, "j": at.j, "claim": "highest power"}, claimed, degree, telling=degree >= 0)


def _guards(exact: Exact, line: PrintedLine, at: At) -> Iterator[Case]:
    """H is 1 exactly where the coefficient behind it exists."""
    for term in line.terms:
        rod, interval, power = term.rod(at), at.n + 1 - term.back, term.power(at)
        if term.family in "1m":
            rate, place = _place(exact, term.family, power)
            exists = interval > 0 and place <= exact.degree(term.letter, rod, interval, rate)
        else:
            exists = exact.alive(term.letter, rod, interval)
        where = {"m": at.m, "n": at.n, "j": at.j, "i": at.i, "claim": f"{term.text} exists"}
        yield Case(where, term.on(at), exists, telling=bool(term.guards))


def _value(exact: Exact, line: PrintedLine, target: PrintedTarget, at: At, source: str) -> Case:
    true = coefficient(exact, source, target, at.j, at.n + 1, at.i)
    printed = fmpq(0)
    for term in line.terms:
        if term.on(at):
            value = coefficient(exact, source, term, term.rod(at), at.n + 1 - term.back, term.power(at))
            printed += term.factor(at) * value
    if line.loads and at.n == 0 and (load := line.loads.get((source, target.family))):
        printed += load(at)
    elif line.loads and at.n > 0:
        printed = true  # III.1 speaks of n = 0 only
    return Case({**_indices(at, target), "source": source, **_numbers(at)}, printed, true, telling=true != 0)


def _indices(at: At, target: PrintedTarget) -> Mapping[str, object]:
    return {"m": at.m, "n": at.n, "j": at.j} | ({"i": at.i} if target.family in "1m" else {})


def _numbers(at: At) -> dict[str, object]:
    return {"kappa_0": at.kappa[0], "kappa_1": at.kappa[1], "kappa_m": at.kappa[at.m]}


def _faults(line: PrintedLine) -> Iterator[tuple[str, PrintedLine]]:
    """Every sign, factor, index, H and range, each wrong once."""
    for place, term in enumerate(line.terms):
        for change, wrong in _term_faults(term):
            yield f"{change} {term.text}", with_terms(line, place, wrong)
    for place, target in enumerate(line.targets):
        if target.top:
            longer = replace(target, top=_shifted(target.top, 1))
            yield "range one longer", replace(line, targets=(*line.targets[:place], longer, *line.targets[place + 1 :]))
    for key, load in (line.loads or {}).items():
        yield f"sign of the load {key[0]}", replace(line, loads={**(line.loads or {}), key: _times(load, -1)})


def _term_faults(term: PrintedTerm) -> Iterator[tuple[str, PrintedTerm]]:
    yield "sign of", replace(term, factor=_times(term.factor, -1))
    yield "factor 2 on", replace(term, factor=_times(term.factor, 2))
    if term.family in "1m":
        yield "power one higher in", replace(term, power=_shifted(term.power, 1))
    else:
        yield "index 0 of", replace(term, family="0" if term.family == "c" else "c")
    for number, guard in enumerate(term.guards):
        late = (*term.guards[:number], _shifted(guard, -1), *term.guards[number + 1 :])
        yield f"H number {number + 1} one later in", replace(term, guards=late)


def _times(factor: Factor, by: int) -> Factor:
    return lambda at: by * factor(at)


def _shifted(count: Count, by: int) -> Count:
    return lambda at: count(at) + by


def _minus(right: PrintedLine) -> Callable[[PrintedLine], str]:
    """Printed minus right, as the terms in which they differ."""

    def difference(line: PrintedLine) -> str:
        mine, theirs = [t.text for t in line.terms], [t.text for t in right.terms]
        extra = [text for text in mine if text not in theirs]
        missing = [text for text in theirs if text not in mine]
        parts = [*(_signed(text) for text in extra), *(_signed(text, turned=True) for text in missing)]
        return " ".join(parts).removeprefix("+ ") or "0"

    return difference


def _signed(text: str, turned: bool = False) -> str:
    negative = text.startswith("-") != turned
    return f"{'-' if negative else '+'} {text.removeprefix('-')}"
