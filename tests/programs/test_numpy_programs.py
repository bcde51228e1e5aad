"""Generated NumPy: every tau of the horizon has its value, its end too, in whatever order and shape they come."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import wavesym
from tests.support.generated import files
from tests.support.truth import Truth
from wavesym.programs.choice import choose
from wavesym.running.compilation import import_text
from wavesym.scene import lower

EVALUATORS = ["closed", "pieces"]
PRECISIONS = ["double", "single"]


def drive(until, tolerance):
    """Two outputs at places that waves reach at different times."""
    return wavesym.Scene(
        name="drive",
        system={"type": "drive", "m": 1, "kappa": ["1/5"], "inertia": [1, 2]},
        load=[{"body": 1, "times": [0], "steps": [1]}],
        output={"until": until, "tolerance": tolerance, "strain": ["1/2", "1/5"]},
    )


@pytest.mark.parametrize("until", ["3.2", "1.7", "2.1", "9.1"])
@pytest.mark.parametrize("evaluator", EVALUATORS)
def test_the_last_single_of_the_horizon_has_a_value(until, evaluator):
    """Which is not the double of the same digits."""
    module = import_text(files(lower(drive(until, "1/2")), "numpy", evaluator, "single")["drive.py"], "made")
    assert module.TAU_MAX == float(np.float32(module.TAU_MAX)) != float(until)
    for tau in (
        module.TAU_MAX,
        [module.TAU_MAX],
        np.float32(module.TAU_MAX),
        np.array([0, module.TAU_MAX], np.float32),
    ):
        assert np.isfinite(module.evaluate(tau)).all()
    for count in (2, 7, 100):
        assert np.isfinite(module.evaluate(np.linspace(0, module.TAU_MAX, count))).all()
    after = np.nextafter(np.float32(module.TAU_MAX), np.float32(np.inf))
    assert np.isnan(module.evaluate(after)).all()


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("evaluator", EVALUATORS)
def test_values_do_not_depend_on_order_or_shape(evaluator, precision):
    """Sorted or not, alone or together, evenly or nearly all of them on one piece: each is within the bound."""
    scene = drive(6, "1e-9" if precision == "double" else "1e-2")
    form = choose(lower(scene), evaluator, precision).evaluator
    module = import_text(files(lower(scene), "numpy", evaluator, precision)["drive.py"], "made")
    kind = np.float64 if precision == "double" else np.float32
    truth = Truth(scene, Fraction(6))
    random = np.random.default_rng(3)
    edges = np.array([0.0, 0.2, 0.5, 1.0, 1.5, 2.0, 5.5, 6.0])
    even = random.uniform(0, 6, 40)
    crowd = np.concatenate([random.uniform(2.3, 2.4, 300), edges])
    allowed = [float(truth.largest(k, Fraction(6))[1]) * output.bound for k, output in enumerate(form.outputs)]
    for taus in (np.sort(even), even, crowd, np.sort(crowd), edges, edges[::-1], edges[3:1:-1], edges[3:4]):
        taus = taus.astype(kind)
        found = module.evaluate(taus)
        assert found.shape == (2, taus.size)
        assert found.dtype == kind
        for k in (0, 1):
            for tau, value in list(zip(taus.tolist(), found[k].tolist(), strict=True))[-40:]:
                assert abs(float(truth.value(k, Fraction(tau))) - value) <= allowed[k] * (1 + 1e-9)
    assert module.evaluate(1.0).shape == (2,)
    assert module.evaluate([]).shape == (2, 0)
    square = module.evaluate(even.reshape(5, 8))
    np.testing.assert_array_equal(square.reshape(2, 40), module.evaluate(even))


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("evaluator", EVALUATORS)
def test_only_what_is_out_of_range_is_no_number(evaluator, precision):
    module = import_text(files(lower(drive(6, "1e-2")), "numpy", evaluator, precision)["drive.py"], "made")
    taus = np.array([3, -1, 0, 7, 6, np.nan, -0.0, 2, -1e-30, np.inf, 5])
    found = module.evaluate(taus)
    np.testing.assert_array_equal(np.isnan(found), [[not 0 <= tau <= 6 for tau in taus]] * 2)
    assert np.isnan(module.evaluate([7.0, 8.0])).all()
    assert np.isnan(module.evaluate([-1.0])).all()
