"""Linear finite elements, consistent mass, and their modes, each stepped exactly: what an engineer would write.

Where dashpots tie the modes all of it is stepped at once. Steps are as long as an element, and lines are drawn between.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from wavesym.rivals.lumped import DiscreteModel
from wavesym.rivals.mass import Elements
from wavesym.rivals.network import NetworkProblem, damped_problem
from wavesym.rivals.problem import Array, Evaluate, Rival


def _prepare(problem: NetworkProblem, resolution: float) -> Evaluate:
    cells = np.maximum(np.rint(problem.delay * resolution), 1).astype(int)
    model = DiscreteModel(Elements(problem, cells))
    _ = model.parts  # found once
    return partial(_read, model, 1 / resolution)


def _read(model: DiscreteModel, step: float, taus: Array) -> Array:
    instants, values = model.history(step)
    return np.array([np.interp(taus, instants, row) for row in values])


RIVAL = Rival(
    "finite elements, modal",
    "NumPy",
    "elements in a unit of delay",
    (4, 10, 20, 50, 100),
    damped_problem,
    _prepare,
)
