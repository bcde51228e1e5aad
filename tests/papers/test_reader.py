"""The reader of printed formulas: what it reads it can write again, and what it cannot read it says."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wavesym.papers.reader import UnreadableError, read_formula, read_range
from wavesym.papers.tree import (
    Addition,
    Blank,
    Call,
    Derivative,
    Group,
    Minus,
    Number,
    Power,
    Product,
    Progression,
    Series,
    Symbol,
    latex,
)

N, ROD, K = Symbol("n"), Symbol("i"), Symbol("k")


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("n-2", Addition((N, Minus(Number("2"))))),
        ("-2n", Minus(Product((Number("2"), N)))),
        ("H(n-2)", Call(Symbol("H"), (Addition((N, Minus(Number("2")))),))),
        ("a(b)", Product((Symbol("a"), Group("(", Symbol("b"))))),
        ("f'_1(z)", Call(Symbol("f", primes=1, subscript=(Number("1"),)), (Symbol("z"),))),
        ("f_1''(z)", Call(Symbol("f", primes=2, subscript=(Number("1"),)), (Symbol("z"),))),
        ("f^{k,1}(z)", Product((Symbol("f", superscript=(K, Number("1"))), Group("(", Symbol("z"))))),
        ("w^2", Power(Symbol("w"), Number("2"))),
        (r"\bar{v}_i^{-1}", Power(Symbol("v", r"\bar", subscript=(ROD,)), Minus(Number("1")))),
        ("t_{0i}", Symbol("t", subscript=(Number("0"), ROD))),
        ("t_{2i}", Symbol("t", subscript=(Product((Number("2"), ROD)),))),
        (r"F^{k, \cdot}", Symbol("F", superscript=(K, Blank(r"\cdot")))),
        (r"\sum_{k=0}^n k", Series(K, Number("0"), N, K)),
        (r"\frac{\partial^2 U}{\partial t^2}", Derivative(2, Symbol("U"), Symbol("t"))),
        ("—", Blank("—")),
    ],
)
def test_what_stands_there(text, tree):
    assert read_formula(text) == tree


@pytest.mark.parametrize(
    "text",
    [
        r"F'_{i,n+1}(z) = F'_{i,n}(z) + e^{-2\kappa_1(z-2n)} \times \sum_{k=0}^{E(K/2)} F_{1, k}^{i, n+1} (z-2n)^k",
        r"\left. \frac{\partial U_i(x, t)}{\partial t} \right|_{t=0} = v_i",
        r"r_0 = \begin{cases} 1 & i = 2, 4, \dots \\ 0 & i = 1, 3, \dots \end{cases}",
        r"U_i = \mathcal{F}_i(c_f(t - t_{0i}) - x) + \ddot{y}_0",
        r"\{ [ (a + b) c ] d \} / e",
    ],
)
def test_what_is_read_is_written_again(text):
    assert read_formula(latex(read_formula(text))) == read_formula(text)


_LEAVES = st.one_of(
    st.integers(0, 99).map(lambda n: Number(str(n))),
    st.sampled_from(
        [Symbol("n"), Symbol("x", r"\bar"), Symbol(r"\kappa", subscript=(ROD,)), Symbol("K", subscript=(N, ROD))]
    ),
)
_TREES = st.recursive(
    _LEAVES,
    lambda inner: st.one_of(
        st.lists(inner, min_size=2, max_size=3).map(lambda terms: Group("(", Addition(tuple(terms)))),
        st.lists(inner, min_size=2, max_size=3).map(lambda parts: Group("[", Product(tuple(parts)))),
        st.tuples(inner).map(lambda argument: Call(Symbol("H"), argument)),
        st.tuples(inner, inner).map(lambda pair: Group("(", Addition((pair[0], Minus(pair[1]))))),
    ),
    max_leaves=12,
)


@given(_TREES)
def test_every_tree_is_written_so_that_it_is_read(tree):
    assert latex(read_formula(latex(tree))) == latex(tree)


@pytest.mark.parametrize(
    "text", ["", "a +", "(a", r"\frac{a}", r"\unknown", "a b)", r"\frac{\partial^2 U}{\partial t}"]
)
def test_what_cannot_be_read_is_said(text):
    with pytest.raises(UnreadableError):
        read_formula(text)


def test_ranges():
    m_less_1 = Addition((Symbol("m"), Minus(Number("1"))))
    assert read_range(r"i = 1, 2, \dots, m-1") == Progression(ROD, (Number("1"), Number("2")), True, m_less_1)
    assert read_range("i = 1, m") == Progression(ROD, (Number("1"), Symbol("m")))
    for text in (r"n \geq 1", r"z \in \langle 2n, 2n + 2 )", r"2n \leq z < 2n + 1", "x = il"):
        assert read_range(latex(read_range(text))) == read_range(text)
