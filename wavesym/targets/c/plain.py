"""Programs whose C is tables, under what numbers are, above plain C: closed forms, pieces, marches and modes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernels
from wavesym.targets.c.tables import program_tables
from wavesym.targets.description import Description

_NUMBERS = {"closed": ("closed/library.h", "real.h"), "pieces": ("real.h", "vectors.h")}
_BELOW = {"march": ("polynomials.c", "series.h", "joint.c")}
"""What stands below the tables besides the kernel."""


@dataclass(frozen=True)
class CPlain:
    """templates/c/plain.c.j2."""

    scene: Description
    numbers: str
    tables: str
    kernel: str


def source(scene: Description, program: Program, constants: Mapping[str, str] | None = None) -> str:
    """NAME.c, with more `constants` than the program has."""
    name = program.kernel
    context = CPlain(
        scene=scene,
        numbers=kernels(scene, *_NUMBERS.get(name, ("real.h",))),
        tables=program_tables(f"{name}/tables.h", scene, program, constants),
        kernel=kernels(scene, *_BELOW.get(name, ()), f"{name}/{name}.c"),
    )
    return render("c/plain.c.j2", context)
