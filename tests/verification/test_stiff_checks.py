"""What `verify` makes of stiff springs: balances stay sharp, and steps that cannot keep up say so."""

from __future__ import annotations

import pytest

import wavesym
from wavesym.scene import lower
from wavesym.verification import integrations
from wavesym.verification import invariants as balances
from wavesym.verification.checks import invariants
from wavesym.verification.integrations import collocation, midpoints
from wavesym.verification.reference import ReferenceOutputs, known_outputs


def made(stiffness: int) -> ReferenceOutputs:
    parts = ["fixed", {"rod": 1}, {"mass": 1, "spring": stiffness, "name": "body"}, {"rod": 1}]
    load = [{"at": "body", "times": [0], "steps": [1]}]
    output = {"until": 2, "tolerance": 1e-9, "velocity": ["body"]}
    scene = wavesym.Scene(name="stiff", system={"type": "chain", "parts": parts}, load=load, output=output)
    return known_outputs(lower(scene))


def test_balances_of_a_stiff_spring_are_sharp() -> None:
    for outcome in invariants(made(10**4)):
        assert outcome.passed
        assert not outcome.note
        assert float(outcome.cells["allowed"]) < 1e-11


@pytest.mark.slow
def test_panels_on_which_springs_swing_far_tell_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(balances, "_SWING", 1e9)
    assert any(float(outcome.cells["allowed"]) > 1e-7 for outcome in invariants(made(10**5)))


@pytest.mark.slow
def test_collocation_follows_a_stiff_spring() -> None:
    assert all(outcome.passed and float(outcome.cells["at 4N"]) < 1e-9 for outcome in collocation(made(10**4)))


def test_steps_refuse_springs_that_they_cannot_follow(monkeypatch: pytest.MonkeyPatch) -> None:
    stiff = made(10**4)
    monkeypatch.setattr(integrations, "MOST_MOVED", integrations.MOST_MOVED // 1000)
    assert all("radians" in outcome.note and outcome.cells == {"to": "refused"} for outcome in midpoints(stiff))
    assert all("radians" not in outcome.note for outcome in midpoints(made(100)))
