"""Every main check is made to fail: a digit in a table, a wrong law, an extreme that is none."""

import re
from dataclasses import replace
from functools import partial
from itertools import pairwise
from types import SimpleNamespace

import pytest
from flint import fmpq

from wavesym.derivation.increments import combine
from wavesym.errors import ToleranceError
from wavesym.exact import reference
from wavesym.exact.extremes import extremes
from wavesym.exact.motion import Motion
from wavesym.exact.tables.network_table import RuledNetwork
from wavesym.numbers.doubles import not_below
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower
from wavesym.targets import files as written
from wavesym.verification import checks, integrations, programs
from wavesym.verification.independent import independent_model
from wavesym.verification.programs import compare_programs
from wavesym.verification.reference import known_outputs

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


def compared(scene, truth, evaluator="auto"):
    """The verdicts on C and NumPy of an evaluator, against exact values alone."""
    outcomes = compare_programs(scene, truth, [None] * len(truth.outputs), [Request(evaluator)])
    assert {outcome.subject.partition(", ")[2] for outcome in outcomes} == {"C", "NumPy"}
    return [outcome.passed for outcome in outcomes]


@pytest.mark.quick(1)
@pytest.mark.parametrize("scene", [DRIVE, BUILDING, COLLISION], ids=["drive", "building", "collision"])
def test_all_is_well(scene):
    truth = known_outputs(lower(scene))
    for check in checks.CHECKS:
        assert all(verdicts(check.run, truth)), check.title
    assert all(compared(scene, truth))


@pytest.mark.slow
def test_of_a_long_horizon_the_beginning_is_compared(monkeypatch):
    """The code is that of the whole horizon; and the displacement goes on to grow, so that its bound is large here."""
    monkeypatch.setattr(reference, "_QUICK", 200_000)
    monkeypatch.setattr(reference, "_SHORTEST", fmpq(1))
    scene = Scene(
        name="far", system=DRIVE.system, load=DRIVE.load, output=DRIVE.output.model_copy(update={"until": 40})
    )
    whole = lower(scene)
    truth = known_outputs(whole)
    assert 1 < truth.until == float(truth.model.until) < float(truth.whole.until)
    assert truth.whole is whole
    assert truth.notes == [f"far: compared to tau = {truth.until:g}; exact values of all of it would take too long"]
    assert all(compared(scene, truth))
    halved = replace(truth.outputs[0], values=truth.outputs[0].values / 2)
    assert not all(compared(scene, replace(truth, outputs=(halved, *truth.outputs[1:]))))


@pytest.mark.slow
def test_beyond_that_an_integration_looks(monkeypatch):
    """A program that is wrong after the beginning only."""
    monkeypatch.setattr(reference, "_QUICK", 200_000)
    monkeypatch.setattr(reference, "_SHORTEST", fmpq(1))
    scene = DRIVE.with_({"output.until": 40, "output.tolerance": "1e-6"})
    truth = known_outputs(lower(scene), independent_model(scene, lower(scene)))
    integrals = [outcome.integral for outcome in integrations.collocation_beyond(truth)]
    assert all(outcome.passed for outcome in compare_programs(scene, truth, integrals, [Request("march")]))
    right_module = programs.import_text

    def late(text, name):
        module = right_module(text, name)
        return SimpleNamespace(evaluate=lambda tau: module.evaluate(tau) * (1 + 1e-4 * (tau > truth.until + 1)))

    monkeypatch.setattr(programs, "import_text", late)
    wrong = compare_programs(scene, truth, integrals, [Request("march")])
    assert [(outcome.subject, outcome.passed) for outcome in wrong] == [("march, NumPy", False), ("march, C", True)]
    assert all(compared(scene, truth, "march"))  # without an integration it is not seen


def changed_files(monkeypatch, change):
    """Let programs be written with changed files."""
    monkeypatch.setattr(programs, "files", lambda program, language: change(written.files(program, language)))


def a_digit_changed(text, file, which):
    """The same program with another fifth digit in one of the long decimals of its tables that are not tiny."""
    numbers = list(re.finditer(r"(?<![\w.])\d\.\d{12,}(?![\de])", text))
    assert numbers, file
    at = numbers[which].start() + 5
    return f"{text[:at]}{(int(text[at]) + 5) % 10}{text[at + 1 :]}"


