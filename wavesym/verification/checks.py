"""The checks of `verify`: each compares one kind of evaluator with the reference, output by output.

A new evaluator or an invariant is one more function in `CHECKS`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wavesym.emission.files import files
from wavesym.errors import ToleranceError
from wavesym.mechanics.chain import chain
from wavesym.verification.characteristics import COARSEST, Motion, integrate
from wavesym.verification.compiled import compiled, imported
from wavesym.verification.reference import Output, Reference

# the reference is rounded once
_ROUNDED = 2.0**-53

# the integration is refined until its own bound is as small as this, as long as it takes no more doubles than that
_FINE = 1e-6
_MOST_DOUBLES = 10_000_000


@dataclass(frozen=True)
class Outcome:
    """What a check found for one output: cells of the table by column, and whether all is within what is allowed.

    `note` is for what does not fit into a column.
    """

    cells: Mapping[str, str]
    passed: bool
    note: str = ""


Check = Callable[[Reference], Sequence[Outcome]]
"""One outcome for every output."""


def generated(reference: Reference) -> list[Outcome]:
    """The generated C, compiled and run, and the generated NumPy, against their proved bound."""
    scene = reference.scene
    try:
        made = files(scene, language="all")
    except ToleranceError as error:  # an evaluator that says where it ends has not failed
        refused = Outcome({"C": "refused", "NumPy": "refused", "bound": "-"}, True, str(error))
        return [refused] * len(reference.outputs)
    bounds = [output["error_bound"] for output in json.loads(made[f"{scene.name}.json"])["outputs"]]
    numpy = imported(made[f"{scene.name}.py"], scene.name).evaluate(np.array(reference.taus))
    with compiled(made, len(reference.outputs)) as program:
        c = program(reference.taus)
        sound = program.selftest() == 0
    note = "" if sound else f"{scene.name}: the self-test of the generated C fails"
    outcomes = []
    for output, bound, *values in zip(reference.outputs, bounds, c, numpy, strict=True):
        errors = [output.error(each) for each in values]
        allowed = 0.0 if output.zero else bound + _ROUNDED
        cells = dict(zip(("C", "NumPy", "bound"), map(_shown, (*errors, bound)), strict=True))
        outcomes.append(Outcome(cells, sound and all(error <= allowed for error in errors), note))
    return outcomes


def integration(reference: Reference) -> list[Outcome]:
    """Characteristics with N, 2N and 4N steps per unit of tau, against the bound they give themselves.

    Where the error falls at least in proportion to the step, what lies between the last two solutions is more than the
    error of the last. N is doubled until that is little.
    """
    system = chain(reference.scene)

    def motion(steps: int) -> Motion:
        return integrate(system, reference.scene.pieces, reference.until, steps)

    steps = COARSEST
    motions = [motion(steps), motion(2 * steps), motion(4 * steps)]
    while True:
        outcomes = [_integrated(reference, output, steps, motions) for output in reference.outputs]
        if not any(outcome.note for outcome in outcomes) or 2 * motions[-1].size > _MOST_DOUBLES:
            return outcomes
        steps *= 2
        motions = [*motions[1:], motion(4 * steps)]


def _integrated(reference: Reference, output: Output, steps: int, motions: Sequence[Motion]) -> Outcome:
    values = [motion.at(output.observable, reference.taus) for motion in motions]
    errors = [output.error(each) for each in values]
    between = float(np.max(np.abs(values[2] - values[1]))) / output.scale
    rounding = motions[2].roundoff(output.observable) / output.scale
    seen = [error for error in errors if error > rounding]
    order = f"{math.log2(seen[-2] / seen[-1]):.1f}" if len(seen) > 1 else "-"
    columns = ("N", "at N", "at 2N", "at 4N", "allowed", "order")
    cells = dict(zip(columns, (str(steps), *map(_shown, (*errors, between + rounding)), order), strict=True))
    if not between <= _FINE:
        return Outcome(cells, False, f"{reference.scene.name}: the integration is too coarse to tell")
    return Outcome(cells, errors[2] <= between + rounding)


CHECKS: tuple[Check, ...] = (generated, integration)


def _shown(error: float) -> str:
    return f"{error:.1e}" if error else "0"
