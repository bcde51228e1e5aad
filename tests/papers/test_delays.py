"""The delay equations: judged from their strings, every function given once."""

from __future__ import annotations

import pytest

from tests.papers.falsified import ENTRIES, judged
from wavesym.papers.pielorz1979.equations import is_complete


@pytest.mark.parametrize(
    ("id", "changes"),
    [
        ("(4.6).3", {"ranges": (r"i = 3, 5, \dots, m-5",)}),
        ("(4.6).3", {"ranges": (r"i = 3, 5, \dots, m-1",)}),
        ("(4.6).3", {"ranges": (r"i = 3, 4, \dots, m-3",)}),
        ("(4.8).3", {"ranges": (r"i = 1, 2, \dots, m-1",)}),
        ("(4.8).3", {"ranges": (r"i = 3, 4, \dots, m-1",)}),
        ("(4.8).3", {"ranges": (r"j = 2, 3, \dots, m-1",)}),
        ("(4.8).3", {"ranges": ()}),
        ("(4.6).1", {"printed": "f'_1(z) = g'_1(z-2)"}),
        ("(4.6).1", {"printed": "f'_1(z) = g'_1(z-2), g'_m(z) = f'_m(z-1)"}),
        ("(4.6).1", {"printed": "f'_1(z) - g'_1(z-2) = 0, g'_m(z) = f'_m(z-2)"}),
        ("(4.8).1", {"printed": "g_1'(z) = f_2'(z-2) + g_2'(z-2) = f_1'(z-2)"}),
        ("(4.8).1", {"printed": "g_1'(z) = f_2'(z-2) + p_2'(z-2) - f_1'(z-2)"}),
        ("(4.8).2", {"printed": ENTRIES["(4.8).2"].printed.replace("^{m_1}", "^{m_1-1}")}),
        ("(4.7).3", {"printed": ENTRIES["(4.7).3"].printed.replace(r" - \tau_{1,k}", "")}),
    ],
)
def test_an_equation_that_is_falsified_loses_its_verdict(id, changes):
    assert judged(id, **changes).verdict == "untested"


def test_a_correction_that_is_falsified_loses_its_verdict():
    right = ENTRIES["(4.7).2"].slip.correction
    for wrong in (right.replace("m_{m+1}", "m_m"), right.replace(r"= -\bar", r"= \bar"), ENTRIES["(4.7).2"].printed):
        assert judged("(4.7).2", slip={"correction": wrong}).verdict == "untested"


@pytest.mark.parametrize("m", range(2, 9))
def test_when_every_function_is_given_once(m):
    assert is_complete("(4.6)", m) == (m % 2 == 0 and m >= 4)
    assert is_complete("(4.8)", m)


@pytest.mark.parametrize(
    ("before", "after"), [("faster", "slower"), ("stay closed", "are closed at first"), ("second and first", "second")]
)
def test_a_sentence_that_is_falsified_loses_its_verdict(before, after):
    right = ENTRIES["(4.6).contacts"].slip.correction
    assert judged("(4.6).contacts", slip={"correction": right.replace(before, after)}).verdict == "untested"
