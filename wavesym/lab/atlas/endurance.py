"""Error and energy drift of the march to tau = 1e5 against its degree: below the degree that it takes, it says so.

The truth is a sum of modes (twist.py), which does not step through time. The march is the C that would be generated.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from wavesym.lab.atlas import twisted_shaft as twist
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.mechanics.model import Model
from wavesym.programs.making import program
from wavesym.programs.march.evaluator import MarchEvaluator, marched
from wavesym.running.native import FAST, address, library
from wavesym.scene import lower
from wavesym.targets.files import sources

HORIZON = 10**5
DEGREES = {
    Fraction(1, 100): (12, 16, 20, 24, 28, 32, 40),
    Fraction(3, 5): (20, 40, 80, 120, 160, 200, 220, 240, 260),
}

# the last of them ends at the horizon
_WINDOWS = 16

_FOLLOW = """
/* March on to each tau, read there, and note the energy and whether the degree has been found too low. */
int follow(const double *tau, size_t count, double *out, double *energy)
{
    static march state;
    int low = 0;
    NAME_init(&state);
    for (size_t k = 0; k < count; ++k) {
        while (state.window < (int)tau[k]) {
            low = NAME_advance(&state, NULL) || low;
        }
        NAME_read(&state, tau[k], out + k * OUTPUTS);
        energy[k] = NAME_energy(&state);
    }
    return low;
}
"""


@dataclass(frozen=True)
class Followed:
    """A march: its largest error, its largest change of energy, both relative, and whether its alarm has rung."""

    error: float
    drift: float
    alarm: bool


def family(
    progress: Progress, horizon: int = HORIZON, tried: Mapping[Fraction, Sequence[int]] = DEGREES
) -> CurveFamily:
    """A curve of errors and one of drifts for each kappa; the last point of each is at the degree that is chosen."""
    points = []
    for kappa, degrees in tried.items():
        panel = f"kappa = {kappa}"
        progress(f"march to {horizon:g}, {panel}, its own degree")
        chosen = marched(lower(twist.scene(kappa, horizon)))
        for degree in (*(degree for degree in degrees if degree < chosen.degree), chosen.degree):
            progress(f"march to {horizon:g}, {panel}, degree {degree}")
            found = follow(kappa, replace(chosen, degree=degree))
            bound = chosen.error_bound if degree == chosen.degree else float("inf")
            refused = f"the program reports that degree {degree} is too low" if found.alarm else ""
            points.append(AtlasPoint(panel, "error", degree, found.error, bound, refused))
            points.append(AtlasPoint(panel, "energy drift", degree, found.drift, refused=refused))
    return CurveFamily(
        "march",
        f"March to tau = {horizon:g}: error and energy drift reach rounding at the degree it takes (the last point)",
        Axis("degree of the polynomials", scale="linear"),
        "relative to the largest value, or to the energy",
        tuple(points),
        "filled: the program reports nothing; hollow: it reports that the degree is too low",
        least=1e-16,
        most=1e-3,
    )


def follow(kappa: Fraction, evaluator: MarchEvaluator) -> Followed:
    """The march of the twisted drive by an evaluator for it, compared now and then on all of its horizon."""
    model = lower(twist.scene(kappa, int(evaluator.tau_max)))
    windows = np.linspace(0, evaluator.tau_max, _WINDOWS + 1).astype(int)[1:] - 1
    taus = twist.calm([1, *windows.tolist()])  # the twist is over by then
    values, energy, alarm = _run(model, evaluator, taus)
    exact = twist.truth(kappa, taus)
    sizes = np.max(np.abs(exact), axis=1, keepdims=True)
    return Followed(float(np.max(np.abs(values - exact) / sizes)), float(np.max(np.abs(energy / energy[0] - 1))), alarm)


def _run(model: Model, evaluator: MarchEvaluator, taus: twist.Array) -> tuple[twist.Array, twist.Array, bool]:
    """Outputs (outputs, n), energies and the alarm."""
    made = sources(program(model, evaluator), "c")
    header = f"{model.name}.h"
    text = made[f"{model.name}.c"] + _FOLLOW.replace("NAME", model.name)
    marching = library(text, FAST, (header, made[header]))
    out, energy = np.empty((len(taus), len(model.probes))), np.empty(len(taus))
    places = [ctypes.c_void_p(address(array)) for array in (taus, out, energy)]
    low = marching.follow(places[0], ctypes.c_size_t(len(taus)), *places[1:])
    return out.T, energy, bool(low)
