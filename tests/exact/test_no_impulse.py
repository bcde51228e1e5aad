"""What moves and has mass is not stopped at once by friction of what has none: closed forms."""

from __future__ import annotations

from math import exp, log
from typing import Any

import numpy as np
import pytest

import wavesym
from tests.exact.test_corner_truth import wrong
from wavesym.exact.contacts.touching_joint import TouchingJoint

ABSORBING = ["absorbing", {"rod": "1/2"}]
RUBS: dict[str, Any] = {"joint": True, "name": "n1", "friction": "1/5"}
LIGHT = [RUBS | {"friction": "1/4"}, {"rod": 1}, "absorbing"]


def chain(parts: list[Any], load: dict[str, Any] | None = None) -> wavesym.Scene:
    return wavesym.Scene(
        name="rubs",
        system={"type": "chain", "parts": parts},
        load=[load] if load else [],
        output={"until": 3, "tolerance": 1e-9, "velocity": [part["name"] for part in parts if "name" in part]},
    )


def events_of(scene: wavesym.Scene) -> list[tuple[str, float]]:
    return [(event.kind, float(event.double)) for event in scene.run().events]


def blow(velocity: float, mirrored: bool = False) -> wavesym.Scene:
    """A mass of 2 comes upon a joint that rubs, at the end of a rod that absorbs."""
    parts = [*ABSORBING, RUBS, {"contact": "1/8"}, {"mass": 2, "name": "n2", "velocity": str(velocity)}]
    return chain(parts[::-1] if mirrored else parts)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("speed", [0.05, 0.25, 3.0])
def test_a_mass_that_comes_upon_what_rubs_goes_on(speed: float, mirrored: bool) -> None:
    """2 s' = -s - 1/5 from the contact on: s = (v + 1/5) exp(-(t - T)/2) - 1/5."""
    scene = blow(speed if mirrored else -speed, mirrored)
    closes = 0.125 / speed
    sticks = closes + 2 * log((speed + 0.2) / 0.2)
    expected = [("closes", closes), ("slips", closes), ("sticks", sticks)]
    found = events_of(scene)
    assert [kind for kind, _ in found] == [kind for kind, tau in expected if tau < 3]
    assert [tau for _, tau in found] == pytest.approx([tau for _, tau in expected if tau < 3], rel=1e-14)
    taus = np.linspace(closes, 3, 50)[1:]
    right = np.maximum((speed + 0.2) * np.exp(-(taus - closes) / 2) - 0.2, 0)
    values = wavesym.evaluator(scene)(taus)
    assert np.max(np.abs(np.abs(values) - right)) < 1e-12 * speed


def test_a_mass_goes_on_over_a_joint_that_stops() -> None:
    """It slows down by 2/5, the joint goes at 2/5 - 1/4; together by 1/4 + their velocity."""
    scene = chain([{"mass": 1, "name": "n0", "velocity": 1}, {"friction": "2/5"}, *LIGHT])
    expected = [("slips", 0.0), ("sticks", 0.85 / 0.4), ("sticks", 0.85 / 0.4 + log(1.6))]
    assert events_of(scene) == [(kind, pytest.approx(tau, rel=1e-14)) for kind, tau in expected]
    values = wavesym.evaluator(scene)([1.0, 2.0, 2.3])
    together = 0.4 * exp(-(2.3 - 2.125)) - 0.25
    assert values == pytest.approx(np.array([[0.6, 0.2, together], [0.15, 0.15, together]]), rel=1e-13)


def test_a_joint_that_a_load_no_longer_pulls_does_not_stop_a_mass() -> None:
    scene = chain(
        [{"mass": 1, "name": "n0", "velocity": 0}, {"friction": "1/5"}, *LIGHT],
        {"at": "n1", "times": [0, 1], "steps": [1, -1]},
    )
    assert wavesym.evaluator(scene)([1.0, 1.5, 2.5]).tolist() == pytest.approx(np.array([[0.2, 0.1, 0], [0, 0, 0]]))


def test_without_that_it_would_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(TouchingJoint, "may_join", lambda *_: True)
    assert [kind for kind, _ in events_of(blow(-0.3))] == ["closes"]


M: dict[str, Any] = {"mass": 2, "name": "n2", "velocity": "-1/4"}
OVER: list[Any] = [{"mass": 1, "name": "n0", "velocity": 1}, {"friction": "2/5"}, *LIGHT[:2]]
RUBBING: dict[str, tuple[list[Any], dict[str, Any] | None]] = {
    "comes to rest": ([*ABSORBING, RUBS, {"contact": "1/8"}, M], None),
    "bounces": ([*ABSORBING, RUBS, {"contact": "1/8"}, M, {"spring": 1}, "fixed"], None),
    "pulled off": ([*ABSORBING, RUBS, {"contact": "1/8"}, M], {"at": "n2", "times": [1], "steps": ["1/8"]}),
    "pushed back": ([*ABSORBING, RUBS, {"contact": "1/8"}, M], {"at": "n1", "times": [1], "steps": ["1/8"]}),
    "struck again": (["fixed", {"rod": "1/2"}, RUBS, {"contact": "1/8"}, M], None),
    "over friction": ([*OVER, "absorbing"], None),
    "on a spring": (["fixed", {"spring": "1/2"}, *OVER, "absorbing"], None),
    "on a rod": ([{"rod": 1}, *OVER, "absorbing"], None),
}


@pytest.mark.parametrize("name", RUBBING)
def test_masses_beside_a_joint_that_rubs_move_as_they_should(name: str) -> None:
    """Against a solver of its own, which knows which points without mass say what a mass may be."""
    parts, load = RUBBING[name]
    assert wrong(chain(parts, load).model_dump(mode="json", by_alias=True, exclude_unset=True), first="0") == []
