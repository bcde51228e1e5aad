"""The constants are judged by what chains with them do, and by their strings alone."""

from __future__ import annotations

import pytest

from tests.papers.test_motion import ENTRIES, judged
from wavesym.papers.pielorz1979.constants import Physical


@pytest.mark.parametrize(
    ("id", "verdict"),
    [("(4.3).kappa", "unreadable"), ("(4.4).kappa", "holds"), ("(4.4).A", "unreadable"), ("(4.5).kappa", "unreadable")],
)
def test_as_printed(id, verdict):
    record = judged(id)
    assert record.verdict == verdict, record.problems
    assert record.mutations.tried == record.mutations.turned > 10


@pytest.mark.parametrize(
    ("id", "changes"),
    [
        ("(4.3).kappa", {"corrected": r"\kappa_i = \frac{2F\rho l}{M_i}"}),
        ("(4.3).kappa", {"corrected": r"\kappa_i = 0"}),
        ("(4.3).kappa", {"ranges": (r"i = 1, 2, \dots, m-1",)}),
        ("(4.4).kappa", {"printed": r"\kappa_i = \frac{J_{0,1} \rho l}{J_i}"}),
        ("(4.4).kappa", {"inferred": (r"i = 1, 2, \dots, m+1",)}),
        ("(4.4).A", {"slip_ranges": (r"S_0 = \frac{G J_{0,1} U_0}{2l}",)}),
        ("(4.5).kappa", {"slip_ranges": ENTRIES["(4.5).kappa"].ranges}),
        ("def.s", {"slip_ranges": ()}),
        ("T1.III.c_f^2", {"printed": r"\frac{G}{\rho} = C^2"}),
    ],
)
def test_a_wrong_string_is_a_verdict(id, changes):
    record = judged(id, **changes)
    assert record.verdict == "untested"
    assert record.problems


def test_equal_sections_give_twice_kappa():
    for equal in (True, False):
        node = Physical("II", 3, equal).node(1)
        kappa = node.beta / node.inertia / 2
        assert (node.rate == 2 * kappa) is equal
