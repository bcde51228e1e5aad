"""Parameters far from all others: what is not there is not claimed, and what overflows is refused by all builds."""

from fractions import Fraction

import numpy as np
import pytest

import wavesym
from tests.support.built_model import BuiltModel
from tests.targets.test_runtime_batch import Batch

STOREYS = wavesym.Scene(
    name="storeys",
    system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
    load=[{"times": [0, "5/2"], "a": [1, 0], "b": [0, "-1/3"]}],
    output={
        "until": 20,
        "tolerance": "1e-12",
        "strain": ["1/2", "1+"],
        "velocity": ["1/2", "3/2"],
        "displacement": [2],
    },
)
GEARS = wavesym.Scene(
    name="gears",
    system={"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    load=[{"body": 1, "times": [0, 3], "steps": [1, "-1/2"]}, {"body": 3, "times": ["1/3"], "steps": [2]}],
    output={"until": 20, "tolerance": "1e-10", "strain": ["1/2", "1+"], "velocity": [2], "displacement": [0, "4/3"]},
)
LOAD = [1, 0, 0, -1 / 3]
HEAVY = [1e-9, 1e-12, 1e-14, 1e-18, 1e-30]
"""kappa of the topmost floor: its displacement is as small, a difference of waves of 1."""


def missed_at_the_top(kappa, tau, found):
    """Relative to its largest value, by the exact outputs."""
    true = wavesym.evaluator(STOREYS.with_({"system.kappa": ["1/4", "3/5", str(kappa)]}))(tau)[4]
    assert np.max(np.abs(true)) > 0
    return np.max(np.abs(found[4] - true)) / np.max(np.abs(true))


def wrongly_claimed(made, kappas):
    """Of which of these the estimate is less than the error."""
    tau, claimed = np.linspace(0, 20, 101), []
    for kappa in kappas:
        assert made.build(0.25, 0.6, kappa, *LOAD) == 0
        status, found = made.sample(0.0, 0.2, 101)
        assert status == 0
        claimed.append(not missed_at_the_top(kappa, tau, found) <= made.estimate)
    return claimed


@pytest.mark.slow
def test_an_output_that_cancels_is_not_claimed(tmp_path):
    made = BuiltModel(STOREYS, ["kappa", "load"], tmp_path)
    assert not any(wrongly_claimed(made, HEAVY))
    assert made.build(0.25, 0.6, 1e-12, *LOAD) == 0
    assert made.estimate < 0.01
    assert made.build(0.25, 0.6, 1e-30, *LOAD) == 0
    assert made.estimate == np.inf


@pytest.mark.slow
def test_it_would_be_without_the_light_cone(tmp_path):
    old = "(largest > 0 || reached(law, slope, lane, output))"
    made = BuiltModel(STOREYS, ["kappa", "load"], tmp_path, [(old, "largest > 0 && reached(law, slope, lane, output)")])
    assert wrongly_claimed(made, HEAVY)[-1]


@pytest.mark.slow
def test_what_no_wave_has_reached_is_exactly_nothing(tmp_path):
    """Without loads, and before the first wave comes."""
    made = BuiltModel(STOREYS, ["kappa", "load"], tmp_path)
    assert made.build(0.25, 0.6, 0.2, 0, 0, 0, 0) == 0
    assert made.estimate == 0
    (tmp_path / "late").mkdir()
    late = GEARS.with_({"output.until": "5/3", "output.velocity": [0], "output.displacement": [2], "output.strain": []})
    made = BuiltModel(late, ["kappa", "inertia", "load"], tmp_path / "late")
    for first, last, silent in ((1, 0, 1), (0, 2, 0)):
        assert made.build(1, 0.5, 1, 2, 1, first, -0.5 * first, last) == 0
        _, found = made.sample(0.0, 1 / 60, 101)
        assert not found[silent].any()
        assert found[1 - silent].any()
        assert made.estimate < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["double", "single"])
def test_a_batch_and_single_precision_say_the_same(precision, tmp_path):
    made = Batch(STOREYS, ["kappa", "load"], tmp_path, precision=precision)
    status, estimate, out = made([[0.25, 0.6, kappa, *LOAD] for kappa in HEAVY])
    assert not status.any()
    tau = np.arange(97) * (20 / 97)
    for which in range(2):
        for kappa, said, found in zip(HEAVY, estimate[which], out[which], strict=True):
            assert missed_at_the_top(kappa, tau, found) <= said


