"""A building of two storeys on ground that shakes as samples say, which may be any time apart; and its modes."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from wavesym.lab.atlas.attempts import Array
from wavesym.lab.atlas.scenes import aimed, made
from wavesym.mechanics.model import Model
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.making import program
from wavesym.programs.modes.evaluator import ModesEvaluator, modes
from wavesym.scene import Scene

KAPPAS = [Fraction(1, 10), Fraction(1, 5), Fraction(1, 10)]
RODS = 2

_LEAP = 8


def scene(spacing: Fraction, samples: int, tolerance: Fraction, damping: Any = 0, **outputs: Any) -> Scene:
    """So many samples from tau = 0 on, the first 0, which leap between -1 and 1; the last is at the horizon."""
    leaps = [Fraction(0), *(Fraction((7 * k * k + 3 * k) % 17 - _LEAP, _LEAP) for k in range(1, samples))]
    system = {"type": "building", "m": RODS, "kappa": KAPPAS, "base": "ground", "damping": damping}
    load = {"spacing": spacing, "samples": leaps}
    return aimed(made(system, [load], spacing * (samples - 1), **outputs), tolerance)


def of_modes(model: Model, taus: Array) -> tuple[ModesEvaluator, Array]:
    """As many modes as the model's tolerance takes, and all outputs (outputs, n). ToleranceError of too many."""
    form = modes(model, DOUBLE)
    return form, program(model, form).evaluate(taus)


def worst(values: Array, right: Array, sizes: Array) -> float:
    """The largest error of any output, relative to its largest value; of `right` values (outputs, n)."""
    return float(np.max(np.abs(values - right) / sizes[:, np.newaxis]))
