"""Error against the gap between rates: partial fractions carry powers of 1/gap, which doubles cannot cancel.

At a gap of exactly 0 the rates merge into one family, and the closed form is well again.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from wavesym.lab.atlas.attempts import attempts, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import LEGEND, drive
from wavesym.scene import Scene

GAPS = (*(Fraction(1, 10**k) for k in range(17)), Fraction(0))
REFLECTIONS = (5, 10)
ZERO = 1e-18


def family(progress: Progress, gaps: Sequence[Fraction] = GAPS, counts: Sequence[int] = REFLECTIONS) -> CurveFamily:
    """Two and three rates that meet, after so many reflections."""
    points: list[AtlasPoint] = []
    for rates, scene in ((2, _two), (3, _three)):
        for reflections in counts:
            for gap in gaps:
                progress(f"{rates} rates, {reflections} reflections, gap {float(gap):g}")
                known = truth(scene(gap, 2 * reflections), per_unit=4)
                panel = f"{rates} rates, {reflections} reflections"
                points += [one.point(panel, one.name, float(gap)) for one in attempts(known)]
    return CurveFamily(
        "gaps",
        "Error against the gap of rates: the closed form fails where rates nearly meet, not where they do",
        Axis("gap between neighbouring rates, of which the smallest is 1", zero=ZERO, falling=True),
        "largest error / largest value",
        tuple(points),
        LEGEND,
        most=1e3,
    )


def _two(gap: Fraction, until: int) -> Scene:
    """Rates 1 and 1 + gap."""
    return drive([Fraction(1)], [1 + gap, 1], until)


def _three(gap: Fraction, until: int) -> Scene:
    """Rates 1, 1 + gap and 1 + 2 gap: of the middle disc half from either shaft, and gap more from the second."""
    return drive([Fraction(1), Fraction(1, 2) + gap], [1, 2, 1], until)