@pytest.mark.quick(1)
@pytest.mark.parametrize("file", ["small.c", "small.py"])
@pytest.mark.parametrize("evaluator", ["closed", "pieces", pytest.param("march", marks=pytest.mark.slow)])
def test_a_digit_in_a_generated_table_is_seen(evaluator, file, monkeypatch):
    truth = known_outputs(lower(BUILDING))
    which = 0 if evaluator == "march" else -1  # the last of a march is of a high degree
    changed_files(
        monkeypatch,
        lambda made: made | {name: a_digit_changed(made[name], name, which) for name in made if name == file},
    )
    assert compared(BUILDING, truth, evaluator) == [file == "small.c", file != "small.c"]  # NumPy, C


def test_a_digit_in_a_program_breaks_the_balances(monkeypatch):
    truth = known_outputs(lower(DRIVE))
    right = checks.make

    def changed(model):
        program = right(model)
        largest = max(program.tables["coefficient"], key=abs)
        wrong = tuple(1.0001 * number if number == largest else number for number in program.tables["coefficient"])
        return replace(program, tables={**program.tables, "coefficient": wrong})

    monkeypatch.setattr(checks, "make", changed)
    assert not all(verdicts(checks.invariants, truth))


@pytest.mark.quick(1)
@pytest.mark.parametrize("scene", [DRIVE, COLLISION], ids=["drive", "collision"])
def test_a_wrong_law_of_joints_is_seen_by_all_that_is_not_derived(scene, monkeypatch):
    """Values of which every motion of a joint is a little wrong, and all that follows from it."""
    right = RuledNetwork._velocities

    def wrong(self, *arrived):
        moved = right(self, *arrived)
        return {point: combine([(1 + fmpq(1, 100000), velocity)]) for point, velocity in moved.items()}

    monkeypatch.setattr(RuledNetwork, "_velocities", wrong)
    truth = known_outputs(lower(scene))
    assert not all(verdicts(integrations.collocation, truth))
    assert not all(verdicts(integrations.midpoints, truth))
    assert not all(verdicts(checks.invariants, truth))


@pytest.mark.slow
@pytest.mark.parametrize("first", [0, "1/1000"])
def test_what_only_the_last_number_sees_is_not_left_out(first, monkeypatch):
    """Where contacts are, the last stretch was left out where it has one double, and extremes were proved without."""
    parts = [{"joint": True, "name": "a"}, {"rod": 1}, "contact", {"rod": 1}, "fixed"]
    load = {"at": "a", "times": [0, "2.3"], "steps": [first, 1]}
    output = {"until": "2.3", "force": ["0"]}
    scene = Scene(name="pressed", system={"type": "chain", "parts": parts}, load=[load], output=output)
    truth = known_outputs(lower(scene))
    assert truth.until in truth.taus
    assert verdicts(checks.peaks, truth) == [True]
    assert all(compared(scene, truth))

    def without(self, starts):
        return [not_below(low) == not_below(high) for low, high in pairwise([*starts, self.until])]

    monkeypatch.setattr(Motion, "_vague", without)
    assert verdicts(checks.peaks, truth) == [False]
    assert all(compared(scene, truth)) == (first != 0)  # else all of it is taken for 0


@pytest.mark.parametrize("side", [0, 1])
def test_an_extreme_that_is_none_is_seen(side, monkeypatch):
    truth = known_outputs(lower(COLLISION))
    right = checks.peaks(truth)
    assert all(outcome.passed for outcome in right)

    def wrong(model, by):
        pairs = [list(pair) for pair in extremes(model)]
        pairs[0][side] = replace(pairs[0][side], value=pairs[0][side].value * by)
        return pairs

    for by in (1 + 1e-12, 1 - 1e-12):
        monkeypatch.setattr(checks, "extremes", partial(wrong, by=by))
        assert verdicts(checks.peaks, truth) == [False] + [True] * (len(right) - 1)


def test_a_refusal_is_no_failure(monkeypatch):
    truth = known_outputs(lower(DRIVE))

    def refuse(model, *_, **__):
        raise ToleranceError("cannot be met")

    monkeypatch.setattr(checks, "make", refuse)
    monkeypatch.setattr(programs, "make", refuse)
    (program,) = compare_programs(DRIVE, truth, [None] * 3, [Request()])
    assert (program.passed, program.cells["error"]) == (True, "refused")
    assert program.note == "small: not auto: cannot be met"
    for outcome in checks.invariants(truth):
        assert outcome.passed
        assert outcome.cells["NumPy"] == "refused"
        assert outcome.note == "cannot be met"
