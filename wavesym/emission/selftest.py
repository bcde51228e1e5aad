"""The self-test: reference values, and how far from them an output may be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from wavesym.emission.description import Description
from wavesym.emission.literals import c_literal, lines, literal
from wavesym.emission.rendering import render
from wavesym.evaluators.choice import Evaluator
from wavesym.evaluators.doubles import above
from wavesym.evaluators.reference import Reference

_MOST_POINTS = 2000


@dataclass(frozen=True)
class SelfTest:
    """templates/c/selftest.c.j2: `values` by output, then by tau; doubles whatever the program's type is."""

    scene: Description
    count: str
    taus: tuple[str, ...]
    values: tuple[str, ...]
    allowed: tuple[str, ...]


def selftest(scene: Description, evaluator: Evaluator, reference: Reference) -> str:
    """NAME_selftest.c."""
    taus = _thinned(evaluator.check_points)
    values = reference.values(taus)
    allowed = [
        # the reference is rounded once
        above((output.bound + 2.0**-53) * size)
        for output, size in zip(evaluator.outputs, reference.largest(), strict=True)
    ]
    context = SelfTest(
        scene=scene,
        count=str(len(taus)),
        taus=lines(c_literal(tau, evaluator.real) for tau in taus),
        values=lines(literal(value) for row in values for value in row),
        allowed=lines(map(literal, allowed)),
    )
    return render("c/selftest.c.j2", context)


def _thinned(points: Sequence[float]) -> Sequence[float]:
    """No more points than a self-test should carry, spread evenly over those there are."""
    step = -(-len(points) // _MOST_POINTS)
    return [*points[::step], points[-1]] if step > 1 else points
