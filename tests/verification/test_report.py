"""The verdict of `verify`: what it says when all is well, and that it can say otherwise."""

import re

import pytest

from wavesym.exact.reference import Reference
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower
from wavesym.verification import outcome, programs, report
from wavesym.verification.checks import CHECKS
from wavesym.verification.integrations import collocation_beyond, corner_changes, differences, elements, midpoints
from wavesym.verification.reference import known_outputs

CLOSED = [Request("closed")]


def drive(until=3, tolerance="1e-10", **outputs):
    return Scene(
        name="small",
        system={"type": "drive", "m": 3, "kappa": [1, 2, 1], "inertia": [1, 1, 2, 1]},
        load=[{"body": 1, "times": [0, "1/2"], "steps": [1, -1]}],
        output={"until": until, "tolerance": tolerance, **(outputs or {"strain": [0, "1/3"], "displacement": [1]})},
    )


def verify(*scenes, requests=None):
    return report.verify([(scene, lower(scene)) for scene in scenes], requests)


def found(text):
    """The tables of a report, one for each check that has something to say, as rows by column."""
    tables = [block.splitlines() for block in text.split("\n\n") if block.startswith("scene ")]
    assert len(tables) == 1 + sum(check.title in text for check in CHECKS)
    rows = []
    for header, *lines in tables:
        columns = re.split("  +", header)
        rows.append([dict(zip(columns, re.split("  +", line), strict=True)) for line in lines])
    return rows


def test_all_is_well():
    text, passed = verify(drive(until=2))
    assert passed
    assert text.isascii()
    for check in CHECKS:  # two are for corners, one for damped modes, one for long horizons
        assert (check.title in text) == (check.run not in (corner_changes, differences, elements, collocation_beyond))
    compared, integration, spacetime, invariants, extremes = found(text)
    names = [row["program"] for row in compared]
    assert names[:7] == ["run", *(f"{kind}, {of}" for kind in ("closed", "pieces", "march") for of in ("NumPy", "C"))]
    assert {"runtime kappa inertia load, C", "runtime kappa inertia load, C, others", "stream, C"} < {*names}
    for row in compared:
        if row["error"] == "refused":
            assert row["verdict"] == "-"
        else:
            assert row["verdict"] == "PASS"
            assert row["error"] == "-" or float(row["error"]) <= float(row["bound"])
            assert float(row["difference"]) <= float(row["bound"]) + float(row["allowed"])
    for table in (integration, spacetime):
        assert [row["of"] for row in table] == ["strain@0", "strain@1/3", "displacement@1"]
    assert {row["verdict"] for row in extremes} == {"PASS"}
    for row in integration:
        assert float(row["at 4N"]) <= float(row["allowed"]) <= 1e-12
    for row in spacetime:
        assert float(row["extrapolated"]) <= float(row["allowed"]) <= 1e-6 < float(row["at 4N"])
        assert row["order"] == "2.0"
    assert [(row["of"], row["to"]) for row in invariants] == [("momentum", "2"), ("energy", "2")]
    for row in invariants:
        assert float(row["reference"]) <= float(row["allowed"]) < 1e-12
        assert float(row["NumPy"]) <= float(row["its bound"]) < 1e-8
    assert {row["verdict"] for table in (integration, spacetime, invariants) for row in table} == {"PASS"}
    for block in text.split("\n\n"):
        if block.startswith("scene "):  # aligned: PASS and verdict end it
            assert len({len(line) for line in block.splitlines() if not line.endswith("-")}) <= 2


def test_an_output_that_is_0_throughout():
    text, passed = verify(drive(until=2, velocity=["5/2"], displacement=[0]), requests=CLOSED)
    assert passed
    _, integration, *_ = found(text)
    assert integration[0]["at 4N"] == "0"
    assert float(integration[1]["at 4N"]) > 0


def test_what_friction_holds_throughout_is_seen(monkeypatch):
    """Steps have it move by rounding, 1e-21, which was no zero and far less than what they may be wrong by."""
    monkeypatch.setattr(outcome, "FINE", 1e-3)
    held = {"mass": 3, "spring": 1, "friction": "1/3", "name": "m"}
    parts = [held, {"friction": "1/6"}, {"mass": 1, "name": "n", "velocity": 0}, {"rod": 1}, "fixed"]
    loads = [{"at": "n", "times": [0, 1], "steps": ["1/5", "-1/9"]}]
    output = {"until": 4, "velocity": ["m", "n"]}
    truth = known_outputs(lower(Scene(name="z", system={"type": "chain", "parts": parts}, load=loads, output=output)))
    for at_rest in midpoints(truth)[:1] + differences(truth)[:1]:
        assert 0 < float(at_rest.cells["at 4N"]) < 1e-18
        assert report._judges(at_rest.integral, truth)
    monkeypatch.setattr(Reference, "values", lambda self, taus: [[1e-20] * len(taus)] * 2)
    assert not report._judges(midpoints(truth)[0].integral, truth)


@pytest.mark.slow
def test_where_all_programs_refuse_run_is_verified():
    text, passed = verify(drive(tolerance="1e-17"))
    assert passed
    compared = {row["program"]: row["error"] for row in found(text)[0]}
    assert compared["run"] == "0"
    assert compared["closed"] == compared["pieces"] == compared["march"] == "refused"
    assert "closed: loses" in text


@pytest.mark.quick(2)
@pytest.mark.parametrize("file", ["small.c", "small.py"])
def test_wrong_values_fail(monkeypatch, file):
    right = programs.files
    wrong = {
        "small.c": ("return sum;", "return sum * (1 + 1e-9);"),
        "small.py": ("return self._values(flat)", "return (1 + 1e-9) * self._values(flat)"),
    }[file]

    def tampered(program, language):
        made = right(program, language)
        assert file not in made or wrong[0] in made[file]
        return {name: text.replace(*wrong, 1) if name == file else text for name, text in made.items()}

    monkeypatch.setattr(programs, "files", tampered)
    text, passed = verify(drive(), requests=CLOSED)
    assert not passed
    assert ("self-test" in text) == (file == "small.c")
    assert [row["verdict"] for row in found(text)[0]] == (["PASS", "FAIL"] if file == "small.c" else ["FAIL", "PASS"])


def test_values_that_are_no_numbers_fail(monkeypatch):
    right = programs.files

    def tampered(program, language):
        made = right(program, language)
        changed = "values[0, 7] = np.nan\n            return values"
        changed = f"values = self._values(flat)\n            {changed}"
        return {name: text.replace("return self._values(flat)", changed) for name, text in made.items()}

    monkeypatch.setattr(programs, "files", tampered)
    text, passed = verify(drive(), requests=CLOSED)
    assert not passed
    verdicts = [[row["verdict"] for row in table] for table in found(text)]
    assert verdicts[:2] == [["FAIL", "PASS"], ["PASS"] * 3]


@pytest.mark.slow
def test_integrations_too_coarse_to_judge_fail(monkeypatch):
    monkeypatch.setattr(outcome, "FINE", 1e-16)
    monkeypatch.setattr(outcome, "LOOSE", 1e-16)
    text, passed = verify(drive(until=3), requests=CLOSED)
    assert not passed
    assert "too coarse" in text
    assert "small: strain@0 is not verified" in text
