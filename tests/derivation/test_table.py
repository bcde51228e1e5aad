"""The laws that are derived are the laws that run: what changes in one shows in the other."""

from dataclasses import replace

from flint import fmpq
from sympy import Integer

from wavesym.derivation import recurrence as derivation
from wavesym.derivation.table import Function, Rules, full_table, required_intervals, unit_response
from wavesym.documents.derivation.document import derivation as written
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters
from wavesym.systems.drive import DRIVE


def drive(kappa, inertia):
    return Chain(
        DRIVE,
        len(kappa),
        Parameters(kappa=dict(enumerate(map(fmpq, kappa), 1)), inertia=dict(enumerate(map(fmpq, inertia), 1))),
    )


def test_a_changed_law_changes_the_tables_and_the_text(monkeypatch):
    chain = drive([1, 2], [1, 2, 3])
    before, text = list(full_table(chain, 4, fmpq(0)).rows()), written("drive", None, "text")
    true = derivation.recurrence(DRIVE)
    law = true.laws[0]
    term = law.terms[0]
    wrong_term = replace(term, weights=replace(term.weights, same=term.weights.same + Integer(1)))
    wrong = replace(true, laws=(replace(law, terms=(wrong_term, *law.terms[1:])), *true.laws[1:]))
    monkeypatch.setattr("wavesym.derivation.recurrence.recurrence", lambda system: wrong)
    monkeypatch.setattr("wavesym.documents.derivation.statement.recurrence", lambda system: wrong)
    assert list(full_table(chain, 4, fmpq(0)).rows()) != before
    assert written("drive", None, "text") != text


def test_equal_discs_have_one_family_and_nothing_divides_by_zero():
    rows = list(full_table(drive([1, 1, 1], [1, 1, 1, 1]), 8, fmpq(0)).rows())
    assert {row.rate for row in rows} == {0, 1, 2}  # the ends turn at rate 1, the discs between at 2


def test_first_increments_by_hand():
    """A step of M_1 on the first disc alone: f_1'' + kappa_1 f_1' = kappa_1 gives 1 - exp(-kappa_1 w)."""
    rules = Rules(drive([fmpq(1, 3), 1], [1, 1, 1]))
    response = unit_response(rules, "M1", {Function("f", 1): 1})
    assert response[Function("f", 1)] == [{fmpq(0): [fmpq(1)], fmpq(1, 3): [fmpq(-1)]}]


def test_only_the_light_cone_is_run():
    chain = drive([1] * 40, [1] * 41)
    cone = required_intervals(Rules(chain), {Function("f", 20): 3})
    assert {function.rod for function in cone} <= set(range(17, 24))
    assert cone[Function("f", 20)] == 3
