"""The JSON schema of scenes, as an editor reads it."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

import wavesym
from wavesym.cli import main
from wavesym.scene import builtin_names, builtin_text
from wavesym.scene.first_scene import KINDS, first_text
from wavesym.scene.schema import scene_schema

ROOT = Path(wavesym.__file__).parents[1]
EXAMPLES = sorted(
    path for path in (ROOT / "examples").rglob("*.toml") if "[system]" in path.read_text(encoding="utf-8")
)
READER = Draft202012Validator(json.loads(scene_schema()))


def wrong(table: dict[str, Any]) -> list[str]:
    return [error.message for error in READER.iter_errors(table)]


def test_it_is_a_schema() -> None:
    Draft202012Validator.check_schema(READER.schema)


@pytest.mark.parametrize("text", [*map(builtin_text, builtin_names()), *map(first_text, KINDS)])
def test_scenes_of_ours_are_right(text: str) -> None:
    assert not wrong(tomllib.loads(text))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_scenes_of_examples_are_right(path: Path) -> None:
    assert not wrong(tomllib.loads(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    "path", ["name", "system.type", "system.kappa", "output.strain", "load"], ids=lambda path: f"without {path}"
)
def test_a_key_that_is_misspelt_is_marked(path: str) -> None:
    table = tomllib.loads(builtin_text("drive_m1"))
    *above, key = path.split(".")
    inner = table[above[0]] if above else table
    inner[f"{key}s_"] = inner.pop(key)
    assert wrong(table)


def test_the_command_writes_it_and_init_names_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "scene.schema.json"
    assert main(["schema", "-o", str(file)]) == 0
    assert file.read_text() == scene_schema()
    assert main(["schema"]) == 0
    assert capsys.readouterr().out == scene_schema()
    assert main(["init", "frame"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == f"#:schema {file.name}"


def test_a_part_of_a_chain_is_known() -> None:
    table = {"name": "bar", "system": {"type": "chain", "parts": ["fixed", {"rod": 1, "impedence": 2}]}}
    assert wrong(table)
    table["system"]["parts"][1] = {"rod": 1, "impedance": 2}  # type: ignore[index]
    assert not wrong(table)
