"""Trees as MathML: well formed, with the elements that each kind of tree needs."""

from xml.etree.ElementTree import fromstring

import pytest

from wavesym.papers.mathml import LONGEST, mathml
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.tree import Marked, Number

LONG = (
    r"F'_{i,n+1}(z) = F'_{i,n}(z) + \sum_{k=0}^{m_1} H(z-2n-\tau_k) [F^{k, i, n+1} + F_0^{k, i, n+1}(z-2n-\tau_k) + "
    r"e^{-2\kappa_1(z-2n-\tau_k)} \sum_{j=0}^{K_1} F_{1,j}^{k, i, n+1}(z-2n-\tau_k)^j]"
)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (r"\frac{a}{2}", "<mfrac><mi>a</mi><mn>2</mn></mfrac>"),
        (r"\bar{x}", '<mover><mi>x</mi><mo stretchy="false">¯</mo></mover>'),
        (r"\ddot{y}_0", '<msub><mover><mi>y</mi><mo stretchy="false">¨</mo></mover><mn>0</mn></msub>'),
        (r"\mathcal{F}_i", "<msub><mi>\N{SCRIPT CAPITAL F}</mi><mi>i</mi></msub>"),
        (r"\mathcal{G}_i", "<msub><mi>\N{MATHEMATICAL SCRIPT CAPITAL G}</mi><mi>i</mi></msub>"),
        ("f_i''", "\N{PRIME}\N{PRIME}</mo></msubsup>"),
        (r"\kappa_1^2", "<msubsup><mi>κ</mi><mn>1</mn><mn>2</mn></msubsup>"),
        (r"\frac{\partial^2 U}{\partial t^2}", "<msup><mo>∂</mo><mn>2</mn></msup><mi>U</mi>"),
        (r"\sum_{k=0}^{m} a_k", "<munderover><mo>∑</mo>"),
        (r"\begin{cases} 1 & i = 2 \\ 0 & i = 3 \end{cases}", "<mtable><mtr><mtd><mn>1</mn></mtd>"),
        (r"\left. u \right|_{t=0}", "<msub><mrow><mi>u</mi><mo"),
        ("a - b", '<mo form="infix">\N{MINUS SIGN}</mo>'),
        (r"(a + b)^2", '<msup><mrow><mo stretchy="false">(</mo>'),
        (r"(\frac{a}{b})^2", '<msup><mrow><mo stretchy="true">(</mo>'),
        (r"a \leq b", "<mo>≤</mo>"),
    ],
)
def test_formulas(text: str, part: str) -> None:
    made = mathml(read_formula(text))
    assert part in made
    assert fromstring(made).tag == "math"


def test_ranges() -> None:
    assert "<mo>…</mo>" in mathml(read_range(r"i = 2, 3, \dots, m"))
    assert '<mo form="prefix">⟨</mo>' in mathml(read_range(r"z \in \langle 2n, 2n+2)"))


def test_a_mark_is_a_row_of_its_own() -> None:
    assert mathml(Marked(Number("2"))) == '<math displaystyle="true"><mrow class="marked"><mn>2</mn></mrow></math>'


def test_a_long_formula_is_cut_where_lines_may_break_and_loses_nothing() -> None:
    pieces = [fromstring(piece + "</math>") for piece in mathml(read_formula(LONG)).split("</math>") if piece]
    sizes = [sum(1 for part in piece.iter() if part.text) for piece in pieces]
    assert len(pieces) > 3
    assert max(sizes) < 2 * LONGEST
    letters = "".join("".join(piece.itertext()) for piece in pieces)
    assert letters.count("κ") == 1
    assert letters.count("τ") == LONG.count("tau")
    assert letters.count("F") == LONG.count("F")
    assert (letters.count("["), letters.count("]")) == (1, 1)
