"""The conditions at the nodes: judged from their strings, places and ranges too."""

from __future__ import annotations

import pytest

from tests.papers.falsified import ENTRIES, judged

SLIPS = {
    "(2.3)": "misprint",
    "(2.4).2": "convention",
    "(2.4).5": "convention",
    "(4.4).1": "unreadable",
    "(4.5).1": "model",
    "(4.5).2": "convention",
}


def test_what_is_wrong_is_stated_beside_what_holds():
    assert {id for id, e in ENTRIES.items() if e.kind == "condition" and e.slip} == SLIPS.keys()


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("id", "changes"),
    [
        ("(4.3).5", {"ranges": (r"\bar{x} = m",)}),
        ("(4.3).5", {"ranges": (r"\bar{x} = m+1",)}),
        ("(4.3).5", {"ranges": ()}),
        ("(4.3).5", {"ranges": (r"\bar{x} = m-1", r"n = 1, 2, \dots, m")}),
        ("(4.3).3", {"ranges": (r"\bar{x} = i", r"i = 2, 4, \dots, m-4")}),
        ("(4.3).3", {"ranges": (r"\bar{x} = i", r"i = 2, 4, \dots, m")}),
        ("(4.3).2", {"ranges": (r"\bar{x} = i", r"i = 2, 3, \dots, m-1")}),
        ("(4.3).3", {"printed": r"\frac{\partial \bar{u}_i(\bar{x}, \tau)}{\partial \bar{x}} = 0"}),
        ("(4.3).6", {"printed": r"\frac{\partial \bar{u}_m(\bar{x}, \tau)}{\partial \tau} = 0"}),
        ("(4.3).6", {"printed": r"\frac{\partial \bar{u}_m(\bar{x}, \tau)}{\partial \bar{x}}"}),
        ("(2.4).3", {"printed": r"\frac{\partial U_i}{\partial x} = \frac{\partial U_{i+1}}{\partial x}"}),
        ("(2.4).4", {"subject": {"at": "a body at a right end"}}),
        ("(4.4).4", {"printed": "-" + ENTRIES["(4.4).4"].printed}),
    ],
)
def test_a_condition_that_is_falsified_loses_its_verdict(id, changes):
    assert judged(id, **changes).verdict == "untested"


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("id", "slip"),
    [
        ("(2.3)", {"ranges": ("x = il", r"i=1, 2, \dots, m-2")}),
        ("(2.3)", {"ranges": ("x = i", r"i=1, 2, \dots, m-1")}),
        ("(2.4).2", {"ranges": ("x_i = il",)}),
        ("(2.4).5", {"ranges": ("x_i = i",)}),
        ("(2.4).2", {"ranges": ()}),
        ("(2.4).5", {"correction": ENTRIES["(2.4).5"].printed.replace("S_i", "-S_i", 1)}),
        ("(4.5).1", {"correction": ENTRIES["(4.5).1"].printed}),
    ],
)
def test_a_correction_that_is_falsified_loses_its_verdict(id, slip):
    assert judged(id, slip=slip).verdict == "untested"


def test_a_slip_needs_something_that_fails():
    right = ENTRIES["(4.4).1"].slip.correction
    assert judged("(4.4).1", printed=right).verdict == "untested"


def test_a_counterexample_is_a_scene():
    shown = judged("(4.4).4", printed="-" + ENTRIES["(4.4).4"].printed).counterexample.example()
    assert 'type = "drive"' in shown.scene
    assert "SCENE" in shown.command
    assert "velocity@1" in shown.look
