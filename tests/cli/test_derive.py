"""`wavesym derive`: a system, a scene, or neither."""

import pytest

from wavesym.cli import main

SCENE = """
name = "mine"
[system]
type = "drive"
m = 1
kappa = [1]
inertia = [1, 2]
[output]
until = 2
strain = [0]
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(SCENE)
    return tmp_path


@pytest.mark.parametrize("source", ["mine.toml", "building_m2", "drive"])
def test_a_system_or_a_scene(source, capsys):
    assert main(["derive", source]) == 0
    assert "Family by family" in capsys.readouterr().out


@pytest.mark.parametrize("arguments", [["building", "--m", "2"], ["mine.toml", "--intervals", "2"]])
@pytest.mark.parametrize("format", ["text", "latex", "json"])
def test_walk_polynomials(arguments, format, capsys):
    assert main(["derive", "--walks", *arguments, "--format", format]) == 0
    assert "2*T_1" in capsys.readouterr().out.replace(r" \, ", "*").replace("T_{1}", "T_1")


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (
            ["drive", "--walks"],
            "wavesym derive: --walks: walks are those of one chain; with the name of a system write --m M too",
        ),
        (["drive", "--walks", "--m", "0"], "wavesym derive: --m: 0 is not supported; write 1 ... 100"),
        (["drive", "--walks", "--m", "60", "--intervals", "60"], "wavesym derive: --intervals: the walk polynomials"),
        (["drive", "--intervals", "3"], "wavesym derive: --intervals: of walks only; write --walks too"),
        (["train"], "wavesym derive: Invalid value for '{collision|drive|building}' or SCENE: 'train' is neither"),
        (
            ["mine.toml", "--m", "2"],
            "wavesym derive: --m: a scene has its own m; leave --m out, or write the name of a system",
        ),
        (["drive", "--m", "0"], "wavesym derive: --m: 0 is not supported; write 1 ... 100"),
        (["bad.toml"], "bad.toml: system.inertia: 1 numbers; write 2 (m + 1)"),
        (["."], ".: Is a directory"),
        ([], "wavesym derive: Missing argument"),
    ],
)
def test_anything_else_is_one_clear_line(arguments, expected, folder, capsys):
    (folder / "bad.toml").write_text(SCENE.replace("[1, 2]", "[1]"))
    assert main(["derive", *arguments]) == 2
    out, line = capsys.readouterr()
    assert out == ""
    assert line.startswith(expected)
    assert line.count("\n") == 1


def test_a_scene_on_a_system_too_long_to_read(folder, capsys):
    kappa = ", ".join(["1"] * 101)
    inertia = ", ".join(["1"] * 102)
    text = SCENE.replace("m = 1", "m = 101").replace("[1]", f"[{kappa}]").replace("[1, 2]", f"[{inertia}]")
    (folder / "long.toml").write_text(text)
    assert main(["derive", "long.toml"]) == 2
    assert "system.m: 101 is more than can be written out; write 100 or less" in capsys.readouterr().err
