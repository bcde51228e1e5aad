"""Mutants are the mistakes they are said to be, and one that makes values wrong is killed."""

import os

import pytest

from tests.mutation.operators import mutants
from tests.mutation.run import ROOMS, ROOT, TESTS, Project, Verdict, known, places, related, report, sample

FRONT = "tests/programs/test_closed.py::test_a_front_between_two_doubles_counts_from_the_upper_one"


def wrongs(line, file="made.py"):
    return {mutant.wrong for place in mutants(file, line + "\n") for mutant in place}


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("a + b", {"a - b", "a", "b"}),
        ("(a + b) * c", {"(a + b) / c", "(a + b)", "c", "(a - b) * c", "(a) * c", "(b) * c"}),
        ("x = a - f(b)", {"x = a + f(b)", "x = a", "x = -f(b)"}),
        ("a / b", {"a * b"}),
        ("x += a", {"x -= a"}),
        ("-a", {"a"}),
        ("a < b", {"a <= b"}),
        ("a >= b", {"a > b"}),
        ("a and b and c", {"a or b and c", "a and b or c"}),
        ("x = a if b else c", {"x = a if not b else c"}),
        ("[a for a in b if c]", {"[a for a in b if not c]"}),
        ("max(a, b)", {"min(a, b)", "a", "b"}),
        ("a.max(b)", {"a.min(b)", "a", "b"}),
        ("np.maximum(a, b)", {"np.minimum(a, b)", "a", "b"}),
        ("abs(a).upper()", {"a.upper()", "abs(a).lower()"}),
        ("a.ceil()", {"a.floor()"}),
        ("from math import ceil", {"from math import floor as ceil"}),
        ("real.not_below(a)", {"real.nearest(a)"}),
        ("f(8)", {"f(9)", "f(7)", "f(16)", "f(4)", "f(2)"}),
        ("f(1.5)", {"f(3.0)", "f(0.75)", "f(0.375)"}),
    ],
)
def test_each_operator_does_what_it_says(right, wrong):
    assert wrongs(right) == wrong


@pytest.mark.parametrize(
    "line",
    [
        '"""a + b, at least 4"""',
        "def f(a: fmpq | None = 3) -> tuple[1]: pass",
        "class Row: a: int = 3",
        "if a > 3: raise CostError(b + c)",
        "raise RangeError(a + b)",
        'f"{a + b}"',
        "_MOST_BITS = 1 << 14",
        "def work(self): return 8 * a",
        "def summary(self): return 8 * a",
    ],
)
def test_what_no_bound_rests_on_is_left_alone(line):
    assert not wrongs(line)


def test_c_is_changed_where_it_computes():
    source = """/* 1 - 2 */
enum { BLOCK = 4 };
#define EIGHT 8
static const int table[] = {1,
    -2};
static real value(int k)
{
    w = (tau - start[k]) + excess[k]; /* a + b */
    sum += 2 * w;
}
"""
    found = [mutant for place in mutants("made.c", source) for mutant in place]
    assert {mutant.function for mutant in found} == {"value"}
    assert {mutant.wrong for mutant in found} == {
        "w = (tau + start[k]) + excess[k]; /* a + b */",
        "w = (tau) + excess[k]; /* a + b */",
        "w = (tau - start[k]) - excess[k]; /* a + b */",
        "w = (tau - start[k]); /* a + b */",
        "sum -= 2 * w;",
        *(f"sum += {number} * w;" for number in (3, 1, 4)),
    }


def test_all_else_is_kept():
    source = "def f():\n    # why\n    return (a\n            + b)  # more\n"
    (place,) = mutants("made.py", source)
    assert place[0].text == source.replace("+", "-")


def test_a_sample_is_the_same_whatever_changes_elsewhere():
    found = places(["closed_form.py"])
    drawn = sample(found, 20, 1)
    assert len({mutant.names for mutant in drawn}) == 20
    assert sample(found[::-1], 20, 1) == drawn
    assert len(set(sample(found[1:], 20, 1)) & set(drawn)) >= 19
    assert sample(found, 20, 2) != drawn


def test_the_tests_of_a_file_come_first():
    assert related("wavesym/exact/contacts/schedule.py")[0].startswith("tests/exact/")
    assert related("templates/c/march/march.c")[0] == "tests/targets/test_march_c.py"
    assert related("templates/c/runtime/bound.c")[0] == "tests/targets/test_runtime_bound.py"
    assert "tests/targets/test_stream_c.py" in related("templates/c/elimination.c")


def test_what_is_changed_and_run_exists():
    assert [room for room in ROOMS if not any(ROOT.glob(room))] == []
    assert [name for name in TESTS if not (ROOT / "tests" / name).exists()] == []


@pytest.mark.slow
def test_known_mutants_can_still_be_made():
    assert not known().keys() - {mutant.names for place in places() for mutant in place}


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="processes are limited and ended in another way there")
def test_a_wrong_value_kills(tmp_path):
    """An arrival between two doubles counts from the nearer one."""
    found = places(["pieces.py"])
    wrong = "seen = [real.nearest(cut) for cut in exact]"
    mutant = next(mutant for place in found for mutant in place if mutant.wrong == wrong)
    project = Project(tmp_path)
    with project.changed(mutant):
        assert project.run([FRONT])[0] == 1
    assert (project.folder / mutant.file).read_text() == (ROOT / mutant.file).read_text()


def test_the_share_leaves_out_what_is_known():
    ((mutant, *_), *_) = places(["closed_form.py"])
    verdicts = [Verdict(mutant, fate) for fate in ["killed"] * 5 + ["hung"] * 3 + ["known"] * 4 + ["survived"] * 2]
    assert "| all | 14 | 8 | 3 | 4 | 2 | 80.0% |" in report(verdicts)
