"""Sums of squares from coefficients: those of values at the data, one by one."""

import numpy as np
import pytest

import wavesym
from wavesym.errors import WavesymError

SCENE = wavesym.Scene.from_toml("drive_equal").with_(
    {"output.until": 4, "output.tolerance": "1e-11", "load[1].times": ["3/2"]}
)
KAPPA = np.array([[1, 1, 1], [0.5, 2, 0.25], [100, 1e-3, 20], *np.linspace([0.2, 0.3, 0.4], [3, 2, 1], 16)])
RANDOM = np.random.default_rng(14)
TAUS = {
    "even": np.linspace(0, 4, 101),
    "none": np.empty(0),
    "few": np.array([4.0, 0.25, 2.999]),
    "at one instant": np.full(30, 2.5),
    "crowded": 1.3 + np.concatenate([1e-9 * np.arange(12), [1e-3, 0.1, 0.15, -0.2]]),
    "any": RANDOM.uniform(0, 4, 300),
}


@pytest.fixture(scope="module")
def model():
    return wavesym.model(SCENE, runtime=["kappa", "load"])  # that of test_model.py, compiled once


@pytest.mark.quick(1)
@pytest.mark.parametrize("where", TAUS)
def test_sums_of_squares_are_those_of_values(model, where):
    tau = TAUS[where]
    data = RANDOM.normal(size=(len(model.outputs), len(tau)))
    data[:, RANDOM.random(len(tau)) < 0.2] = np.nan
    found = model.misfit(tau, data)(kappa=KAPPA)
    expected = np.nansum((model.values(kappa=KAPPA, tau=tau) - data) ** 2, axis=(1, 2))
    assert found == pytest.approx(expected, rel=1e-11, abs=0)


def test_data_that_fit_are_missed_by_nothing(model):
    tau = TAUS["even"]
    (data,) = model.values(kappa=KAPPA[1], tau=tau)
    found = model.misfit(tau, data)(kappa=KAPPA)
    assert found[1] < 1e-24 * np.sum(data**2)
    assert np.all(np.delete(found, 1) > 1e-3 * np.sum(data**2))


def test_a_refused_set_is_nan_and_no_other(model):
    tau = TAUS["any"]
    misfit = model.misfit(tau, np.zeros((len(model.outputs), len(tau))))
    kappa = KAPPA.copy()
    alone = misfit(kappa=kappa)
    kappa[[3, 12]], kappa[5] = -1, 1e9
    assert list(model.check(kappa=kappa).status[[3, 5, 12]]) == [1, 2, 1]
    assert np.flatnonzero(np.isnan(misfit(kappa=kappa))).tolist() == [3, 5, 12]
    others = np.delete(np.arange(len(kappa)), [3, 5, 12])
    assert misfit(kappa=kappa)[others] == pytest.approx(alone[others], rel=1e-11)


def test_extreme_neighbours_refuse_nobody(model):
    # the degree of a vector of sets is that of the one that needs most, too high for numbers powers of ten apart
    kappa = np.ones((8, 3))
    kappa[1:3] = [719.7478728848876, 2.1606981724817378e-4, 2.1349976718954e-4], [0.0014492, 629.033, 0.0011016]
    kappa[7] = 8.470871815094311e-05, 391.86809543607063, 0.8303045540449441
    tau = np.linspace(0, 4, 11)
    found = model.misfit(tau, np.zeros((len(model.outputs), 11)))(kappa=kappa)
    assert list(model.check(kappa=kappa).status) == [0, 2, 2, 0, 0, 0, 0, 0]
    assert found == pytest.approx(np.sum(model.values(kappa=kappa, tau=tau) ** 2, axis=(1, 2)), rel=1e-10, nan_ok=True)


def test_other_data_are_refused(model):
    with pytest.raises(WavesymError, match=r"data: an array of shape \(2,\); write one of shape \(\d, 2\)"):
        model.misfit([0, 1], [1, 2])
    with pytest.raises(WavesymError, match="data: an infinite number; write finite ones, and NaN where there is none"):
        model.misfit([1.0], np.full((len(model.outputs), 1), np.inf))
    with pytest.raises(WavesymError, match="tau: beyond the data; where there are data write 0 to 4"):
        model.misfit([7.0], np.zeros((len(model.outputs), 1)))
