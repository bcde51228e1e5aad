"""Names of outputs for people: shown wherever people look, beside the identifier that programs keep."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import wavesym
from wavesym import Scene
from wavesym.cli import main
from wavesym.errors import SceneError
from wavesym.pictures.histories import histories
from wavesym.scene import lower

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
