"""Dashpots near the impedance: what they send back is as small as it has to be, and is not lost.

A pulse runs along a bar to a dashpot b, which sends (b - Z)/(b + Z) of its stress back, and nothing at all if b = Z.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from wavesym.lab.atlas.attempts import EVALUATORS, attempt, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import AIM, LEGEND, aimed, made
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower

GAPS = (*(Fraction(1, 10**k) for k in range(0, 19, 2)), Fraction(0))
SIDES = {"b = Z (1 + gap)": 1, "b = Z (1 - gap)": -1}
UNTIL = 8
ZERO = 1e-20

# when a pulse that is 1/4 long, seen in the middle of the bar, has been to the dashpot once, and twice
ECHOES = {"first echo": 1.625, "second echo": 3.625}


def scene(dashpot: Fraction) -> Scene:
    """A bar of impedance 1, free but for a pulse of force at one end, with a dashpot at the other."""
    parts = [{"joint": True, "name": "first"}, {"rod": 1}, {"joint": True, "dashpot": dashpot}]
    pulse = {"at": "first", "times": [0, Fraction(1, 4)], "steps": [1, -1]}
    return made({"type": "chain", "parts": parts}, [pulse], UNTIL, strain=["1/2"])


def echoes(dashpot: Fraction) -> list[float]:
    """The size of each echo, by the pieces that would be generated; the pulse has size 1."""
    pieces = make(lower(aimed(scene(dashpot), AIM)), Request(evaluator="pieces"))
    return list(map(float, np.abs(pieces.evaluate(list(ECHOES.values()))[0])))


def family(progress: Progress, gaps: Sequence[Fraction] = GAPS) -> CurveFamily:
    """The errors of the evaluators, and how large the echoes are."""
    points = []
    for panel, sign in SIDES.items():
        for gap in gaps:
            progress(f"dashpot, {panel}, gap {float(gap):g}")
            known = truth(scene(1 + sign * gap), per_unit=8)
            points += [attempt(known, name).point(panel, name, float(gap)) for name in EVALUATORS]
            for name, size in zip(ECHOES, echoes(1 + sign * gap), strict=True):
                points.append(AtlasPoint(panel, name, float(gap), size))
    return CurveFamily(
        "dashpots",
        "Dashpots near the impedance: echoes shrink as the gap and as its square, and are exactly 0 where it is",
        Axis("gap", zero=ZERO, falling=True),
        "largest error, or echo, / largest value",
        tuple(points),
        LEGEND,
        least=1e-40,
        most=1e4,
    )
