"""The verdict of `verify`: what it says when all is well, and that it can say otherwise."""

import re

import pytest

from wavesym.scene import Scene, lower
from wavesym.verification import checks
from wavesym.verification.checks import CHECKS, damped, records
from wavesym.verification.contacts import fronts, happening
from wavesym.verification.report import verify


def drive(until=3, tolerance="1e-10", **outputs):
    return Scene(
        name="small",
        system={"type": "drive", "m": 3, "kappa": [1, 2, 1], "inertia": [1, 1, 2, 1]},
        load=[{"body": 1, "times": [0, "1/2"], "steps": [1, -1]}],
        output={"until": until, "tolerance": tolerance, **(outputs or {"strain": [0, "1/3"], "displacement": [1]})},
    )


def found(text):
    """The tables of a report, one for each check that has something to say, as rows by column."""
    tables = [block.splitlines() for block in text.split("\n\n") if block.startswith("scene ")]
    assert len(tables) == sum(check.title in text for check in CHECKS)
    rows = []
    for header, *lines in tables:
        columns = re.split("  +", header)
        rows.append([dict(zip(columns, re.split("  +", line), strict=True)) for line in lines])
    return rows


def test_all_is_well():
    text, passed = verify(map(lower, [drive(), drive(until=2)]))
    assert passed
    assert text.isascii()
    assert max(map(len, text.splitlines())) <= 120
    for check in CHECKS:  # two are for chains that are written out, two for modes
        assert (check.title in text) == (check.run not in (fronts, happening, damped, records))
    generated, integration, spacetime, invariants = found(text)
    for table in (generated, integration, spacetime):
        assert [row["of"] for row in table] == ["strain@0", "strain@1/3", "displacement@1"] * 2
    for row in generated:
        assert max(float(row["C"]), float(row["NumPy"])) <= float(row["bound"])
    for row in integration:
        assert float(row["at 4N"]) <= float(row["allowed"]) <= 1e-6
        assert row["order"] in ("-", "3.9", "4.0", "4.1")
    for row in spacetime:
        assert float(row["extrapolated"]) <= float(row["allowed"]) <= 1e-6 < float(row["at 4N"])
        assert row["order"] == "2.0"
    assert [(row["of"], row["to"]) for row in invariants] == [(of, to) for to in "32" for of in ("momentum", "energy")]
    for row in invariants:
        assert float(row["reference"]) <= float(row["allowed"]) < 1e-12
        assert float(row["NumPy"]) <= float(row["its bound"]) < 1e-8
    assert {row["verdict"] for table in (generated, integration, spacetime, invariants) for row in table} == {"PASS"}
    for block in text.split("\n\n"):
        if block.startswith("scene "):  # aligned: PASS and verdict end it
            assert len({len(line) for line in block.splitlines()}) <= 2


def test_an_output_that_is_0_throughout():
    text, passed = verify(map(lower, [drive(until=2, velocity=["5/2"], displacement=[0])]))
    assert passed
    generated, integration, spacetime, _ = found(text)
    assert [generated[0][column] for column in ("C", "NumPy", "bound")] == ["0"] * 3
    assert integration[0]["at 4N"] == spacetime[0]["at 4N"] == "0"
    assert float(integration[1]["at 4N"]) > 0
    assert float(spacetime[1]["at 4N"]) > 0


def test_a_closed_form_that_refuses_is_no_failure():
    text, passed = verify(map(lower, [drive(tolerance="1e-17")]))
    assert passed
    assert {row["C"] for row in found(text)[0]} == {"refused"}
    assert "closed: loses" in text


@pytest.mark.parametrize("file", ["small.c", "small.py"])
def test_wrong_values_fail(monkeypatch, file):
    right = checks.files
    wrong = {
        "small.c": ("return sum;", "return sum * (1 + 1e-9);"),
        "small.py": ("return out.reshape", "out *= 1 + 1e-9\n        return out.reshape"),
    }[file]

    def tampered(program, language):
        made = right(program, language)
        assert wrong[0] in made[file]
        return {**made, file: made[file].replace(*wrong, 1)}

    monkeypatch.setattr(checks, "files", tampered)
    text, passed = verify(map(lower, [drive()]))
    assert not passed
    assert "FAIL" in text
    assert ("self-test" in text) == (file == "small.c")


def test_values_that_are_no_numbers_fail(monkeypatch):
    right = checks.files

    def tampered(program, language):
        made = right(program, language)
        text = made["small.py"].replace("return out.reshape", "out[0, 7] = np.nan\n        return out.reshape")
        return {**made, "small.py": text}

    monkeypatch.setattr(checks, "files", tampered)
    text, passed = verify(map(lower, [drive()]))
    assert not passed
    assert [[row["verdict"] for row in table] for table in found(text)] == [
        ["FAIL", "PASS", "PASS"],
        ["PASS"] * 3,
        ["PASS"] * 3,
        ["PASS"] * 2,
    ]


def test_an_integration_too_coarse_to_tell_fails(monkeypatch):
    monkeypatch.setattr(checks, "FINE", 1e-12)
    monkeypatch.setattr(checks, "_MOST_DOUBLES", 1)
    text, passed = verify(map(lower, [drive()]))
    assert not passed
    assert "too coarse" in text
