"""`verify --derived`: what it says is what was found, and a fault in any of the claims fails it."""

from dataclasses import replace

import pytest

from wavesym.cli import main
from wavesym.derivation import table as tables
from wavesym.derivation.delay import delay_equations
from wavesym.systems.drive import DRIVE
from wavesym.verification import derivation_report as module
from wavesym.verification.derivation_report import derivation_report

THEOREMS = (
    "The delay equations are the node law, for all i and m.",
    "The recurrences solve the delay equations, for all i, m, n and k.",
    "No power is higher than is stated, for all i, m, n, l and s.",
    "Tables are what walk polynomials give.",
)


def sections(text):
    """The lines under each theorem."""
    blocks = [block.splitlines() for block in text.strip().split("\n\n")]
    return {claim: lines for claim, *lines in blocks}


def failed(text):
    """The theorems that do not hold for all."""
    return {claim for claim, lines in sections(text).items() if any(line.startswith("  FAIL") for line in lines)}


def only_the_drive(systems):
    return [system for system in systems if system is DRIVE]


@pytest.mark.slow
def test_all_holds(capsys):
    assert main(["verify", "--derived"]) == 0
    found = sections(capsys.readouterr().out)
    assert tuple(found) == THEOREMS
    for lines in found.values():
        proofs = [line for line in lines if line.startswith("  PASS")]
        for system in ("collision", "drive", "drive-ramps", "building-force", "building-ground"):
            assert any(line.startswith(f"  PASS  {system}") for line in proofs)
        # the argument stands before its proofs, in sentences
        argument = " ".join(" ".join(lines[: lines.index(proofs[0])]).split())
        assert argument.endswith(".")
        assert len(argument) > 150


def test_arguments_say_what_was_gone_through():
    text, passed = derivation_report(only_the_drive)
    assert passed
    law, solved, powers, *_ = (" ".join(" ".join(lines).split()) for lines in sections(text).values())
    assert "f_1: s + kappa_1 and 1" in law
    assert "leaves (b - a g) F[g,k] + a (k + 1) F[g,k+1] at exp(-g w) w^k, and a sum_g F[g,0] at the front" in solved
    assert "equal shafts, equal discs: 29 of 29 residuals Functions: f_1, g_i, f_i and g_m." in solved
    assert "Rates: any g; 0, kappa_1, 2 kappa_1." in solved
    assert "f_i (i = 1, 2, ..., m) floor((n - |i - l| - |l - s| - 1)/2), since n - |i - s| - 1" in powers
    assert "n drops out of the differences" in powers


@pytest.mark.slow
def test_an_argument_follows_what_is_proved(monkeypatch):
    """What is told is taken from the rows and the laws, not written beside them."""
    family = module.FAMILIES["drive"][0]
    rows = tuple(replace(row, budget=row.budget - 6) for row in family.rows)
    monkeypatch.setitem(module.FAMILIES, "drive", (replace(family, rows=rows),))
    text, _ = derivation_report(only_the_drive)
    assert "floor((n - |i - l| - |l - s| - 7)/2)" in " ".join(text.split())


@pytest.mark.slow
def test_a_power_too_low_fails(monkeypatch):
    family = module.FAMILIES["drive"][0]
    rows = tuple(replace(row, budget=row.budget - 2) for row in family.rows[:1])
    monkeypatch.setitem(module.FAMILIES, "drive", (replace(family, rows=rows + family.rows[1:]),))
    text, passed = derivation_report(only_the_drive)
    assert not passed
    assert failed(text) == {THEOREMS[2]}
    assert "is not at least 0" in text


def test_a_wrong_equation_fails(monkeypatch):
    def wrong(system, *parameters):
        first, *others = delay_equations(system, *parameters)
        return (replace(first, right=first.right.scale(2)), *others)

    monkeypatch.setattr(module, "delay_equations", wrong)
    text, passed = derivation_report(only_the_drive)
    assert not passed
    assert set(THEOREMS[:2]) <= failed(text)
    assert "Not so: the equation of f of rod 1 leaves" in text


@pytest.mark.slow
def test_wrong_tables_fail_by_every_route_that_can_see_them(monkeypatch):
    right = tables.solve
    monkeypatch.setattr(tables, "solve", lambda own, right_side, jump: right(own, right_side, jump + 1))
    text, passed = derivation_report(only_the_drive)
    assert not passed
    assert failed(text) == set(THEOREMS[3:])


@pytest.mark.parametrize("arguments", [["--derived", "drive_m1"], ["--derived", "--published"]])
def test_one_thing_at_a_time(arguments, capsys):
    assert main(["verify", *arguments]) == 2
    assert "SCENE, --published and --derived exclude each other" in capsys.readouterr().err
