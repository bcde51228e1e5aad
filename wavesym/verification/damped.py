"""Chains whose modes are damped: finite elements of consistent mass, damped by the same ratios.

Elements know nothing of waves or of their modes. Their error is a series in the square of their length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesym.mechanics.model import Model
from wavesym.rivals import modal_elements
from wavesym.rivals.lumped import DiscreteModel
from wavesym.rivals.mass import Elements
from wavesym.rivals.problem import Array
from wavesym.rivals.sums import summing
from wavesym.verification.outcome import FINE, IntegratedOutput, Outcome
from wavesym.verification.reference import Known
from wavesym.verification.refinement import Refinement, Solutions

_COARSEST = 2  # elements of the shortest rod
_MOST = 400  # unknowns
_INSTANTS = 400  # besides those at which loads change


def damped(known: Known) -> list[Outcome]:
    """Elements with N, 2N and 4N to the shortest rod; there is no truth to compare them with."""
    model = known.independent or known.whole
    if model.damping is None:
        return []
    first = _COARSEST
    solved = [solution(model, first * finer) for finer in (1, 2, 4)]

    def refined() -> list[Refinement]:
        found = []
        for k in range(len(model.probes)):
            coarse, half, quarter = (values[k] for _, values in solved)
            scale = float(np.max(np.abs(quarter))) or 1.0
            found.append(Solutions((coarse, half, quarter), None, 0.0, scale).extrapolated())
        return found

    while any(not each.between <= FINE for each in refined()) and _size(model, 8 * first) <= _MOST:
        first *= 2
        solved = [*solved[1:], solution(model, 4 * first)]
    taus = np.minimum(solved[0][0], model.horizon()).tolist()
    outcomes = []
    for probe, each in zip(model.probes, refined(), strict=True):
        size = float(np.max(np.abs(each.values))) or 1.0
        integral = IntegratedOutput(taus, each.values, each.allowed * size, clear=True)
        outcomes.append(Outcome(probe.name, each.cells(first), integral.judges, integral=integral))
    return outcomes


def solution(model: Model, count: int) -> tuple[Array, Array]:
    """Instants, and outputs there (outputs, instants), with so many elements in the shortest rod."""
    stated = summing(modal_elements.RIVAL).states(model)
    model_of = DiscreteModel(Elements(stated.problem, _cells(stated.problem.delay, count)))
    taus, values = model_of.history(stated.problem.until / _INSTANTS)
    return taus, stated.added(values, taus)


def _cells(delay: Array, count: int) -> NDArray[np.int_]:
    """How many elements each rod has: twice as many where `count` is twice as large."""
    first = np.maximum(np.rint(_COARSEST * delay / np.min(delay)), 1).astype(int)
    return np.asarray(first * count // _COARSEST)


def _size(model: Model, count: int) -> int:
    delay = np.array([float(bar.delay.p) / float(bar.delay.q) for bar in model.network.bars])
    return int(np.sum(_cells(delay, count)))
