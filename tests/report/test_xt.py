"""Place x time: the values are those of outputs there, the lines are the chain's, and the picture is the same again."""

from __future__ import annotations

import numpy as np
import pytest

import wavesym
from wavesym.exact.field import Field
from wavesym.exact.reference import Reference
from wavesym.report import xt
from wavesym.scene import Scene, lower

CHAIN = {
    "type": "chain",
    "parts": [
        {"mass": 2, "velocity": 1},
        {"rod": "1/2"},
        {"rod": 2, "impedance": 3, "speed": 2},
        {"mass": 1, "name": "a"},
    ],
    "branch": [{"from": "a", "name": "b", "ratio": 2, "parts": [{"rod": 1}, "fixed"]}],
}
VISIBLE = 1e-6  # far below a shade of colour
PLACES = {"velocity": ["1/4", "3/2", "b:1/3"], "strain": ["1/4", "3/2", "b:1/3"]}


def test_a_field_has_what_outputs_have():
    scene = wavesym.Scene(name="field", system=CHAIN, load=[], output={"until": 6, **PLACES})
    model = lower(scene)
    field = Field(model)
    taus = np.linspace(0.01, 5.9, 50)
    values = np.array(Reference(model).values(taus.tolist()))
    for k, (bar, part, impedance) in enumerate([(0, 0.5, 1), (1, 0.5, 3 * 2), (2, 1 / 3, 1)]):
        velocity, force = field.at(bar, np.full_like(taus, part), taus)
        assert np.allclose(force, impedance * values[k], rtol=0, atol=VISIBLE)
        assert np.allclose(velocity, values[3 + k], rtol=0, atol=VISIBLE)


def test_lines_are_the_chain_and_its_branches():
    lines = wavesym.Scene(name="lines", system=CHAIN, load=[], output={"until": 1, "velocity": [0]}).system.lines
    assert {name: [station.right for station in stations] for name, stations in lines.items()} == {
        "": [0, 1, None],
        "b": [2, None],
    }
    assert [float(stations[-1].x) for stations in lines.values()] == [2.5, 1.0]
    drive = Scene.from_toml("drive_m1").system.lines
    assert [station.points for station in drive[""]] == [(0,), (1,)]


@pytest.mark.parametrize("name", ["building_m2"])
def test_the_same_picture_again(name, tmp_path):
    pytest.importorskip("matplotlib")
    from wavesym import compiler

    scene = Scene.from_toml(name)
    for file in ("one.png", "other.png"):
        compiler.plot(scene, tmp_path / file, "xt")
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "other.png").read_bytes()
