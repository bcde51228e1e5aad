"""NAME_selftest.c: reference values, and how far from them an output may be."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.choice import Evaluator
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import c_literals, lines, literal
from wavesym.targets.reference import ReferenceValues


@dataclass(frozen=True)
class CSelfTest:
    """templates/c/selftest.c.j2: `values` by output, then by tau; doubles whatever the program's type is."""

    scene: Description
    count: str
    taus: tuple[str, ...]
    values: tuple[str, ...]
    allowed: tuple[str, ...]


def selftest(scene: Description, evaluator: Evaluator, reference: ReferenceValues) -> str:
    """The program that holds an evaluator's C against reference values."""
    # the reference is rounded once, and the largest value is too
    allowed = [(output.bound + 2.0**-52) * output.largest for output in evaluator.outputs]
    context = CSelfTest(
        scene=scene,
        count=str(len(reference.taus)),
        taus=c_literals(reference.taus, evaluator.real),
        values=lines(literal(value) for row in reference.values for value in row),
        allowed=lines(map(literal, allowed)),
    )
    return render("c/selftest.c.j2", context)
