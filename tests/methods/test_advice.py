"""`wavesym advise`: what is enough where rods weigh little, where they do not, and where waves are all there is."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq
from scipy.sparse import diags_array

from wavesym import api
from wavesym.cli import main
from wavesym.mechanics.damping import Damping
from wavesym.methods import advice, elements
from wavesym.methods.advice import advise
from wavesym.scene import Scene, lower


def found(scene, tolerance=0.01):
    return advise(lower(scene), tolerance)


def worst(scene):
    return [candidate.worst for candidate in found(scene).candidates]


@pytest.mark.parametrize("name", ["drive_m1", "building_m2", "collision_m4"])
def test_the_figures_of_the_paper_need_waves(name):
    given = found(Scene.from_toml(name))
    assert given.enough == "waves"
    assert all(candidate.worst > 0.05 for candidate in given.candidates)


def tower(kappa, turns=2.0, **load):
    """Three storeys on ground that is pushed smoothly over some of the building's own periods."""
    period = 2 * np.pi / (0.445 * kappa**0.5)
    times = [round(period * turns * k / 12) for k in range(13)]  # one panel of a march
    slopes = np.diff(np.sin(np.linspace(0, 2 * np.pi, 13))) / np.diff(np.array(times, float))
    bends = np.diff(slopes, prepend=0, append=0)
    load = {"times": times, "a": [0] * 13, "b": [f"{bend:.9g}" for bend in bends * 100], **load}
    return Scene(
        name="tower",
        system={"type": "building", "m": 3, "kappa": [f"{kappa:.9g}"] * 4, "base": "ground"},
        load=[load],
        output={"until": times[-1], "tolerance": "1e-9", "strain": ["0", "1/2"], "velocity": [3]},
    )


def test_the_lighter_the_rods_the_better_the_springs():
    """Frequencies are wrong by kappa without the rods' mass, by its square with it."""
    few, many = worst(tower(0.01)), worst(tower(0.04))
    assert 3 < many[0] / few[0] < 5
    assert 12 < many[1] / few[1] < 20
    assert found(tower(0.04)).enough == "consistent"
    assert found(tower(1e-3)).enough == "massless"
    assert found(tower(1e-3), 1e-5).enough == "consistent"


def test_mass_that_is_shared_out_wrongly_is_seen(monkeypatch):
    """Half shares at the ends are of the same order as none."""
    right = worst(tower(0.04))

    def shared(self):
        parts = self.mean.T @ diags_array(self._masses) @ self.mean
        ends = self.stretch.T @ diags_array(self._masses / 4) @ self.stretch
        return parts + ends + self._at_points(np.diag(self.problem.mass))

    monkeypatch.setattr(elements.Elements, "mass", property(shared))
    assert worst(tower(0.04))[1] > 10 * right[1]


@pytest.mark.parametrize("part", ["massless", "consistent"])
def test_waves_are_what_is_compared_with(monkeypatch, part):
    """A program that is wrong by a tenth makes nothing enough."""
    program = advice.program

    class Wrong:
        evaluator, error_bound = "wrong", 0.0

        def __init__(self, *asked):
            right = program(*asked)
            self.outputs, self.evaluate = right.outputs, lambda taus: 1.1 * right.evaluate(taus)

    monkeypatch.setattr(advice, "program", Wrong)
    found = {candidate.name: candidate for candidate in advise(lower(tower(1e-3)), 0.01).candidates}
    assert found[part].worst == pytest.approx(0.1 / 1.1, rel=0.05)


OPEN = {"type": "collision", "m": 4, "kappa": ["1/10", "1/5"], "velocity": [1, "-1/2"], "contacts": "open"}


def test_contacts_that_open_need_waves():
    given = found(Scene(name="scene", system=OPEN, output={"until": 5, "velocity": ["1/2"]}))
    assert given.enough == "waves"
    assert all("at 2 opens and closes" in candidate.refusal for candidate in given.candidates)
    assert json.loads(given.json())["models"]["massless"] == {"refused": given.candidates[0].refusal}
    assert "contact" in given.text()
    assert "nothing is compared with waves, as no other model serves" in given.text()
    assert "enough to" not in given.text()


def test_rods_alone_have_no_masses_on_springs():
    parts = [{"rod": 1}, {"rod": 1, "impedance": 2}]
    load = [{"at": "0", "times": [0], "steps": [1]}]
    given = found(
        Scene(name="scene", system={"type": "chain", "parts": parts}, load=load, output={"until": 5, "velocity": ["2"]})
    )
    massless, consistent = given.candidates
    assert "parts without mass; write a mass or a support" in massless.refusal
    assert consistent.worst > 0.1


