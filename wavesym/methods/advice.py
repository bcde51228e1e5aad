"""Which model of a scene is enough: masses on springs, rods with consistent mass, or waves, over its own horizon."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from flint import fmpq

from wavesym.documents.advice import Advice, Candidate, Discrepancy
from wavesym.errors import UnservedError
from wavesym.mechanics.model import Model
from wavesym.methods.discrete import DiscreteModel
from wavesym.methods.elements import Elements
from wavesym.methods.network_problem import linear_problem
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import rational
from wavesym.programs.choice import attempt, choose
from wavesym.programs.making import program
from wavesym.programs.program import Program

WEIGHTS: Mapping[str, float] = {"massless": 0.0, "consistent": 1.0}
"""The models in place of waves, from cheap to dear, and what of their mass the rods have."""

# while a wave crosses the shortest rod, and in all
_INSTANTS, _MOST_INSTANTS = 8, 20_000
# of the tolerance, what the waves themselves may be wrong by
_EXACT = fmpq(1, 100)


def advise(model: Model, tolerance: float, known: Program | None = None) -> Advice:
    """Compare models in place of waves with waves.

    Args:
        model: a scene's model.
        tolerance: the largest difference that is allowed, in parts of the largest value of each output.
        known: a program of the waves to the model's tolerance, where there is one already; it may have more outputs.

    Raises:
        ToleranceError, CostError: there is no program of the waves either.
        UnservedError: there are no rods.
    """
    model.network.refuse_rodless("what springs could stand for", "write one")
    histories: dict[str, Array] = {}
    refused: dict[str, str] = {}
    for name, weight in WEIGHTS.items():
        try:
            taus, histories[name] = springs(model, weight)
        except UnservedError as error:
            refused[name] = str(error)
    if not histories:
        return Advice(model.name, tolerance, tuple(Candidate(name, refusal=why) for name, why in refused.items()))
    soonest = known or _soonest(model.tolerating(max(model.tolerance, rational(tolerance) * _EXACT)))
    names = [output.name for output in soonest.outputs]
    waves = soonest.evaluate(taus)[[names.index(probe.name) for probe in model.probes]]
    return Advice(
        model.name,
        tolerance,
        tuple(
            Candidate(name, refusal=refused[name])
            if name in refused
            else Candidate(name, tuple(_differences(histories[name], waves)))
            for name in WEIGHTS
        ),
        tuple(
            (probe.name, probe.unit, float(np.max(np.abs(row)))) for probe, row in zip(model.probes, waves, strict=True)
        ),
        f"{soonest.evaluator}, bound {soonest.error_bound:.1e}",
        len(taus),
    )


def _soonest(model: Model) -> Program:
    """A program of the waves: not the quickest one, but the one that is made soonest."""
    tried = (attempt(model, kind) for kind in ("modes", "march"))
    form = next((one.form for one in tried if one.form and not one.refusal), None)
    return program(model, form or choose(model).evaluator)


def springs(model: Model, weight: float, step: float | None = None) -> tuple[Array, Array]:
    """Solve a model whose rods are springs, one each.

    Args:
        model: a scene's model.
        weight: how much of its mass each rod has, 0 or 1.
        step: the largest distance of instants; None for as close as it takes to see a wave in the shortest rod.

    Returns:
        Instants, and the outputs there (outputs, instants).

    Raises:
        UnservedError: contacts open and close, nothing holds a part where rods weigh nothing, or a mode is damped that
            there is not.
    """
    problem = linear_problem(model)
    close = max(float(np.min(problem.delay)) / _INSTANTS, problem.until / _MOST_INSTANTS)
    return DiscreteModel(Elements(problem, np.ones(len(problem.ends), dtype=int), weight)).outputs(step or close)


def _differences(ours: Array, waves: Array) -> Iterator[Discrepancy]:
    for one, other in zip(ours, waves, strict=True):
        largest, size = float(np.max(np.abs(other))), float(np.max(np.abs(one)))
        scale = largest or (np.inf if size == 0 else 0.0)
        with np.errstate(divide="ignore"):
            yield Discrepancy(
                *(float(np.divide(gap, scale)) for gap in (np.max(np.abs(one - other)), abs(size - largest)))
            )
