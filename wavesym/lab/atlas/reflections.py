"""Error against the number of reflections: the closed form loses its digits, pieces and march keep theirs."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from wavesym.lab.atlas.attempts import EVALUATORS, attempt, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import LEGEND, drive
from wavesym.numbers.doubles import nearest

KAPPAS = (Fraction(1, 20), Fraction(1, 2), Fraction(5))
COUNTS = (1, 2, 3, 5, 7, 10, 14, 20, 30, 40, 50, 70, 100, 140, 200)
# pieces on longer horizons exist, but take minutes to fit
FITTED = {Fraction(1, 20): 200, Fraction(1, 2): 100, Fraction(5): 50}


def family(progress: Progress, kappas: Sequence[Fraction] = KAPPAS, counts: Sequence[int] = COUNTS) -> CurveFamily:
    """One drive of two equal discs for each kappa; its first front meets each disc once in two units of tau."""
    points = []
    for kappa in kappas:
        for name in EVALUATORS:
            progress(f"reflections, kappa = {kappa}, {name}")
            points += _points(kappa, name, counts)
    return CurveFamily(
        "reflections",
        "Error against reflections: the closed form loses all its digits, pieces and march stay within their bounds",
        Axis("reflections n of the first front at either disc, tau up to 2 n"),
        "largest error so far / largest value",
        tuple(points),
        LEGEND,
    )


def _points(kappa: Fraction, name: str, counts: Sequence[int]) -> list[AtlasPoint]:
    """An evaluator for the longest horizon, looked at up to shorter ones."""
    until = 2 * (min(FITTED[kappa], counts[-1]) if name == "pieces" else counts[-1])
    known = truth(drive([kappa], [1, 1], until), per_unit=3)
    one = attempt(known, name)
    assert one.errors is not None  # all of them have values here
    points = []
    for count in (count for count in counts if 2 * count <= until):
        last = int(np.searchsorted(known.taus, 2 * count)) - 1
        error, bound = float(np.max(one.errors[: last + 1])), float(one.bounds[last])
        refused = one.refused if bound > nearest(known.model.tolerance) else ""
        points.append(AtlasPoint(f"kappa = {kappa}", name, count, error, bound, refused))
    return points
