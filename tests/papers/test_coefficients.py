"""The list III.1 ... III.22: a wrong line or range is seen, and the list run by itself says what it lacks in words."""

import pytest

from wavesym.papers.pielorz1979 import coefficients
from wavesym.papers.pielorz1979.paper import ADAPTERS
from wavesym.papers.pielorz1979.transcript import entries, ids, right_reading
from wavesym.papers.record import judge, reading


def verdict(id, **changes):
    entry = entries()[id].model_copy(update=changes)
    return judge(entry, ADAPTERS[entry.kind](entry)).verdict


def test_the_list_is_whole():
    assert ids("line") == tuple(f"III.{number}" for number in range(1, 23))
    assert [id for id in ids("line") if entries()[id].slip] == [f"III.{n}" for n in (5, 6, 12, 13, 14, 17, 22)]


@pytest.mark.parametrize(
    ("id", "before", "after"),
    [
        ("III.1", "k,1,1", "k,1,n+1"),  # of n = 0 only
        ("III.2", "k,2,n", "k-1,2,n"),
        ("III.8", "H(n-1)", "H(n)"),
        ("III.9", "k,j-1", "k,j"),  # the same on both sides
        ("III.16", r"\kappa_m", r"\kappa_0"),
    ],
)
def test_a_wrong_line_is_seen(id, before, after):
    printed = entries()[id].printed
    assert verdict(id, printed=printed.replace(before, after)) == "untested"


@pytest.mark.parametrize(
    ("id", "ranges"),
    [
        ("III.4", (r"j = 2, 3, \dots, m",)),
        ("III.9", (r"j = 3, 4, \dots, m",)),
        ("III.11", (r"i = n-m+1, n-m, \dots, 0",)),
        ("III.16", (r"i = n-1, n-2, \dots, 0",)),
        ("III.18", (r"i = 2n, 2n-1, \dots, 2",)),
        ("III.2", ()),
    ],
)
def test_a_range_too_long_or_short_is_a_verdict(id, ranges):
    assert verdict(id, ranges=ranges) == "untested"


def test_a_correction_is_the_whole_formula():
    """With H(n-2) left out of it III.12 lets in what does not exist."""
    entry = entries()["III.12"]
    assert verdict(entry.id) == "misprint"
    shorter = entry.slip.correction.replace("H(n-2)", "")
    assert verdict(entry.id, slip=entry.slip.model_copy(update={"correction": shorter})) == "untested"
    assert verdict(entry.id, inferred_ranges=()) == "untested"


def test_the_list_by_itself():
    assert coefficients.gives_all(4, 4)
    assert not coefficients.gives_all(2, 2)


def test_every_correction_is_necessary():
    assert not [id for id in ids("line") if entries()[id].slip and "without it too" in coefficients.consequence(id)]
    assert "g_(1,0)^(1,4,1) is in no line's range" in coefficients.consequence("III.13")
    assert "rests on itself" in coefficients.consequence("III.17")


def test_what_lines_differ_in():
    entry = entries()["III.17"]
    difference = judge(entry, ADAPTERS[entry.kind](entry)).difference
    assert difference == "-g_{m,0}^{k,m,n + 1} + g^{k,m,n + 1}"


def test_what_the_list_lacks_is_said_in_words():
    short = reading(entries()["III.9"].printed, [r"j = 3, 4, \dots, m"])
    with pytest.raises(coefficients.NotGivenError, match=r"f_0\^\(1,2,1\) is in no line's range"):
        list(coefficients.listed_values([short if id == "III.9" else right_reading(id) for id in ids("line")], 3, 2))
