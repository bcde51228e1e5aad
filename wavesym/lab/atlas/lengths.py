"""Lengths that are nearly equal: what they cost is their knots, not the steps that their common measure would need."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

from wavesym.exact.breakpoints import Breakpoints
from wavesym.lab.atlas.attempts import attempt, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import chain
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import rational
from wavesym.scene import Scene

GAPS = (*(Fraction(1, 10**k) for k in (0, 1, 2, 3, 6, 9, 12, 15, 18)), Fraction(0))
UNTIL = 20
ZERO = 1e-20

KNOTS, STEPS, PIECES = "knots, the most at one joint", "steps of the common measure to the horizon", "pieces"


def scene(gap: Fraction) -> Scene:
    """Rods of length 1 and 1 + gap between three equal masses, of which the first is pushed."""
    parts = [{"mass": 1, "name": "first"}, {"rod": 1}, {"mass": 1}, {"rod": 1 + gap}, {"mass": 1}]
    return chain(parts, UNTIL, velocity=["first"], strain=["1-"])


def family(progress: Progress, gaps: Sequence[Fraction] = GAPS) -> CurveFamily:
    """Knots, steps, and the error of pieces, as the lengths come together."""
    points = []
    for gap in gaps:
        progress(f"lengths 1 and 1 + {float(gap):g}")
        known = truth(scene(gap), per_unit=4)
        points.append(AtlasPoint("", KNOTS, float(gap), most_knots(known.model)))
        points.append(AtlasPoint("", STEPS, float(gap), steps(known.model)))
        points.append(attempt(known, "pieces").point("", PIECES, float(gap)))
    return CurveFamily(
        "lengths",
        "Rods of lengths 1 and 1 + gap: a common grid would need ever more steps; knots and errors stay as they are",
        Axis("gap", zero=ZERO, falling=True),
        "a number; of pieces largest error / largest value",
        tuple(sorted(points, key=lambda point: (KNOTS, STEPS, PIECES).index(point.curve))),
        least=1e-17,
        most=1e21,
    )


def most_knots(model: Model) -> int:
    """How many knots the joint with most of them has by the horizon."""
    joints = Breakpoints(model, rational(model.horizon())).joints
    return max(sum(knot <= model.until for knot in times) for times in joints.values())


def steps(model: Model) -> float:
    """How many steps a grid has on which every wave takes a whole number of them through every rod."""
    delays = [bar.delay for bar in model.network.bars]
    common = math.lcm(*(int(delay.q) for delay in delays))
    return float(model.until * common / math.gcd(*(int(delay * common) for delay in delays)))
