"""`generate --windows`: what a march that will be driven by hand is made for, and what is refused."""

import json
import re
import time

import pytest

from wavesym.cli import main
from wavesym.programs.march.evaluator import marched
from wavesym.scene import Scene, lower

SCENE = """name = "mine"
[system]
type = "drive"
m = 1
kappa = [1]
inertia = [1, 2]
[[load]]
body = 1
times = [0]
steps = [1]
[output]
until = 2
tolerance = 1e-6
strain = [0.5]
velocity = [1]
"""
COLLISION = """name = "mine"
[system]
type = "collision"
m = 4
kappa = [1, 2]
velocity = [1, 0]
[output]
until = 2
tolerance = 1e-6
strain = [2]
"""


@pytest.fixture
def asked(tmp_path, monkeypatch, capsys):
    """Status, standard output and error of `generate`, and its seconds."""
    monkeypatch.chdir(tmp_path)

    def ask(text, *options):
        (tmp_path / "mine.toml").write_text(text)
        begun = time.process_time()
        status = main(["generate", "mine.toml", *options])
        out, err = capsys.readouterr()
        return status, out, err, time.process_time() - begun

    return ask


def test_header_and_manifest_say_what_is_proved(asked, tmp_path):
    status, _, err, _ = asked(SCENE, "--evaluator", "march", "--windows", "300", "--language", "all")
    assert (status, err.count("\n")) == (0, 1)
    proved = marched(lower(Scene.from_toml("mine.toml")), windows=300).given
    header = (tmp_path / "mine/mine.h").read_text()
    assert re.findall(r"#define MINE_WINDOWS (\S+)", header) == ["300"]
    (printed,) = re.findall(r"#define MINE_GIVEN_ERROR (\S+)", header)
    assert float(printed) == max(proved.errors)
    manifest = json.loads((tmp_path / "mine/mine.json").read_text())
    assert manifest["windows"] == 300
    assert manifest["given_error"] == dict(zip(("strain@0.5", "velocity@1"), proved.errors, strict=True))
    assert "polynomials of degree\n * 4 or less" in header


def test_without_it_nothing_is_said(asked, tmp_path):
    assert asked(SCENE, "--evaluator", "march")[0] == 0
    assert "WINDOWS" not in (tmp_path / "mine/mine.h").read_text()
    assert not {"windows", "given_error"} & set(json.loads((tmp_path / "mine/mine.json").read_text()))


@pytest.mark.parametrize(
    ("text", "options", "line"),
    [
        (SCENE, ["--windows", "9"], "--windows goes with --evaluator march, auto given"),
        (SCENE, ["--evaluator", "pieces", "--windows", "9"], "--windows goes with --evaluator march, pieces given"),
        (SCENE, ["--evaluator", "closed", "--windows", "9"], "--windows goes with --evaluator march, closed given"),
        (COLLISION, ["--evaluator", "march", "--windows", "9"], "--windows: no load can be given here"),
        (SCENE, ["--evaluator", "march", "--windows", "0"], "0 is not in the range"),
        (SCENE, ["--evaluator", "march", "--windows", "-3"], "-3 is not in the range"),
        (SCENE, ["--evaluator", "march", "--windows", "2147483647"], "2147483647 is not in the range"),
        (SCENE, ["--evaluator", "march", "--windows", "2147483646"], "polynomials of degree"),
        (SCENE, ["--evaluator", "march", "--windows", "1000000"], "--windows: a march of degree "),
    ],
)
def test_what_makes_no_sense_or_costs_too_much_is_refused_in_one_line(asked, tmp_path, text, options, line):
    status, out, err, seconds = asked(text, *options)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert line in err
    assert seconds < 2
    assert not (tmp_path / "mine").exists()
