"""Each evaluator tried on a scene, by the program that would be generated, where it refuses too; and the truth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wavesym.errors import CostError, UnservedError
from wavesym.lab.atlas.family import AtlasPoint
from wavesym.lab.atlas.scenes import AIM
from wavesym.lab.standard import Standard, standard
from wavesym.mechanics.model import Model
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.choice import MAKERS
from wavesym.programs.closed_form import ClosedForm
from wavesym.programs.making import program
from wavesym.scene import Scene, lower

EVALUATORS = ("closed", "pieces", "march")
ROUNDED = 2.0**-53
"""The truth is rounded once: an error may be this much larger than its bound."""


@dataclass(frozen=True)
class Truth:
    """The outputs of a model at ascending `taus`, (outputs, n), by a `standard`."""

    model: Model
    standard: Standard
    taus: Array
    values: Array

    def errors(self, values: Array) -> Array:
        """The largest error of any output at each of the `taus`, relative to its largest value."""
        return np.asarray(np.max(self.standard.errors(values, self.values), axis=0))


@dataclass(frozen=True)
class Attempt:
    """An evaluator's errors at the taus of a truth, relative to the outputs' largest values and the largest of them.

    None where there are no values; `bounds` has the proved bound up to each tau.
    """

    name: str
    taus: Array
    errors: Array | None
    bounds: Array
    refusal: str

    def point(self, panel: str, curve: str, x: float) -> AtlasPoint:
        """The largest error as a point of a curve."""
        error = math.nan if self.errors is None else float(np.max(self.errors))
        return AtlasPoint(panel, curve, x, error, float(self.bounds[-1]), self.refusal)


def truth(scene: Scene, per_unit: int, around: Sequence[float] = ()) -> Truth:
    """At `per_unit` places in a unit of tau, at every arrival, and just before it or at these distances from it."""
    known = standard(model := lower(scene))
    until, arrivals = known.until, known.arrivals.tolist()
    taus = {float(tau) for tau in np.linspace(0.0, until, round(per_unit * until) + 1)} | set(arrivals)
    taus |= {arrival + by for arrival in arrivals for by in around} or {math.nextafter(tau, 0.0) for tau in arrivals}
    where = sorted(tau for tau in taus if 0.0 <= tau <= until)
    return Truth(model, known, np.array(where), np.array(known.values(where)))


def attempt(known: Truth, name: str) -> Attempt:
    """One evaluator at the truth's taus."""
    model, taus = known.model, known.taus
    nothing = np.full(len(taus), math.inf)
    try:
        form = MAKERS[name](model.tolerating(rational(AIM)), DOUBLE, True, "speed", False)
    except (CostError, UnservedError, OverflowError) as error:
        return Attempt(name, taus, None, nothing, str(error))
    met = rational(min(form.error_bound, 2.0)) <= model.tolerance
    refused = "" if met else form.shortfall(model.tolerance)
    bounds = _bounds_by_horizon(form, taus) if isinstance(form, ClosedForm) else np.full(len(taus), form.error_bound)
    with np.errstate(over="ignore", invalid="ignore"):
        wrong = known.errors(program(model, form).evaluate(taus))
    errors = np.where(np.isfinite(wrong), wrong, math.inf)
    return Attempt(name, taus, errors, bounds, refused)


def _bounds_by_horizon(form: ClosedForm, taus: Array) -> Array:
    """The proved bound of the closed form up to each tau."""
    bounds = np.zeros(len(taus))
    for output in form.outputs:
        starts = [pulse.start for pulse in output.pulses]
        here = np.searchsorted(starts, taus, side="right")
        bounds = np.maximum(bounds, np.concatenate([[0.0], output.pulse_bounds])[here])
    return bounds


def skipped_attempt(known: Truth, name: str, why: str) -> Attempt:
    """An evaluator that the atlas leaves out, and why."""
    return Attempt(name, known.taus, None, np.full(len(known.taus), math.inf), f"not tried: {why}")
