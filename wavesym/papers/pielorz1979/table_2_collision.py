"""Table 2, cell by cell: the highest powers of example I."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import floor

from wavesym.papers.exact_tables import Exact, collision
from wavesym.papers.pielorz1979.powers import Cell, Formula, Formulas, Index, cell_claim, half, present, shifted
from wavesym.papers.record import Case, Claim, by_size

_COLUMNS = ("K_1", "j_0,1", "j_1", "K_j,1", "j_0,2", "j_2", "K_j,2", "K_m-1")


def _one(at: Index) -> int:
    return 1


_WHOLE = Cell(r"\frac{m-4}{2}", lambda at: half(at.m - 4))
_ONE = Cell("1", _one)


def _nothing(column: str) -> Cell:
    """A dash: no second part. As a range it is the one from 1 to 0."""
    return Cell("-", lambda at: 0 if column == "j_2" else 1)


def _row(*cells: Cell) -> Mapping[str, Cell]:
    """A row; with five cells it has no second part."""
    if len(cells) == 5:
        cells = (*cells[:4], *(_nothing(column) for column in _COLUMNS[4:7]), cells[4])
    return dict(zip(_COLUMNS, cells, strict=True))


ROWS: dict[str, Mapping[str, Cell]] = {
    "g_1": _row(
        Cell("n", lambda at: at.n),
        _ONE,
        _WHOLE,
        Cell("n-j", lambda at: at.n - at.j),
        Cell(r"n-\frac{m}{2}+1", lambda at: at.n - half(at.m) + 1),
    ),
    "g_i": _row(
        Cell(r"n-\frac{i+1}{2}", lambda at: at.n - half(at.i + 1)),
        _ONE,
        Cell(r"\frac{i-1}{2}", lambda at: half(at.i - 1)),
        Cell(r"n-\frac{i+1}{2}+j", lambda at: at.n - half(at.i + 1) + at.j),
        Cell(r"\frac{i+1}{2}", lambda at: half(at.i + 1)),
        _WHOLE,
        Cell(r"n+\frac{i-3}{2}-j", lambda at: at.n + half(at.i - 3) - at.j),
        Cell(r"n-\frac{m-i+1}{2}", lambda at: at.n - half(at.m - at.i + 1)),
    ),
    "g_m-2": _row(
        Cell(r"n-\frac{m}{2}", lambda at: at.n - half(at.m)),
        _ONE,
        _WHOLE,
        Cell(r"n-\frac{m}{2}+j", lambda at: at.n - half(at.m) + at.j),
        Cell("n-1", lambda at: at.n - 1),
    ),
    "f_i": _row(
        Cell(r"n-\frac{i-1}{2}", lambda at: at.n - half(at.i - 1)),
        _ONE,
        Cell(r"\frac{i-3}{2}", lambda at: half(at.i - 3)),
        Cell(r"n-\frac{i-1}{2}+j", lambda at: at.n - half(at.i - 1) + at.j),
        Cell(r"\frac{i-1}{2}", lambda at: half(at.i - 1)),
        _WHOLE,
        Cell(r"n+\frac{i-5}{2}-j", lambda at: at.n + half(at.i - 5) - at.j),
        Cell(r"n-\frac{m-i+3}{2}", lambda at: at.n - half(at.m - at.i + 3)),
    ),
    "f_m": _row(
        Cell(r"n-\frac{m}{2}+1", lambda at: at.n - half(at.m) + 1),
        _ONE,
        _WHOLE,
        Cell(r"n-\frac{m}{2}+1+j", lambda at: at.n - half(at.m) + 1 + at.j),
        Cell("n", lambda at: at.n),
    ),
}
_RANGES = {"g_i": "i = 3, 5, ..., m-3", "f_i": "i = 3, 5, ..., m-1"}


def rods(row: str, m: int) -> tuple[str, range]:
    """The functions that a row is about."""
    return {
        "g_1": ("g", range(1, 2)),
        "g_i": ("g", range(3, m - 2, 2)),
        "g_m-2": ("g", range(m - 2, m - 1)),
        "f_i": ("f", range(3, m, 2)),
        "f_m": ("f", range(m, m + 1)),
    }[row]


def claims() -> Iterator[Claim[Formula]]:
    """The cells of Table 2, dashes included."""
    for row, cells in ROWS.items():
        for column, cell in cells.items():
            claim = cell_claim(
                f"T2.{row}.{column}",
                f"Table 2, row {row}, column {column}",
                cell,
                "; ".join(filter(None, ("m = 4, 6, ...", _RANGES.get(row), "2n <= z < 2n+2, n = 0, 1, ..."))),
                "degrees of the exact tables with unequal bodies, m = 4, 6, 8, 10, n = 0 ... 8; power E(K_j,s / 2) as "
                "in (4.9), every inner body in one part",
                partial(_cases, row, column),
            )
            if cell.text == "-":
                more = {"a second part that begins and ends with j = 1": _part_of_one(column)}
                claim = replace(claim, mutations=more)
            yield claim


def _part_of_one(column: str) -> Formula:
    """A dash read as if there were a second part: j = 1 ... 1."""
    return {"j_0,2": shifted(_one, -1), "j_2": _one}.get(column, lambda at: -2)


def _cases(row: str, column: str, formula: Formula) -> Iterator[Case]:
    row_formulas = {name: cell.right for name, cell in ROWS[row].items()} | {column: formula}
    if column == "K_j,2" and ROWS[row][column].text == "-" and formula is not ROWS[row][column].formula:
        row_formulas["j_2"] = _one  # a power in place of a dash needs a j
    for m, n in by_size((m, n) for m in (4, 6, 8, 10) for n in range(9)):
        exact = collision(m)
        letter, numbers = rods(row, m)
        for i in numbers:
            at = Index(m, n, i)
            if column in ("K_1", "K_m-1"):
                degree = _degree(exact, letter, at, 0 if column == "K_1" else (m - 2) // 2)
                yield Case({"m": m, "n": n, "i": i}, present(formula(at)), degree, telling=degree >= 0)
            else:
                yield from _inner_bodies(exact, letter, at, row_formulas)


def _inner_bodies(exact: Exact, letter: str, at: Index, row: Formulas) -> Iterator[Case]:
    """For every j: one part has it, and its highest power is right."""
    parts = {s: _range(row[f"j_0,{s}"](at), row[f"j_{s}"](at)) for s in (1, 2)}
    inner = range(1, (at.m - 4) // 2 + 1)
    for j in sorted({*inner, *parts[1], *parts[2]}):
        claimed = tuple(
            present(floor(row[f"K_j,{s}"](replace(at, j=j)) / 2)) for s, members in parts.items() if j in members
        )
        true = (_degree(exact, letter, at, j),) if j in inner else ()
        yield Case({"m": at.m, "n": at.n, "i": at.i, "j": j}, claimed, true, telling=true not in ((), (-1,)))


def _range(first: Fraction | int, last: Fraction | int) -> range:
    """No j at all where an end is not whole."""
    return range(floor(first), floor(last) + 1) if {first, last} == {floor(first), floor(last)} else range(0)


def _degree(exact: Exact, letter: str, at: Index, j: int) -> int:
    return exact.degree(letter, at.i, at.n + 1, 2 * exact.chain.parameters.kappa[2 * j + 1])
