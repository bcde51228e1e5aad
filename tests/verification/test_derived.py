"""`verify --derived`: what it says is what was found, and a fault in any of the claims fails it."""

from dataclasses import replace

import pytest

from wavesym.cli import main
from wavesym.derivation.delay import delay_equations
from wavesym.exact import table as tables
from wavesym.systems.drive import DRIVE
from wavesym.verification import derived as module
from wavesym.verification.derived import derived


def failed(text):
    """The claims that do not hold."""
    return {line.split("  ", 1)[1].strip().rsplit("  ", 3)[0].strip() for line in text.splitlines() if "FAIL" in line}


def only_the_drive(systems):
    return [system for system in systems if system is DRIVE]


def test_all_holds(capsys):
    assert main(["verify", "--derived"]) == 0
    text = capsys.readouterr().out
    assert text.count("PASS") == len(text.splitlines()) - 1 > 50
    for system in ("collision", "drive", "building-force", "building-ground"):
        assert f"\n{system} " in text


def test_a_power_too_low_fails(monkeypatch):
    family = module.POWERS["drive"][0]
    rows = tuple(replace(row, budget=row.budget - 2) for row in family.rows[:1])
    monkeypatch.setitem(module.POWERS, "drive", (replace(family, rows=rows + family.rows[1:]),))
    text, passed = derived(only_the_drive)
    assert not passed
    assert all("no power is higher" in claim for claim in failed(text))


def test_a_wrong_equation_fails(monkeypatch):
    def wrong(system, *parameters):
        first, *others = delay_equations(system, *parameters)
        return (replace(first, right=first.right.scaled(2)), *others)

    monkeypatch.setattr(module, "delay_equations", wrong)
    text, passed = derived(only_the_drive)
    assert not passed
    assert any("node law" in claim for claim in failed(text))
    assert any("solve the delay equations" in claim for claim in failed(text))


def test_wrong_tables_fail_by_every_route_that_can_see_them(monkeypatch):
    right = tables.solve
    monkeypatch.setattr(tables, "solve", lambda own, right_side, jump: right(own, right_side, jump + 1))
    text, passed = derived(only_the_drive)
    assert not passed
    for route in ("without jumps", "in physical time", "from walk polynomials"):
        assert any(route in claim for claim in failed(text)), route


@pytest.mark.parametrize("arguments", [["--derived", "drive_m1"], ["--derived", "--published"]])
def test_one_thing_at_a_time(arguments, capsys):
    assert main(["verify", *arguments]) == 2
    assert "more than one of SCENE, --published and --derived given" in capsys.readouterr().err
