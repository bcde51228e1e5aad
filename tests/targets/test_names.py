"""Names of scenes whose files would hide what programs include or import."""

from __future__ import annotations

from pathlib import Path

import pytest

from wavesym.cli import main
from wavesym.scene.scene_file import builtin_text


def made(name: str, language: str, folder: Path) -> int:
    scene = folder / "scene.toml"
    scene.write_text(builtin_text("drive_m1").replace('"drive_m1"', f'"{name}"'))
    return main(["generate", str(scene), "--language", language, "-o", str(folder / "made")])


@pytest.mark.parametrize(
    ("name", "language", "hidden"),
    [
        ("math", "numpy", "math.py"),
        ("json", "all", "json.py"),
        ("math", "c", "<math.h>"),
        ("Math", "c", "<math.h>"),  # where capitals do not matter to files
        ("string", "c", "<string.h>"),
    ],
)
def test_a_name_that_hides_a_module_or_a_header_is_refused(
    name: str, language: str, hidden: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert made(name, language, tmp_path) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert hidden in line
    assert f'write another name, such as "{name}_scene"' in line
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize(("name", "language"), [("json", "c"), ("Math", "numpy"), ("math_scene", "all")])
def test_other_names_stay(name: str, language: str, tmp_path: Path) -> None:
    assert made(name, language, tmp_path) == 0
