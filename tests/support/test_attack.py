"""An attack draws the same scenes again, writes them down whole, and finds what is wrong."""

import json

import pytest

from tests.support import attack
from tests.support.drawn import NEARLY
from tests.support.scenes import as_toml
from wavesym.scene import Scene, lower

SCENE = Scene(
    name="struck",
    system={"type": "collision", "m": 4, "kappa": [1, NEARLY], "velocity": [1, "3/8"]},
    output={"until": "3.2", "tolerance": "1e-3", "strain": [0, 2], "velocity": ["3/2"], "displacement": [1]},
)


@pytest.mark.quick(8)
@pytest.mark.parametrize("number", range(40))
def test_a_drawn_scene_can_be_drawn_again_and_written_down(number, tmp_path):
    scene, precision = attack.drawn(number)
    assert attack.drawn(number) == (scene, precision)
    (tmp_path / "scene.toml").write_text(as_toml(scene))
    assert Scene.from_toml(tmp_path / "scene.toml") == scene


@pytest.mark.slow
def test_every_program_of_a_plain_scene_holds():
    outcomes = list(attack.attack(SCENE, "double"))
    assert len(outcomes) == 9
    assert all(outcome.values > 500 and 0 < outcome.worst <= 1 for outcome in outcomes)


@pytest.mark.quick(1)
@pytest.mark.parametrize("language", ["c", "numpy"])
@pytest.mark.parametrize("wrong", ["bound", "zero"])
def test_a_wrong_program_is_found(monkeypatch, language, wrong):
    made = attack.files(lower(SCENE), "all", "pieces", "double")
    told = json.loads(made["struck.json"])
    if wrong == "bound":
        told["outputs"][3]["error_bound"] /= 1e6
    else:  # the strain at a free end is 0, the velocity is not
        names = [output["name"] for output in told["outputs"]]
        assert names[0] == "strain@0"
        other = Scene(**SCENE.model_dump() | {"output": SCENE.output.model_dump() | {"strain": ["1/2", 2]}})
        made = attack.files(lower(other), "all", "pieces", "double")
    made["struck.json"] = json.dumps(told)
    monkeypatch.setattr(attack, "files", lambda *_: made)
    outcomes = list(attack.attack(SCENE, "double", ("pieces",), (language,)))
    assert outcomes
    assert all(outcome.worst > 1 for outcome in outcomes)