def test_what_no_wave_has_reached_has_no_size():
    """There springs move already; they are not enough, and JSON has no number for it."""
    load = [{"body": 1, "times": [0], "steps": [1]}]
    drive = {"type": "drive", "m": 3, "kappa": [1, 1, 1], "inertia": [1, 1, 1, 1]}
    given = found(Scene(name="scene", system=drive, load=load, output={"until": 2, "velocity": [0, 3]}))
    assert given.enough == "waves"
    said = json.loads(given.json())
    assert said["models"]["massless"]["outputs"][1] == {"name": "velocity@3", "history": None, "peak": None}
    assert said["models"]["waves"]["outputs"][1] == {"name": "velocity@3", "unit": "", "largest": 0.0}


def test_the_foundation_is_at_rest_to_itself():
    """No wave is asked for, and none is compared."""
    scene = tower(0.01).with_({"output.strain": [], "output.velocity": [], "output.relative": [0]})
    assert found(scene).enough == "massless"
    assert worst(scene)[0] == 0


def test_at_rest_anything_is_enough():
    still = tower(0.5, b=[0] * 13)
    assert found(still).enough == "massless"
    assert worst(still) == [0, 0]


def test_text_and_json_say_the_same():
    scene = tower(0.04)
    said = json.loads(api.advise(scene, 0.01).json())
    text = api.advise(scene, 0.01).text()
    assert said["enough"] == "consistent"
    assert list(said["models"]) == ["massless", "consistent", "waves"]
    assert text.startswith("tower: enough to 0.01 of the largest value of every output: consistent\n")
    for name, outputs in ((name, model["outputs"]) for name, model in said["models"].items()):
        for row in outputs:
            line = next(line for line in text.splitlines() if line.startswith(f"  {row['name']} "))
            shown = f"{row['largest']:.6g}" if name == "waves" else f"{row['history']:.1e}"
            assert shown in line


def test_the_command(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["advise", "drive_m1", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["enough"] == "waves"
    assert main(["advise", "collision_m4"]) == 0
    assert "computed as if it stayed closed" in capsys.readouterr().err
    assert main(["advise", "drive_m1", "--tolerance", "0.6"]) == 0
    assert "every output: massless" in capsys.readouterr().out
    for wrong in ("0", "1", "nan", "much"):
        assert main(["advise", "drive_m1", "--tolerance", wrong]) == 2
        out, line = capsys.readouterr()
        assert out == ""
        assert line.count("\n") == 1
    assert not list(tmp_path.iterdir())


EL_CENTRO = Path(__file__).parents[2].parent / "shared" / "records" / "elcentro_1940_ns_peknold.csv"


def frame(kappa, samples):
    """Ten storeys that swing in 0.95 s, at 5 %, whatever kappa: a rod's delay goes with its root."""
    spacing = 0.02 / (0.004 * (kappa / 0.031) ** 0.5)
    load = {"spacing": f"{spacing:.6g}", "samples": samples}
    scene = Scene(
        name="frame",
        system={"type": "building", "m": 10, "kappa": [f"{kappa:g}"] * 11, "base": "ground"},
        load=[load],
        output={"until": f"{spacing * (len(samples) - 1):.6g}", "tolerance": "1e-6", "drift": [1]},
    )
    return replace(lower(scene), damping=Damping((fmpq(1, 20),)))


@pytest.mark.skipif(not EL_CENTRO.exists(), reason="the shared records are not beside the repository")
@pytest.mark.parametrize("count", [500, pytest.param(1560, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("kappa", "enough"), [(1e-4, "massless"), (0.01, "consistent"), (0.1, "consistent")])
def test_a_frame_in_an_earthquake(kappa, enough, count):
    """Known for the whole record: massless springs are off by 8e-4, 8e-2, 0.6, those with mass by 2e-9, 2e-5, 1e-3."""
    rows = EL_CENTRO.read_text().splitlines()[2:]
    given = advise(frame(kappa, [row.split(",")[1] for row in rows[:count]]), 0.01)
    massless, consistent = (candidate.worst for candidate in given.candidates)
    assert given.enough == enough
    assert 0.3 < massless / {1e-4: 8e-4, 0.01: 8e-2, 0.1: 0.6}[kappa] < 3
    assert consistent < {1e-4: 1e-6, 0.01: 1e-4, 0.1: 3e-3}[kappa]
