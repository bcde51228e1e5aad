"""Chains that are written out, from the command line: what is told of them, and what is refused in one line."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

import wavesym
from wavesym.cli import main
from wavesym.documents.inspection.document import inspection
from wavesym.scene import Scene

LINE = "system.type: chain has no closed form, as collision, drive and building have; take pieces, march or `run`"
SYSTEM = {
    "type": "chain",
    "parts": [
        {"mass": 2, "velocity": 1, "name": "ram"},
        {"rod": 1},
        {"joint": True, "dashpot": "1/10", "name": "seat"},
        {"spring": 3, "dashpot": "1/4"},
        {"mass": "1/2"},
        {"rod": 9, "impedance": 2},
        "fixed",
    ],
    "branch": [{"from": "seat", "name": "side", "ratio": -2, "parts": [{"rod": "1/2"}, "absorbing"]}],
}


def chain(**output: object) -> Scene:
    return Scene(name="pile", system=SYSTEM, output={"until": 4, "velocity": ["ram"], **output})


def test_the_law_of_a_joint_by_hand() -> None:
    """C = 1/10 + 1 + 2^2 1 + 1/4 at the seat of a dashpot, a rod, a gear of ratio -2 and a dashpot beside it."""
    read = json.loads(inspection(chain(), "laws", "json"))
    assert read["light_cone"] == {"modelled": [0, 1, 3], "left_out": 1}
    seat = read["joints"][1]
    assert (seat["points"], seat["ends"]) == (["seat", 2], 3)
    assert seat["M"] == [["0", "0"], ["0", "1/2"]]
    assert seat["C"] == [["107/20", "-1/4"], ["-1/4", "9/4"]]
    assert seat["K"] == [["3", "-3"], ["-3", "3"]]
    assert [joint["breakpoints"] for joint in read["joints"]] == [4, 4, 3], "0, 2, 3, 4 and 0, 1, 2, 3 and 0, 3/2, 5/2"
    assert read["not_served"]["refusal"] == LINE


def test_the_model_is_told_as_it_is() -> None:
    read = json.loads(inspection(chain(), "model", "json"))
    assert [(bar["length"], bar["speed"], bar["impedance"], bar["ratios"]) for bar in read["bars"]] == [
        ("1", "1", "1", ["1", "1"]),
        ("9", "1", "2", ["1", "1"]),
        ("1/2", "1", "1", ["-2", "1"]),
    ]
    assert [point["motion"] for point in read["points"]] == [None, None, None, "fixed", None]
    (link,) = read["links"]
    assert [link[key] for key in ("left", "right", "ratio", "stiffness", "damping")] == [1, 2, "1", "3", "1/4"]


def test_the_header_lists_the_parts(tmp_path: Path) -> None:
    header = next(path for path in wavesym.generate(chain(), tmp_path) if path.suffix == ".h").read_text()
    said = " ".join(header.replace("\n *", " ").split())
    assert "parts = mass 2, velocity 1, name ram | rod 1 | joint, dashpot 1/10, name seat | spring 3" in said
    assert "branch side = from seat, ratio -2: rod 1/2 | absorbing" in said
    assert "places in lengths, tau in lengths at speed 1" in said


BOB = "joint at bob has the polynomial s^2 + s + 1, and exact tables support only those with factors s + g, g rational"
NO_PAPER = "as collision, drive and building have"


@pytest.mark.parametrize(
    ("command", "line"),
    [
        (["tables", "swinging.toml"], BOB),
        (["generate", "swinging.toml", "--evaluator", "closed"], BOB),
        (["tables", "geared_drive", "--symbolic"], f"chain has no --symbolic, {NO_PAPER}"),
        (["derive", "geared_drive", "--walks"], f"chain has no --walks, {NO_PAPER}"),
        (
            ["tables", "geared_drive", "--intervals", "500"],
            "--intervals: the tables would hold more than",
        ),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_what_is_not_served_is_one_line(
    command: list[str], line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("swinging.toml").write_text(
        'name = "swinging"\n[system]\ntype = "chain"\n'
        'parts = [{ mass = 1, spring = 1, velocity = 1, name = "bob" }, { rod = 1 }]\n'
        "[output]\nuntil = 1\nvelocity = [0]\n"
    )
    assert main(command) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert line in err
    assert err.startswith(f"{command[1]}: ")
    assert err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["swinging.toml"]


def test_tables_of_a_chain(capsys: pytest.CaptureFixture[str]) -> None:
    """A rod's name or number, NODE:step, the tau at which the wave leaves; by hand: (D + 1) q = 1 at the disc."""
    assert main(["tables", "stepped_shaft"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "function,rod,source,interval,rate,power,value"
    assert lines[1:5] == [
        "f,1,disc:step,0,0,0,1",
        "f,1,disc:step,0,1,0,-1",
        "f,1,disc:step,2,0,0,-3/5",
        "f,1,disc:step,2,1,0,3/5",
    ]
    assert main(["tables", "stepped_shaft", "--format", "json", "--intervals", "2"]) == 0
    read = json.loads(capsys.readouterr().out)
    assert read.keys() == {"name", "rows"}
    assert read["rows"][-1]["interval"] == "4", "3 and twice through the second rod"
    assert main(["tables", "stepped_shaft", "--format", "latex", "--intervals", "1"]) == 0
    assert "when it leaves its end of the rod" in capsys.readouterr().out
    rows = wavesym.tables(Scene.from_toml("stepped_shaft"), 2)
    assert [str(row.interval) for row in rows][-1] == "4"
    assert all(isinstance(row.interval, Fraction) for row in rows)


def test_a_march_is_generated_and_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", "geared_drive", "--evaluator", "march", "--language", "all", "-o", str(tmp_path)]) == 0
    assert capsys.readouterr().err.startswith("geared_drive: march, degree ")
    told = json.loads((tmp_path / "geared_drive.json").read_text())
    assert (told["evaluator"], told["command"]) == ("march", "wavesym generate geared_drive.toml --evaluator march")
    assert "on steps of 1/2" in told["reason"]
    assert 0 < told["error_bound"] < 1e-8


def test_a_march_on_too_fine_a_step_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "fine.toml"
    lines = 'name = "fine"', "[system]", 'type = "chain"', "parts = [{ rod = 1, strain = 1 }, { rod = 1.001 }]"
    file.write_text("\n".join([*lines, "[output]", "until = 3", "velocity = [0]"]))
    assert main(["generate", str(file), "--evaluator", "march", "-o", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert "delays 1, 1001/1000 have the common measure 1/1000" in err
    assert 'speed_adjustment = "0.5 %" under [system], or pieces, help' in err
    for options in (["--stream"], ["--runtime", "impedance"]):  # with which pieces do not go
        assert main(["generate", str(file), *options, "-o", str(tmp_path / "out")]) == 2
        assert 'speed_adjustment = "0.5 %" under [system] helps' in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_chain_that_moves_is_not_told_to_be_still(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bar.toml"
    lines = 'name = "bar"', "[system]", 'type = "chain"', "parts = [{ rod = 1, strain = 1 }]"
    file.write_text("\n".join([*lines, "[output]", "until = 1", "velocity = [0]"]))
    assert main(["run", str(file), "--samples", "2"]) == 0
    assert "no load" not in capsys.readouterr().err


def test_a_joint_that_nothing_holds_is_refused() -> None:
    """A dashpot between two joints that hang on springs alone."""
    parts = [{"rod": 1}, {"spring": 1}, {"joint": True}, {"dashpot": 1}, {"joint": True}, {"spring": 1}, {"rod": 1}]
    with pytest.raises(wavesym.SceneError, match="without mass, rod or dashpot"):
        Scene(name="loose", system={"type": "chain", "parts": parts}, output={"until": 1, "velocity": [0]})


@pytest.mark.parametrize(("end", "quantity"), [("fixed", "velocity"), ("free", "strain"), ("fixed", "displacement")])
def test_what_an_end_keeps_at_0_is_0_and_can_be_generated(end: str, quantity: str, tmp_path: Path) -> None:
    system = {"type": "chain", "parts": [{"mass": 4, "velocity": 1}, {"rod": 1}, end]}
    scene = Scene(name="bar", system=system, output={"until": 6, quantity: ["1", "1/2"]})
    assert not wavesym.evaluator(scene)([0.5, 2.5, 6.0])[0].any()
    assert wavesym.generate(scene, tmp_path)


def test_an_absorbing_end_sends_nothing_back() -> None:
    """Ahead of it strain and velocity stay opposite, to the last bit."""
    system = {"type": "chain", "parts": [{"mass": 4, "velocity": 1}, {"rod": 1, "impedance": "1/3"}, "absorbing"]}
    scene = Scene(name="bar", system=system, output={"until": 9, "strain": ["1/2"], "velocity": ["1/2"]})
    strain, velocity = wavesym.evaluator(scene)([k / 7 for k in range(63)])
    assert velocity.any()
    assert (strain == -velocity).all()
