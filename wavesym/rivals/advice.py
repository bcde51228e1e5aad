"""Which model of a scene is enough: masses on springs, rods with consistent mass, or waves, over its own horizon."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from flint import fmpq

from wavesym.documents.advice import Advice, Candidate, Difference
from wavesym.errors import UnservedError
from wavesym.model.model import Model
from wavesym.numbers.doubles import rational
from wavesym.programs.making import make
from wavesym.rivals.lumped import Lumped
from wavesym.rivals.mass import Elements
from wavesym.rivals.network import network_problem
from wavesym.rivals.problem import Array

WEIGHTS: Mapping[str, float] = {"massless": 0.0, "consistent": 1.0}
"""The models in place of waves, from cheap to dear, and what of their mass the rods have."""

# while a wave crosses the shortest rod, and in all
_INSTANTS, _MOST_INSTANTS = 8, 200_000
# of what is told apart, what the waves themselves may be wrong by
_EXACT = fmpq(1, 100)


def advise(model: Model, tolerance: float) -> Advice:
    """What `tolerance`, in parts of the largest value of each output, asks for.

    ToleranceError, CostError where there is no program of the waves either.
    """
    histories: dict[str, Array] = {}
    refused: dict[str, str] = {}
    for name, weight in WEIGHTS.items():
        try:
            taus, histories[name] = springs(model, weight)
        except UnservedError as error:
            refused[name] = str(error)
    if not histories:
        return Advice(model.name, tolerance, tuple(Candidate(name, refused=why) for name, why in refused.items()))
    program = make(model.tolerating(max(model.tolerance, rational(tolerance) * _EXACT)))
    waves = program.evaluate(taus)
    return Advice(
        model.name,
        tolerance,
        tuple(
            Candidate(name, refused=refused[name])
            if name in refused
            else Candidate(name, tuple(_differences(histories[name], waves)))
            for name in WEIGHTS
        ),
        tuple(
            (probe.name, probe.unit, float(np.max(np.abs(row)))) for probe, row in zip(model.probes, waves, strict=True)
        ),
        f"{program.kind}, bound {program.error_bound:.1e}",
        len(taus),
    )


def springs(model: Model, weight: float) -> tuple[Array, Array]:
    """Instants, and the outputs there (outputs, instants), where each rod is one spring with `weight` of its mass.

    UnservedError for contacts that open and close, and where rods that weigh nothing leave something free.
    """
    problem = network_problem(model)
    one = np.ones(len(problem.ends), dtype=int)
    step = max(float(np.min(problem.delay)) / _INSTANTS, problem.until / _MOST_INSTANTS)
    return Lumped(Elements(problem, one, weight)).history(step)


def _differences(ours: Array, waves: Array) -> Iterator[Difference]:
    for one, other in zip(ours, waves, strict=True):
        largest, size = float(np.max(np.abs(other))), float(np.max(np.abs(one)))
        scale = largest or (np.inf if size == 0 else 0.0)
        with np.errstate(divide="ignore"):
            yield Difference(
                *(float(np.divide(gap, scale)) for gap in (np.max(np.abs(one - other)), abs(size - largest)))
            )
