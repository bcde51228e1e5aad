"""What a scene says, and how its loads and outputs are reduced."""

from __future__ import annotations

import copy
import pickle
import tomllib
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st

import wavesym
from wavesym.errors import SceneError
from wavesym.mechanics.loads import AppliedLoad
from wavesym.numbers.doubles import fraction, rational
from wavesym.scene import Scene, builtin_names, builtin_text, lower

BUILDING = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"}
DRIVE = {"type": "drive", "m": 11, "kappa": [1] * 11, "inertia": [1] * 12}
WATCH = {"until": 20, "strain": [0.5]}

small = st.fractions(min_value=-5, max_value=5, max_denominator=12)
positive = st.fractions(min_value=Fraction(1, 12), max_value=3, max_denominator=12)


def scene(system: dict[str, Any], load: list[dict[str, Any]], **output: Any) -> Scene:
    return Scene(name="s", system=system, load=load, output=WATCH | output)


def acceleration(loads: tuple[AppliedLoad, ...], tau: Fraction) -> Fraction:
    """The base acceleration that weights of unit steps and ramps stand for; H(0) = 1."""
    started = [load for load in loads if rational(tau) >= load.time]
    ramped = ((load, tau - fraction(load.time)) for load in started)
    return sum((fraction(load.weight) * (1 if load.source == "a" else since) for load, since in ramped), Fraction(0))


@given(st.lists(small, min_size=1, max_size=8), positive, st.lists(positive, max_size=8))
def test_a_record_is_linear_between_its_samples(
    samples: list[Fraction], spacing: Fraction, taus: list[Fraction]
) -> None:
    loads = lower(scene(BUILDING, [{"spacing": spacing, "samples": samples}])).loads
    for k, value in enumerate(samples):
        assert acceleration(loads, k * spacing) == value
    for k, (left, right) in enumerate(pairwise(samples)):
        assert acceleration(loads, (k + Fraction(1, 3)) * spacing) == left + (right - left) / 3
    end = (len(samples) - 1) * spacing
    for tau in taus:
        assert acceleration(loads, end + tau) == samples[-1]


@given(st.lists(st.tuples(st.lists(st.tuples(positive, small, small), max_size=4)), max_size=3), st.lists(positive))
def test_loads_add_up(tables: list[tuple[list[tuple[Fraction, Fraction, Fraction]]]], taus: list[Fraction]) -> None:
    pieced = [sorted({t: (t, a, b) for t, a, b in rows}.values()) for (rows,) in tables]
    load = [{"times": [t for t, _, _ in p], "a": [a for _, a, _ in p], "b": [b for _, _, b in p]} for p in pieced]
    loads = lower(scene(BUILDING, load)).loads
    for tau in taus:
        expected = sum(a + b * (tau - t) for p in pieced for t, a, b in p if tau >= t)
        assert acceleration(loads, tau) == expected
    keys = [(piece.time, piece.source) for piece in loads]
    assert keys == sorted(set(keys))
    assert all(piece.weight for piece in loads)


def test_moments_are_sorted_by_time_and_body_and_merged() -> None:
    load = [
        {"body": 10, "times": [0, 3], "steps": [1, "-1/2"]},
        {"body": 2, "times": [0], "steps": [4]},
        {"body": 10, "times": [3, 5], "steps": [0.5, 2]},
    ]
    zero, five = fmpq(0), fmpq(5)
    assert lower(scene(DRIVE, load)).loads == (
        AppliedLoad("M2", zero, fmpq(4)),
        AppliedLoad("M10", zero, fmpq(1)),
        AppliedLoad("M10", five, fmpq(2)),
    )


def test_a_collision_is_one_impact() -> None:
    assert lower(Scene.from_toml("collision_m4")).loads == (AppliedLoad("impact", fmpq(0), fmpq(1)),)


