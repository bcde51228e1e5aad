"""Families of curves: other methods at fronts, and the chain of masses and springs that waves become.

Most methods converge away from fronts and never at one. As kappa goes to 0 waves die out, if they do: seen at fixed
sqrt(kappa) tau, the slow time of the springs. The march computes the waves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from wavesym.lab.atlas.attempts import Truth, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import atlas_scene
from wavesym.methods.advice import springs as solve_springs
from wavesym.methods.catalogue import METHODS
from wavesym.methods.problem import Method
from wavesym.programs.making import program
from wavesym.programs.march.evaluator import march
from wavesym.scene import Scene, lower

AT = "at fronts: within 1/50 of an arrival"
AWAY = "away from fronts: 1/10 or more from any arrival"

_SAME, _NEAR, _FAR = 1e-6, 0.0201, 0.0999
# so near that no grid or series here resolves it, and farther
_DISTANCES = (1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 2e-2)
AROUND = (*_DISTANCES, *(-distance for distance in _DISTANCES))
# of the largest value: who is wrong by more however fine it is does not converge
_WRONG = 0.01


def jumping() -> Scene:
    """A building of two storeys under a step of the base acceleration, by base force: its fronts are jumps."""
    system = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"}
    load = [{"times": [0], "a": [1], "b": [0]}]
    return atlas_scene(system, load, 10, strain=[Fraction(1, 2), Fraction(3, 2)])


def fronts(progress: Progress) -> CurveFamily:
    """A curve for each method, at fronts and away from them."""
    known = truth(jumping(), per_unit=40, around=AROUND)
    points: list[AtlasPoint] = []
    least: dict[str, float] = {}
    for method in METHODS:
        for resolution in method.resolutions:
            progress(f"{method.name}, {resolution:g} {method.unit}")
            at, away = errors(method, resolution, known)
            finer = resolution / method.resolutions[0]
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
    wrong = known.errors(method.prepare(method.state(known.model), resolution)(known.taus))
    distance = np.min(np.abs(known.taus[:, np.newaxis] - known.standard.arrivals), axis=1)
    # at an arrival itself either side of the jump will do
    near = (distance > _SAME) & (distance <= _NEAR)
    return float(np.max(wrong[near])), float(np.max(wrong[distance >= _FAR]))


KAPPAS = tuple(Fraction(1, 10**k) for k in range(1, 6))
# sqrt(kappa) tau at the end: about a period of the springs
SLOW_TIME = 6
# many to a unit of tau, and in step with no wave
SAMPLES = 20_011


class LumpedSystem(NamedTuple):
    """A system whose kappas are in fixed proportion, and the rods whose strains are compared."""

    name: str
    fields: dict[str, Any]
    proportions: tuple[Fraction, ...]
    load: tuple[dict[str, Any], ...]
    rods: tuple[int, ...]


_STEP = ({"times": [0], "a": [1], "b": [0]},)
_STOREYS = (Fraction(1), Fraction(1), Fraction(3, 2))
SYSTEMS = (
    LumpedSystem(
        "drive",
        {"type": "drive", "m": 2, "inertia": [1, 2, 1]},
        (Fraction(1), Fraction(2)),
        ({"body": 1, "times": [0], "steps": [1]},),
        (1, 2),
    ),
    LumpedSystem(
        "collision",
        {"type": "collision", "m": 4, "velocity": [1, "-1/2"]},
        (Fraction(1), Fraction(2)),
        (),
        (2, 3),
    ),
    LumpedSystem("building on moving ground", {"type": "building", "m": 2, "base": "ground"}, _STOREYS, _STEP, (1, 2)),
    LumpedSystem("building, base force, rod 1", {"type": "building", "m": 2, "base": "force"}, _STOREYS, _STEP, (1,)),
    LumpedSystem("building, base force, rod 2", {"type": "building", "m": 2, "base": "force"}, _STOREYS, _STEP, (2,)),
)


def springs(progress: Progress, kappas: Sequence[Fraction] = KAPPAS) -> CurveFamily:
    """A curve for each system, its order in its name."""
    points = []
    for system in SYSTEMS:
        for kappa in kappas:
            progress(f"masses and springs, {system.name}, kappa = {kappa}")
            points.append(AtlasPoint("all systems", system.name, float(kappa), difference(system, kappa)))
    return CurveFamily(
        "springs",
        "Waves against a chain of masses and springs: its order in kappa depends on the load, and may be none",
        Axis("kappa", falling=True),
        "largest difference of strain / largest strain",
        _label_orders(points),
        least=1e-6,
        most=1e1,
    )


def difference(system: LumpedSystem, kappa: Fraction) -> float:
    """Between the strains in the middle of the rods and those of springs, relative to the largest of the latter."""
    until = math.ceil(SLOW_TIME / math.sqrt(kappa))
    model = lower(_scene(system, kappa, until))
    waves = program(model, march(model))
    taus, strains = solve_springs(model, 0.0, until / SAMPLES)
    taus, strains = taus[:-1], strains[:, :-1]  # a front may arrive at the end
    return float(np.max(np.abs(waves.evaluate(taus) - strains)) / np.max(np.abs(strains)))


def _scene(system: LumpedSystem, kappa: Fraction, until: int) -> Scene:
    fields = {**system.fields, "kappa": [part * kappa for part in system.proportions]}
    return atlas_scene(fields, system.load, until, strain=[Fraction(2 * rod - 1, 2) for rod in system.rods])


def orders(points: Sequence[AtlasPoint]) -> dict[str, float]:
    """The slope of each curve over its last decade: the power of kappa with which the difference falls."""
    found = {}
    for name in dict.fromkeys(point.curve for point in points):
        before, last = [point for point in points if point.curve == name][-2:]
        found[name] = math.log(before.error / last.error) / math.log(before.x / last.x)
    return found


def _label_orders(points: Sequence[AtlasPoint]) -> tuple[AtlasPoint, ...]:
    slopes = orders(points)
    return tuple(replace(point, curve=f"{point.curve}: order {slopes[point.curve]:.2f}") for point in points)
