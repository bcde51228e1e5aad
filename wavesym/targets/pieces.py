"""Pieces as C and as NumPy: the grids' tables one after the other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from wavesym.numbers.reals import Real
from wavesym.programs.pieces import BLOCK, Grid, Pieces
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.header import common_header
from wavesym.targets.literals import c_literal, firsts, lines, literal


@dataclass(frozen=True)
class Source:
    """templates/c/pieces.c.j2; every table as the lines between its braces."""

    scene: Description
    grid_count: str
    block: str
    most: str
    steps: str
    first_member: tuple[str, ...]
    member: tuple[str, ...]
    first_piece: tuple[str, ...]
    start: tuple[str, ...]
    centre: tuple[str, ...]
    first_part: tuple[str, ...]
    scale: tuple[str, ...]
    part: tuple[str, ...]
    first_polynomial: tuple[str, ...]
    first_power: tuple[str, ...]
    coefficient: tuple[str, ...]
    offset: tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """A grid in NumPy: starts, centres, and for each member the powers of all pieces, highest degree throughout."""

    members: str
    starts: tuple[str, ...]
    centres: tuple[str, ...]
    powers: tuple[str, ...]


@dataclass(frozen=True)
class Module:
    """templates/numpy/pieces.py.j2."""

    scene: Description
    grids: tuple[Table, ...]


def c_header(scene: Description, form: Pieces) -> str:
    """NAME.h."""
    return common_header(scene)


def c_source(scene: Description, form: Pieces) -> str:
    """NAME.c."""
    grids, real = form.grids, form.real
    polynomials = [powers for grid in grids for piece in grid.powers for powers in piece]
    source = Source(
        scene=scene,
        grid_count=str(len(grids)),
        block=str(BLOCK),
        # whole numbers up to here are exact, sums with an offset too
        most=str(2**24 - BLOCK) if real.name == "single" else "",
        steps=str(max(grid.steps for grid in grids)),
        first_member=firsts(len(grid.outputs) for grid in grids),
        member=lines(str(k) for grid in grids for k in grid.outputs),
        first_piece=firsts(len(grid.centres) for grid in grids),
        start=_reals((start for grid in grids for start in grid.starts), real),
        centre=_reals((centre for grid in grids for centre in grid.centres), real),
        first_part=firsts(len(grid.first) for grid in grids),
        scale=_reals((grid.scale for grid in grids), real),
        part=lines(str(piece) for grid in grids for piece in grid.first),
        first_polynomial=firsts(len(grid.centres) * len(grid.outputs) for grid in grids),
        first_power=firsts(len(powers) for powers in polynomials),
        coefficient=_reals((c for powers in polynomials for c in reversed(powers)), real),
        offset=_reals(map(float, range(BLOCK)), real),
    )
    return render("c/pieces.c.j2", source)


def numpy_source(scene: Description, form: Pieces) -> str:
    """NAME.py."""
    return render("numpy/pieces.py.j2", Module(scene, tuple(_table(grid, form.real) for grid in form.grids)))


def _table(grid: Grid, real: Real) -> Table:
    def written(values: Iterable[float]) -> tuple[str, ...]:
        return lines((literal(value, real) for value in values), width=100)

    return Table(
        members=", ".join(map(str, grid.outputs)),
        starts=written(grid.starts),
        centres=written(grid.centres),
        powers=tuple(_rows(grid, real)),
    )


def _rows(grid: Grid, real: Real) -> Iterator[str]:
    """For every piece, the powers of its outputs."""
    for piece in grid.powers:
        yield "[" + ", ".join("[" + ", ".join(literal(c, real) for c in powers) + "]" for powers in piece) + "],"


def _reals(values: Iterable[float], real: Real) -> tuple[str, ...]:
    return lines(c_literal(value, real) for value in values)
