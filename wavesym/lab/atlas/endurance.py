"""Error and energy drift of the march to tau = 1e5 against its degree.

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
from wavesym.numbers.doubles import nearest
from wavesym.programs.making import program
from wavesym.programs.march.evaluator import March, march
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
/* March on to each tau, read there, and note the energy in the rods and of the bodies at the window's end. */
void follow(const double *tau, size_t count, const double *impedance, const double *mass, double *out, double *energy)
{
    static march state;
    begin_march(&state);
    for (size_t i = 0; i < count; ++i) {
        outputs_at(&state, tau[i], out + i * OUTPUTS);
        energy[i] = 0;
        for (int n = 0; n < STATES; ++n) {
            energy[i] += mass[n] * state.x[n] * state.x[n] / 2;
        }
        for (int n = 0; n < TRACKS; ++n) {
            for (int panel = 0; panel < PANELS; ++panel) {
                const double *const c = wave_sent(&state, n, panel);
                double sum = 0;
                for (int j = 0; j <= DEGREE; ++j) {
                    for (int k = j % 2; k <= DEGREE; k += 2) {
                        const double both = j + k;
                        const double apart = j - k;
                        sum += c[j] * c[k] * (1 / (1 - both * both) + 1 / (1 - apart * apart));
                    }
                }
                energy[i] += impedance[n] * half_length[panel] * sum;
            }
        }
    }
}
"""


@dataclass(frozen=True)
class Followed:
    """A march: its largest error and its largest change of energy, both relative."""

    error: float
    drift: float


def family(
    progress: Progress, horizon: int = HORIZON, tried: Mapping[Fraction, Sequence[int]] = DEGREES
) -> CurveFamily:
    """A curve of errors and one of drifts for each kappa; the last point of each is at the degree that is chosen."""
    points = []
    for kappa, degrees in tried.items():
        panel = f"kappa = {kappa}"
        progress(f"march to {horizon:g}, {panel}, its own degree")
        chosen = march(lower(twist.scene(kappa, horizon)))
        for degree in (*(degree for degree in degrees if degree < chosen.degree), chosen.degree):
            progress(f"march to {horizon:g}, {panel}, degree {degree}")
            found = follow(kappa, replace(chosen, degree=degree))
            bound = chosen.error_bound if degree == chosen.degree else float("inf")
            refused = f"its bound asks for degree {chosen.degree}" if degree < chosen.degree else ""
            points.append(AtlasPoint(panel, "error", degree, found.error, bound, refused))
            points.append(AtlasPoint(panel, "energy drift", degree, found.drift, refused=refused))
    return CurveFamily(
        "march",
        f"March to tau = {horizon:g}: error and energy drift reach rounding at the degree it takes (the last point)",
        Axis("degree of the polynomials", scale="linear"),
        "relative to the largest value, or to the energy",
        tuple(points),
        "filled: the degree that its bound asks for; hollow: a lower one",
        least=1e-16,
        most=1e-3,
    )


def follow(kappa: Fraction, evaluator: March) -> Followed:
    """The march of the twisted drive by an evaluator for it, compared now and then on all of its horizon."""
    model = lower(twist.scene(kappa, int(evaluator.tau_max)))
    windows = np.linspace(0, evaluator.tau_max, _WINDOWS + 1).astype(int)[1:] - 1
    taus = twist.calm([1, *windows.tolist()])  # the twist is over by then
    values, energy = _run(model, evaluator, taus)
    exact = twist.truth(kappa, taus)
    sizes = np.max(np.abs(exact), axis=1, keepdims=True)
    return Followed(float(np.max(np.abs(values - exact) / sizes)), float(np.max(np.abs(energy / energy[0] - 1))))


def _run(model: Model, evaluator: March, taus: twist.Array) -> tuple[twist.Array, twist.Array]:
    """Outputs (outputs, n) and energies."""
    plan = evaluator.plan
    made = sources(program(model, evaluator), "c")
    header = f"{model.name}.h"
    marching = library(made[f"{model.name}.c"] + _FOLLOW, FAST, (header, made[header]))
    impedances = np.array([nearest(track.impedance) for track in plan.tracks])
    masses = np.array([nearest(weight) for joint in plan.joints for weight in joint.space.weights])
    out, energy = np.empty((len(taus), len(model.probes))), np.empty(len(taus))
    places = [ctypes.c_void_p(address(array)) for array in (taus, impedances, masses, out, energy)]
    marching.follow(places[0], ctypes.c_size_t(len(taus)), *places[1:])
    return out.T, energy
