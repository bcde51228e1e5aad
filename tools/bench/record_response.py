"""A record through a damped frame of ten storeys: modes, and finite elements with modes of their own."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
from flint import fmpq

from wavesym.lab.timing import medians
from wavesym.mechanics.model import Model
from wavesym.methods.discrete import DiscreteModel
from wavesym.methods.elements import Elements
from wavesym.methods.network_problem import linear_problem
from wavesym.numbers.arrays import Array
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower

SAMPLES, SPACING = 1560, fmpq(4995, 1000)
_ELEMENTS = (1, 2, 4, 8)  # of a rod
_STOREYS = range(1, 11)
_FREQUENCIES = (0.4, 0.9, 1.1, 1.7, 2.3, 3.1, 4.7, 7.3)  # Hz


def frame() -> Scene:
    """Ten storeys that weigh as a steel frame's do, at 5 %, on ground that shakes about as in an earthquake."""
    seconds = np.arange(SAMPLES) / 50
    shaking = sum(np.sin(2 * np.pi * f * seconds + f**2) for f in _FREQUENCIES)
    shaking *= seconds * np.exp(-seconds / 4)
    return Scene(
        name="frame",
        system={"type": "building", "m": 10, "kappa": ["31/1000"] * 11, "base": "ground", "damping": "1/20"},
        load=[{"spacing": str(SPACING), "samples": [f"{value:.4f}" for value in shaking.tolist()]}],
        output={
            "until": str(SPACING * (SAMPLES - 1)),
            "tolerance": "1e-6",
            "acceleration": list(_STOREYS),
            "force": [0],
            "drift": list(_STOREYS),
            "relative": list(_STOREYS),
        },
    )


def rows() -> Iterator[Sequence[str]]:
    """What, the seconds that it takes from the scene's model to all outputs at all samples, its largest error."""
    model = lower(frame())
    taus = np.array([float(k * SPACING) for k in range(SAMPLES)])
    ways: dict[str, Callable[[], Array]] = {"modes": partial(modes, model, taus)}
    for count in _ELEMENTS:
        ways[f"finite elements, modal, {count} a rod"] = partial(elements, model, count)
    right = make(model.tolerating(model.tolerance / 30), Request(evaluator="modes")).evaluate(taus)
    sizes = np.max(np.abs(right), axis=1, keepdims=True)
    for (name, way), seconds in zip(ways.items(), medians(list(ways.values()), rounds=3), strict=True):
        yield name, f"{seconds:.3f}", f"{np.max(np.abs(way() - right) / sizes):.1e}"


def modes(model: Model, taus: Array) -> Array:
    """The outputs at tau by modes of waves."""
    return make(model, Request(evaluator="modes")).evaluate(taus)


def elements(model: Model, count: int) -> Array:
    """The outputs at the samples, `count` elements to a rod."""
    problem = linear_problem(model)
    return DiscreteModel(Elements(problem, np.full(len(problem.ends), count))).outputs(float(SPACING))[1]