@pytest.mark.slow
def test_python_says_the_same():
    model = wavesym.model(STOREYS, runtime=["kappa"])
    check = model.check(kappa=[[0.25, 0.6, kappa] for kappa in (0.2, *HEAVY)])
    assert not check.status.any()
    assert check.estimate[0] < 1e-11
    assert check.estimate[2] < 0.01
    assert check.estimate[-1] == np.inf


BEYOND = {
    "gears": (GEARS, ["kappa", "inertia", "load"], [[1, 2.2e-308, 1, 2, 3.8e22, 1, 1e-38, 2]]),
    "storeys": (
        STOREYS,
        ["kappa", "load"],
        [[235.6, 0.6, 0.2, 1, 0.605, 1.7e308, 4.94], [169, 12.3, 4.9e-324, -1.7e308, 1.1, 0.14, 1e150]],
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", BEYOND)
def test_what_overflows_is_refused_by_every_build(case, tmp_path):
    scene, runtime, sets = BEYOND[case]
    made = BuiltModel(scene, runtime, tmp_path)
    for given in sets:
        assert made.build(*given) == 1
        assert np.isnan(made.estimate)
        status, bound = made.bound(*given)
        assert status == 1
        assert np.isnan(bound).all()
        assert made.tangents(given, 0.0, 0.2, 101)[0] == 1


@pytest.mark.slow
def test_status_0_is_finite_and_a_refusal_has_no_estimate(tmp_path):
    """Numbers from anywhere: what `build` takes is finite, derivatives too, and NaN is what it refuses."""
    made = BuiltModel(GEARS, ["kappa", "inertia", "load"], tmp_path)
    draw, counts = np.random.default_rng(14), [0, 0, 0]
    light = [37.25, 0.5, 4.94e-324, 0.2137, 1e16, 1, 0.00284, 3.4e-6]
    for given in (
        light,
        *(10.0 ** draw.uniform(-300, 300, 8) for _ in range(100)),
        *10.0 ** draw.uniform(-4, 2, (20, 8)),
    ):
        status = made.build(*given)
        estimate, (_, found) = made.estimate, made.sample(0.0, 0.2, 101)
        counts[status] += 1
        assert np.isnan(estimate) if status else estimate >= 0
        assert np.isnan(found).all() if status else np.isfinite(found).all()
        assert made.bound(*given)[0] == status
        told, lanes = made.tangents(given, 0.0, 0.2, 101)
        assert told or np.isfinite(lanes).all()
    assert min(counts[:2]) > 5


LIGHT = wavesym.Scene(
    name="light",
    system={"type": "drive", "m": 6, "kappa": [1] * 6, "inertia": [1] * 7},
    load=[{"body": 1, "times": [0], "steps": [1]}],
    output={"until": 10, "tolerance": "1e-12", "strain": ["1/2"], "velocity": [0, 6]},
)


def beyond_estimates(made, kappas):
    """Errors over estimates, of equal shafts."""
    tau = np.linspace(0, 10, 1001)
    for kappa in kappas:
        assert made.build(*[kappa] * 6) == 0
        found = made.sample(0.0, 0.01, 1001)[1]
        true = wavesym.evaluator(LIGHT.with_({"system.kappa": [Fraction(kappa)] * 6, "output.tolerance": "1e-14"}))(tau)
        errors = np.max(np.abs(found - true), axis=1) / np.max(np.abs(true), axis=1)
        yield float(np.max(errors) / made.estimate)


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes", [[], [("unit * (real)(degree * degree) / 16", "0 * unit * (real)degree")]], ids=["right", "blind"]
)
def test_rounding_of_high_degrees_is_in_the_estimate(changes, tmp_path):
    kappas = [41.653907084189861, 64.66177062800014, 90.06388912129225, 90.676416664731789]  # unlucky ones
    beyond = max(beyond_estimates(BuiltModel(LIGHT, ["kappa"], tmp_path, changes), kappas))
    assert beyond > 1 if changes else beyond < 1
