"""The house is as it is told: a scene is lowered once, no room is too large."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

import wavesym
from wavesym import api
from wavesym.mechanics import chain
from wavesym.scene import Scene, lower

PACKAGE = Path(wavesym.__file__).parent
TEMPLATES = PACKAGE.parent / "templates"
LARGEST = 1 / 5
"""Of all lines, what one room may have."""


def sources() -> Iterator[tuple[Path, str]]:
    for path in sorted(PACKAGE.rglob("*.py")):
        yield path.relative_to(PACKAGE), path.read_text(encoding="utf-8")


def test_no_room_has_more_than_a_fifth_of_the_lines() -> None:
    rooms: Counter[str] = Counter()
    for path, text in sources():
        rooms[room_of(path)] += text.count("\n")
    templates = (path for path in TEMPLATES.rglob("*") if path.is_file())
    rooms["templates"] = sum(path.read_text(encoding="utf-8").count("\n") for path in templates)
    (room, most), *_ = rooms.most_common(1)
    assert most <= LARGEST * rooms.total(), room


def room_of(path: Path) -> str:
    """The first folder; a paper's own folder is a room of its own."""
    room, *inner = path.parts
    return f"{room}/{inner[0]}" if room == "papers" and len(inner) > 1 and inner[0] != "pages" else room


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often scenes are lowered, and nodes of chains written out."""
    counted: Counter[str] = Counter()
    right_node = chain._exact_node

    def counting(scene):
        counted["models"] += 1
        return lower(scene)

    def node(given):
        counted["nodes"] += 1
        return right_node(given)

    monkeypatch.setattr(api, "lower", counting)
    monkeypatch.setattr(chain, "_exact_node", node)
    return counted


@pytest.mark.parametrize("name", ["building_m2", "collision_m4", "drive_m1"])
def test_generate_lowers_a_scene_once(built: Counter[str], name: str, tmp_path: Path) -> None:
    scene = Scene.from_toml(name)
    api.generate(scene, tmp_path, "all")
    assert built == {"models": 1, "nodes": scene.system.m + 1}


def test_verify_lowers_a_scene_once(built: Counter[str]) -> None:
    scene = Scene.from_toml("drive_m1")
    _, passed = api.verify([scene], "closed")
    assert passed
    assert built == {"models": 1, "nodes": scene.system.m + 1}


def test_plot_lowers_a_scene_once(built: Counter[str], tmp_path: Path) -> None:
    scene = Scene.from_toml("collision_m4")
    api.plot(scene, tmp_path / "picture.svg")
    assert built == {"models": 1, "nodes": scene.system.m + 1}


def test_values_lower_a_scene_once(built: Counter[str]) -> None:
    scene = Scene.from_toml("building_m2")
    assert api.evaluator(scene)([1.0]).shape == (6, 1)
    assert built == {"models": 1, "nodes": scene.system.m + 1}
