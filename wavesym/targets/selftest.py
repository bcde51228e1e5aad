"""The self-test: reference values, and how far from them an output may be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from wavesym.exact.reference import Reference, beginning
from wavesym.model.model import Model
from wavesym.programs.choice import Evaluator
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import c_literal, lines, literal

_MOST_POINTS = 2000
_MOST_VALUES = 40_000


@dataclass(frozen=True)
class SelfTest:
    """templates/c/selftest.c.j2: `values` by output, then by tau; doubles whatever the program's type is."""

    scene: Description
    count: str
    taus: tuple[str, ...]
    values: tuple[str, ...]
    allowed: tuple[str, ...]


def selftest(model: Model, description: Description, evaluator: Evaluator) -> str:
    """NAME_selftest.c. On very long horizons it covers only the beginning."""
    reference = Reference(beginning(model), evaluator.real)
    most = max(10, min(_MOST_POINTS, _MOST_VALUES // len(evaluator.outputs)))
    taus = _thinned([tau for tau in evaluator.check_points if tau <= reference.tau_max], most)
    values = reference.values(taus)
    # the reference is rounded once, and the largest value is too
    allowed = [(output.bound + 2.0**-52) * output.largest for output in evaluator.outputs]
    context = SelfTest(
        scene=description,
        count=str(len(taus)),
        taus=lines(c_literal(tau, evaluator.real) for tau in taus),
        values=lines(literal(value) for row in values for value in row),
        allowed=lines(map(literal, allowed)),
    )
    return render("c/selftest.c.j2", context)


def _thinned(points: Sequence[float], most: int) -> Sequence[float]:
    """No more points than a self-test should carry, spread evenly over those there are."""
    step = -(-len(points) // most)
    return [*points[::step], points[-1]] if step > 1 else points
