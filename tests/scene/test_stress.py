"""Stresses are forces over sections: against formulas of the textbooks, in every program; refused without a section."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

import wavesym
from wavesym.errors import SceneError, UnservedError
from wavesym.programs.choice import choose
from wavesym.programs.making import program
from wavesym.scene import lower
from wavesym.scene.explicit_text import explicit_text

E, RHO, SPEED = 210e9, 7850.0, 5.0
STEEL = {"E": "210 GPa", "rho": "7850 kg/m^3"}
SHAFT = {"G": "80 GPa", "rho": "7850 kg/m^3"}
RAM = {"mass": "2 kg", "velocity": "5 m/s", "name": "ram"}


def _scene(system: dict[str, Any], units: dict[str, Any] | None = None, **output: Any) -> wavesym.Scene:
    load = output.pop("load", [])
    return wavesym.Scene(name="stressed", units=units or {}, system=system, load=load, output=output)


def _bars(**output: Any) -> wavesym.Scene:
    parts = [RAM, "contact", {"rod": "1 m", "A": "8 cm^2", **STEEL}, {"rod": "1 m", "A": "4 cm^2", **STEEL}, "fixed"]
    return _scene({"type": "chain", "parts": parts}, {"stress": "MPa"}, **{"until": "1 ms", **output})


def test_a_struck_bar_has_the_stress_of_the_textbook() -> None:
    """A rigid mass at v on a bar: -rho c v at once (Saint-Venant), and 4/3 of what comes where the area is halved."""
    result = _bars(stress=["0 m", "1 m-", "1 m+"]).run([0.0, 1.0001 / math.sqrt(E / RHO)])
    first = -math.sqrt(E * RHO) * SPEED / 1e6
    assert result["stress@0 m"][0] == pytest.approx(first, rel=1e-12)
    came = 4 / 3 * first * math.exp(-math.sqrt(E * RHO) * 8e-4 / 2 * 0.0001 / math.sqrt(E / RHO))
    assert result["stress@1 m+"][1] == pytest.approx(came, rel=1e-12)
    assert result["stress@1 m-"][1] == pytest.approx(came / 2, rel=1e-12)


@pytest.mark.parametrize(
    ("rod", "kind", "section"),
    [
        ({"rod": "1 m", "A": "8 cm^2", **STEEL}, "longitudinal", 8e-4),
        ({"rod": "1 m", "k": "5/6", "A": "8 cm^2", **SHAFT}, "shear", 8e-4),
        ({"rod": "1 m", "diameter": "50 mm", **SHAFT}, "torsional", math.pi * 0.05**3 / 16),
        (
            {"rod": "1 m", "diameter": "50 mm", "bore": "30 mm", **SHAFT},
            "torsional",
            math.pi * (0.05**4 - 0.03**4) / 0.8,
        ),
    ],
)
def test_stress_is_force_over_area_or_moment_over_section_modulus(
    rod: dict[str, str], kind: str, section: float
) -> None:
    """16 T / (pi d^3) at the surface of a shaft. Every program that serves it agrees."""
    mass, moment = ("1 kg*m^2", "5 kN*m") if kind == "torsional" else ("1 kg", "5 kN")
    unit = {"moment": "N*m"} if kind == "torsional" else {}
    load = [{"at": "0 m", "times": ["0 s"], "steps": [moment]}]
    scene = _scene(
        {"type": "chain", "parts": [{"mass": mass}, rod, "fixed"]},
        {"kind": kind, **unit},
        load=load,
        until="2 ms",
        tolerance="1e-9",
        force=["0.3 m"],
        stress=["0.3 m"],
    )
    times = np.linspace(0, 2e-3, 41)
    force, stress = scene.run(times).values
    assert np.abs(stress).max() > 0
    np.testing.assert_allclose(stress, force / section, rtol=1e-13, atol=1e-13 * np.abs(stress).max())
    model = lower(scene)
    for evaluator in ("closed", "pieces", "march"):
        made = program(model, choose(model, evaluator).evaluator)
        own = made.evaluate(np.linspace(0, float(model.until), 41))
        np.testing.assert_allclose(own[1], stress, rtol=0, atol=1e-9 * np.abs(stress).max())


def _wall(*areas: float) -> wavesym.Scene:
    """A damped building of walls, in the ground's motion."""
    shear = {"k": "5/6", "G": "12 GPa", "rho": "2400 kg/m^3"}
    walls = [{"height": "3 m", "shear": {**shear, "A": f"{area} m^2"}, "floor_mass": "90 t"} for area in areas]
    ground = [{"spacing": "0.1 s", "samples": [0, 0.1, 0.3], "unit": "g"}]
    building = {"type": "building", "base": "ground", "damping": 0.05, "storey": walls}
    places = [0, "1+"]
    return _scene(building, load=ground, until="0.2 s", tolerance="1e-6", force=places, stress=places)


