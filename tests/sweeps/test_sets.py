"""Permanent sets of links as a statistic of sweeps: those of summaries, over the dimension `link`."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("zarr", reason="the extra `sweep` is not installed")
pytest.importorskip("xarray", reason="the extra `sweep` is not installed")

import wavesym
from wavesym import api
from wavesym.errors import SceneError
from wavesym.scene import Scene
from wavesym.sweeps.table import write_table

PARTS: list[Any] = [
    {"mass": "1 t", "velocity": "2 m/s", "name": "ram"},
    {"rod": "5 m", "E": "200 GPa", "A": "0.01 m^2", "rho": "8000 kg/m^3"},
    {"joint": True, "spring": "50 MN/m", "yield": "100 kN", "name": "toe"},
]
SCENE: dict[str, Any] = {
    "name": "pile",
    "units": {"length": "mm"},
    "system": {"type": "chain", "parts": PARTS},
    "output": {"until": "10 ms", "tolerance": "1e-6", "displacement": ["toe"]},
}
VELOCITIES = ["1 m/s", "3 m/s"]
VARIED = "system.parts[0].velocity"
TOE = "spring at 5000 mm (toe)"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("sets") / "made"
    sweep = {"scene": SCENE, "vary": {VARIED: VELOCITIES}, "keep": {"summary": ["max", "set"]}}
    assert api.run_sweep(sweep, made, None, None, False) == 0
    return made


def expected() -> list[float]:
    links = [api.summary(Scene(**SCENE).with_({VARIED: each})).links for each in VELOCITIES]
    return [link.set.value for found in links for link in found or ()]


def test_sets_are_those_of_summaries(folder: Path) -> None:
    from wavesym.sweeps.store import open_dataset

    found = open_dataset(folder)
    assert found["set"].dims == (VARIED, "link")
    assert found["set"].attrs["units"] == "mm"
    assert found["set"].values.ravel().tolist() == expected()
    assert expected()[1] > expected()[0] > 0
    assert found["max"].dims == (VARIED, "output")


def test_a_table_has_them_with_their_unit(folder: Path, tmp_path: Path) -> None:
    write_table(folder, tmp_path / "a.csv")
    with (tmp_path / "a.csv").open() as file:
        rows = list(csv.DictReader(file))
    (name,) = [each for each in rows[0] if ".set" in each]
    assert name.endswith(".set [mm]")
    assert [float(row[name]) for row in rows] == expected()


def test_a_page_draws_them(folder: Path) -> None:
    from wavesym.pictures.page.sweep import sweep_page

    text = sweep_page(folder)
    assert f"set of {TOE} over {VARIED}" in text
    assert f"set of {TOE}, mm, greatest" in text


def test_parquet_has_units_of_all_columns(folder: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    write_table(folder, tmp_path / "a.parquet")
    schema = parquet.read_schema(tmp_path / "a.parquet")
    assert schema.field("displacement@toe.max").metadata[b"unit"] == b"mm"
    assert schema.field(VARIED).metadata[b"unit"] == b"m/s"


def test_without_such_links_it_is_refused(tmp_path: Path) -> None:
    fields = {"scene": "drive_m1", "vary": {"system.kappa[0]": [1, 2]}, "keep": {"summary": ["set"]}}
    with pytest.raises(SceneError, match="no link of the scene yields or rubs"):
        api.run_sweep(fields, tmp_path / "made", None, None, False)
    assert not (tmp_path / "made").exists()
    with pytest.raises(wavesym.errors.WavesymError, match='"set" is not a statistic'):
        wavesym.peaks([Scene.from_toml("drive_m1")], keep=("set",))
