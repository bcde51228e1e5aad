"""Many sets of parameters at once, from Python: each is what the exact outputs of its own scene are."""

import copy
import pickle
from functools import cache

import numpy as np
import pytest

import wavesym
from tests.support.without_compiler import without_compiler
from wavesym.errors import WavesymError
from wavesym.running import sets
from wavesym.running.toolchain import CompilerError

SCENE = wavesym.Scene.from_toml("drive_equal").with_(
    {"output.until": 3, "output.tolerance": "1e-11", "load[1].times": ["3/2"]}
)
KAPPA = np.array([[0.5, 2, 0.25], [1, 1.0000001, 1], [1e-3, 1e-3, 1e-3], [100, 1e-3, 20]])


@pytest.fixture(scope="module", autouse=True)
def sooner():
    """Compiled sooner."""
    with pytest.MonkeyPatch.context() as machine:
        machine.setattr(sets, "FAST", ("-O1",))
        yield


@pytest.fixture(scope="module")
def model():
    return wavesym.model(SCENE, runtime=["kappa", "load"])


def scene(kappa):
    return SCENE.with_({"system.kappa": list(kappa)})


@cache
def exact():
    """Of each set of KAPPA its outputs, and their extremes."""
    scenes = [scene(kappa) for kappa in KAPPA]
    return [(wavesym.evaluator(each), wavesym.summary(each).outputs) for each in scenes]


@pytest.mark.quick(1)
@pytest.mark.parametrize("tau", [np.linspace(0, 3, 25), np.array([0.0, 0.3, 2.9, 1.5, 3.0])], ids=["even", "uneven"])
def test_each_set_is_its_scene(model, tau):
    true = np.array([response(tau) for response, _ in exact()])
    largest = np.max(np.abs(true), axis=2, keepdims=True)
    error = np.max(np.abs(model.values(kappa=KAPPA, tau=tau) - true) / largest, axis=(1, 2))
    estimate = model.check(kappa=KAPPA).estimate
    # the largest value of an output may lie between these instants, so the estimate is of something larger
    assert np.all(error <= np.maximum(2 * estimate, 1e-11))
    assert np.all(estimate < 1e-9)


@pytest.mark.slow
def test_errors_are_within_bounds(model):
    tau = np.linspace(0, 3, 25)
    bounds = model.bounds(kappa=[KAPPA[0], -KAPPA[0]])
    true = np.array(wavesym.evaluator(scene(KAPPA[0]))(tau))
    error = np.max(np.abs(model.values(kappa=KAPPA[:1], tau=tau)[0] - true), axis=1)
    # outputs may be larger between these instants
    assert np.all(error <= 2 * bounds[0] * np.max(np.abs(true), axis=1))
    assert np.all(bounds[0] < 1e-8)
    assert np.isnan(bounds[1]).all()


def test_extremes_are_those_of_the_exact_outputs(model):
    found = model.peaks(kappa=KAPPA)
    for (response, outputs), *rows in zip(exact(), found.min, found.tau_min, found.max, found.tau_max, strict=True):
        size = max(abs(extreme.value) for output in outputs for extreme in (output.min, output.max))
        for place, output in enumerate(outputs):
            least, tau_least, greatest, tau_greatest = (row[place] for row in rows)
            true = response([tau_least, tau_greatest])[place]  # other instants may do as well
            errors = [least - output.min.value, greatest - output.max.value, least - true[0], greatest - true[1]]
            assert np.max(np.abs(errors)) < 1e-11 * size


def test_derivatives_are_those_of_the_exact_outputs(model):
    tau, kappa, h = np.linspace(0, 3, 13), np.array([0.5, 2, 0.25]), 1e-5
    found = model.gradients(kappa=kappa, tau=tau)
    assert np.allclose(found.values, model.values(kappa=kappa, tau=tau), rtol=0, atol=1e-15)
    for place in range(3):
        step = h * np.eye(3)[place]
        both = [wavesym.evaluator(scene(kappa + side * step))(tau) for side in (1, -1)]
        # central differences: of the third derivative, of order 1 here, times h^2/6
        assert np.allclose(found.by["kappa"][0, place], (both[0] - both[1]) / (2 * h), rtol=0, atol=1e-9)
    assert [found.estimates[name].shape for name in ("kappa", "load")] == [(1, 3), (1, len(model.parameters["load"]))]
    assert np.max(found.estimates["kappa"]) < 1e-8
    # outputs are linear in loads
    sums = np.einsum("nlot,l->not", found.by["load"], model.parameters["load"])
    assert np.allclose(sums, found.values, rtol=0, atol=1e-13)


def test_extremes_are_not_those_of_samples_alone(model):
    full = model.peaks(kappa=KAPPA)
    samples = model.values(kappa=KAPPA, tau=np.linspace(0, 3, 1001))
    # those at jumps aside, no sample is beyond the extremes, and one is near
    assert np.all(samples.max(axis=2) <= full.max + 1e-12)
    assert np.all(samples.min(axis=2) >= full.min - 1e-12)
    assert 1e-9 < np.max(full.max - samples.max(axis=2)) < 1e-2


def test_what_is_not_given_is_the_scenes(model):
    tau = np.linspace(0, 3, 7)
    (own,) = model.values(tau)
    values = model.values(tau, load=[[1, 0.5], [2, 1]])
    assert np.allclose(values[0], own, rtol=0, atol=1e-15)
    assert np.allclose(values[1], 2 * own, rtol=1e-14)
    assert model.labels["kappa"] == ("kappa_1", "kappa_2", "kappa_3")


