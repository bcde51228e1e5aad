"""The verdict of `verify`: what it says when all is well, and that it can say otherwise."""

import pytest

from wavesym.scene import Scene
from wavesym.verification import checks
from wavesym.verification.report import verify


def drive(until=3, tolerance="1e-10", **outputs):
    return Scene(
        name="small",
        system={"type": "drive", "m": 3, "kappa": [1, 2, 1], "inertia": [1, 1, 2, 1]},
        load=[{"body": 1, "times": [0, "1/2"], "steps": [1, -1]}],
        output={"until": until, "tolerance": tolerance, **(outputs or {"strain": [0, "1/3"], "displacement": [1]})},
    )


def rows(text):
    header, *lines = text.split("\n\n")[0].splitlines()
    columns = header.replace("at ", "at").split()
    return [dict(zip(columns, line.split(), strict=True)) for line in lines]


def test_all_is_well():
    text, passed = verify([drive(), drive(until=2)])
    assert passed
    assert text.isascii()
    found = rows(text)
    assert [row["output"] for row in found] == ["strain@0", "strain@1/3", "displacement@1"] * 2
    for row in found:
        assert row["verdict"] == "PASS"
        assert max(float(row["C"]), float(row["NumPy"])) <= float(row["bound"])
        assert float(row["at4N"]) <= float(row["allowed"]) <= 1e-6
        assert row["order"] in ("-", "3.9", "4.0", "4.1")
    assert len({len(line) for line in text.split("\n\n")[0].splitlines()}) <= 2  # aligned: PASS and verdict end it


def test_an_output_that_is_0_throughout():
    text, passed = verify([drive(until=2, velocity=["5/2"], displacement=[0])])
    assert passed
    zero, other = rows(text)
    assert [zero[column] for column in ("C", "NumPy", "bound", "at4N")] == ["0"] * 4
    assert float(other["at4N"]) > 0


def test_a_closed_form_that_refuses_is_no_failure():
    text, passed = verify([drive(tolerance="1e-17")])
    assert passed
    assert {row["C"] for row in rows(text)} == {"refused"}
    assert "closed: loses" in text


@pytest.mark.parametrize("file", ["small.c", "small.py"])
def test_wrong_values_fail(monkeypatch, file):
    right = checks.files
    wrong = {
        "small.c": ("return sum;", "return sum * (1 + 1e-9);"),
        "small.py": ("return out.reshape", "out *= 1 + 1e-9\n    return out.reshape"),
    }[file]

    def tampered(scene, language):
        made = right(scene, language)
        assert wrong[0] in made[file]
        return {**made, file: made[file].replace(*wrong)}

    monkeypatch.setattr(checks, "files", tampered)
    text, passed = verify([drive()])
    assert not passed
    assert "FAIL" in text
    assert ("self-test" in text) == (file == "small.c")


def test_values_that_are_no_numbers_fail(monkeypatch):
    right = checks.files

    def tampered(scene, language):
        made = right(scene, language)
        text = made["small.py"].replace("return out.reshape", "out[0, 7] = np.nan\n    return out.reshape")
        return {**made, "small.py": text}

    monkeypatch.setattr(checks, "files", tampered)
    text, passed = verify([drive()])
    assert not passed
    assert [row["verdict"] for row in rows(text)] == ["FAIL", "PASS", "PASS"]


def test_an_integration_too_coarse_to_tell_fails(monkeypatch):
    monkeypatch.setattr(checks, "_FINE", 1e-12)
    monkeypatch.setattr(checks, "_MOST_DOUBLES", 1)
    text, passed = verify([drive()])
    assert not passed
    assert "too coarse" in text
