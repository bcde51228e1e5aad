"""What is marked where two formulas differ."""

import pytest

from wavesym.papers.difference import mark_differences, mark_range_differences
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.tree import latex


@pytest.mark.parametrize(
    ("printed", "corrected", "one", "other"),
    [
        (r"\kappa_i f", r"\kappa_{i-1} f", r"\kappa_{i}f", r"\kappa_{i \marked{ - 1}}f"),
        ("i-1-r_0", "i+3-r_0", r"i \marked{ - 1} - r_{0}", r"i \marked{ + 3} - r_{0}"),
        ("a + b - c", "a - b - c", r"a \marked{+} b - c", r"a \marked{-}b - c"),
        ("S + A = 0", "-S + A = 0", "S + A = 0", r"\marked{-}S + A = 0"),
        (r"c U", r"c^2 U_i", "cU", r"c^{\marked{2}}U_{\marked{i}}"),
        ("f^{k,m}", "f_0^{k,m}", "f^{k,m}", r"f_{\marked{0}}^{k,m}"),
        ("a + g", "a + H(n-1) g", "a + g", r"a + \marked{H(n - 1)}g"),
        ("a + b", "a - H(n-1) b", r"a \marked{+} b", r"a \marked{-}\marked{H(n - 1)}b"),
        (r"\frac{r_0}{i}", "m", r"\frac{r_{0}}{i}", "m"),
        ("a = b", "a = b", "a = b", "a = b"),
    ],
)  # fmt: skip
def test_only_what_differs_is_marked(printed: str, corrected: str, one: str, other: str) -> None:
    assert tuple(map(latex, mark_differences(read_formula(printed), read_formula(corrected)))) == (one, other)


def test_without_marks_both_sides_are_as_before() -> None:
    printed = read_formula(r"g = \frac{1}{2\kappa_1 - \kappa_m} [(i+1)(g_{1,i+n} + f_{1,i+1})H(2n+m-5-i)]")
    corrected = read_formula(r"g = \frac{1}{2\kappa_1 - \kappa_m} [(i+1)(g_{1,i+1} - f_{1,i})H(2n+m-5)]")
    one, other = (latex(tree).replace(r"\marked", "") for tree in mark_differences(printed, corrected))
    stripped = [latex(tree) for tree in (printed, corrected)]
    assert [plain(one), plain(other)] == list(map(plain, stripped))


def plain(text: str) -> str:
    return text.translate(str.maketrans("", "", "{} "))


def test_ranges_are_compared_as_lists() -> None:
    printed = [read_range(r"i = 2, 3, \dots, m")]
    corrected = [read_range(r"i = 2, 3, \dots, m-1"), read_range("m > 3")]
    one, other = mark_range_differences(printed, corrected)
    assert list(map(latex, one)) == [r"i = 2, 3, \dots, m"]
    assert list(map(latex, other)) == [r"i = 2, 3, \dots, m \marked{ - 1}", r"\marked{m > 3}"]
