"""What is marked where two formulas differ."""

import pytest

from wavesym.papers.pages.marks import differing_tokens, mark
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.tree import latex


def marked(printed: list[str], corrected: list[str]) -> tuple[list[str], list[str]]:
    """Two lists of formulas in LaTeX with their differences marked."""
    places = differing_tokens(printed, corrected)
    one, other = (
        [mark([text], own)[0] for text, own in zip(*side, strict=True)]
        for side in zip((printed, corrected), places, strict=True)
    )
    return one, other


@pytest.mark.parametrize(
    ("printed", "corrected", "one", "other"),
    [
        (r"\kappa_i f", r"\kappa_{i-1} f", r"\kappa_{i}f", r"\kappa_{i \marked{- 1}}f"),
        ("i-1-r_0", "i+3-r_0", r"i \marked{- 1} - r_{0}", r"i \marked{+ 3} - r_{0}"),
        ("a + b - c", "a - b - c", r"a \marked{+} b - c", r"a \marked{-} b - c"),
        ("S + A = 0", "-S + A = 0", "S + A = 0", r"\marked{-}S + A = 0"),
        (r"c U", r"c^2 U_i", "cU", r"c^{\marked{2}}U_{\marked{i}}"),
        ("f^{k,m}", "f_0^{k,m}", "f^{k,m}", r"f_{\marked{0}}^{k,m}"),
        ("a + g", "a + H(n-1) g", "a + g", r"a + \marked{H(n - 1)}g"),
        ("m_1 + 1", r"m_1 + m_1", r"m_{1} + \marked{1}", r"m_{1} + \marked{m}_{\marked{1}}"),
        (r"\frac{\partial U}{\partial t}", r"\frac{\partial^2 U}{\partial t^2}", r"\frac{\partial U}{\partial t}",
         r"\frac{\partial^{\marked{2}} U}{\partial t^{\marked{2}}}"),
        (r"\frac{r_0}{i}", "m", r"\frac{r_{0}}{i}", "m"),
        ("a = b", "a = b", "a = b", "a = b"),
    ],
)  # fmt: skip
def test_only_what_differs_is_marked(printed: str, corrected: str, one: str, other: str) -> None:
    assert marked([latex(read_formula(printed))], [latex(read_formula(corrected))]) == ([one], [other])


def test_without_marks_both_sides_are_as_before() -> None:
    sides = [
        [latex(read_formula(r"g = \frac{1}{2\kappa_1 - \kappa_m} [(i+1)(g_{1,i+n} + f_{1,i+1})H(2n+m-5-i)]"))],
        [latex(read_formula(r"g = \frac{1}{2\kappa_1 - \kappa_m} [(i+1)(g_{1,i+1} - f_{1,i})H(2n+m-5)]"))],
    ]
    for side, [made] in zip(sides, marked(*sides), strict=True):
        assert r"\marked" in made
        assert plain(made.replace(r"\marked", "")) == plain(side[0])


def plain(text: str) -> str:
    return text.translate(str.maketrans("", "", "{} "))


def test_ranges_are_compared_as_lists() -> None:
    printed = [latex(read_range(r"i = 2, 3, \dots, m"))]
    corrected = [latex(read_range(text)) for text in (r"i = 2, 3, \dots, m-1", "m > 3")]
    one, other = marked(printed, corrected)
    assert one == [r"i = 2, 3, \dots, m"]
    assert other == [r"i = 2, 3, \dots, m \marked{- 1}", r"\marked{m > 3}"]
    assert marked([], ["m > 3"]) == ([], [r"\marked{m > 3}"])


def test_a_formula_in_pieces_is_marked_as_one() -> None:
    (places,), _ = differing_tokens(["a + b + c"], ["a + c"])
    assert mark(["a ", "+ b ", "+ c"], places) == ["a ", r"\marked{+ b} ", "+ c"]
