"""Which cells of Tables 2 to 4 the letters of (4.9), (4.10) and (4.12) are, as they should be."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from wavesym.papers.evaluation import MeaninglessError, Scope, holds, span
from wavesym.papers.pielorz1979 import cells
from wavesym.papers.pielorz1979.transcript import paper
from wavesym.papers.tree import Blank, Minus, Number, Progression, Symbol, Tree, latex

HALVES = ("even", "odd")
"""The halves of Table 3, in the order of their intervals."""

ALPHA = r"\alpha"


@cache
def functions(example: str, m: int) -> dict[tuple[str, int], str]:
    """The functions f, g of rods that the table of an example is about, each with the id of its row or head."""
    return {function: id for id, row in _heads(example, m) for function in row}


def _heads(example: str, m: int) -> Iterator[tuple[str, list[tuple[str, int]]]]:
    table = {"I": "T2.", "II": "T3.even.", "III": f"T4.m{2 if m == 2 else 3}."}[example]
    for entry in paper().entries():
        if entry.kind == "function" and entry.id.startswith(table):
            letter, scope = cells.right(entry.id), Scope({"m": m})
            assert isinstance(letter, Symbol)
            ranges = cells.right_ranges(entry.id)
            rods = span(ranges[0], scope) if ranges else scope.indices(letter)
            yield entry.id, [(letter.name, rod) for rod in rods]


def cell(example: str, letter: str, symbol: Symbol, scope: Scope) -> Tree:
    """The cell that a letter is at a place; a dash is an empty range. MeaninglessError where there is none."""
    id = _id(example, letter, symbol, scope)
    try:
        tree = cells.right(id)
    except KeyError:
        raise MeaninglessError(f"{latex(symbol)} is not defined") from None
    if not all(holds(range_, scope) for range_ in cells.right_ranges(id) if isinstance(range_, Progression)):
        if symbol.name != "K":
            raise MeaninglessError(f"{latex(symbol)} is not given here")
        return Minus(Number("1"))  # no power is said
    if isinstance(tree, Blank):
        return Number("1" if len(symbol.below) == 2 else "0")
    return tree


def _id(example: str, letter: str, symbol: Symbol, scope: Scope) -> str:
    name, indices, m = symbol.name, scope.indices(symbol), scope.bound["m"]
    if example == "II":
        head = f"T3.{scope.bound.get('half')}"
        if name in "dw" and not indices:
            return f"{head}.{name}"
        return f"{head}.{letter}.alpha{scope.bound.get(ALPHA)}.{'_'.join([name, *map(str, indices)])}"
    row = functions(example, m).get((letter, scope.bound.get("i", 0)))
    if example == "III":
        last = {1: "1", m: "2" if m == 2 else "m"}.get(indices[0] if len(indices) == 1 else 0)
        return f"{row}.{name}_{last}"
    if name == "K" and len(indices) == 1:
        return f"{row}.K_" + {1: "1", m - 1: "m-1"}.get(indices[0], "")
    first = "j" if name == "K" else indices[0] if indices else ""
    return f"{row}.{name}_{','.join(map(str, (first, *indices[1:])))}"
