"""The march as C: its joints, tracks, loads and outputs as tables."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel
from wavesym.targets.c.tables import tables_text
from wavesym.targets.description import Description
from wavesym.targets.literals import c_constants, c_tables


@dataclass(frozen=True)
class CMarch:
    """templates/c/march/march.c.j2."""

    scene: Description
    tables: list[str]
    constants: dict[str, str]
    numbers: str
    series: str
    joint: str
    kernel: str


def source(scene: Description, program: Program) -> str:
    """NAME.c."""
    context = CMarch(
        scene=scene,
        tables=tables_text("march/tables.h", c_tables(program.tables, program.real)),
        constants=c_constants(program.constants, program.real),
        numbers=kernel("real.h", scene),
        series=kernel("series.h", scene),
        joint=kernel("joint.c", scene),
        kernel=kernel("march/march.c", scene),
    )
    return render("c/march/march.c.j2", context)
