"""Derivatives by parameters in C: those of exact values, and a mistake in them is seen."""

from fractions import Fraction

import numpy as np
import pytest

import wavesym
from tests.support.built_model import BuiltModel
from tests.support.patience import first_always
from tests.targets.test_runtime_c import CASES, DRIVE, flat, scene_with


def steepness(made, scene, given, count=41):
    """The largest error of any derivative relative to its largest value; the truth from differences of exact values."""
    step = made.until / (count - 1)
    names, own = list(given), flat(given)
    status, found = made.tangents(own, 0.0, step, count)
    assert status == 0
    assert np.all(np.isfinite(found))
    assert made.build(*own) == 0
    assert np.array_equal(found[0], made.sample(0.0, step, count)[1])
    tau = np.array([k * step for k in range(count)])
    worst = 0.0
    lane = 0
    for name in names:
        for k, value in enumerate(map(Fraction, given[name])):
            lane += 1
            small = Fraction(1) if name in ("load", "velocity") else value / 10**5
            values = []
            for other in (value + small, value - small):
                changed = [*given[name][:k], other, *given[name][k + 1 :]]
                values.append(wavesym.evaluator(scene_with(scene, given | {name: changed}))(tau))
            true = (values[0] - values[1]) / float(2 * small)
            largest = np.max(np.abs(true), axis=1)
            assert np.all(np.abs(found[lane][largest == 0]) <= 1e-12)
            errors = np.max(np.abs(found[lane] - true), axis=1)
            worst = max(worst, float(np.max(errors[largest > 0] / largest[largest > 0], initial=0.0)))
    return worst


TANGENTS = {
    "building": {"kappa": ["1/4", "3/5", "1/5"], "load": [1, 0, "-1/2", "-1/4", "1/2", 0]},
    "drive": {"kappa": [1, "1/2"], "inertia": [1, 2, 1], "load": [1, -1, "1/3"]},
    "collision": {"kappa": [1, 2], "velocity": [1, -1]},
}


@pytest.mark.parametrize("case", first_always(TANGENTS))
def test_derivatives_are_those_of_exact_values(case, tmp_path):
    # velocities that part are no scene, so those here stay in between
    given = TANGENTS[case] | ({"velocity": [2, -2]} if case == "collision" else {})
    made = BuiltModel(CASES[case][0], list(given), tmp_path)
    # differences leave 1e-10 of second order, and about 1e-16/1e-5 of rounding
    assert steepness(made, CASES[case][0], given) < 1e-8


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        ("p[k] += share_of_rate", "p[k] += 0.999 * share_of_rate"),
        ("slope->alpha[node] * a[k]", "0.999 * slope->alpha[node] * a[k]"),
        ("listen(m, m->waves, slope.gain", "listen(m, m->waves, law.gain"),
    ],
)
def test_a_mistake_in_derivatives_is_seen(change, tmp_path):
    given = {"kappa": [1, "1/2"]}
    made = BuiltModel(DRIVE, ["kappa"], tmp_path, [change])
    assert steepness(made, DRIVE, given) > 1e-6