def test_a_refused_set_is_nan_and_no_other(model):
    kappa = [[1, 1, 1], [1, -1, 1], [1e5, 1, 1]]
    found = model.check(kappa=kappa)
    assert found.status.tolist() == [0, 1, 2]
    assert found.why[0] == ""
    assert "not finite" in found.why[1]
    assert "too light" in found.why[2]
    assert np.isnan(found.estimate).tolist() == [False, True, True]
    values = model.values(kappa=kappa, tau=[[0.0, 1.0, 7.0]])
    assert values.shape == (3, 3, 1, 3)
    assert np.isnan(values[1:]).all()
    assert np.isnan(values[0]).any(axis=(0, 1)).tolist() == [False, False, True]
    assert np.isnan(model.peaks(kappa=kappa).max).all(axis=1).tolist() == [False, True, True]
    slopes = model.gradients(kappa=kappa, tau=[1.0])
    assert np.isnan(slopes.estimates["kappa"]).all(axis=1).tolist() == [False, True, True]
    assert np.isnan(slopes.by["load"]).all(axis=(1, 2, 3)).tolist() == [
        False,
        True,
        True,
    ]


def test_no_set_and_no_instant_are_empty(model):
    assert model.values(kappa=np.empty((0, 3)), tau=[1.0]).shape == (0, 3, 1)
    assert model.values(tau=[]).shape == (1, 3, 0)
    assert model.values(tau=2.0).shape == (1, 3)
    assert model.peaks(kappa=np.empty((0, 3))).min.shape == (0, 3)
    assert model.gradients([1.0], kappa=np.empty((0, 3))).by["kappa"].shape == (0, 3, 3, 1)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"inertia": [1, 1, 1, 1]}, "inertia: not a parameter of this model; write kappa or load"),
        ({"kappa": [1, 2]}, r"kappa: an array of shape \(2,\); write one of shape \(sets, 3\)"),
        ({"kappa": 1}, r"kappa: an array of shape \(\); write one of shape \(sets, 3\)"),
        ({"kappa": ["a", "b", "c"]}, "kappa: not numbers; write an array of them"),
        ({"kappa": [1, 1j, 1]}, "kappa: not numbers; write an array of them"),
        ({"kappa": [[1, 1, 1]] * 2, "load": [[1, 1]] * 3}, "2 and 3 sets; write as many of each parameter"),
    ],
)
def test_other_arrays_are_refused(model, parameters, message):
    with pytest.raises(WavesymError, match=message) as error:
        model.values([0.0], **parameters)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("way", [copy.deepcopy, pickle.dumps])
def test_a_model_says_that_other_processes_make_their_own(model, way):
    with pytest.raises(TypeError, match=r"wavesym\.model\(scene, runtime\) makes one"):
        way(model)


def test_without_a_compiler_there_is_no_model():
    with without_compiler(), pytest.raises(CompilerError, match="pip install ziglang") as error:
        wavesym.model(SCENE, runtime=["kappa"])
    assert "the extra compiler of wavesym" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.slow
def test_velocities_of_a_scene_that_does_not_move_may_come_later():
    scene = wavesym.Scene.from_toml("collision_m4").with_({"output.until": 4})
    still = wavesym.model(scene.with_({"system.velocity": [1, 1]}), runtime=["velocity"])
    checks = still.check(velocity=[[1, -0.5], [1, 1]])
    assert checks.status.tolist() == [0, 0]
    tau = np.linspace(0, 4, 9)
    true = wavesym.evaluator(scene.with_({"system.velocity": [1, "-1/2"]}))(tau)
    assert np.max(np.abs(still.run(tau, velocity=[1, -0.5])[0] - true)) < 1e-9 * np.max(np.abs(true))
    slopes = still.gradients(tau, velocity=[1, 1]).by["velocity"][0]
    assert np.max(np.abs(slopes[0] - slopes[1] / 2 - true)) < 1e-9 * np.max(np.abs(true))


@pytest.mark.parametrize("ramps", [(0, 0), ("1/2", 0)])
def test_ramps_that_the_scene_has_as_0_are_given_at_run_time(ramps):
    """A drive whose ramps are all 0 took those of a set for none, under a bound of 1e-11."""
    load = {"body": 1, "times": [0, 2], "steps": [1, 0], "ramps": list(ramps)}
    drive = {"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 2]}
    scene = wavesym.Scene(name="ramped", system=drive, load=[load], output={"until": 5, "strain": ["1/2"]})
    given = {"load[0].steps": [1, "-1/2"], "load[0].ramps": ["3/4", 1]}
    tau = np.linspace(0, 5, 31)
    found = wavesym.model(scene, ["load"]).values(load=[1, -0.5, 0.75, 1], tau=tau)
    np.testing.assert_allclose(found.squeeze(), wavesym.evaluator(scene.with_(given))(tau)[0], atol=1e-9)


@pytest.mark.parametrize("load", [{"a": [1, 0]}, {"a": [1, 0], "b": [0, 0]}, {"a": [0, 0]}, {"a": [0, 1], "b": [0, 0]}])
def test_a_scene_with_numbers_of_loads_that_are_0_is_served(load):
    """Degrees were enough for it with 1 in the place of each."""
    building = {"type": "building", "m": 1, "kappa": [1, 1], "base": "force"}
    scene = wavesym.Scene(
        name="resting", system=building, load=[{"times": [0, 2], **load}], output={"until": 5, "strain": ["1/2"]}
    )
    checked = wavesym.model(scene, ["load"]).check()
    assert checked.status.tolist() == [0]
    assert checked.estimate[0] < 1e-10