def test_outputs_keep_their_order_and_are_named_as_written(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(
        'name = "s"\n[system]\ntype = "building"\nm = 2\nkappa = [0.1, 1, 2]\nbase = "ground"\n'
        '[output]\nuntil = 1\ndisplacement = ["2-"]\nvelocity = ["1-", 0.50]\n'
        'strain = ["1+", "1-", "1/2", 1.5e0, "0+"]\n'
    )
    scene = Scene.from_toml(path)
    half = Fraction(1, 2)
    found = tuple((each.quantity, each.x, each.side, each.name) for each in scene.outputs)
    assert found == (
        ("strain", Fraction(1), 1, "strain@1+"),
        ("strain", Fraction(1), -1, "strain@1-"),
        ("strain", half, 0, "strain@1/2"),
        ("strain", 3 * half, 0, "strain@1.5e0"),
        ("strain", Fraction(0), 0, "strain@0+"),
        ("velocity", Fraction(1), 0, "velocity@1-"),
        ("velocity", half, 0, "velocity@0.50"),
        ("displacement", Fraction(2), 0, "displacement@2-"),
    )
    assert scene.system.kappa == (Fraction(1, 10), Fraction(1), Fraction(2))
    assert scene.load == ()


@pytest.mark.parametrize(
    ("system", "bodies"),
    [
        ({"type": "collision", "m": 6, "kappa": [1, 1, 1], "velocity": [1, 1, 1]}, {1, 3, 5}),
        ({"type": "drive", "m": 4, "kappa": [1] * 4, "inertia": [1] * 5}, {1, 2, 3}),
        ({"type": "building", "m": 3, "kappa": [1] * 4, "base": "ground"}, {1, 2}),
    ],
)
def test_a_side_matters_at_bodies_inside_the_chain_only(system: dict[str, Any], bodies: set[int]) -> None:
    for x in range(system["m"] + 1):
        watched = Scene(name="s", system=system, output={"until": 1, "strain": [f"{x}-"], "velocity": [f"{x}-"]})
        assert [output.side for output in watched.outputs] == [-1 if x in bodies else 0, 0]


def test_positions_from_python_are_named_like_their_numbers() -> None:
    names = [o.name for o in scene(BUILDING, [], strain=[Fraction(3, 2), 0.1, 0, "1/3", "2"]).outputs]
    assert names == ["strain@3/2", "strain@0.1", "strain@0", "strain@1/3", "strain@2"]


def test_python_and_toml_make_equal_scenes() -> None:
    builtin = Path(wavesym.scene.__file__).parent / "builtin"  # type: ignore[attr-defined]
    for name in builtin_names():
        from_toml = Scene.from_toml(name)
        again = Scene(**tomllib.loads((builtin / f"{name}.toml").read_text(encoding="utf-8")))
        assert (again.name, again.system, again.load) == (from_toml.name, from_toml.system, from_toml.load)
        assert again.outputs == from_toml.outputs
        assert again.output.until == from_toml.output.until
        for clone in (copy.deepcopy(from_toml), pickle.loads(pickle.dumps(from_toml))):
            assert clone == from_toml
            assert lower(clone).loads == lower(from_toml).loads


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", list(builtin_names()))
def test_a_scene_is_what_it_is_dumped_as(name: str) -> None:
    scene = Scene.from_toml(name)
    assert Scene(**scene.model_dump()) == scene
    assert Scene(**scene.model_dump(mode="json")) == scene


def test_builtin_scenes() -> None:
    named = ["building_half_roof", "building_m2", "collision_m4", "drive_equal", "drive_m1"]
    assert sorted(builtin_names()) == sorted([*named, "damped_building", "geared_drive", "stepped_shaft"])
    for name, description in builtin_names().items():
        assert Scene.from_toml(name).name == name
        assert description.endswith(".")
    building = Scene.from_toml("building_m2")
    # said in its comment: from 1 to -1 at 3, from 1/2 to -1/2 at 6, then nothing
    values = [acceleration(lower(building).loads, Fraction(tau)) for tau in ("0", "1.5", "3", "4.5", "6", "7")]
    assert values == [1, 0, Fraction(1, 2), 0, 0, 0]
    assert building.output.tolerance == Fraction(1, 10**8)
    assert Scene.from_toml("collision_m4").output.tolerance == Fraction(1, 10**10)
    floor, roof = Scene.from_toml("building_half_roof").system.kappa[1::2]
    assert 2 * floor == roof


def test_a_scene_does_not_change() -> None:
    frozen = Scene.from_toml("drive_m1")
    with pytest.raises(ValueError, match="frozen"):
        frozen.name = "other"  # type: ignore[misc]
    assert hash(frozen) == hash(Scene.from_toml("drive_m1"))


def test_a_text_is_a_scene(tmp_path: Path) -> None:
    text = builtin_text("drive_m1")
    assert Scene.from_toml(text) == Scene.from_toml("drive_m1")
    with pytest.raises(SceneError, match=r"scene: name: .* \(line 1\)"):
        Scene.from_toml('name = "1"\n[output]\n')
