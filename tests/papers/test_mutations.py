"""Faults from trees: every sign, number, index, H, limit and quantity, each once."""

from __future__ import annotations

import pytest

from wavesym.papers.mutations import ends, mutations
from wavesym.papers.reader import read_formula, read_range
from wavesym.papers.tree import latex


def _made(text):
    return {latex(tree) for _, tree in mutations(read_formula(text))}


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("a - b", {"-a - b", "a + b", "(2a) - b", "a - (2b)"}),
        ("n-2", {"-n - 2", "n + 2", "(2n) - 2", "n - 3", "n - 1"}),
        (r"\kappa_i", {r"(2\kappa_{i})", r"\kappa_{i + 1}", r"\kappa_{i - 1}"}),
        ("g_1'(z)", {"g'_{2}(z)", "g'_{0}(z)", "g'_{1}((2z))"}),
    ],
)
def test_all_of_them(text, wrong):
    assert _made(text) == wrong


def test_H_and_sums():
    made = _made(r"\sum_{k=0}^m H(n-k) a_k")
    assert {r"\sum_{k=1}^{m} H(n - k)a_{k}", r"\sum_{k=0}^{m + 1} H(n - k)a_{k}", r"\sum_{k=0}^{m} a_{k}"} <= made
    assert r"\sum_{k=0}^{m} H(n - k + 1)a_{k}" in made


def test_names_are_told_apart():
    names = [name for name, _ in mutations(read_formula("a_1 + a_1 + a_1"))]
    assert len(names) == len(set(names))


def test_both_ends_of_ranges():
    made = [latex(tree) for _, tree in ends(read_range(r"i = 3, 5, \dots, m-1"))]
    assert sorted(made) == sorted(
        [r"i = 5, 7, \dots, m - 1", r"i = 1, 3, 5, \dots, m - 1", r"i = 3, 5, \dots, m + 1", r"i = 3, 5, \dots, m - 3"]
    )
    assert [latex(tree) for _, tree in ends(read_range(r"n = 0, 1, \dots"))] == [
        r"n = 1, 2, \dots",
        r"n = -1, 0, 1, \dots",
    ]
    assert [latex(tree) for _, tree in ends(read_range(r"n \geq 1"))] == [r"(2n) \geq 1", r"n \geq 2", r"n \geq 0"]
