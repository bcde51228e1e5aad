"""The limit kappa -> 0 against the chain of masses and springs: how fast the waves die out, if they do.

Seen at fixed sqrt(kappa) tau, the slow time of the springs. The march computes the waves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import made
from wavesym.methods.advice import springs
from wavesym.programs.making import program
from wavesym.programs.march.evaluator import march
from wavesym.scene import Scene, lower

KAPPAS = tuple(Fraction(1, 10**k) for k in range(1, 6))
# sqrt(kappa) tau at the end: about a period of the springs
SLOW_TIME = 6
# many to a unit of tau, and in step with no wave
SAMPLES = 20_011


class Lumped(NamedTuple):
    """A system whose kappas are in fixed proportion, and the rods whose strains are compared."""

    name: str
    fields: dict[str, Any]
    proportions: tuple[Fraction, ...]
    load: tuple[dict[str, Any], ...]
    rods: tuple[int, ...]


_STEP = ({"times": [0], "a": [1], "b": [0]},)
_STOREYS = (Fraction(1), Fraction(1), Fraction(3, 2))
SYSTEMS = (
    Lumped(
        "drive",
        {"type": "drive", "m": 2, "inertia": [1, 2, 1]},
        (Fraction(1), Fraction(2)),
        ({"body": 1, "times": [0], "steps": [1]},),
        (1, 2),
    ),
    Lumped(
        "collision",
        {"type": "collision", "m": 4, "velocity": [1, "-1/2"]},
        (Fraction(1), Fraction(2)),
        (),
        (2, 3),
    ),
    Lumped("building on moving ground", {"type": "building", "m": 2, "base": "ground"}, _STOREYS, _STEP, (1, 2)),
    Lumped("building, base force, rod 1", {"type": "building", "m": 2, "base": "force"}, _STOREYS, _STEP, (1,)),
    Lumped("building, base force, rod 2", {"type": "building", "m": 2, "base": "force"}, _STOREYS, _STEP, (2,)),
)


def family(progress: Progress, kappas: Sequence[Fraction] = KAPPAS) -> CurveFamily:
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
        _labelled(points),
        least=1e-6,
        most=1e1,
    )


def difference(system: Lumped, kappa: Fraction) -> float:
    """Between the strains in the middle of the rods and those of springs, relative to the largest of the latter."""
    until = math.ceil(SLOW_TIME / math.sqrt(kappa))
    model = lower(_scene(system, kappa, until))
    waves = program(model, march(model))
    taus, strains = springs(model, 0.0, until / SAMPLES)
    taus, strains = taus[:-1], strains[:, :-1]  # a front may arrive at the end
    return float(np.max(np.abs(waves.evaluate(taus) - strains)) / np.max(np.abs(strains)))


def _scene(system: Lumped, kappa: Fraction, until: int) -> Scene:
    fields = {**system.fields, "kappa": [part * kappa for part in system.proportions]}
    return made(fields, system.load, until, strain=[Fraction(2 * rod - 1, 2) for rod in system.rods])


def orders(points: Sequence[AtlasPoint]) -> dict[str, float]:
    """The slope of each curve over its last decade: the power of kappa with which the difference falls."""
    found = {}
    for name in dict.fromkeys(point.curve for point in points):
        before, last = [point for point in points if point.curve == name][-2:]
        found[name] = math.log(before.error / last.error) / math.log(before.x / last.x)
    return found


def _labelled(points: Sequence[AtlasPoint]) -> tuple[AtlasPoint, ...]:
    slopes = orders(points)
    return tuple(replace(point, curve=f"{point.curve}: order {slopes[point.curve]:.2f}") for point in points)
