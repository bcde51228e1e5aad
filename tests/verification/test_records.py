"""Modes against the march in `verify`: what agrees, what is seen, and what is said where there is no march."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import pytest

from tests.support.shaken import SAMPLES, shaken
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.verification import checks
from wavesym.verification.checks import records
from wavesym.verification.reference import Known


@cache
def made():
    """A record that modes take, with their program."""
    model = shaken([0, *SAMPLES], until=90, strain=["1/3"], velocity=[3], displacement=[], tolerance="1e-5")
    return model, make(model, Request(evaluator="modes"))


@pytest.fixture
def modal(monkeypatch):
    model, program = made()
    monkeypatch.setattr(
        checks, "make", lambda given, request: program if request.evaluator == "modes" else make(given, request)
    )
    return model, program


def test_modes_agree_with_the_march_of_a_hat(modal):
    """Motion to 1e-11, strain to what is proved of the modes that are left out."""
    model, program = modal
    strain, velocity = records(Known(model, model, 90.0, (), ()))
    assert strain.passed
    assert velocity.passed
    assert float(velocity.cells["error"]) < 1e-11
    assert float(velocity.cells["allowed"]) < 1e-7
    assert float(strain.cells["error"]) < program.outputs[0].bound < 1e-5


def test_modes_that_are_wrong_are_seen(modal, monkeypatch):
    model, program = modal
    right = program.evaluate
    wrong = SimpleNamespace(evaluator="modes", outputs=program.outputs, evaluate=lambda taus: right(taus + 1e-4))
    monkeypatch.setattr(
        checks, "make", lambda given, request: wrong if request.evaluator == "modes" else make(given, request)
    )
    assert not any(outcome.passed for outcome in records(Known(model, model, 90.0, (), ())))


def test_what_a_march_does_not_serve_is_said(modal, monkeypatch):
    model, _ = modal
    jumps = replace(model, loads=tuple(replace(load, source="a") for load in model.loads))
    (outcome,) = records(Known(jumps, jumps, 90.0, (), ()))
    assert (outcome.passed, outcome.cells) == (True, {"march": "refused"})
    assert "times at a spacing of 1.37 leave 26 different remainders of the step 1" in outcome.note
