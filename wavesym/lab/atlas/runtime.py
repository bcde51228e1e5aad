"""Parameters at run time: what a model says of its error without knowing the truth, an estimate and a proved bound."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from wavesym.lab.atlas.attempts import truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import drive
from wavesym.programs.runtime.making import sets_program
from wavesym.running.model import compiled_model
from wavesym.scene import lower

KAPPAS = (*(factor * Fraction(10) ** power for power in range(-3, 3) for factor in (1, 3)), Fraction(1000))
SHAFTS = (1, 3)
COUNTS = (1, 2, 3, 5, 10, 20, 50, 100, 200)
RATES = (Fraction(1, 20), Fraction(1), Fraction(20))

_NOTE = "dotted: proved, by name_error_bound; the estimate comes with every build; cross: refused, bodies too light"
_Y = "largest error / largest value"
_TOLERANCE = "1e-12"
_UNTIL = 10


def by_kappa(progress: Progress, kappas: Sequence[Fraction] = KAPPAS, shafts: Sequence[int] = SHAFTS) -> CurveFamily:
    """One model of equal shafts and discs, built for one kappa after the other."""
    points: list[AtlasPoint] = []
    for m in shafts:
        for kappa in kappas:
            progress(f"at run time, m = {m}, kappa = {float(kappa):g}")
            points += _points(f"drive, m = {m}, tau to {_UNTIL}", [kappa] * m, _UNTIL, float(kappa))
    return CurveFamily(
        "runtime_kappa",
        "Parameters at run time, error against kappa: the bound costs digits, and all hold until the degree ends",
        Axis("kappa of all shafts"),
        _Y,
        tuple(points),
        _NOTE,
        most=1e-6,
    )


def by_reflections(
    progress: Progress, rates: Sequence[Fraction] = RATES, counts: Sequence[int] = COUNTS
) -> CurveFamily:
    """A shaft between two discs, for longer and longer."""
    points: list[AtlasPoint] = []
    for kappa in rates:
        for count in counts:
            progress(f"at run time, kappa = {kappa}, {count} reflections")
            points += _points(f"kappa = {kappa}", [kappa], 2 * count, count)
    return CurveFamily(
        "runtime_reflections",
        "Parameters at run time, error against reflections: rounding adds up slowly, what is proved of it faster",
        Axis("reflections n of the first front at either disc, tau up to 2 n"),
        _Y,
        tuple(points),
        _NOTE,
        most=1e-4,
    )


def _points(panel: str, kappa: Sequence[Fraction], until: int, x: float) -> list[AtlasPoint]:
    """The error with its bound, and the estimate, of a model whose own kappa is 1."""
    known = truth(drive(list(kappa), [1] * (len(kappa) + 1), until), per_unit=8)
    own = drive([Fraction(1)] * len(kappa), [1] * (len(kappa) + 1), until).with_({"output.tolerance": _TOLERANCE})
    model = compiled_model(sets_program(lower(own), ["kappa"]))
    values = np.array([float(value) for value in kappa])
    checks = model.check(kappa=values)
    (estimate,) = checks.estimate
    why = checks.why[0] if checks.status[0] else ""  # an estimate above the tolerance is no refusal
    wrong = known.errors(model.run(known.taus, kappa=values)[0])
    bound = float(np.nan_to_num(np.max(model.bounds(kappa=values)), nan=np.inf))
    return [
        AtlasPoint(panel, "error", x, float(np.max(wrong)), bound, why),
        AtlasPoint(panel, "estimate", x, float(estimate), refusal=why),
    ]
