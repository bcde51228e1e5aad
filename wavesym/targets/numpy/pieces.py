"""Pieces as NumPy: the grids' tables one after the other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from wavesym.numbers.reals import Real
from wavesym.programs.pieces import Grid, Pieces
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import lines, literal


@dataclass(frozen=True)
class NumPyGrid:
    """A grid in NumPy: starts, centres, and for each member the powers of all pieces, highest degree throughout."""

    members: str
    starts: tuple[str, ...]
    centres: tuple[str, ...]
    powers: tuple[str, ...]


@dataclass(frozen=True)
class NumPyPieces:
    """templates/numpy/pieces.py.j2."""

    scene: Description
    grids: tuple[NumPyGrid, ...]


def source(scene: Description, form: Pieces) -> str:
    """NAME.py."""
    return render("numpy/pieces.py.j2", NumPyPieces(scene, tuple(_table(grid, form.real) for grid in form.grids)))


def _table(grid: Grid, real: Real) -> NumPyGrid:
    def written(values: Iterable[float]) -> tuple[str, ...]:
        return lines((literal(value, real) for value in values), width=100)

    return NumPyGrid(
        members=", ".join(map(str, grid.outputs)),
        starts=written(grid.starts),
        centres=written(grid.centres),
        powers=tuple(_rows(grid, real)),
    )


def _rows(grid: Grid, real: Real) -> Iterator[str]:
    """For every piece, the powers of its outputs."""
    for piece in grid.powers:
        yield "[" + ", ".join("[" + ", ".join(literal(c, real) for c in powers) + "]" for powers in piece) + "],"
