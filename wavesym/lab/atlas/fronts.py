"""What each method does at a front, against its resolution: most converge away from fronts and never at one."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from wavesym.lab.atlas.attempts import Truth, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import made
from wavesym.methods.every import METHODS
from wavesym.methods.problem import Method
from wavesym.scene import Scene

UNTIL = 10
AT = "at fronts: within 1/50 of an armethod"
AWAY = "away from fronts: 1/10 or more from any armethod"

_SAME, _NEAR, _FAR = 1e-6, 0.0201, 0.0999
# so near that no grid or series here resolves it, and farther
_DISTANCES = (1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 2e-2)
AROUND = (*_DISTANCES, *(-distance for distance in _DISTANCES))
# of the largest value: who is wrong by more however fine it is does not converge
_WRONG = 0.01
# a solver of order 8 takes as many more steps as its tolerance to this power
_PER_TOLERANCE = -1 / 8


def scene() -> Scene:
    """A building of two storeys under a step of the base acceleration, by base force: its fronts are jumps."""
    system = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"}
    load = [{"times": [0], "a": [1], "b": [0]}]
    return made(system, load, UNTIL, strain=[Fraction(1, 2), Fraction(3, 2)])


def family(progress: Progress) -> CurveFamily:
    """A curve for each method, at fronts and away from them."""
    known = truth(scene(), per_unit=40, around=AROUND)
    points: list[AtlasPoint] = []
    least: dict[str, float] = {}
    for method in METHODS:
        for resolution in method.resolutions:
            progress(f"{method.name}, {resolution:g} {method.unit}")
            at, away = errors(method, resolution, known)
            finer = refinement(method, resolution)
            points += [AtlasPoint(AT, method.name, finer, at), AtlasPoint(AWAY, method.name, finer, away)]
            least[method.name] = min(at, least.get(method.name, at))
    astray = sum(error > _WRONG for error in least.values())
    return CurveFamily(
        "fronts",
        f"Other methods at a front: {astray} of {len(least)} stay wrong by over {_WRONG:.0%} there, however fine",
        Axis("how many times finer than the coarsest grid, series or steps"),
        "largest error / largest value",
        tuple(sorted(points, key=lambda point: point.panel != AT)),
        least=1e-14,
        most=1e1,
    )


def errors(method: Method, resolution: float, known: Truth) -> tuple[float, float]:
    """The largest error at fronts, and away from them."""
    found = method.prepare(method.state(known.model), resolution)(known.taus)
    wrong = np.max(np.abs(found - known.values) / known.sizes[:, np.newaxis], axis=0)
    distance = np.min(np.abs(known.taus[:, np.newaxis] - known.arrivals), axis=1)
    # at an armethod itself either side of the jump will do
    near = (distance > _SAME) & (distance <= _NEAR)
    return float(np.max(wrong[near])), float(np.max(wrong[distance >= _FAR]))


def refinement(method: Method, resolution: float) -> float:
    """How much finer a resolution is than the first."""
    ratio = resolution / method.resolutions[0]
    return float(ratio**_PER_TOLERANCE if "tolerance" in method.unit else ratio)
