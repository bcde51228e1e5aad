"""Options that are times take them with units where the scene has units."""

from __future__ import annotations

import re
import shlex
from fractions import Fraction
from pathlib import Path

import pytest

import wavesym
from wavesym.cli import main
from wavesym.scene import Scene


def written(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir()}


def test_a_step_in_milliseconds_is_one_in_tau(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["init", "drive", "-o", str(tmp_path / "d.toml")]) == 0
    scale = Scene.from_toml(tmp_path / "d.toml").scale
    assert scale is not None
    milliseconds = scale.seconds * 1000 / 2
    for name, step in (("a", f"{milliseconds} ms"), ("b", "1/2")):
        arguments = ["generate", str(tmp_path / "d.toml"), "--stream", "--step", step, "-o", str(tmp_path / name)]
        assert main(arguments) == 0, capsys.readouterr().err
    assert written(tmp_path / "a") == written(tmp_path / "b")


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["generate", "drive_m1", "--stream", "--step", "1 ms"], "no [units]"),
        (["generate", "drive_m1", "--stream", "--step", "-1"], "is not a positive time"),
        (["formula", "drive_m1", "--output", "strain@0", "--until", "2 m"], "is not a positive time"),
        (["tables", "drive", "--m", "3"], "drive_equal"),
    ],
)
def test_what_is_no_time_is_one_line(arguments: list[str], what: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    err = capsys.readouterr().err
    assert what in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("step", "typed"), [("0.25 ms", '--step "0.00025 s"'), ("0.00025 s", '--step "0.00025 s"'), ("1/8", "--step 1/8")]
)
def test_headers_of_streams_say_the_step_in_the_unit_of_time(
    step: str, typed: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """And the command in them makes the same files again."""
    scene = tmp_path / "drive.toml"
    assert main(["init", "drive", "-o", str(scene)]) == 0
    assert main(["generate", str(scene), "--stream", "--step", step, "-o", str(tmp_path / "made")]) == 0, (
        capsys.readouterr().err
    )
    (header,) = (tmp_path / "made").glob("*.h")
    text = header.read_text()
    assert typed in text.splitlines()[0]
    (panel,) = re.findall(r"#define \w+_PANEL (\S+)", text)
    (seconds,) = re.findall(r"#define \w+_SECONDS_PER_TAU (\S+)", text)
    (every,) = re.findall(r"#define \w+_STEP (\S+)", text)
    meant = 1 / 8 if step == "1/8" else 0.00025 / float(seconds)
    assert abs(float(every) / meant - 1) < 1e-15
    assert f"/* How long a panel is, in tau: {float(panel) * float(seconds) * 1000:.9g} ms. */" in text
    command = shlex.split(text.splitlines()[0].partition("command: wavesym ")[2])
    command[1] = str(scene)
    assert main([*command, "-o", str(tmp_path / "again")]) == 0
    assert written(tmp_path / "made") == written(tmp_path / "again")


def test_a_step_that_is_refused_is_a_decimal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """0.25 ms are no short number of tau."""
    scene = tmp_path / "drive.toml"
    assert main(["init", "drive", "-o", str(scene)]) == 0
    assert main(["generate", str(scene), "--step", "0.25 ms", "-o", str(tmp_path / "made")]) == 2
    err = capsys.readouterr().err
    found = re.search(r"--step: (\S+) tau ", err)
    assert found, err
    tau = Fraction(1, 4000) / wavesym.Scene.from_toml(scene).scale.seconds  # type: ignore[union-attr]
    assert "." in found[1]
    assert float(found[1]) == pytest.approx(float(tau), rel=1e-5)
    assert len(found[1]) <= 12
