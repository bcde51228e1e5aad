"""Many sets of parameters at once, from Python."""

import numpy as np
import pytest

import wavesym
from wavesym.compiler import runtime_model
from wavesym.errors import WavesymError

SCENE = wavesym.Scene.from_toml("drive_equal").with_({"output.until": 6, "output.tolerance": "1e-11"})


@pytest.fixture(scope="module")
def model():
    return runtime_model(SCENE, ["kappa", "load"])


def test_each_set_is_its_scene(model):
    kappa = np.array([[1, 1, 1], [0.5, 2, 0.25], [3, 0.125, 3]])
    even, uneven = np.linspace(0, 6, 25), np.array([0.0, 0.3, 5.9, 3.0])
    for tau in (even, uneven):
        values, status, estimate = model.run(tau, kappa=kappa)
        assert values.shape == (3, 3, len(tau))
        assert list(status) == [0, 0, 0]
        for found, numbers, error in zip(values, kappa, estimate, strict=True):
            true = wavesym.evaluator(SCENE.with_({"system.kappa": numbers.tolist()}))(tau)
            largest = np.max(np.abs(true), axis=1, keepdims=True)
            assert np.all(np.abs(found - true) <= max(error, 1e-11) * largest)


def test_what_is_not_given_is_the_scenes(model):
    tau = np.linspace(0, 6, 7)
    (own,), _, _ = model.run(tau)
    values, _, _ = model.run(tau, load=[[1, 0.5], [2, 1]])
    assert np.array_equal(values[0], own)
    assert np.allclose(values[1], 2 * own, rtol=1e-14)


def test_a_refused_set_is_nan_and_no_other(model):
    values, status, estimate = model.run([0.0, 1.0, 7.0], kappa=[[1, 1, 1], [1, -1, 1], [1e5, 1, 1]])
    assert list(status) == [0, 1, 2]
    assert np.isnan(values[1:]).all()
    assert np.isnan(estimate[1:]).all()
    assert np.isnan(values[0]).any(axis=0).tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"inertia": [1, 1, 1, 1]}, "inertia given, kappa or load expected"),
        ({"kappa": [1, 2]}, r"kappa: an array of shape \(2,\) given, \(sets, 3\) expected"),
        ({"kappa": [[1, 1, 1]] * 2, "load": [[1, 1]] * 3}, "2 and 3 sets given"),
    ],
)
def test_other_arrays_are_refused(model, parameters, message):
    with pytest.raises(WavesymError, match=message):
        model.run([0.0], **parameters)
