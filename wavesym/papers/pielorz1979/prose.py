"""Statements in the text, text.1 ... in the order of print; section 5 is in figures.py."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import groupby, pairwise
from math import floor
from typing import Any

from flint import fmpq

from wavesym.papers.exact_tables import Exact, building, collision, drive, gammas
from wavesym.papers.pielorz1979 import table_2_collision
from wavesym.papers.pielorz1979.building_alone import corrected
from wavesym.papers.pielorz1979.building_list import cases as line_cases
from wavesym.papers.pielorz1979.powers import Formula, Index, half, shifted
from wavesym.papers.pielorz1979.table_3_drive import TABLE, cell_cases
from wavesym.papers.pielorz1979.table_4_building import ROWS
from wavesym.papers.record import Case, Claim, Slip


def claims() -> Iterator[Claim[Any]]:
    """The statements about the solutions."""
    yield from _formulas()
    yield from _dependence()
    yield from _left_out()
    yield from _highest_powers()


def _formulas() -> Iterator[Claim[Any]]:
    yield Claim(
        "text.1",
        "section 1, (3.1), (3.2), (4.12), III.2-III.22",
        "the function of Heaviside H (its value at 0 is not given)",
        "",
        "the corrected lines III.1 ... III.22 with true values, H(0) as read",
        _heaviside,
        0,
        {"H(0) = 0": 0},
        Slip("convention", "H(0) = 1", 1, "With H(0) = 0 terms are missing from the recurrences."),
    )
    yield _intervals("text.2", "in examples I and III the formulas change at even z", {"I": 2, "III": 2})
    yield _intervals("text.3", "in example II the formulas change at whole z", {"II": 1})
    yield Claim(
        "text.4",
        "section 4, after (4.9)",
        "(4.9) and Table 2 give the derivatives of m functions",
        "m = 4, 6, ...",
        "the functions in the rows of Table 2",
        lambda count: (
            Case(
                {"m": m},
                count(m),
                len({(row, i) for row in table_2_collision.ROWS for i in table_2_collision.rods(row, m)[1]}),
            )
            for m in range(4, 13, 2)
        ),
        lambda m: m,
        {"m - 1": lambda m: m - 1},
    )


def _dependence() -> Iterator[Claim[Any]]:
    for number, side, said, scan in (
        (
            5,
            "even",
            "for 2n <= z < 2n+1 functions of odd i depend on all odd moments, those of even i on the even ones",
            "(2n, 2n+1)",
        ),
        (
            6,
            "odd",
            "for 2n+1 <= z < 2n+2 functions of odd i depend on the even moments, those of even i on all odd ones",
            r"\langle 2n+1, 2n+2 \rangle",
        ),
    ):
        yield _moments(f"text.{number}", said, side, scan)


def _left_out() -> Iterator[Claim[Any]]:
    yield Claim(
        "text.7",
        "section 4, after (4.12)",
        "g'_{i,j}(z) is found from the first equation of (4.8)",
        "m = 2, 3, ...",
        "the functions without a row in Table 4",
        lambda name: (Case({"m": m}, name, _without_row(m)) for m in range(2, 8)),
        "g_i",
        {"g_2": "g_2", "f_1": "f_1"},
        Slip(
            "unreadable",
            "g'_{1,n+1}(z)",
            "g_1",
            "Only g_1 is missing from Table 4: beyond doubt (but for the letter n).",
        ),
    )
    yield Claim(
        "text.8",
        "section 4, after (4.12)",
        "g'_{i,j}(z) = 0 for i = 2, 3, ..., n",
        "n = 0, 1, ...",
        "exact tables with equal floors: in which intervals g'_i gains nothing",
        _at_rest,
        lambda m, n, i: i <= n,
        {"i = 1, ..., m": lambda m, n, i: n <= 1, "never": lambda m, n, i: False},
        Slip(
            "unreadable",
            "g'_{i,1}(z) = 0 for i = 2, 3, ..., m",
            lambda m, n, i: n == 0,
            "j is read for 1 and n for m; the first interval is the only one for which it can be said: beyond doubt.",
        ),
        scan="g'_{i,j}(z) = 0 dla i=2, 3, ..., n",
    )


def _highest_powers() -> Iterator[Claim[Any]]:
    yield Claim(
        "text.9",
        "section 4, after (4.12)",
        "the solutions depend exponentially on the masses, on kappa_i or gamma_i",
        "",
        "the rates of the exact tables: 0, and one for every body (equal floors: one for all)",
        _bodies,
        0,
        {"one rate more": 1, "one rate less": -1},
    )
    yield Claim(
        "text.10",
        "section 4, after (4.12)",
        "example I: highest powers change every 2 at kappa_1 and kappa_{m-1}, every 4 at the others",
        "m = 4, 6, ...",
        "degrees of the exact tables, functions of Table 2: the length in z between changes",
        _steps,
        (2, 4),
        {"4 and 4": (4, 4), "2 and 2": (2, 2)},
    )
    yield Claim(
        "text.11",
        "section 4, after (4.12)",
        "example III: highest powers change every 2",
        "m = 2, 3, ...",
        "degrees of the exact tables: the length in z between changes",
        _floor_steps,
        2,
        {"every 4": 4},
    )
    yield Claim(
        "text.12",
        "section 4, after (4.12)",
        "highest powers rise with l for l <= L_1, are equal for l = L_1+1, ..., L_2, and fall for the others",
        "both groups of moments, f and g, both halves; rising and falling by 1",
        "degrees of the exact tables, m = 1 ... 6, differences inside a range",
        _slopes,
        (1, 0, -1),
        {"falls first": (-1, 0, 1), "rises throughout": (1, 1, 1)},
        note="The factor is read with i for l and omega for w: (4.10) has e^{-\\gamma_l w}.",
        scan=r"e^{-\gamma_i \omega}",
    )
    formulas: dict[str, Formula] = {
        "K_1": lambda at: at.n - at.r + at.l - half(at.i + 1 - at.r_0),
        "K_2": lambda at: at.n + at.r - half(at.i - 1 + at.r_0),
        "K_3": lambda at: at.n + at.r - at.l + half(at.i + 1 - at.r_0),
    }
    yield Claim(
        "text.13",
        "section 4, after (4.12)",
        r"K_1 = n-r+l-\frac{i+1-r_0}{2}, K_2 = n+r-\frac{i-1+r_0}{2}, K_3 = n+r-l+\frac{i+1-r_0}{2}",
        r"f in the even half, r = r_0, ..., \frac{i-1+r_0}{2}; l = 1, ..., 2r-r_0, ..., i, ..., m+1",
        "as Table 3",
        lambda parts: (case for name, formula in parts.items() for case in cell_cases("even", "f", 1, name, formula)),
        formulas,
        {f"{name} one more": {**formulas, name: shifted(formulas[name], 1)} for name in formulas},
    )


def _heaviside(at_zero: int) -> Iterator[Case]:
    def opened(guard: Callable[[Any], int]) -> Callable[[Any], int]:
        return lambda at: guard(at) - 1 + at_zero

    for line in corrected():
        terms = tuple(replace(term, guards=tuple(map(opened, term.guards))) for term in line.terms)
        for case in line_cases(replace(line, terms=terms)):
            yield replace(case, at={"line": f"III.{line.number}", **case.at})


def _intervals(id: str, text: str, lengths: Mapping[str, int]) -> Claim[Mapping[str, int]]:
    tables: Mapping[str, Exact] = {"I": collision(6), "II": drive(3), "III": building(4)}

    def cases(reading: Mapping[str, int]) -> Iterator[Case]:
        for example, length in reading.items():
            yield Case({"example": example}, length, tables[example].interval)

    return Claim(
        id,
        "section 4, after Table 4",
        text,
        "",
        "the greatest common divisor of the lags of the derived delay equations",
        cases,
        lengths,
        {"twice": {example: 2 * length for example, length in lengths.items()}},
    )


def _moments(id: str, text: str, side: str, scan: str) -> Claim[Callable[[int, str, int, int], frozenset[int]]]:
    odd = side == "odd"

    def parity(m: int, letter: str, i: int, n: int) -> frozenset[int]:
        return frozenset(s for s in range(1, m + 2) if (s - i) % 2 == odd)

    def arrived(m: int, letter: str, i: int, n: int) -> frozenset[int]:
        """Those whose waves have come: straight from a body, or back from the one at the other end of rod i."""
        back = 2 if letter == "g" else 0
        return frozenset(s for s in parity(m, letter, i, n) if (s - i if s > i else i - s + back) <= 2 * n + odd)

    def cases(reading: Callable[[int, str, int, int], frozenset[int]]) -> Iterator[Case]:
        for m in range(1, 6):
            table = drive(m)
            for n in range(6):
                for letter in "fg":
                    for i in range(1, m + 1):
                        true = {s for s in range(1, m + 2) if table.increment(f"M{s}", letter, i, 2 * n + 1 + odd)}
                        yield Case({"m": m, "n": n, "F": f"{letter}_{i}"}, reading(m, letter, i, n), true, bool(true))

    return Claim(
        id,
        "section 4, after (4.11)",
        text,
        "i = 1, 2, ..., m",
        "exact tables, m = 1 ... 5: which moments a function depends on in an interval",
        cases,
        parity,
        {"the other parity": lambda m, letter, i, n: frozenset(range(1, m + 2)) - parity(m, letter, i, n)},
        Slip(
            "convention",
            "of these moments, those whose waves have arrived (a negative K is an empty sum)",
            arrived,
            "In the first intervals waves of far moments are still on their way.",
        ),
        scan=scan,
    )


def _without_row(m: int) -> str:
    part = "m2" if m == 2 else "m3"
    there = {
        (letter, i)
        for letter, first, last in ROWS[part].values()
        for i in range(first or m, (last if last > 0 else m + last) + 1)
    }
    return ", ".join(f"{a}_{i}" for a in "fg" for i in range(1, m + 1) if (a, i) not in there)


def _at_rest(said: Callable[[int, int, int], bool]) -> Iterator[Case]:
    for m in range(2, 8):
        for n in range(9):
            for i in range(2, m + 1):
                yield Case(
                    {"m": m, "n": n, "i": i, "claim": "g' = 0"}, said(m, n, i), not building(m).alive("g", i, n + 1)
                )


def _bodies(more: int) -> Iterator[Case]:
    for name, table, bodies in (
        ("I", collision(8), 4),
        ("II", drive(4), 5),
        ("III", building(5), 2),
    ):
        found = {
            r for response in table.responses.values() for parts in response.values() for part in parts for r in part
        }
        yield Case({"example": name, "claim": "exponents"}, bodies + more, len(found - {fmpq(0)}))


def _lengths(degrees: list[int]) -> set[int]:
    """How many intervals a power stays, from its first change to its last."""
    runs = [len(list(run)) for _, run in groupby(d for d in degrees if d >= 0)]
    return set(runs[1:-1])


def _steps(periods: tuple[int, int]) -> Iterator[Case]:
    for m in (4, 6, 8):
        table = collision(m)
        kappa = table.chain.parameters.kappa
        for row in table_2_collision.ROWS:
            letter, numbers = table_2_collision.rods(row, m)
            for i in numbers:
                for body in range(1, m, 2):
                    degrees = [table.degree(letter, i, n, 2 * kappa[body]) for n in range(1, 10)]
                    lengths = {2 * length for length in _lengths(degrees)}
                    printed = periods[0 if body in (1, m - 1) else 1]
                    if lengths:
                        yield Case({"m": m, "F": f"{letter}_{i}", "body": body}, {printed}, lengths)


def _floor_steps(period: int) -> Iterator[Case]:
    for m in range(2, 8):
        table = building(m)
        kappa = table.chain.parameters.kappa
        for name, rate in (("kappa_1", 2 * kappa[1]), ("kappa_m", kappa[m])):
            for letter in "fg":
                for i in range(1, m + 1):
                    lengths = {2 * n for n in _lengths([table.degree(letter, i, n, rate) for n in range(1, 10)])}
                    if lengths:
                        yield Case({"m": m, "F": f"{letter}_{i}", "rate": name}, {period}, lengths)


def _slopes(slopes: tuple[int, int, int]) -> Iterator[Case]:
    for (side, letter, alpha), column in TABLE.items():
        for m in range(1, 7):
            table = drive(m)
            rates = gammas(table)
            for n in range(6):
                for i in range(1, m + 1):
                    at = Index(m, n, i)
                    first, last = (floor(column[f"{end}_{alpha}"].right(at)) for end in "sR")
                    for r in range(first, last + 1):
                        here = replace(at, r=r)
                        s = column["s"].right(here)
                        ends = [0, *(floor(column[f"L_{beta}"].right(here)) for beta in (1, 2, 3))]
                        d = 2 * n + 1 + (side == "odd")
                        for slope, (low, high) in zip(slopes, pairwise(ends), strict=True):
                            powers = [table.degree(letter, i, d, rates[b], f"M{s}") for b in range(low + 1, high + 1)]
                            for place, (one, other) in enumerate(pairwise(powers), low + 1):
                                if min(one, other) >= 0:
                                    where = {"half": side, "m": m, "n": n, "F": f"{letter}_{i}", "s": s, "l": place}
                                    yield Case(where, slope, other - one)
