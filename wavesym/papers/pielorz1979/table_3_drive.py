"""Table 3, cell by cell: the highest powers of example II, and which moments and rates they belong to.

`even` and `odd` are the halves of the table, 2n <= z < 2n+1 and 2n+1 <= z < 2n+2. For a function, alpha = 1, 2 part the
moments s = s(r), r = s_alpha ... R_alpha, and L_1, L_2, L_3 part the bodies l = 1 ... m+1 into those with powers K_1,
K_2, K_3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import chain
from math import floor

from wavesym.papers.exact_tables import Exact, drive, gammas
from wavesym.papers.pielorz1979.powers import (
    Cell,
    Formula,
    Formulas,
    Index,
    cell_claim,
    half,
    present,
    shifted,
    wrong,
)
from wavesym.papers.record import Case, Claim, by_size

HALVES = {"even": "2n <= z < 2n+1", "odd": "2n+1 <= z < 2n+2"}
MOST_SHAFTS, MOST_N = 6, 5

_SURE = "The prose after (4.12) gives both, r = r_0, r_0+1, ..., (i-1+r_0)/2, for f in the even half: beyond doubt."


# twice the last r of the first part, for the even half or not, for f or not
_LAST: Mapping[tuple[bool, bool], tuple[str, Callable[[Index], int]]] = {
    (True, True): ("i-1+r_0", lambda at: at.i - 1 + at.r_0),
    (True, False): ("i-1+r_0", lambda at: at.i - 1 + at.r_0),
    (False, True): ("i-2+r_1", lambda at: at.i - 2 + at.r_1),
    (False, False): ("i+r_1", lambda at: at.i + at.r_1),
}


def _parity(even: bool) -> tuple[str, Callable[[Index], int]]:
    return ("r_0", lambda at: at.r_0) if even else ("r_1", lambda at: at.r_1)


def _column(even: bool, letter: str, alpha: int) -> Mapping[str, Cell]:
    """One part of one column of Table 3."""
    mark, q = _parity(even)
    f = letter == "f"
    first = alpha == 1
    last_text, last = _LAST[even, f]
    next_text = {"i-1+r_0": "i+1+r_0", "i-2+r_1": "i+r_1", "i+r_1": "i+2+r_1"}[last_text]
    moment = Cell(f"2r+1-{mark}", lambda at: 2 * at.r + 1 - q(at))
    if first:
        ends = {
            "s_1": wrong(
                "unreadable",
                rf"\frac{{{mark}}}{{{last_text}}}",
                lambda at: Fraction(q(at), last(at)) if last(at) else Fraction(-1),
                mark,
                q,
                f"The scan runs the cells s_1 and R_1 together as one fraction. {_SURE}",
            ),
            "R_1": wrong(
                "unreadable",
                rf"\frac{{2}}{{2r+1-{mark}}}",
                lambda at: Fraction(2, q(at) + 1),  # with the first r, s_1, for the r in it
                rf"\frac{{{last_text}}}{{2}}",
                lambda at: half(last(at)),
                f"The scan runs the cells s_1, R_1 and s together; the numerator stands in s_1. {_SURE}",
            ),
        }
        bounds = {
            "L_1": Cell(f"2r-{mark}", lambda at: 2 * at.r - q(at)),
            "L_2": Cell("i", lambda at: at.i) if f else Cell("i+1", lambda at: at.i + 1),
        }
    else:
        ends = {
            "s_2": Cell(rf"\frac{{{next_text}}}{{2}}", lambda at: half(last(at)) + 1),
            "R_2": wrong(
                "misprint",
                r"E\left(\frac{m+1}{2}\right)",
                lambda at: (at.m + 1) // 2,
                rf"E\left(\frac{{m+{mark}}}{{2}}\right)",
                lambda at: (at.m + q(at)) // 2,
                f"For odd m and {mark} = 0 the last moment would be number m+2, which does not exist; harmless where "
                "it is taken as 0.",
            ),
        }
        bounds = {
            "L_1": Cell("i-1", lambda at: at.i - 1) if f else Cell("i", lambda at: at.i),
            "L_2": Cell(f"2r+1-{mark}", lambda at: 2 * at.r + 1 - q(at)),
        }
    return {**ends, "s": moment, **bounds, "L_3": Cell("m+1", lambda at: at.m + 1), **_powers(even, f, first)}


def _powers(even: bool, f: bool, first: bool) -> Mapping[str, Cell]:
    rising = {
        (True, True): Cell(r"n-r+l-\frac{i+1-r_0}{2}", lambda at: at.n - at.r + at.l - half(at.i + 1 - at.r_0)),
        (True, False): wrong(
            "misprint",
            r"n-r+l-\frac{i-1-r_0}{2}",
            lambda at: at.n - at.r + at.l - half(at.i - 1 - at.r_0),
            r"n-r+l-\frac{i+3-r_0}{2}",
            lambda at: at.n - at.r + at.l - half(at.i + 3 - at.r_0),
            "The only formula of this form that holds; it also goes over into K_2 at the first l after L_1.",
        ),
        (False, True): Cell(r"n-r+l-\frac{i-r_1}{2}", lambda at: at.n - at.r + at.l - half(at.i - at.r_1)),
        (False, False): Cell(r"n-r+l-\frac{i+2-r_1}{2}", lambda at: at.n - at.r + at.l - half(at.i + 2 - at.r_1)),
    }[even, f]
    level = {
        (True, True, True): Cell(r"n+r-\frac{i-1+r_0}{2}", lambda at: at.n + at.r - half(at.i - 1 + at.r_0)),
        (True, False, True): Cell(r"n+r-\frac{i+1+r_0}{2}", lambda at: at.n + at.r - half(at.i + 1 + at.r_0)),
        (False, True, True): Cell(r"n+r-\frac{i-2+r_1}{2}", lambda at: at.n + at.r - half(at.i - 2 + at.r_1)),
        (False, False, True): Cell(r"n+r-\frac{i+r_1}{2}", lambda at: at.n + at.r - half(at.i + at.r_1)),
        (True, True, False): Cell(r"n-r+\frac{i-1+r_0}{2}", lambda at: at.n - at.r + half(at.i - 1 + at.r_0)),
        (True, False, False): Cell(r"n-r+\frac{i-1+r_0}{2}", lambda at: at.n - at.r + half(at.i - 1 + at.r_0)),
        (False, True, False): Cell(r"n-r+\frac{i+r_1}{2}", lambda at: at.n - at.r + half(at.i + at.r_1)),
        (False, False, False): Cell(r"n-r+\frac{i+r_1}{2}", lambda at: at.n - at.r + half(at.i + at.r_1)),
    }[even, f, first]
    falling = {
        True: Cell(r"n+r-l+\frac{i+1-r_0}{2}", lambda at: at.n + at.r - at.l + half(at.i + 1 - at.r_0)),
        False: Cell(r"n+r-l+\frac{i+2-r_1}{2}", lambda at: at.n + at.r - at.l + half(at.i + 2 - at.r_1)),
    }[even]
    return {"K_1": rising, "K_2": level, "K_3": falling}


TABLE: dict[tuple[str, str, int], Mapping[str, Cell]] = {
    (side, letter, alpha): _column(side == "even", letter, alpha)
    for side in HALVES
    for letter in "fg"
    for alpha in (1, 2)
}
HEADS: dict[str, Mapping[str, Cell]] = {
    "even": {"d": Cell("2n+1", lambda at: 2 * at.n + 1), "w": Cell(r"z-2n-\tau_{s,k}", lambda at: -2 * at.n)},
    "odd": {"d": Cell("2n+2", lambda at: 2 * at.n + 2), "w": Cell(r"z-2n-1-\tau_{s,k}", lambda at: -2 * at.n - 1)},
}


def claims() -> Iterator[Claim[Formula]]:
    """The cells of Table 3."""
    for side, heads in HEADS.items():
        for name, cell in heads.items():
            yield cell_claim(
                f"T3.{side}.{name}",
                f"Table 3, {side} half, head {name}",
                cell,
                f"{HALVES[side]}, n = 0, 1, ...",
                "the interval that starts at z = 2n (even) or 2n+1 (odd) is number d from 1 on, and w = 0 at its start",
                partial(_head_cases, side, name),
            )
    for (side, letter, alpha), cells in TABLE.items():
        for name, cell in cells.items():
            claim = cell_claim(
                f"T3.{side}.{letter}.alpha{alpha}.{name}",
                f"Table 3, {side} half, {letter}_i, alpha = {alpha}, row {name}",
                cell,
                f"i = 1, 2, ..., m; {HALVES[side]}, n = 0, 1, ...",
                f"degrees of the exact tables with all rates different, m = 1 ... {MOST_SHAFTS}, n = 0 ... {MOST_N}; "
                "every moment that can act in one part, every body in one range",
                partial(cell_cases, side, letter, alpha, name),
            )
            yield _bound(claim, cell) if name in ("L_1", "L_2") else claim


def _bound(claim: Claim[Formula], cell: Cell) -> Claim[Formula]:
    """Where two ranges meet the powers agree, so that only an end that is two off shows for certain."""
    faults = {"two more": shifted(cell.right, 2), "two less": shifted(cell.right, -2)}
    return replace(claim, mutations=faults, note="The powers of neighbouring ranges agree where these meet.")


def _head_cases(side: str, name: str, formula: Formula) -> Iterator[Case]:
    for n in range(MOST_N + 1):
        start = 2 * n + (side == "odd")
        true = start + 1 if name == "d" else -start
        yield Case({"n": n, "z": start}, formula(Index(0, n, 0)), true)


def cell_cases(side: str, letter: str, alpha: int, name: str, formula: Formula) -> Iterator[Case]:
    parts = {a: {key: cell.right for key, cell in TABLE[side, letter, a].items()} for a in (1, 2)}
    parts[alpha][name] = formula
    for m, n in by_size((m, n) for m in range(1, MOST_SHAFTS + 1) for n in range(MOST_N + 1)):
        for i in range(1, m + 1):
            at = Index(m, n, i)
            if name[0] in "sR":
                yield from _moments(parts, at, side)
            else:
                yield from _bodies(drive(m), parts[alpha], alpha, at, side, letter)


def _moments(parts: Mapping[int, Formulas], at: Index, side: str) -> Iterator[Case]:
    """Both parts together have every moment that can act in this half once: s - i is even in the even half."""
    claimed = [s for alpha, part in parts.items() for s in _numbers(part, alpha, at)]
    true = [s for s in range(1, at.m + 2) if (s - at.i) % 2 == (side == "odd")]
    yield Case({"m": at.m, "i": at.i, "claim": "moments s"}, tuple(sorted(claimed)), tuple(true))


def _numbers(part: Formulas, alpha: int, at: Index) -> list[Fraction | int]:
    """The s of a part, r from s_alpha to R_alpha; R_alpha may have r in it only where the scan is garbled."""
    first, last = part[f"s_{alpha}"](at), part[f"R_{alpha}"](at)
    if first != floor(first) or last != floor(last):
        return [first, last]  # no numbers of terms: shown as they are
    return [part["s"](replace(at, r=r)) for r in range(floor(first), floor(last) + 1)]


def _bodies(exact: Exact, part: Formulas, alpha: int, at: Index, side: str, letter: str) -> Iterator[Case]:
    """For every moment of the part, every body is in one of the three ranges, and its highest power is right."""
    rates = gammas(exact)
    d = 2 * at.n + (1 if side == "even" else 2)
    for r in range(floor(part[f"s_{alpha}"](at)), floor(part[f"R_{alpha}"](at)) + 1):
        here = replace(at, r=r)
        s = part["s"](here)
        ends = [0, *(part[f"L_{beta}"](here) for beta in (1, 2, 3))]
        ranges = {beta: range(floor(ends[beta - 1]) + 1, floor(ends[beta]) + 1) for beta in (1, 2, 3)}
        for body in sorted({*range(1, at.m + 2), *chain.from_iterable(ranges.values())}):
            claimed = tuple(
                present(part[f"K_{beta}"](replace(here, l=body))) for beta, members in ranges.items() if body in members
            )
            true = (exact.degree(letter, at.i, d, rates[body], f"M{s}"),) if body in rates else ()
            where = {"m": at.m, "n": at.n, "i": at.i, "s": s, "l": body}
            yield Case(where, claimed, true, telling=true not in ((), (-1,)))
