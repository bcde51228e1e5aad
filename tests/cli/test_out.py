"""Where `-o` says so the same text goes to a file, whole; the scene itself is never replaced."""

from __future__ import annotations

from pathlib import Path

import pytest

from wavesym.cli import main

COMMANDS = [
    "summary drive_m1",
    "init frame",
    "scenes drive_m1",
    "inspect drive_m1 --stage laws",
    "derive drive",
    "schema",
]


@pytest.mark.quick(3)
@pytest.mark.parametrize("words", COMMANDS)
def test_the_same_text_goes_to_a_file(words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words.split()) == 0
    printed = capsys.readouterr().out
    assert main([*words.split(), "-o", str(tmp_path / "out.txt")]) == 0
    assert capsys.readouterr().out == ""
    assert (tmp_path / "out.txt").read_text(encoding="utf-8") == printed


@pytest.mark.parametrize("command", ["summary", "inspect", "advise", "derive"])
def test_a_scene_is_not_replaced(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes", "drive_m1", "-o", str(tmp_path / "mine.toml")]) == 0
    text = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    assert main([command, str(tmp_path / "mine.toml"), "-o", str(tmp_path / "mine.toml")]) == 2
    assert "is the scene itself; write another file" in capsys.readouterr().err
    assert (tmp_path / "mine.toml").read_text(encoding="utf-8") == text


@pytest.mark.parametrize("words", ["init frame", "scenes drive_m1", "run drive_m1"])
def test_another_scene_is_not_replaced_either(words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.toml").write_text("# edited for days\n")
    assert main([*words.split(), "-o", str(tmp_path / "mine.toml")]) == 2
    assert "mine.toml is there already, and may be a scene of yours; write another file" in capsys.readouterr().err
    assert (tmp_path / "mine.toml").read_text() == "# edited for days\n"


def test_a_file_in_no_folder_is_refused_before_the_work(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "plain").write_text("")
    assert main(["verify", "--derived", "-o", str(tmp_path / "plain" / "out.txt")]) == 2
    assert "Not a directory" in capsys.readouterr().err
