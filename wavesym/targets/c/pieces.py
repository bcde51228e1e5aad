"""Pieces as C: the grids' tables one after the other."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel
from wavesym.targets.description import Description
from wavesym.targets.literals import Lines, c_literal, c_tables


@dataclass(frozen=True)
class CPieces:
    """templates/c/pieces/pieces.c.j2; every table as the lines between its braces."""

    scene: Description
    tables: dict[str, Lines]
    grids: str
    steps: str
    exact: str
    numbers: str
    kernel: str


def source(scene: Description, program: Program) -> str:
    """NAME.c."""
    context = CPieces(
        scene=scene,
        tables=c_tables(program.tables, program.real),
        grids=str(len(program.tables["scale"])),
        steps=str(program.constants["steps"]),
        exact=c_literal(program.real.nearest(1 / program.real.roundoff), program.real),
        numbers=kernel("real.h", scene),
        kernel=kernel("pieces/pieces.c", scene),
    )
    return render("c/pieces/pieces.c.j2", context)
