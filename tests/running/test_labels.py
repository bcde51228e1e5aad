"""Values of many sets carry the names of outputs, the times, and the numbers that vary."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import wavesym
from wavesym.errors import WavesymError
from wavesym.running import sets
from wavesym.running.model import RuntimeModel

xarray = pytest.importorskip("xarray")

BAR = """name = "bar"
units = { time = "ms" }
[system]
type = "chain"
parts = [{ mass = "1 kg", name = "hammer" }, { rod = "1 m", E = "210 GPa", rho = "7850 kg/m^3", A = "8 cm^2" }, "fixed"]
[[load]]
at = "hammer"
times = ["0 s"]
steps = ["1 kN"]
[output]
until = "1 ms"
velocity = ["hammer"]
"""


@pytest.fixture(scope="module", autouse=True)
def sooner() -> Iterator[None]:
    """Compiled sooner."""
    with pytest.MonkeyPatch.context() as machine:
        machine.setattr(sets, "FAST", ("-O1",))
        yield


@pytest.fixture(scope="module")
def model() -> RuntimeModel:
    return wavesym.model(wavesym.Scene.from_toml("drive_m1"), runtime=["kappa", "inertia"])


def test_one_number_that_varies_is_the_first_dimension(model: RuntimeModel) -> None:
    """A field of one number takes a number for each set."""
    found = model.run([0.5, 2.0], kappa=[0.5, 1, 2])
    assert found.dims == ("kappa", "output", "time")
    assert found["kappa"].attrs["long_name"] == "kappa_1"
    values = model.values([0.5, 2.0], kappa=[[0.5], [1], [2]])
    np.testing.assert_array_equal(found.values, values)
    assert (
        found.sel({"kappa": 2, "output": "strain@0", "time": 0.5}).item()
        == values[2, model.outputs.index("strain@0"), 0]
    )


def test_more_that_vary_are_coordinates_of_the_sets(model: RuntimeModel) -> None:
    """What is the same in all sets is none."""
    found = model.run(1.0, inertia=[[1, 2], [1, 3]], kappa=[[0.5], [2]])
    assert found.dims == ("set", "output")
    assert found["inertia[1]"].values.tolist() == [2, 3]
    assert found["kappa"].dims == ("set",)
    assert "inertia[0]" not in found.coords
    own = model.run([[1.0], [2.0]])
    assert own.dims == ("set", "output", "time_0", "time_1")
    assert own.shape == (1, len(model.outputs), 2, 1)


@pytest.mark.slow
def test_times_are_those_of_results(tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("bar") / "bar.toml"
    path.write_text(BAR)
    scene = wavesym.Scene.from_toml(path)
    model = wavesym.model(scene, runtime=["load"])
    times = [0.1, 0.5, 1.0]
    found = model.run(times=times, load=[1, 2])
    assert found["time"].values.tolist() == times
    assert (found["time"].attrs["units"], model.time_unit) == ("ms", "ms")
    assert found.dims[0] == "load"
    assert found["load"].attrs["units"] == "N"
    true = scene.run(times).values
    np.testing.assert_allclose(found.values[0], true / 1000, rtol=1e-8)
    by_tau = model.run(found["tau"].values)
    np.testing.assert_allclose(by_tau["time"].values, times, rtol=1e-15)
    assert not np.isnan(found.values).any()  # the last time is the horizon


def test_either_times_or_tau_or_neither(model: RuntimeModel) -> None:
    with pytest.raises(WavesymError, match="times: write either times or tau"):
        model.run(tau=[1.0], times=[1.0])
    tau = np.linspace(0, model.tau_max, 1001)
    np.testing.assert_array_equal(model.run().values, model.run(tau=tau).values)


def test_without_xarray_it_is_an_array(model: RuntimeModel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wavesym.running.labels.find_spec", lambda _: None)
    found = model.run([1.0], kappa=[1, 2])
    assert type(found) is np.ndarray
    assert found.shape == (2, len(model.outputs), 1)


def test_extremes_are_labelled_and_show_themselves_in_a_line(model: RuntimeModel) -> None:
    found = model.peaks(kappa=[0.5, 1, 2])
    assert repr(found) == f"SetPeaks(3 sets of {len(model.outputs)} outputs: min, max, tau_min, tau_max)"
    labelled = found.to_xarray()
    assert labelled["max"].dims == ("kappa", "output")
    for name in ("min", "max", "tau_min", "tau_max"):
        np.testing.assert_array_equal(labelled[name], getattr(found, name))
    assert labelled["max"].sel(kappa=2, output="strain@0") == found.max[2, model.outputs.index("strain@0")]


def test_a_model_shows_what_it_is_of(model: RuntimeModel) -> None:
    assert repr(model) == "RuntimeModel('drive_m1', 1 of kappa, 2 of inertia, 5 outputs, until tau = 10)"
