"""Records whose samples are no whole number of rods apart: where the march ends, and what goes on."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

import numpy as np

from wavesym.errors import WavesymError
from wavesym.exact.reference import Reference
from wavesym.lab.atlas import shaken
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import midpoint, nearest, rational
from wavesym.programs.hats.evaluator import hat_march
from wavesym.programs.making import make, program
from wavesym.programs.march.evaluator import march
from wavesym.programs.program import Program
from wavesym.programs.request import Request
from wavesym.scene import lower

PARTS = (1, 2, 4, 8, 16, 32, 200, 10**3, 10**6, 10**9, 10**12)
SAMPLES = 18  # two more than a march has panels
TOLERANCE = Fraction(1, 10**6)


def spacing(parts: int) -> Fraction:
    """So many samples are a whole number of rods, and no fewer."""
    return 5 - Fraction(1, parts)


def family(progress: Progress, counts: Sequence[int] = PARTS) -> CurveFamily:
    """Each program at the samples."""
    points = []
    for parts in counts:
        scene = shaken.scene(spacing(parts), SAMPLES, TOLERANCE, force=[0], drift=[1], relative=[2])
        reference = Reference(lower(scene))
        times = (nearest(rational(k * spacing(parts))) for k in range(SAMPLES))
        taus = np.array([min(time, reference.tau_max) for time in times])
        sizes = np.array([midpoint(size) for size in reference.largest()])
        right = np.array(reference.values(taus.tolist()))
        for name, way in WAYS.items():
            progress(f"samples 5 - 1/{parts} apart, {name}")
            try:
                made = way(reference.model)
                values = made.evaluate(taus)
            except WavesymError as why:
                points.append(AtlasPoint("", name, parts, float("nan"), refused=str(why)))
                continue
            error = shaken.worst(values, right, sizes)
            refused = f"{name}: a bound of {made.error_bound:.1e} in all" if made.error_bound > TOLERANCE else ""
            points.append(AtlasPoint("", name, parts, error, made.error_bound, refused))
    return CurveFamily(
        "spacings",
        "Samples 5 - 1/q apart: a march goes to q = 16, that of one hat far on, modes anywhere",
        Axis("q"),
        "largest error at the samples / largest value",
        tuple(points),
        "filled: proved to stay below 1e-6; hollow: not; cross: refused before the work (the table has each reason)",
    )


def _modes(model: Model) -> Program:
    return make(model, Request(evaluator="modes"))


def _march(model: Model) -> Program:
    """As it is, and not of one hat."""
    return program(model, march(model))


def _hat(model: Model) -> Program:
    made = hat_march(model)
    assert made  # there are samples enough
    return program(model, made)


WAYS: Mapping[str, Callable[[Model], Program]] = {"modes": _modes, "march": _march, "march of one hat": _hat}
