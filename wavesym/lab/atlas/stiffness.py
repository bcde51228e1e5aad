"""Springs from very soft to very stiff: the bound does not grow with what a series has to bear."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from wavesym.lab.atlas.attempts import EVALUATORS, attempt, truth
from wavesym.lab.atlas.family import Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import LEGEND, chain
from wavesym.scene import Scene

EXPONENTS = range(-6, 7)
UNTIL = 3


def scene(stiffness: Fraction) -> Scene:
    """Two unit masses with a spring between them, the first pushed, the second on a rod that ends in a wall."""
    parts = [{"mass": 1, "name": "first"}, {"spring": stiffness}, {"mass": 1, "name": "second"}, {"rod": 1}, "fixed"]
    return chain(parts, UNTIL, velocity=["first", "second"], strain=["0.5"])


def family(progress: Progress, exponents: Sequence[int] = EXPONENTS) -> CurveFamily:
    """K/M from 1e-6 to 1e6, for which the spring swings up to 700 times on the horizon."""
    points = []
    for exponent in exponents:
        progress(f"spring, K/M = 1e{exponent}")
        known = truth(scene(Fraction(10) ** exponent), per_unit=64)
        points += [attempt(known, name).point("", name, 10.0**exponent) for name in EVALUATORS]
    return CurveFamily(
        "stiffness",
        "Error against the stiffness of a spring between two masses: bounds hold from soft to stiff",
        Axis("K/M, stiffness of the spring against either mass"),
        "largest error / largest value",
        tuple(points),
        LEGEND,
    )
