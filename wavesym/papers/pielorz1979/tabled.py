"""Tables 2 to 4 as they should be: the functions that their rows are for, and the cells that letters of forms are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from wavesym.papers.evaluation import MeaninglessError, Scope, holds, places, sides
from wavesym.papers.pielorz1979.transcript import entries, ids, settled
from wavesym.papers.record import Reading
from wavesym.papers.tree import Blank, Minus, Number, Progression, Symbol, Tree, latex

Tried = Mapping[str, Reading]
"""Records as they are tried, by id; all others are as they are right."""
HALVES = ("even", "odd")
"""The halves of Table 3, in the order of their intervals."""
ALPHA = r"\alpha"
_GROUPS = {"I": "T2.", "II": "T3.even.", "III": "T4."}
_DEFINED: Mapping[tuple[str, tuple[int, ...]], str] = {
    ("L", (0,)): "(4.10).L_0",
    ("r", (0,)): "(4.11).r_0",
    ("r", (1,)): "(4.11).r_1",
}


def as_tried(id: str, tried: Tried) -> Reading:
    """A record as it is tried, or as it is right; KeyError, MeaninglessError."""
    return tried[id] if id in tried else settled(id)


def rows(group: str, m: int, tried: Tried) -> dict[str, list[tuple[str, int]]]:
    """The functions that rows or columns of a table are for, by the ids of their heads."""
    found: dict[str, list[tuple[str, int]]] = {}
    for id in ids("function", group):
        head, block, scope = as_tried(id, tried), id.rpartition(".")[0], Scope({"m": m})
        function = head.formula
        if not isinstance(function, Symbol) or len(function.below) != 1:
            raise MeaninglessError(f"{latex(function)} is no function")
        sizes = (as_tried(block, tried).formula,) if block in entries() else ()
        found[id] = []
        for place in places((*sizes, *head.ranges), scope):
            with scope.binding(place):
                found[id].append((function.name, *scope.indices(function)))  # type: ignore[arg-type]
    return found


@cache
def functions(example: str, m: int) -> dict[tuple[str, int], str]:
    """The functions f, g of rods that the table of an example is about, each with the id of its row or column."""
    return {function: id for id, row in rows(_GROUPS[example], m, {}).items() for function in row}


LETTERS = ("m", "n", "i", "j", "k", "l", "r", "s")
"""What the value of a cell may depend on."""


@dataclass
class Limit:
    """What a letter of a form is: its tree, and the values that are known for some LETTERS."""

    tree: Tree
    known: dict[tuple[Any, ...], Any] = field(default_factory=dict)


def limit(example: str, letter: str, name: str, indices: tuple[int, ...], scope: Scope, tried: Tried) -> Limit:
    """What a letter with indices is at a place: the right side of a definition, or a cell. MeaninglessError."""
    bound = scope.bound
    try:
        if id := _DEFINED.get((name, indices)):
            return _defined(name, indices[0], tried[id]) if id in tried else _right_definition(name, indices[0], id)
        place = bound.get("i", 0), bound.get("half"), bound.get(ALPHA)
        id = _id(example, bound["m"], letter, name, indices, *place)
        if tried.keys().isdisjoint({*_DEFINED.values(), *_part(id)}):
            return _right(id, bound["m"], place[0], bound.get("n", 0))
        return _limit(id, scope, tried)
    except KeyError:
        below = ", ".join(map(str, indices))
        raise MeaninglessError(f"{name}_({below}) is not defined" if below else f"{name} is not defined") from None


def _defined(name: str, index: int, said: Reading) -> Limit:
    left, right = sides(said.formula)
    if left != Symbol(name, below=(Number(str(index)),)):
        raise KeyError(name)
    return Limit(right)


@cache
def _right_definition(name: str, index: int, id: str) -> Limit:
    return _defined(name, index, settled(id))


@cache
def _right(id: str, m: int, i: int, n: int) -> Limit:
    return _limit(id, Scope({"m": m, "i": i, "n": n}), {})


def _limit(id: str, scope: Scope, tried: Tried) -> Limit:
    """A cell where its ranges hold; where not, no power. A dash is an empty range."""
    cell = as_tried(id, tried)
    if len({isinstance(as_tried(one, tried).formula, Blank) for one in _part(id)}) > 1:
        raise MeaninglessError("a part is given whole or not at all")
    if not all(holds(range_, scope) for range_ in cell.ranges if isinstance(range_, Progression)):
        if ".K_" not in id:
            raise MeaninglessError(f"{id} is not given for n = {scope.bound.get('n')}")
        return Limit(Minus(Number("1")))
    if isinstance(cell.formula, Blank):
        return Limit(Number("1" if ".j_0," in id else "0"))
    return Limit(cell.formula)


def _part(id: str) -> tuple[str, ...]:
    """A cell and those of its part of Table 2, of which all are dashes or none."""
    row, _, name = id.rpartition(".")
    if name.startswith(("j_", "K_j")):
        return tuple(f"{row}.{one}{name[-1]}" for one in ("j_0,", "j_", "K_j,"))
    return (id,)


@cache
def _id(
    example: str, m: int, letter: str, name: str, indices: tuple[int, ...], i: int, half: str | None, alpha: int | None
) -> str:
    if example == "II":
        below = "_".join([name, *map(str, indices)])
        return f"T3.{half}.{name}" if below in ("d", "w") else f"T3.{half}.{letter}.alpha{alpha}.{below}"
    row = functions(example, m).get((letter, i))
    lasts = {1: "1", m - 1: "m-1"} if example == "I" else {1: "1", m: "2" if m == 2 else "m"}
    if name == "K" and len(indices) == 1:
        return f"{row}.K_{lasts.get(indices[0])}"
    first = "j" if name == "K" else indices[0] if indices else ""
    return f"{row}.{name}_{','.join(map(str, (first, *indices[1:])))}"
