"""The door: results that show themselves, in the scene's own units, right as `run` is."""

from __future__ import annotations

import io
import warnings
from pathlib import Path

import numpy as np
import pandas
import pytest

import wavesym
from wavesym import Scene, api
from wavesym.results.rows import SAMPLES

DRIVE = Scene.from_toml("drive_m1")
FRAME = Scene(
    name="frame",
    units={"time": "ms", "length": "mm"},
    load=[{"spacing": "0.5 s", "samples": [0, 0.3, -0.3, 0.1, 0], "unit": "g"}],
    output={"until": "4 s", "tolerance": 1e-6, "drift": [1]},
    system={
        "type": "building",
        "base": "ground",
        "damping": 0.05,
        "storey": [
            {
                "count": 3,
                "height": "3.5 m",
                "stiffness": "277 MN/m",
                "column_mass": "11 t",
                "floor_mass": "350 t",
            }
        ],
    },
)


def test_a_scene_says_what_it_is_in_a_line() -> None:
    assert repr(FRAME) == str(FRAME) == "Scene('frame', building, 3 storeys, load of 5 samples, until 4000 ms)"
    assert repr(DRIVE) == "Scene('drive_m1', drive, 1 shaft, 2 loads, until tau = 10)"
    assert "img" in DRIVE._repr_html_()
    assert "drive_m1" in DRIVE._repr_html_()


@pytest.mark.parametrize("scene", [DRIVE, FRAME], ids=["tau", "units"])
def test_a_result_is_what_run_prints(scene: Scene) -> None:
    found = scene.run(samples=9)
    printed = pandas.read_csv(io.StringIO("".join(api.run_csv(scene, 9))), float_precision="round_trip")
    assert list(printed.columns[1:]) == list(found.columns)
    assert np.array_equal(printed.to_numpy().T, np.vstack([found.time, found.values]))
    assert found.time_unit == ("ms" if scene is FRAME else None)
    assert np.array_equal(found[found.outputs[0]], found.values[0])
    assert list(found) == list(found.outputs)
    assert len(found) == len(found.outputs)
    with pytest.raises(KeyError, match="no output of"):
        found["strain@17"]


def test_a_result_is_a_table_with_names_and_units() -> None:
    found = wavesym.run(FRAME, times=[0, 500, 530.47])
    frame, array = found.to_pandas(), found.to_xarray()
    assert frame.index.name == "time [ms]"
    assert frame["drift@1 [mm]"].iloc[2] == found["drift@1"][2] == array.sel(output="drift@1").values[2]
    assert array["unit"].values.tolist() == ["mm"]
    assert array.attrs["bound"] == found.bound < 1e-6
    assert repr(found).startswith("Result('frame', 1 output at 3 instants from 0 to 530.47 ms, modes, ")
    assert found._repr_html_().count("<tr>") == 4
    assert DRIVE.run()._repr_html_().count("<tr>") == 12
    assert DRIVE.run().time.size == SAMPLES


def test_what_is_outside_the_horizon_warns_once_or_is_an_error() -> None:
    with pytest.warns(UserWarning, match="1 of 2 tau are outside 0 to 10") as caught:
        assert np.isnan(DRIVE.run([5, 11])["strain@0"]).tolist() == [False, True]
    assert len(caught) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(wavesym.WavesymError, match="outside 0 to 10"):
            DRIVE.run([5, 11], strict=True)
    for wrong in ("soon", [[1, 2]], [1j]):
        with pytest.raises(wavesym.WavesymError, match="not a list of numbers"):
            DRIVE.run(wrong)
    with pytest.raises(wavesym.WavesymError, match="samples: 0 is not positive"):
        DRIVE.run(samples=0)


def test_a_summary_is_found_by_name() -> None:
    found = FRAME.summary()
    assert found["drift@1"] is found.outputs[0]
    assert found.to_pandas().loc["drift@1", "max"] == found["drift@1"].max.value
    assert repr(found).startswith("Summary('frame', 1 output, modes at ")
    assert "<td>mm</td>" in found._repr_html_()
    with pytest.raises(KeyError, match="drift@1"):
        found["drift@2"]


def test_a_plot_is_a_figure_and_a_file(tmp_path: Path) -> None:
    figure = DRIVE.plot(tmp_path / "drive.svg")
    assert (tmp_path / "drive.svg").stat().st_size > 1000
    assert figure.axes
    assert DRIVE.run(samples=3).plot().axes
    with pytest.raises(wavesym.WavesymError, match=r"^kind: map3 is unknown; write history, xt, envelope or map"):
        DRIVE.plot(kind="map3")
    with pytest.raises(wavesym.SceneError, match="not a picture"):
        wavesym.plot(DRIVE, tmp_path / "drive.txt")


def test_a_derivation_takes_the_name_of_a_scene():
    """It takes that of a system, and any other name was an error of Python's."""
    assert wavesym.derive("drive_m1") == wavesym.derive(wavesym.Scene.from_toml("drive_m1"))
    with pytest.raises(wavesym.WavesymError, match="No such file"):
        wavesym.derive("nothing")
