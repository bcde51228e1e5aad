"""What is said of the motion is judged by its strings: the equations of rods, their solution, loads and clocks."""

from __future__ import annotations

import pytest

from tests.papers.falsified import ENTRIES, judged


@pytest.mark.parametrize(
    ("id", "changes"),
    [
        ("(2.1)", {"slip": {"correction": ENTRIES["(2.1)"].printed}}),
        ("(2.2)", {"ranges": ("(i-1)l < x < (i+1)l",)}),
        ("(2.5)", {"slip": {"correction": ENTRIES["(2.5)"].slip.correction.replace("+ v_i t", "- v_i t")}}),
        ("(2.5)", {"inferred_ranges": (r"i = 2, 3, \dots, m",)}),
        ("(2.5)", {"inferred_ranges": (r"i = 1, 2, \dots, m+1",)}),
        ("(2.5)", {"slip": {"correction": "0 = 0 = 0"}}),
        ("(3.1)", {"ranges": (r"i = 1, 2, \dots, m",)}),
        ("(3.1)", {"ranges": ()}),
        ("(3.2)", {"slip": {"correction": r"\ddot{y}_0 = \sum_{k=0}^{m_2} [a_k + b_k (t - t_k)] H(t - t_k)"}}),
        ("def.tau", {"printed": r"\tau = \frac{c_f t}{2l}"}),
        ("def.v", {"slip": {"ranges": (r"v_0 = \frac{c_f U_0}{2l}",)}}),
        ("def.g", {"slip": {"correction": r"g_i = \frac{\mathcal{F}_i}{U_0}"}}),
        ("T1.I.tau_0", {"printed": r"\begin{cases} 1 & i=1, m \\ 0 & i=2, 3, \dots, m-2 \end{cases}"}),
        ("T1.II.S", {"slip": {"ranges": (r"i = 1, 2, \dots, m+2",)}}),
        ("(4.2)", {"printed": ENTRIES["(4.2)"].printed.replace(r"- \bar{x} +", r"+ \bar{x} -")}),
        ("text.t_0", {"english": ENTRIES["text.t_0"].english.replace("first", "last")}),
        ("text.III.masses", {"english": ENTRIES["text.III.masses"].english.replace("m-1,", "m,")}),
        ("text.F", {"english": "the functions F_i run"}),
    ],
)
def test_a_wrong_string_is_a_verdict(id, changes):
    record = judged(id, **changes)
    assert record.verdict == "untested"
    assert record.problems


def test_a_counterexample_can_be_seen():
    shown = judged("T1.II.S").counterexample.example()
    assert "body = 2" in shown.scene
    assert "velocity@1" in shown.look
