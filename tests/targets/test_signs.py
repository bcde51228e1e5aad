"""What headers say of signs is what programs do."""

from __future__ import annotations

import pytest

import wavesym
from wavesym.api.programs import program
from wavesym.programs.request import Request
from wavesym.scene import Scene
from wavesym.targets.description import describe

OUTPUT = {"until": 1, "velocity": [0, 2], "force": [0]}


def drive(body: int) -> Scene:
    load = [{"body": body, "times": [0], "steps": [1]}]
    return Scene(
        name="d", system={"type": "drive", "m": 2, "kappa": [1, 1], "inertia": [1, 1, 1]}, load=load, output=OUTPUT
    )


def chain(at: str, first: object = "free", branch: bool = False) -> Scene:
    parts = [first, {"rod": 1}, {"mass": 1, "name": "hub"}, {"rod": 1}, {"mass": 1}]
    system: dict[str, object] = {"type": "chain", "parts": parts}
    if branch:
        system["branch"] = [{"from": "hub", "name": "arm", "parts": [{"rod": 1}, {"mass": 1, "name": "tip"}]}]
    output = OUTPUT | ({"velocity": [0, 2, "tip"]} if branch else {})
    return Scene(name="c", system=system, load=[{"at": at, "times": [0], "steps": [1]}], output=output)


def said(scene: Scene) -> str:
    return " ".join(describe(program(scene, Request())).signs)


def test_a_moment_on_the_last_disc_counts_backwards() -> None:
    text = said(drive(1))
    assert "count along positive rotation, but that on the last disc against it" in text
    assert wavesym.run(drive(1), [0.5])["velocity@0"][0] > 0
    assert wavesym.run(drive(3), [0.5])["velocity@2"][0] < 0


def test_the_moment_in_a_shaft_turns_what_is_left_of_it_forward() -> None:
    """What pushes the first disc forward is held back by its shaft."""
    assert "positive where they turn what is left of them forward" in said(drive(1))
    assert wavesym.run(drive(1), [0.5])["force@0"][0] < 0


@pytest.mark.parametrize(("at", "output"), [("0", "velocity@0"), ("2", "velocity@2"), ("tip", "velocity@tip")])
def test_loads_on_nodes_count_in_the_direction_of_x(at: str, output: str) -> None:
    scene = chain(at, branch=at == "tip")
    assert "Loads on nodes count in the direction of x, on branches outwards" in said(scene)
    assert wavesym.run(scene, [0.5])[output][0] > 0


def test_forces_in_rods_pull() -> None:
    """What is pushed along x pulls the rod behind it."""
    scene = chain("2").with_({"output.force": ["2"]})
    assert "forces in rods are positive where they pull" in said(scene)
    assert wavesym.run(scene, [0.5])["force@2"][0] > 0
