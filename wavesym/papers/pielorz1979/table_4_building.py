"""Table 4, cell by cell: the highest powers of example III."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from wavesym.papers.exact_tables import building
from wavesym.papers.pielorz1979.powers import Cell, Formula, Index, cell_claim, present, wrong
from wavesym.papers.record import Case, Claim, by_size

_RESTS = "For n = 0 and {} the formula gives a power to a function that is 0; so the text says (g' = 0 at first)."


def _at_rest(text: str, formula: Formula, where: str) -> Cell:
    """A power of a g, which is 0 in the first interval."""
    return wrong(
        "convention",
        text,
        formula,
        f"{text} for n >= 1; none for n = 0",
        lambda at: formula(at) if at.n else -1,
        _RESTS.format(where),
    )


# row -> (function, first rod, last rod), column -> cell
ROWS: dict[str, dict[str, tuple[str, int, int]]] = {
    "m3": {"f_1": ("f", 1, 1), "f_i": ("f", 2, 0), "g_i": ("g", 2, -1), "g_m": ("g", 0, 0)},
    "m2": {"f_1": ("f", 1, 1), "f_2": ("f", 2, 2), "g_2": ("g", 2, 2)},
}
CELLS: dict[str, dict[str, dict[str, Cell]]] = {
    "m3": {
        "f_1": {"K_1": Cell("2(n-1)", lambda at: 2 * (at.n - 1)), "K_m": Cell("n-m", lambda at: at.n - at.m)},
        "f_i": {
            "K_1": Cell("2n+i-2", lambda at: 2 * at.n + at.i - 2),
            "K_m": Cell("n-m+i-1", lambda at: at.n - at.m + at.i - 1),
        },
        "g_i": {
            "K_1": _at_rest("2n+i-3", lambda at: 2 * at.n + at.i - 3, "i >= 3"),
            "K_m": Cell("n-m+i-1", lambda at: at.n - at.m + at.i - 1),
        },
        "g_m": {
            "K_1": _at_rest("2n+m-4", lambda at: 2 * at.n + at.m - 4, "m >= 4"),
            "K_m": Cell("n-1", lambda at: at.n - 1),
        },
    },
    "m2": {
        "f_1": {"K_1": Cell("n-1", lambda at: at.n - 1), "K_2": Cell("n-2", lambda at: at.n - 2)},
        "f_2": {"K_1": Cell("n", lambda at: at.n), "K_2": Cell("n-1", lambda at: at.n - 1)},
        "g_2": {"K_1": Cell("n-1", lambda at: at.n - 1), "K_2": Cell("n-1", lambda at: at.n - 1)},
    },
}
_RANGES = {"f_i": "i = 2, 3, ..., m", "g_i": "i = 2, 3, ..., m-1"}


def claims() -> Iterator[Claim[Formula]]:
    """The cells of Table 4."""
    for part, rows in CELLS.items():
        storeys = "m = 2" if part == "m2" else "m >= 3"
        for row, columns in rows.items():
            for column, cell in columns.items():
                yield cell_claim(
                    f"T4.{part}.{row}.{column}",
                    f"Table 4, {storeys}, row {row}, column {column}",
                    cell,
                    "; ".join(filter(None, (storeys, _RANGES.get(row), "2n <= z < 2n+2, n = 0, 1, ..."))),
                    "degrees of the exact tables with equal floors, m = 2 ... 7, n = 0 ... 8",
                    partial(_cases, part, row, column),
                )


def _cases(part: str, row: str, column: str, formula: Formula) -> Iterator[Case]:
    letter, first, last = ROWS[part][row]
    for m, n in by_size((m, n) for m in ((2,) if part == "m2" else range(3, 8)) for n in range(9)):
        exact = building(m)
        kappa = exact.chain.parameters.kappa
        rate = 2 * kappa[1] if column == "K_1" else kappa[m]
        for i in range(first or m, (last if last > 0 else m + last) + 1):
            degree = exact.degree(letter, i, n + 1, rate)
            yield Case({"m": m, "n": n, "i": i}, present(formula(Index(m, n, i))), degree, telling=degree >= 0)
