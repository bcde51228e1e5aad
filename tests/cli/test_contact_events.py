"""What contacts do is told everywhere in the same words: a bar that falls on rigid ground, whose instants are known."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from flint import arb

import wavesym
from tests.support.generated import files
from wavesym.cli import main
from wavesym.documents.inspection.document import inspection
from wavesym.exact.reference import Reference
from wavesym.running.compilation import compile_files, import_text
from wavesym.scene import Scene, lower

# Doyen, Ern, Piperno 2011: E = 900, rho = 1, L = 10, g = 10, h0 = 5, seen from the falling bar
DROP = {
    "name": "drop",
    "system": {
        "type": "chain",
        "parts": [
            {"motion": "acceleration", "name": "ground"},
            {"contact": 5},
            {"rod": 10, "speed": 30, "impedance": 30},
        ],
    },
    "load": [{"at": "ground", "times": [0], "steps": [10]}],
    "output": {"until": 5, "strain": [5], "velocity": ["0+"], "displacement": ["0+", "ground"], "tolerance": 1e-9},
}
KNOWN = [
    ("0", "closes", Fraction(1)),
    ("0", "opens", Fraction(5, 3)),
    ("0", "closes", Fraction(11, 3)),
    ("0", "opens", Fraction(13, 3)),
]
LINE = re.compile(r"contact at x = (\S+) (opens|closes) at tau = (\S+)")


def scene() -> Scene:
    return Scene(**DROP)


def agreed(told: list[tuple[str, str, str]]) -> None:
    """The same events, each tau with 20 digits."""
    assert [row[:2] for row in told] == [row[:2] for row in KNOWN]
    for (_, _, digits), (_, _, tau) in zip(told, KNOWN, strict=True):
        assert abs(Fraction(digits) - tau) < Fraction(1, 10**18)
        assert len(digits.replace(".", "")) == 20


def test_the_header_the_manifest_and_the_module() -> None:
    made = files(lower(scene()), "all")
    read = json.loads(made["drop.json"])
    agreed([(event["x"], event["kind"], event["tau"]) for event in read["events"]])
    assert read["contact_end"] == {}
    assert "#define DROP_EVENTS 4\n" in made["drop.h"]
    agreed([tuple(found) for found in re.findall(rf"^/\* {LINE.pattern} \*/$", made["drop.h"], re.MULTILINE)])
    module = import_text(made["drop.py"], "drop")
    assert [(x, kind) for x, kind, _ in module.EVENTS] == [row[:2] for row in KNOWN]
    assert [tau for *_, tau in module.EVENTS] == pytest.approx([float(tau) for *_, tau in KNOWN], rel=1e-15)


def test_the_programs_go_through_events() -> None:
    """C and NumPy have what `run` has, within their bound; the height of the lower end is what is published."""
    response = wavesym.evaluator(scene())
    taus = [0.5, 2.0, 7 / 3, 3.0, 5.0, 1.0, 4 / 3, 4.0]
    true = response(taus)
    height = 5 + true[2] - true[3]
    assert height == pytest.approx([15 / 4, 5 / 3, 40 / 9, 40 / 9, 40 / 9, 0, 0, 0], abs=1e-13)
    made = files(lower(scene()), "all")
    largest = np.abs(response(np.linspace(0, 5, 501))).max(axis=1)
    module = import_text(made["drop.py"], "drop")
    with compile_files(made, len(response.outputs)) as program:
        for values in (program(taus), module.evaluate(np.array(taus))):
            assert np.all(np.abs(values - true).max(axis=1) <= module.ERROR_BOUND * largest * 1.01)
        assert program.selftest() == 0


def test_run_and_inspect(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "drop.toml"
    file.write_text(
        """name = "drop"
        [system]
        type = "chain"
        parts = [
            { motion = "acceleration", name = "ground" },
            { contact = 5 },
            { rod = 10, speed = 30, impedance = 30 },
        ]
        [[load]]
        at = "ground"
        times = [0]
        steps = [10]
        [output]
        until = 5
        velocity = ["0+"]
        """
    )
    assert main(["run", str(file), "--samples", "2"]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("tau,velocity@0+\n0.0,0.0\n")
    agreed([LINE.fullmatch(line.removeprefix("drop: ")).groups() for line in err.splitlines()])  # type: ignore[union-attr]
    for stage in ("summary", "program"):
        read = json.loads(inspection(scene(), stage, "json"))
        agreed([(event["x"], event["kind"], event["tau"]) for event in read["events"]])
        assert "contacts" not in read
    text = inspection(scene(), "program")
    agreed(re.findall(r"^  (0)  (opens|closes) +(\S+)$", text, re.MULTILINE))
    (contact,) = json.loads(inspection(scene(), "model", "json"))["links"]
    assert [contact[key] for key in ("place", "left", "right", "ratio", "gap")] == ["0", 0, 1, "1", "5"]


def test_an_open_collision_is_told_as_one() -> None:
    system = {"type": "collision", "m": 4, "kappa": [1, 1], "velocity": [1, 0], "contacts": "open"}
    bars = Scene(name="bars", system=system, output={"until": 6, "velocity": [0]})
    read = json.loads(inspection(bars, "summary", "json"))
    assert read["system"] == {**read["system"], "type": "collision", "contacts": "open"}
    assert [(event["x"], event["kind"]) for event in read["events"]] == [("2", "opens")]
    assert [row["place"] for row in json.loads(inspection(bars, "model", "json"))["links"]] == ["2"]
    header = files(lower(bars), "c")["bars.h"]
    assert "contacts = open" in header
    assert "CONTACT_END" not in header


def test_response() -> None:
    events = wavesym.evaluator(scene()).events
    agreed([(event.x, event.kind, event.digits) for event in events])
    assert [event.double for event in events] == pytest.approx([float(tau) for *_, tau in KNOWN], rel=1e-15)
    assert wavesym.evaluator(Scene.from_toml("collision_m4")).events == ()


@pytest.mark.slow
def test_where_no_contact_can_open_nothing_is_said_of_events() -> None:
    for name in ("collision_m4", "stepped_shaft"):
        short = Scene.from_toml(name).with_({"output.until": 5})
        made = files(lower(short), "numpy")
        assert not any("EVENTS" in text or '"events"' in text for text in made.values())
        assert "events" not in json.loads(inspection(short, "program", "json"))


def test_contacts_without_events_are_counted(tmp_path: Path) -> None:
    """A gap that nobody closes: 0 events, which is not that there are no contacts."""
    parts = [{"rod": 1, "velocity": "-1/3"}, {"contact": 1}, {"rod": 1}]
    output = {"until": 3, "velocity": ["1-"], "strain": ["1/2"]}
    still = Scene(name="still", system={"type": "chain", "parts": parts}, output=output)
    strain, velocity = Reference(lower(still)).largest()
    assert strain == 0, "two waves that cancel, although 1/6 is no binary number"
    assert velocity.overlaps(arb(1) / 3)
    made = files(lower(still), "all")
    assert "#define STILL_EVENTS 0\n" in made["still.h"]
    assert json.loads(made["still.json"])["events"] == []
    assert import_text(made["still.py"], "still").EVENTS == []


@pytest.mark.parametrize(
    "command", [["tables"], ["generate", "--evaluator", "march"], ["generate", "--evaluator", "closed"]]
)
def test_what_has_no_contacts_refuses_them(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "bars.toml"
    collision = 'type = "collision"\nm = 4\nkappa = [1, 1]\nvelocity = [1, 0]\ncontacts = "open"'
    chain = 'type = "chain"\nparts = [{ rod = 1, velocity = 1 }, "contact", { rod = 1 }]'
    for system in (collision, chain):
        file.write_text(f'name = "bars"\n[system]\n{system}\n[output]\nuntil = 1\nvelocity = [0]\n')
        assert main([command[0], str(file), *command[1:]]) == 2
        out, err = capsys.readouterr()
        assert out == ""
        assert re.search(r"\bcontacts?\b", err)
        assert err.count("\n") == 1
        assert [path.name for path in tmp_path.iterdir()] == ["bars.toml"]


def test_an_event_that_may_be_at_a_double_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The two sides move alike, and what is rounded of both hides that they meet at exactly 3/2."""
    scene = tmp_path / "meet.toml"
    text = """
        name = "meet"
        system.type = "chain"
        system.parts = [
            {mass = 1, velocity = 2}, {rod = 1, velocity = 1}, {contact = 1.5}, {rod = 1}, {mass = 1, velocity = 1},
        ]
        output = {until = 4, velocity = ["1-"]}
    """
    scene.write_text(text, encoding="utf-8")
    asked = (["run", str(scene), "--samples", "9"], 2), (["generate", str(scene), "-o", str(tmp_path / "made")], 1)
    for command, status in asked:
        assert main(command) == status
        named = "the contact at x = 1, which closes where no bits tell it from tau = 1.5, helps"
        assert named in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [scene]
