"""Damping from none to far beyond critical: modes against finite elements that are extrapolated.

The elements have consistent mass, and modes of their own, which are damped and stepped by other means. Their error has
even powers of an element alone where nothing bends too sharply; two levels of extrapolation tell by how much it has.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from wavesym.fields.numbers import decimal_text
from wavesym.lab.atlas import shaken
from wavesym.lab.atlas.attempts import Array
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.mechanics.model import Model
from wavesym.methods.discrete import DiscreteModel
from wavesym.methods.elements import Elements
from wavesym.methods.problem import problem_of
from wavesym.scene import lower

_NEARLY = Fraction(1, 10**9)
RATIOS = (
    *(Fraction(number) for number in ("0", "1/1000", "1/100", "1/50", "1/20", "1/10", "1/5", "1/2")),
    *(1 - _NEARLY, Fraction(1), 1 + _NEARLY),
    *(Fraction(number) for number in ("11/10", "2", "5", "10")),
)
ALL, RAYLEIGH = "all modes at this ratio", "Rayleigh: modes 1 and 2 at this ratio"
PANELS = (ALL, RAYLEIGH)
MODES, ELEMENTS, DOUBT = "modes", "finite elements", "extrapolation itself"
SPACING, SAMPLES = Fraction(5, 2), 9
TOLERANCE = Fraction(1, 10**6)
ZERO = 1e-4

_CELLS = (8, 16, 32, 64)  # of a rod
_INSTANTS = 10  # of a step


class Extrapolated(NamedTuple):
    """Outputs at `taus` (outputs, n): of the finest elements, and of none; and these from elements twice as coarse."""

    taus: Array
    finest: Array
    limit: Array
    coarser: Array


def family(progress: Progress, ratios: Sequence[Fraction] = RATIOS, panels: Sequence[str] = PANELS) -> CurveFamily:
    """Displacements, whose elements converge well enough to judge what modes leave out."""
    points = []
    for panel in panels:
        for ratio in ratios:
            progress(f"damping, {panel}: {float(ratio):g}")
            model = lower(shaken.scene(SPACING, SAMPLES, TOLERANCE, damping(panel, ratio), drift=[1], relative=[2]))
            found = extrapolated(model)
            sizes = np.max(np.abs(found.limit), axis=1)
            form, values = shaken.of_modes(model, found.taus)
            for name, one, bound in (
                (MODES, values, form.error_bound),
                (ELEMENTS, found.finest, np.inf),
                (DOUBT, found.coarser, np.inf),
            ):
                points.append(AtlasPoint(panel, name, float(ratio), shaken.worst(one, found.limit, sizes), bound))
    return CurveFamily(
        "damping",
        "Error of modes against damping, from none to ten times critical: no ratio is a special case",
        Axis("damping ratio", zero=ZERO),
        "largest difference / largest value",
        tuple(points),
        f"from finite elements, {_CELLS[-1]} a rod, extrapolated to none; that may itself be wrong by its own curve",
        least=1e-12,
        most=1e-4,
    )


def damping(panel: str, ratio: Fraction) -> Fraction | str | Mapping[str, Any]:
    """What a scene says of it; above critical damping in percent."""
    said = ratio if ratio <= 1 else f"{decimal_text(100 * ratio)} %"
    return said if panel == ALL else {"modes": [1, 2], "ratio": said}


def extrapolated(model: Model) -> Extrapolated:
    """The limit of elements that are halved again and again, by two powers of their length."""
    problem = problem_of(model)
    levels = []
    for count in _CELLS:
        cells = np.full(shaken.RODS, count)
        taus, values = DiscreteModel(Elements(problem, cells)).outputs(float(SPACING) / _INSTANTS)
        levels.append(values)
    once = [(4 * fine - coarse) / 3 for coarse, fine in pairwise(levels)]
    coarser, limit = ((16 * fine - coarse) / 15 for coarse, fine in pairwise(once))
    return Extrapolated(taus, levels[-1], limit, coarser)
