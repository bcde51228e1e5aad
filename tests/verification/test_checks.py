"""Every main check is made to fail: a coefficient, a sign in the arithmetic, a digit in a table, a wrong rule."""

import importlib
import inspect
import re
import sys
from dataclasses import replace

import pytest
from flint import fmpq

from wavesym.errors import ToleranceError
from wavesym.exact import reference
from wavesym.exact.tables import table as tables
from wavesym.exact.tables.table import Function, full_table
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.programs.schemes import SCHEMES
from wavesym.rendering import text_of
from wavesym.scene import Scene, lower
from wavesym.targets import files as written
from wavesym.targets.c import kernel
from wavesym.verification import checks
from wavesym.verification.node_law import differences
from wavesym.verification.reference import known
from wavesym.verification.substitution import jumps, residuals

DRIVE = Scene(
    name="small",
    system={"type": "drive", "m": 3, "kappa": [1, 2, 1], "inertia": [1, 1, 2, 1]},
    load=[{"body": 1, "times": [0, "1/2"], "steps": [1, -1]}],
    output={"until": 4, "strain": [0, "1/3"], "displacement": [1]},
)
BUILDING = Scene(
    name="small",
    system={"type": "building", "m": 2, "kappa": [1, "1/2", "1/2"], "base": "force"},
    load=[{"times": [0], "a": [1], "b": [0]}],
    output={"until": 9, "strain": ["1/2"], "velocity": [2]},
)
COLLISION = Scene(
    name="small",
    system={"type": "collision", "m": 4, "kappa": ["1/2", "1/3"], "velocity": [1, 0]},
    output={"until": 5, "strain": [2], "velocity": ["1/2"], "displacement": [4]},
)


def verdicts(check, truth):
    return [outcome.passed for outcome in check(truth)]


@pytest.mark.parametrize("scene", [DRIVE, BUILDING, COLLISION], ids=["drive", "building", "collision"])
def test_all_is_well(scene):
    truth = known(lower(scene))
    for check in checks.CHECKS:
        assert all(verdicts(check.run, truth)), check.title


def test_of_a_long_horizon_the_beginning_is_compared(monkeypatch):
    """The code is that of the whole horizon; and the displacement goes on to grow, so that its bound is large here."""
    monkeypatch.setattr(reference, "_QUICK", 200_000)
    monkeypatch.setattr(reference, "_SHORTEST", fmpq(1))
    whole = lower(
        Scene(name="far", system=DRIVE.system, load=DRIVE.load, output=DRIVE.output.model_copy(update={"until": 40}))
    )
    truth = known(whole)
    assert 1 < truth.until == float(truth.model.until) < float(truth.whole.until)
    assert truth.whole is whole
    assert truth.notes == [f"far: compared to tau = {truth.until:g}; exact values of all of it would take too long"]
    assert all(verdicts(checks.generated, truth))
    halved = replace(truth.outputs[0], values=truth.outputs[0].values / 2)
    assert not all(verdicts(checks.generated, replace(truth, outputs=(halved, *truth.outputs[1:]))))


def made_with(monkeypatch, evaluator, change=lambda made: made):
    """Let the checks see code of one evaluator, its files changed."""
    monkeypatch.setattr(checks, "files", lambda program, language: change(written.files(program, language)))
    monkeypatch.setattr(checks, "make", lambda model, **asked: make(model, Request(evaluator), **asked))


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        ("closed.c", "sum += polynomial", "sum -= polynomial"),
        ("closed.py", "row[late] += polynomial", "row[late] -= polynomial"),
        ("pieces.c", "tau - centre[piece]", "tau + centre[piece]"),
        ("pieces.py", "powers[:, 1:] + powers[:, :1]", "powers[:, 1:] - powers[:, :1]"),
        pytest.param("march.c", "sum += gain[k] * arrived", "sum -= gain[k] * arrived", marks=pytest.mark.slow),
        pytest.param("march.py", "total += self.gain[k]", "total -= self.gain[k]", marks=pytest.mark.slow),
    ],
)
def test_a_sign_in_the_arithmetic_is_seen(file, right, wrong, monkeypatch, tmp_path):
    truth = known(lower(DRIVE))
    evaluator, language = file.split(".")
    made_with(monkeypatch, evaluator)
    assert all(verdicts(checks.generated, truth) + verdicts(checks.invariants, truth))
    if language == "c":
        assert right in text_of(f"c/{evaluator}/{file}")
        monkeypatch.setattr(kernel, "text_of", lambda other: text_of(other).replace(right, wrong))
    else:
        monkeypatch.setitem(SCHEMES, evaluator, changed(SCHEMES[evaluator], right, wrong, monkeypatch, tmp_path))
    assert not all(verdicts(checks.generated, truth))
    assert all(verdicts(checks.invariants, truth)) == (language == "c")  # which look at NumPy


