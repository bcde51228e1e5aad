"""The march on long horizons: error and energy drift against its degree, in the C of its program.

The truth is a sum of modes, which does not step through time (tests/support/twisted_shaft.py).
"""

import ctypes
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from tests.support.twisted_shaft import calm, modal_sum, twisted
from wavesym.exact.reference import Reference
from wavesym.numbers.doubles import nearest
from wavesym.programs.making import program
from wavesym.programs.march.evaluator import march
from wavesym.running.native import FAST, address, library
from wavesym.scene import lower
from wavesym.targets.files import sources

WINDOWS = 16  # that are looked at; the last of them ends at the horizon

FOLLOW = """
/* March on to each tau, read there, and note the energy in the rods and of the bodies at the window's end. */
void follow(const double *tau, size_t count, const double *impedance, const double *mass, double *out, double *energy)
{
    static march state;
    start_march(&state);
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


def follow(kappa, evaluator):
    """The largest error and the largest change of energy of a march, both relative, now and then on its horizon."""
    model = lower(twisted(kappa, int(evaluator.tau_max)))
    windows = np.linspace(0, evaluator.tau_max, WINDOWS + 1).astype(int)[1:] - 1
    taus = calm([1, *windows.tolist()])  # the twist is over by then
    values, energy = run(model, evaluator, taus)
    exact = modal_sum(kappa, taus)
    sizes = np.max(np.abs(exact), axis=1, keepdims=True)
    return np.max(np.abs(values - exact) / sizes), np.max(np.abs(energy / energy[0] - 1))


def run(model, evaluator, taus):
    """Outputs (outputs, n) and energies."""
    plan = evaluator.plan
    made = sources(program(model, evaluator), "c")
    header = f"{model.name}.h"
    marching = library(made[f"{model.name}.c"] + FOLLOW, FAST, (header, made[header]))
    impedances = np.array([nearest(track.impedance) for track in plan.tracks])
    masses = np.array([nearest(weight) for joint in plan.joints for weight in joint.space.weights])
    out, energy = np.empty((len(taus), len(model.probes))), np.empty(len(taus))
    places = [ctypes.c_void_p(address(array)) for array in (taus, impedances, masses, out, energy)]
    marching.follow(places[0], ctypes.c_size_t(len(taus)), *places[1:])
    return out.T, energy


@pytest.mark.quick(1)
@pytest.mark.parametrize("kappa", [Fraction(1, 100), Fraction(3, 5), Fraction(5)])
def test_the_sum_of_modes_is_the_motion(kappa):
    taus = calm([1, 2, 30])
    exact = np.array(Reference(lower(twisted(kappa, 32))).values(taus.tolist()))
    np.testing.assert_allclose(modal_sum(kappa, taus), exact, rtol=0, atol=2e-13 * np.abs(exact).max())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kappa", "horizon", "most"),
    [(Fraction(3, 5), 300, 1e-13), (Fraction(1, 100), 10**5, 1e-12)],
)
def test_error_and_energy_stay_at_rounding(kappa, horizon, most):
    """A degree that is far too low is seen."""
    chosen = march(lower(twisted(kappa, horizon)))
    error, drift = follow(kappa, chosen)
    assert error <= chosen.error_bound
    assert max(error, drift) < most
    assert min(follow(kappa, replace(chosen, degree=12))) > 1e4 * max(error, drift)
