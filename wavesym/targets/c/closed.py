"""The closed form as C: its pulses, families and coefficients as tables."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.targets.c.kernel import kernel
from wavesym.targets.c.tables import tables_text
from wavesym.targets.description import Description
from wavesym.targets.literals import c_tables
from wavesym.targets.number_format import number_format


@dataclass(frozen=True)
class CClosed:
    """templates/c/closed/closed.c.j2."""

    scene: Description
    tables: list[str]
    exponential: str
    numbers: str
    kernel: str


def source(scene: Description, program: Program) -> str:
    """NAME.c."""
    context = CClosed(
        scene=scene,
        tables=tables_text("closed/tables.h", c_tables(program.tables, program.real)),
        exponential=number_format(program.real).c_exponential,
        numbers=kernel("real.h", scene),
        kernel=kernel("closed/closed.c", scene),
    )
    return render("c/closed/closed.c.j2", context)
