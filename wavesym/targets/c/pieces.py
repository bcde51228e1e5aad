"""Pieces as C: the grids' tables one after the other."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.pieces import BLOCK, Pieces
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import c_literals, firsts, lines


@dataclass(frozen=True)
class CPieces:
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


def source(scene: Description, form: Pieces) -> str:
    """NAME.c."""
    grids, real = form.grids, form.real
    polynomials = [powers for grid in grids for piece in grid.powers for powers in piece]
    context = CPieces(
        scene=scene,
        grid_count=str(len(grids)),
        block=str(BLOCK),
        # whole numbers up to here are exact, sums with an offset too
        most=str(2**24 - BLOCK) if real.name == "single" else "",
        steps=str(max(grid.steps for grid in grids)),
        first_member=firsts(len(grid.outputs) for grid in grids),
        member=lines(str(k) for grid in grids for k in grid.outputs),
        first_piece=firsts(len(grid.centres) for grid in grids),
        start=c_literals((start for grid in grids for start in grid.starts), real),
        centre=c_literals((centre for grid in grids for centre in grid.centres), real),
        first_part=firsts(len(grid.first) for grid in grids),
        scale=c_literals((grid.scale for grid in grids), real),
        part=lines(str(piece) for grid in grids for piece in grid.first),
        first_polynomial=firsts(len(grid.centres) * len(grid.outputs) for grid in grids),
        first_power=firsts(len(powers) for powers in polynomials),
        coefficient=c_literals((c for powers in polynomials for c in reversed(powers)), real),
        offset=c_literals(map(float, range(BLOCK)), real),
    )
    return render("c/pieces.c.j2", context)
