"""Accelerations, forces, drifts and relative displacements in scenes: where they may be, in which order they come."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import wavesym
from wavesym.errors import SceneError, WavesymError
from wavesym.scene import Scene
from wavesym.scene.explicit_text import explicit_text

BUILDING = {"type": "building", "m": 3, "kappa": [1, "1/2", "1/3", "1/4"], "base": "ground"}
DRIVE = {"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]}
COLLISION = {"type": "collision", "m": 4, "kappa": ["1/10", "1/5"], "velocity": [1, "-1/2"]}
CHAIN: dict[str, Any] = {
    "type": "chain",
    "parts": [
        {"motion": "velocity", "name": "base"},
        {"rod": 1},
        {"joint": True, "name": "step"},
        {"rod": 2, "impedance": 3},
        {"mass": 1, "name": "gear"},
        {"rod": 1},
        {"spring": 1},
        {"rod": 1},
        {"mass": 2, "name": "last"},
    ],
    "branch": [{"from": "gear", "name": "a", "ratio": 2, "parts": [{"rod": 1}, {"mass": 1, "name": "tip"}]}],
}


def scene(system: object, **outputs: object) -> Scene:
    return Scene(name="scene", system=system, output={"until": 3, **outputs})


@pytest.mark.parametrize(
    ("system", "outputs", "line"),
    [
        (BUILDING, {"acceleration": [1, "1+"]}, "acceleration[1]: 1+ is the same place as 1"),
        (BUILDING, {"force": [1]}, 'force[0]: 1 has two sides, of the body there; write "1-" or "1+"'),
        (CHAIN, {"force": ["gear"]}, 'force[0]: gear has two sides; write "gear-" or "gear+"'),
        (
            BUILDING,
            {"drift": [0]},
            'drift[0]: 0 is not the number of a storey; write 1 to 3, or drift = "all" for every storey there is',
        ),
        (
            BUILDING,
            {"drift": [4]},
            'drift[0]: 4 is not the number of a storey; write 1 to 3, or drift = "all" for every storey there is',
        ),
        (
            BUILDING,
            {"drift": ["1+"]},
            'drift[0]: 1+ is not the number of a storey; write 1 to 3, or drift = "all" for every storey there is',
        ),
        (
            DRIVE,
            {"drift": ["1/2"]},
            'drift[0]: 1/2 is not the number of a rod; write 1 to 2, or drift = "all" for every rod there is',
        ),
        (CHAIN, {"drift": ["a:2"]}, "drift[0]: a:2 is not the number of a rod; write 1"),
        (
            CHAIN,
            {"drift": ["gear"]},
            "drift[0]: gear is not a rod; write the number of one, on a branch after its name",
        ),
        (CHAIN, {"drift": [1, "1"]}, "drift[1]: 1 is the same place as 1"),
        (DRIVE, {"relative": [1]}, "relative[0]: 1, but a drive has no foundation"),
        (COLLISION, {"relative": [1]}, "relative[0]: 1, but a collision has no foundation"),
        (
            {"type": "chain", "parts": [{"mass": 1}, {"rod": 1}, "fixed"]},
            {"relative": [0]},
            "relative[0]: 0 is relative to the one end that moves, and there are 0; write a chain with 1 motion end",
        ),
        (
            {"type": "chain", "parts": [{"motion": "velocity"}, {"rod": 1}, {"motion": "acceleration"}]},
            {"relative": [0]},
            "relative[0]: 0 is relative to the one end that moves, and there are 2; write a chain with 1 motion end",
        ),
    ],
)
def test_a_place_where_it_is_not_is_one_line(system: object, outputs: dict[str, object], line: str) -> None:
    with pytest.raises(SceneError) as refused:
        scene(system, **outputs)
    assert str(refused.value).startswith(f"scene: output.{line}") or str(refused.value).startswith(f"output.{line}")
    assert "\n" not in str(refused.value)


def test_a_force_needs_a_side_only_where_it_jumps() -> None:
    """An impedance step and a spring pass it on, a strain differs on their two sides; a mass and a gear take of it."""
    made = scene(CHAIN, force=["step", "0", 4, "3-", "3+", "a:0"])
    assert [output.name for output in made.outputs] == [
        "force@step", "force@0", "force@4", "force@3-", "force@3+", "force@a:0"
    ]  # fmt: skip
    for place in ("step", 4):
        with pytest.raises(SceneError, match="has two sides"):
            scene(CHAIN, strain=[place])
    taus = np.linspace(0, 3, 50)
    load = [{"at": "gear", "times": [0], "steps": [1]}]
    sides = Scene(
        name="sides", system=CHAIN, load=load, output={"until": 3, "strain": ["1-", "1+", "4-", "4+"], "force": [1, 4]}
    )
    *strains, step, spring = wavesym.evaluator(sides)(taus)
    np.testing.assert_allclose([step, step], [strains[0], 3 * strains[1]], rtol=0, atol=1e-15)
    np.testing.assert_allclose([spring, spring], strains[2:], rtol=0, atol=1e-15)


def test_rows_come_in_the_order_of_quantities() -> None:
    """Whatever the order of the scene; the rows are named in the header of C and in NumPy."""
    asked = {"relative": [3], "drift": [2, 1], "force": ["1-"], "acceleration": [2], "velocity": [1], "strain": ["1/2"]}
    made = scene(BUILDING, **asked)
    assert [output.name for output in made.outputs] == [
        "strain@1/2", "velocity@1", "acceleration@2", "force@1-", "drift@2", "drift@1", "relative@3"
    ]  # fmt: skip


def test_scenes_that_do_not_ask_for_them_keep_their_hash() -> None:
    dumped = scene(BUILDING, velocity=[1], drift=[1]).model_dump(mode="json")["output"]
    assert list(dumped) == ["until", "tolerance", "strain", "velocity", "displacement", "drift"]


@pytest.mark.parametrize(
    ("system", "outputs"),
    [
        (BUILDING, {"acceleration": [1, 3], "force": [0, "2+"], "drift": [1, 3], "relative": [0, "5/2"]}),
        ({**BUILDING, "base": "force"}, {"acceleration": [2], "force": [0, "2+"], "drift": [2]}),
        (DRIVE, {"acceleration": [0, 1, 2], "force": ["1-", "1+", "1/2"], "drift": [1, 2]}),
        (COLLISION, {"acceleration": [1, 3], "force": [2, "1-"], "drift": [2, 3]}),
        ({**COLLISION, "contacts": "open"}, {"acceleration": [1, 3], "force": ["2-"], "drift": [2, 3]}),
    ],
    ids=["ground", "force", "drive", "collision", "open"],
)
def test_a_named_system_written_out_has_the_same_outputs(
    system: dict[str, Any], outputs: dict[str, Any], tmp_path: Any
) -> None:
    loads = {
        "building": [{"times": [0, "1/3"], "a": [1, -2], "b": ["1/2", 0]}],
        "drive": [{"body": 2, "times": ["1/4"], "steps": [1]}],
    }
    given = Scene(name="given", system=system, load=loads.get(system["type"], []), output={"until": "7/2", **outputs})
    path = tmp_path / "written.toml"
    path.write_text(explicit_text(given), encoding="utf-8")
    taus = np.linspace(0.01, 3.49, 40)
    named, written = (wavesym.evaluator(each) for each in (given, Scene.from_toml(path)))
    assert named.outputs == written.outputs
    np.testing.assert_array_equal(named(taus), written(taus))


def test_without_a_motion_end_nothing_is_relative_when_it_is_written_out() -> None:
    with pytest.raises(WavesymError, match=r'output.relative: base = "force" has no foundation that moves'):
        explicit_text(scene({**BUILDING, "base": "force"}, relative=[3]))


def test_all_drifts_are_those_of_every_rod() -> None:
    building = Scene.from_toml("building_m2")
    every = building.with_({"output.drift": "all"})
    assert every == building.with_({"output.drift": [1, 2]})
    assert [output.name for output in every.outputs][-2:] == ["drift@1", "drift@2"]
    chain = Scene(
        name="linked",
        system={"type": "chain", "parts": [{"rod": 1}, {"spring": 1}, {"rod": 2}, {"mass": 1}, {"rod": 1}, "fixed"]},
        output={"until": 1, "drift": "all"},
    )
    assert [output.name for output in chain.outputs] == ["drift@1", "drift@2", "drift@3"]
    with pytest.raises(SceneError, match=r'output\.drift: "each" is not a list; write \[1, 2, 3\], or "all"'):
        building.with_({"output.drift": "each"})
