"""Names of outputs and loads for people: shown wherever people look, beside the identifier that programs keep."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import wavesym
from wavesym import Scene, api
from wavesym.cli import main
from wavesym.errors import SceneError
from wavesym.pictures.histories import histories
from wavesym.pictures.loads import load_histories
from wavesym.programs.request import Request
from wavesym.scene import lower
from wavesym.scene.explicit_text import explicit_text
from wavesym.scene.first_scene import first_text
from wavesym.targets.fmu.variables import variables

FORCE = {"at": 0, "name": "Base shear"}


@pytest.fixture
def building() -> Scene:
    return Scene.from_toml("building_m2").with_(
        {"output.force": [FORCE], "output.drift": [1, {"at": 2, "name": "Top drift"}]}
    )


def test_the_identifier_stays(building: Scene) -> None:
    bare = building.with_({"output.force": [0], "output.drift": [1, 2]})
    assert [output.name for output in building.outputs] == [output.name for output in bare.outputs]
    assert (wavesym.run(building).values == wavesym.run(bare).values).all()
    assert wavesym.run(building)["force@0"].shape == (1001,)
    assert Scene(**building.model_dump()) == building


@pytest.mark.slow
def test_people_are_shown_the_name(building: Scene, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = [history.name for history in histories(lower(building)).outputs]
    assert names[-3:] == ["Base shear", "drift@1", "Top drift"]
    summary = wavesym.summary(building)
    assert (summary["force@0"].name, summary["force@0"].label) == ("force@0", "Base shear")
    page = tmp_path / "page.html"
    wavesym.report(building, page)
    assert page.read_text(encoding="utf-8").count("Base shear") >= 2
    file = tmp_path / "building.toml"
    file.write_text(
        'name = "b"\n[system]\ntype = "building"\nm = 2\nkappa = [1, 1, 1]\nbase = "ground"\n'
        "[[load]]\ntimes = [0]\na = [1]\n"
        '[output]\nuntil = 3\nforce = [{ at = 0, name = "Base shear" }]\n'
    )
    assert main(["summary", str(file)]) == 0
    assert "Base shear" in capsys.readouterr().out
    assert main(["summary", str(file), "--format", "json"]) == 0
    (output,) = json.loads(capsys.readouterr().out)["outputs"]
    assert (output["name"], output["title"]) == ("force@0", "Base shear")
    wavesym.generate(Scene.from_toml(str(file)), tmp_path / "out", language="all")
    assert "force@0: Base shear" in (tmp_path / "out" / "b.h").read_text()


def test_names_and_units(tmp_path: Path) -> None:
    parts = [
        "fixed",
        {"rod": "1 m", "A": "1 cm^2", "E": "210 GPa", "rho": "7850 kg/m^3"},
        {"mass": "1 kg", "name": "end"},
    ]
    scene = Scene(
        name="bar",
        units={},
        system={"type": "chain", "parts": parts},
        load=[{"at": "end", "times": ["0 s"], "steps": ["1 N"]}],
        output={"until": "1 ms", "force": [{"at": "0 m", "name": "Anchor"}]},
    )
    assert [(output.name, output.title) for output in scene.outputs] == [("force@0 m", "Anchor")]


@pytest.mark.parametrize(
    ("position", "message"),
    [
        ({"at": 0}, "output.force[0].name: missing; write a name for people"),
        ({"name": "x"}, "output.force[0].at: missing; write a place"),
        ({"at": 0, "name": ""}, "output.force[0].name"),
        ({"at": 0, "name": "a\nb"}, "output.force[0].name"),
        ({"at": 0, "name": "*/ int x;"}, '"*/ int x;" is not a name for people; write a line without */'),
        ({"at": 0, "name": "x", "unit": "N"}, "output.force[0].unit: unknown key; write at or name"),
    ],
)
def test_what_is_no_name_gets_one_line(position: dict[str, object], message: str) -> None:
    with pytest.raises(SceneError) as caught:
        Scene.from_toml("building_m2").with_({"output.force": [position]})
    assert message in str(caught.value)


GUST = {"at": "roof", "times": [0, 2], "steps": [1, -1], "name": "Wind gust"}
ROOM = {
    "name": "room",
    "system": {"type": "chain", "parts": ["fixed", {"rod": 1}, {"mass": 1, "name": "roof"}]},
    "load": [GUST],
    "output": {"until": 4, "force": [{"at": 0, "name": "Base shear"}]},
}


def test_a_load_is_called_by_its_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """In pictures, pages, headers, simulators and frequency responses; its key in sources and hashes stays."""
    scene = Scene(**ROOM)
    bare = scene.with_({"load": [{key: value for key, value in GUST.items() if key != "name"}]})
    assert [load.name for load in load_histories(lower(scene))] == ["Wind gust"]
    assert [load.name for load in load_histories(lower(bare))] == ["force at roof"]
    assert lower(scene).loads == lower(bare).loads
    assert "name" not in bare.model_dump()["load"][0]
    assert Scene(**scene.model_dump()) == scene
    page = tmp_path / "page.html"
    wavesym.report(scene, page)
    assert "Wind gust" in page.read_text(encoding="utf-8")
    wavesym.generate(scene, tmp_path / "out")
    assert "Wind gust: 1 roof:step at 0" in (tmp_path / "out" / "room.h").read_text()
    seen = {each.name: each.about for each in variables(api.program(scene, Request.from_options(target="fmu2")))}
    assert seen["load@roof"].startswith("Wind gust, from the start of a step on")
    assert seen["force@0"] == "Base shear: force at 0"
    assert wavesym.frf(scene, [0.5], "Wind gust").load == wavesym.frf(scene, [0.5], "roof").load == "Wind gust"


def test_names_are_in_what_is_written_out(tmp_path: Path) -> None:
    """In numbers and in units; read back they are the same."""
    storey = {"height": "3.5 m", "stiffness": "678 MN/m", "column_mass": "11 t", "floor_mass": "350 t"}
    physical = Scene(
        name="frame",
        units={},
        system={"type": "building", "base": "ground", "storey": [{**storey, "count": 2}]},
        load=[{"times": ["0 s"], "a": ["1 m/s^2"], "name": "Earthquake \u00fc"}],
        output={"until": "1 s", "force": [FORCE], "drift": [{"at": 2, "name": "Top drift"}]},
    )
    plain = Scene.from_toml("building_m2").with_({"load[0].name": "Earthquake \u00fc", "output.force": [FORCE]})
    for scene in (physical, plain):
        file = tmp_path / "explicit.toml"
        file.write_text(explicit_text(scene), encoding="utf-8")
        explicit = Scene.from_toml(str(file))
        assert [load.label for load in explicit.load] == ["Earthquake \u00fc"]
        assert [output.title for output in explicit.outputs] == [output.title for output in scene.outputs]
    assert "Earthquake" in lower(physical).labels.load_names[0]
    assert "Earthquake" not in lower(physical).labels.loads[0]


@pytest.mark.parametrize("name", ["", " ", "a\nb", "*/ int x;", 3, "x" * 101])
def test_what_is_no_name_of_a_load_gets_one_line(name: object) -> None:
    with pytest.raises(SceneError, match=r"load\[0\]\.name: .* is not a name for people; write a line"):
        Scene(**{**ROOM, "load": [{**GUST, "name": name}]})


def test_loads_are_drawn_in_the_units_that_they_are_written_in() -> None:
    """A drive counts moments in units of its own, by the disc that they turn."""
    drive = Scene.from_toml(first_text("drive"))
    (moment,) = load_histories(lower(drive))
    assert (moment.output.unit, *moment.points[:, 1]) == ("kN*m", 2, 2, 1, 1)


def test_a_stream_says_what_its_loads_are_called(tmp_path: Path) -> None:
    scene = Scene.from_toml(first_text("drive").replace("body = 1 ", 'name = "Motor torque"\nbody = 1 '))
    wavesym.generate(scene, tmp_path, language="c", stream=True)
    assert "DRIVE_LOAD_M1 = 0 /* M1 [kN*m]: Motor torque */" in (tmp_path / "drive.h").read_text()
