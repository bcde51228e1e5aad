"""Tables 2 to 4: a wrong cell, head or range is seen, and what a table says as it should be can be asked for."""

import pytest

from tests.papers.falsified import changed_passage
from wavesym.papers import entries as data
from wavesym.papers.evaluation import MeaninglessError
from wavesym.papers.pielorz1979.forms import ALPHA, FormScope, form_chain, right_form
from wavesym.papers.pielorz1979.paper import ADAPTERS
from wavesym.papers.pielorz1979.tables import TESTS
from wavesym.papers.pielorz1979.transcript import entries, paper
from wavesym.papers.reader import read_formula
from wavesym.papers.record import judge


def verdict(id, **changes):
    entry = entries()[id].model_copy(update=changes)
    return judge(entry, ADAPTERS[entry.kind](entry)).verdict


@pytest.mark.quick(9)
@pytest.mark.parametrize(
    ("id", "wrong"),
    [
        ("T2.g_1.K_1", "n+1"),
        ("T2.f_i.j_0,2", r"\frac{i+1}{2}"),
        ("T2.f_m.K_j,2", "n-j"),
        ("T2.g_i.K_j,1", "—"),
        ("T3.even.d", "2n+2"),
        ("T3.odd.w", r"z-2n-\tau_{s,k}"),
        ("T3.even.f.alpha2.K_2", r"n-r+\frac{i+1+r_0}{2}"),
        ("T3.odd.g.alpha1.s", "2r+1"),
        ("T4.m2.f_1.K_2", "n-1"),
        ("T4.m3.f_1.K_1", r"2(n-1)/0"),
        ("T4.m3.f_1.K_1", "F^{2}"),
        ("T4.m3", r"m \geq 2"),
        ("T2.range", r"2n \leq z \leq 2n+2"),
        ("T3.odd.range", r"2n \leq z < 2n+2"),
        ("T2.g_m-2", "g_{m-3}"),
    ],
)
def test_a_wrong_cell_is_seen(id, wrong):
    assert verdict(id, printed=wrong) == "untested"


@pytest.mark.parametrize(
    ("id", "wrong"),
    [
        ("T2.g_i", r"i = 3, 5, \dots, m-1"),
        ("T2.g_i", r"i = 5, 7, \dots, m-3"),
        ("T4.m3.f_i", r"i = 2, 3, \dots, m+1"),
        ("T4.m3.g_i", r"i = 2, 3, \dots, m-2"),
        ("T4.range", r"n = 1, 2, \dots"),
        ("T3.even.g", r"i = 1, 2, \dots, m-1"),
    ],
)
def test_a_range_too_long_or_short_is_a_verdict(id, wrong):
    assert verdict(id, ranges=(wrong,)) == "untested"


@pytest.mark.parametrize("id", ["T3.even.g.alpha1.K_1", "T3.odd.g.alpha1.R_1", "T4.m3.g_m.K_1"])
def test_a_wrong_correction_is_seen(id):
    entry = entries()[id]
    assert verdict(id) not in ("holds", "untested")
    assert verdict(id, slip=entry.slip.model_copy(update={"correction": entry.slip.correction + "+1"})) == "untested"
    assert verdict(id, slip=None) == "untested"


def test_a_range_that_corrects_is_tried():
    entry = entries()["T4.m3.g_i.K_1"]
    ranges = tuple(range_.replace("n = 1, 2", "n = 2, 3") for range_ in entry.slip.ranges)
    assert verdict(entry.id, slip=entry.slip.model_copy(update={"ranges": ranges})) == "untested"


def test_cells_as_they_should_be():
    scope = FormScope(right_form("II"), form_chain("II", 5), "g")
    with scope.bind({"i": 3, "n": 2, "half": "even", ALPHA: 2}):
        assert scope.value(read_formula(r"R_\alpha")) == 2  # as printed 3
        with pytest.raises(MeaninglessError, match=r"Q.* is not defined"):
            scope.value(read_formula("Q"))


def test_a_part_of_table_2_is_given_whole_or_not_at_all():
    assert verdict("T2.g_1.j_0,2", printed="1") == "untested"


def test_a_counterexample_says_where_to_look():
    entry = entries()["T3.even.g.alpha1.K_1"]
    example = judge(entry, TESTS["cell"](entry)).counterexample.example()
    assert 'type = "drive"' in example.scene
    assert example.look == "g of rod 2, source M2, interval 1, rate 3/4: there is none"


@pytest.mark.parametrize(
    ("before", "after", "problem"),
    [
        ("\t1\t$", "\t2\t$", "are not those that were checked"),
        ("g_1⟧\tn", "g_2⟧\tn", "has no label g_1"),
        ("F_i⟧\t", "F_i⟧\tn+3", "neither judged nor set aside: n+3"),
    ],
)
def test_a_table_is_bound_to_the_source(before, after, problem):
    (table,) = (passage for passage in paper().passages if passage.where == "Table 2")
    assert before in table.marked
    changed = data.Paper(
        paper().description, (changed_passage(table, marked=table.marked.replace(before, after, 1)),), paper().digest
    )
    assert any(problem in found for _, found in data.problems(changed))
