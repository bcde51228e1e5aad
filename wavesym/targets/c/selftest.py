"""NAME_selftest.c: reference values, and how far from them an output may be."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.numbers.reals import DOUBLE
from wavesym.programs.program import Program, ReferenceValues
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import Lines, c_literals


@dataclass(frozen=True)
class CSelfTest:
    """templates/c/selftest.c.j2: `expected` by output, then by tau; doubles whatever the program's type is."""

    scene: Description
    count: str
    tables: dict[str, Lines]


def selftest(scene: Description, program: Program, reference: ReferenceValues) -> str:
    """The program that holds the C of a program against reference values."""
    # the reference is rounded once, and the largest value is too
    allowed = [(output.bound + 2.0**-52) * output.largest for output in program.outputs]
    context = CSelfTest(
        scene=scene,
        count=str(len(reference.taus)),
        tables={
            "taus": c_literals(reference.taus, program.real),
            "expected": c_literals((value for row in reference.values for value in row), DOUBLE),
            "allowed": c_literals(allowed, DOUBLE),
        },
    )
    return render("c/selftest.c.j2", context)
