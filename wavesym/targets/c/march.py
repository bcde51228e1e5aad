"""The march as C: its joints, tracks, loads and outputs as tables."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel, kernels
from wavesym.targets.c.tables import program_tables
from wavesym.targets.description import Description


@dataclass(frozen=True)
class CMarch:
    """templates/c/march/march.c.j2."""

    scene: Description
    tables: str
    numbers: str
    series: str
    joint: str
    kernel: str


def source(scene: Description, program: Program) -> str:
    """NAME.c."""
    context = CMarch(
        scene=scene,
        tables=program_tables("march/tables.h", scene, program),
        numbers=kernel("real.h", scene),
        series=kernels(scene, "polynomials.c", "series.h"),
        joint=kernel("joint.c", scene),
        kernel=kernel("march/march.c", scene),
    )
    return render("c/march/march.c.j2", context)
