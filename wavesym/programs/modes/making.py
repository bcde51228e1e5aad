"""Model -> modes: the modal system that is enough for its tolerance, and what rounding adds to its error."""

from __future__ import annotations

from dataclasses import replace

from flint import fmpq

from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import relative
from wavesym.numbers.reals import Real
from wavesym.programs.modes.evaluator import ModesEvaluator
from wavesym.programs.modes.system import modal_system
from wavesym.programs.program import ProgramOutput

_PLAIN = fmpq(1), ""


def modes(model: Model, real: Real) -> ModesEvaluator:
    """The modes of a model in `real` numbers, whatever rounding does to them.

    UnservedError for what has no modes, or loads that jump; ToleranceError where too many would be needed.
    OverflowError where numbers would be beyond those of the format.
    """
    made = modal_system(model.to_horizon(real))
    sources = tuple(step.removesuffix(":step") or ramp.removesuffix(":ramp") for step, ramp in made.sources)
    spacing = made.loads.spacing(model.until, model.spacing)
    evaluator = ModesEvaluator(
        made.system,
        made.loads,
        sources,
        spacing,
        real,
        model.horizon(real),
        tuple(model.inputs.get(step or ramp, _PLAIN) for step, ramp in made.sources),
        proved=made.proved,
    )
    totals = made.errors + evaluator.rounding.errors
    outputs = tuple(
        ProgramOutput(probe.name, relative(error, size), size)
        for probe, error, size in zip(model.probes, totals.tolist(), made.largest.tolist(), strict=True)
    )
    return replace(evaluator, outputs=outputs)
