"""Pieces as C: the grids' tables one after the other."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel, kernels
from wavesym.targets.c.tables import tables_text
from wavesym.targets.description import Description
from wavesym.targets.literals import c_literal, c_tables


@dataclass(frozen=True)
class CPieces:
    """templates/c/pieces/pieces.c.j2."""

    scene: Description
    tables: list[str]
    numbers: str
    kernel: str


def source(scene: Description, program: Program) -> str:
    """NAME.c."""
    steps = str(program.constants["steps"])
    constants = {
        "grids": str(len(program.tables["scale"])),
        "exact": c_literal(program.real.nearest(1 / program.real.roundoff), program.real),
    }
    context = CPieces(
        scene=scene,
        tables=tables_text("pieces/tables.h", c_tables(program.tables, program.real), constants, {"STEPS": steps}),
        numbers=kernels(scene, "real.h", "vectors.h"),
        kernel=kernel("pieces/pieces.c", scene),
    )
    return render("c/pieces/pieces.c.j2", context)