def test_named_systems_have_stresses_in_their_rods() -> None:
    """A wall of unequal storeys, and a drive: the k-th rod's own section."""
    shafts = [{"length": "1 m", "diameter": f"{d} mm", **SHAFT} for d in (60, 50)]
    drive = {"type": "drive", "shaft": shafts, "disc": [{"inertia": "2 kg*m^2"}] * 3}
    torque = [{"body": 1, "times": ["0 s"], "steps": ["1 kN*m"]}]
    places = ["1/2", "3/2"]
    turned = _scene(drive, load=torque, until="5 ms", force=places, stress=places)
    for scene, sections in ((_wall(4, 2), (4, 2)), (turned, [math.pi * d**3 / 16 for d in (0.06, 0.05)])):
        values = wavesym.run(scene, samples=31).values
        np.testing.assert_allclose(values[2:], values[:2] / np.array(sections)[:, None], rtol=1e-13)


def test_a_response_with_loss_has_the_loss_in_stresses_too() -> None:
    parts = [{"mass": "1 kg"}, {"rod": "1 m", "A": "8 cm^2", "loss": "0.1", **STEEL}, "fixed"]
    load = [{"at": "0 m", "times": ["0 s"], "steps": ["1 kN"]}]
    scene = _scene({"type": "chain", "parts": parts}, load=load, until="1 ms", force=["1 m"], stress=["1 m"])
    force, stress = wavesym.frf(scene, frequencies=[200.0, 900.0]).values
    np.testing.assert_allclose(stress, force / 8e-4, rtol=1e-12)
    assert np.abs(stress.imag).min() > 0


@pytest.mark.slow
def test_many_structures_at_once_divide_each_by_its_own_area() -> None:
    """Walls of many areas are sets of numbers of the first one, whose stresses are others."""
    areas = np.arange(20, 30) / 10
    found = wavesym.peaks([_wall(area, 2) for area in areas.tolist()])
    np.testing.assert_allclose(found["max"][:, 2], found["max"][:, 0] / areas, rtol=1e-9)
    np.testing.assert_allclose(found["max"][:, 3], found["max"][:, 1] / 2, rtol=1e-9)


@pytest.mark.parametrize(
    ("rod", "units", "place", "said"),
    [
        (
            {"rod": "1 m", "impedance": "1 kN*s/m", "speed": "5 km/s"},
            {},
            "0 m",
            "unknown section; write its A, E and rho",
        ),
        ({"rod": "1 m", "J": "8 cm^4", **SHAFT}, {"kind": "torsional"}, "0 m", "unknown section; write its diameter"),
        ({"rod": 1}, None, 0, "0 has no section without [units]; write force"),
    ],
)
def test_stress_without_a_section_is_refused(rod: dict[str, Any], units: Any, place: Any, said: str) -> None:
    fields = {"system": {"type": "chain", "parts": [rod, "fixed"]}, "output": {"until": 1, "stress": [place]}}
    with pytest.raises(SceneError, match=re.escape(said)) as error:
        wavesym.Scene(name="none", **fields, **({} if units is None else {"units": units}))
    assert "output.stress[0]" in str(error.value)
    assert "\n" not in str(error.value)


def test_rods_of_one_impedance_and_unlike_areas_have_two_stresses() -> None:
    """Twice as stiff and heavy with half of the area: no wave is sent back, and yet the stress jumps."""
    dense = {"rod": "1 m", "A": "4 cm^2", "E": "420 GPa", "rho": "15700 kg/m^3"}
    system = {"type": "chain", "parts": [RAM, "contact", {"rod": "1 m", "A": "8 cm^2", **STEEL}, dense, "fixed"]}
    with pytest.raises(SceneError, match='1 m has two sides; write "1 m-" or "1 m\\+"'):
        _scene(system, until="1 ms", stress=["1 m"])
    left, right = _scene(system, until="1 ms", stress=["1 m-", "1 m+"]).run(samples=11).values
    np.testing.assert_allclose(right, 2 * left, rtol=1e-13)


def test_scenes_that_differ_in_a_section_alone_are_two() -> None:
    def sha(area: int) -> str:
        rod = {"rod": "1 m", "A": f"{area} cm^2", "E": f"{1680 // area} GPa", "rho": f"{62800 // area} kg/m^3"}
        system = {"type": "chain", "parts": [RAM, "contact", rod, "fixed"]}
        return lower(_scene(system, until="1 ms", stress=["0 m"])).labels.sha256

    assert sha(8) != sha(4)


def test_a_chain_written_out_has_no_sections_to_divide_by() -> None:
    with pytest.raises(UnservedError, match=r"^output.stress: what is written out has no sections; take force$"):
        explicit_text(_wall(4, 2))
