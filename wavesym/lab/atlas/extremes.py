"""Extreme kappa: very heavy and very light bodies, and which evaluator still goes there."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from wavesym.lab.atlas.attempts import EVALUATORS, attempt, not_tried, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import LEGEND, drive

# at 1e4 the march may take a minute, as degrees up to the largest are tried before it refuses
EXPONENTS = (*range(-6, 4), 5, 6)
REFLECTIONS = 5

# the power series that pieces come from have more terms than kappa: minutes for 100, and then hours
_PIECES_TO = 10
_WHY = "a fit to so light a body takes minutes"


def family(progress: Progress, exponents: Sequence[int] = EXPONENTS) -> CurveFamily:
    """Two equal discs and their shaft, kappa from 1e-6 to 1e6."""
    points: list[AtlasPoint] = []
    for exponent in exponents:
        kappa = Fraction(10) ** exponent
        progress(f"kappa = 1e{exponent}")
        known = truth(drive([kappa], [1, 1], 2 * REFLECTIONS), per_unit=8)
        for name in EVALUATORS:
            tried = name != "pieces" or kappa <= _PIECES_TO
            one = attempt(known, name) if tried else not_tried(known, name, _WHY)
            points.append(one.point(f"drive, m = 1, {REFLECTIONS} reflections", name, float(kappa)))
    return CurveFamily(
        "kappa",
        "Error against kappa: heavy bodies cost the closed form digits, light ones cost the others degrees",
        Axis("kappa, impedance of the shaft against inertia of the disc"),
        "largest error / largest value",
        tuple(points),
        LEGEND,
    )