def changed(scheme, right, wrong, monkeypatch, folder):
    """A scheme with one text of its file replaced."""
    text = inspect.getsource(sys.modules[scheme.__module__])
    assert right in text
    (folder / "changed_scheme.py").write_text(text.replace(right, wrong))
    monkeypatch.syspath_prepend(folder)
    monkeypatch.delitem(sys.modules, "changed_scheme", raising=False)
    return getattr(importlib.import_module("changed_scheme"), scheme.__name__)


def a_digit_changed(text, file):
    """The same program with another fifth digit in the last long decimal of its tables that is not tiny."""
    numbers = list(re.finditer(r"(?<![\w.])\d\.\d{12,}(?![\de])", text))
    assert numbers, file
    at = numbers[-1].start() + 5
    return f"{text[:at]}{(int(text[at]) + 5) % 10}{text[at + 1 :]}"


@pytest.mark.parametrize("file", ["small.c", "small.py"])
@pytest.mark.parametrize("evaluator", ["closed", "pieces", pytest.param("march", marks=pytest.mark.slow)])
def test_a_digit_in_a_generated_table_is_seen(evaluator, file, monkeypatch):
    truth = known(lower(BUILDING))
    made_with(monkeypatch, evaluator, lambda made: {**made, file: a_digit_changed(made[file], file)})
    assert not all(verdicts(checks.generated, truth))


def test_a_digit_in_a_program_breaks_the_balances(monkeypatch):
    truth = known(lower(DRIVE))
    right = checks.make

    def changed(model):
        program = right(model)
        *_, last = (number for number in program.tables["coefficient"] if abs(number) > 0.1)
        wrong = tuple(1.0001 * number if number == last else number for number in program.tables["coefficient"])
        return replace(program, tables={**program.tables, "coefficient": wrong})

    monkeypatch.setattr(checks, "make", changed)
    assert not all(verdicts(checks.invariants, truth))


@pytest.mark.parametrize("scene", [DRIVE, COLLISION], ids=["drive", "collision"])
def test_a_wrong_rule_is_seen_by_all_that_is_not_derived(scene, monkeypatch):
    """Tables of which every start is a little wrong, and all that follows from it."""
    right = tables.solve

    def wrong(own, right_side, jump):
        return right(own, right_side, jump + fmpq(1, 100000))

    monkeypatch.setattr(tables, "solve", wrong)
    system = scene.system.chain
    table = full_table(system, 4, fmpq(0))
    assert list(differences(system, table))
    assert list(jumps(system, table))
    truth = known(lower(scene))
    assert not all(verdicts(checks.integration, truth))
    assert not all(verdicts(checks.spacetime, truth))
    assert not all(verdicts(checks.invariants, truth))


@pytest.mark.parametrize("power", [0, 1])
def test_a_coefficient_of_a_table_is_seen(power):
    system = BUILDING.system.chain
    table = full_table(system, 6, fmpq(0))
    assert not [*differences(system, table), *residuals(system, table), *jumps(system, table)]
    row = [row for row in table.rows() if row.power == power][-1]
    table.responses[row.source][Function(row.function, row.rod)][row.interval - 1][row.rate][power] += fmpq(1, 10**12)
    assert list(differences(system, table))
    assert [*residuals(system, table), *jumps(system, table)]


def test_a_refusal_is_no_failure(monkeypatch):
    truth = known(lower(DRIVE))

    def refuse(model, **_):
        raise ToleranceError("small: cannot be met")

    monkeypatch.setattr(checks, "make", refuse)
    for outcome in (*checks.generated(truth), *checks.invariants(truth)):
        assert outcome.passed
        assert outcome.cells["NumPy"] == "refused"
        assert outcome.note == "small: cannot be met"
