"""Trees as MathML: well formed, marked where they differ, and cut where they are long."""

import sys
from xml.etree.ElementTree import fromstring

import pytest

from wavesym.errors import WavesymError
from wavesym.papers.pages.mathml import LONGEST, mathml, pieces
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.tree import Number, latex

LONG = (
    r"F'_{i,n+1}(z) = F'_{i,n}(z) + \sum_{k=0}^{m_1} H(z-2n-\tau_k) [F^{k, i, n+1} + F_0^{k, i, n+1}(z-2n-\tau_k) + "
    r"e^{-2\kappa_1(z-2n-\tau_k)} \sum_{j=0}^{K_1} F_{1,j}^{k, i, n+1}(z-2n-\tau_k)^j]"
)


@pytest.mark.parametrize(
    "text",
    [
        r"\frac{a}{2}",
        r"\bar{x} - \ddot{y}_0",
        r"\mathcal{F}_i",
        "f_i''",
        r"\kappa_1^2",
        r"\frac{\partial^2 U}{\partial t^2}",
        r"\begin{cases} 1 & i = 2 \\ 0 & i = 3 \end{cases}",
        r"\left. u \right|_{t=0}",
        r"a \leq b",
        "—",
    ],
)
def test_formulas_are_well_formed_and_have_no_command_left(text: str) -> None:
    made = mathml(read_formula(text))
    assert fromstring(made).tag == "math"
    assert "\\" not in made


def test_ranges() -> None:
    assert "…" in "".join(fromstring(mathml(read_range(r"i = 2, 3, \dots, m"))).itertext())
    assert "⟨" in "".join(fromstring(mathml(read_range(r"z \in \langle 2n, 2n+2)"))).itertext())


def test_a_mark_is_a_row_of_its_own() -> None:
    assert '<mrow class="marked"><mn>2</mn></mrow>' in mathml(Number("2"), frozenset({0}))


def test_a_long_formula_is_cut_where_lines_may_break_and_loses_nothing() -> None:
    found = pieces(read_formula(LONG))
    assert len(found) > 3
    assert max(map(len, found)) < 2 * LONGEST
    assert "".join(found).replace(" ", "") == latex(read_formula(LONG)).replace(" ", "")
    assert all(fromstring(made + "</math>").tag == "math" for made in mathml(read_formula(LONG)).split("</math>")[:-1])


def test_a_missing_library_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "latex2mathml.converter", None)
    with pytest.raises(WavesymError, match=r"pip install .*\[papers\]'"):
        mathml(Number("2"))
