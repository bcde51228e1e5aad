"""`wavesym advise`: what is enough where rods weigh little, where they do not, and where waves are all there is."""

import json

import numpy as np
import pytest

from wavesym import compiler
from wavesym.rivals import advice, mass
from wavesym.rivals.advice import advise
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
    times = [f"{period * turns * k / 12:.3f}" for k in range(13)]
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
    pairs = mass.Elements._pairs
    monkeypatch.setattr(
        mass.Elements,
        "_pairs",
        lambda self, bar, inner, across: (
            pairs(self, bar, inner + across, 0) if across > 0 else pairs(self, bar, inner, across)
        ),
    )
    assert worst(tower(0.04))[1] > 10 * right[1]


@pytest.mark.parametrize("part", ["massless", "consistent"])
def test_waves_are_what_is_compared_with(monkeypatch, part):
    """A program that is wrong by a tenth makes nothing enough."""
    make = advice.make

    class Wrong:
        kind, error_bound = "wrong", 0.0

        def __init__(self, model):
            self.evaluate = lambda taus: 1.1 * make(model).evaluate(taus)

    monkeypatch.setattr(advice, "make", Wrong)
    found = {candidate.name: candidate for candidate in advise(lower(tower(1e-3)), 0.01).candidates}
    assert found[part].worst == pytest.approx(0.1 / 1.1, rel=0.05)


OPEN = {"type": "collision", "m": 4, "kappa": ["1/10", "1/5"], "velocity": [1, "-1/2"], "contacts": "open"}


def test_contacts_that_open_need_waves():
    given = found(Scene(name="scene", system=OPEN, output={"until": 5, "velocity": ["1/2"]}))
    assert given.enough == "waves"
    assert all("contact that opens and closes" in candidate.refused for candidate in given.candidates)
    assert json.loads(given.json())["models"]["massless"] == {"refused": given.candidates[0].refused}
    assert "contact" in given.text()


def test_rods_alone_have_no_masses_on_springs():
    parts = [{"rod": 1}, {"rod": 1, "impedance": 2}]
    load = [{"at": "0", "times": [0], "steps": [1]}]
    given = found(
        Scene(name="scene", system={"type": "chain", "parts": parts}, load=load, output={"until": 5, "velocity": ["2"]})
    )
    massless, consistent = given.candidates
    assert "parts without mass that nothing holds" in massless.refused
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


def test_at_rest_anything_is_enough():
    still = tower(0.5, b=[0] * 13)
    assert found(still).enough == "massless"
    assert worst(still) == [0, 0]


def test_text_and_json_say_the_same():
    scene = tower(0.04)
    said = json.loads(compiler.advise(scene, 0.01, "json"))
    text = compiler.advise(scene, 0.01)
    assert said["enough"] == "consistent"
    assert list(said["models"]) == ["massless", "consistent", "waves"]
    assert text.startswith("tower: enough to 0.01 of the largest value of every output: consistent\n")
    for name, outputs in ((name, model["outputs"]) for name, model in said["models"].items()):
        for row in outputs:
            line = next(line for line in text.splitlines() if line.startswith(f"  {row['name']} "))
            shown = f"{row['largest']:.6g}" if name == "waves" else f"{row['history']:.1e}"
            assert shown in line
