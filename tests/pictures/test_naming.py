"""Names and units of outputs as people say them."""

from __future__ import annotations

import pytest

from wavesym.pictures.naming import with_titles
from wavesym.pictures.units import unit_text
from wavesym.scene import Scene, lower

BUILDING = {"type": "building", "m": 3, "kappa": ["1/4", "3/5", "1/5", "1/2"], "base": "ground"}
OUTPUT = {
    "until": 2,
    "force": [0, "1-", "1+"],
    "drift": [2],
    "acceleration": [0, 1, 3],
    "relative": [{"at": 3, "name": "Sway"}, 2],
    "strain": ["1/2"],
}


def test_floors_and_storeys_have_the_names_that_engineers_give_them() -> None:
    scene = Scene(name="b", system=BUILDING, load=[{"spacing": 1, "samples": [0, 1]}], output=OUTPUT)
    assert {probe.name: probe.title for probe in with_titles(lower(scene)).probes} == {
        "strain@1/2": "Strain at x = 1/2",
        "acceleration@0": "Foundation acceleration",
        "acceleration@1": "Floor 1 acceleration",
        "acceleration@3": "Roof acceleration",
        "force@0": "Base shear",
        "force@1-": "Shear below floor 1",
        "force@1+": "Shear above floor 1",
        "drift@2": "Storey 2 drift",
        "relative@3": "Sway",
        "relative@2": "Floor 2 displacement relative to the ground",
    }


def test_places_of_chains_have_their_own_names() -> None:
    parts = [{"mass": 1, "name": "hub", "velocity": 1}, {"rod": 1}, "fixed"]
    output = {"until": 2, "velocity": ["hub", "1/2"], "drift": [1]}
    model = with_titles(lower(Scene(name="c", system={"type": "chain", "parts": parts}, output=output)))
    titles = [probe.title for probe in model.probes]
    assert titles == ["Velocity of hub", "Velocity at x = 1/2", "Deformation of rod 1"]


@pytest.mark.parametrize(
    ("unit", "shown"),
    [("m/s^2", "m/s\u00b2"), ("kN*m", "kN\u00b7m"), ("mm", "mm"), ("", ""), ("m**-1", "m\u207b\u00b9")],
)
def test_units_are_written_by_hand(unit: str, shown: str) -> None:
    assert unit_text(unit) == shown
