"""Chains with contacts against a solver that shares nothing with the package: events to 18 digits, values to a bit."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, reject, settings

from tests.support.judging import wrong_events, wrong_values
from tests.support.piecewise import PiecewiseChain
from tests.support.series import Unclear
from tests.support.striking import seeded, striking
from wavesym.errors import WavesymError
from wavesym.exact.contacts.events import events
from wavesym.scene import Scene, lower

# walls, masses, a branch; what parts at once, parts and strikes again; what is nearly as long; what stays at rest where
# balls do not tell
KEPT = (5, 18, 24, 39, 207, 297)


def wrong(table: Mapping[str, Any], claimed: Mapping[str, Any] | None = None) -> list[str]:
    """What is not as the truth has it; `claimed` is another scene to take the package's word for."""
    model = lower(Scene(**(claimed or table)))
    until = Fraction(model.horizon())
    made = PiecewiseChain(table, until)
    return [*wrong_events(model, made), *wrong_values(model, made, instants(made, until))]


def instants(made: PiecewiseChain, until: Fraction) -> list[float]:
    """Some in the horizon, and soon after what happened."""
    after = [int(event.tau.p) / int(event.tau.q) + 1e-9 for event in made.events[:4]]
    return sorted(
        tau for tau in [*(float(until) * part for part in (0.1234, 0.377, 0.71, 0.97)), *after] if tau <= until
    )


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", KEPT)
def test_contacts_open_and_close_as_they_should(seed: int) -> None:
    assert wrong(seeded(seed)) == []


# a cushion without mass lifts off: from the ground, a ram, a rod, what is moved, with loads on it, and on the right
CUSHION = {"spring": 4, "dashpot": "1/4"}
ROD, BAR = {"rod": 1, "velocity": -1}, {"rod": 1, "impedance": 2}
CAP = {"joint": True, "name": "cap", **CUSHION}
LIFTED = {
    "ground": [CAP, "contact", ROD, BAR],
    "ram": [{"mass": 1, "velocity": 1}, CUSHION, "contact", {**ROD, "velocity": 0}, BAR, "fixed"],
    "rod": [{"rod": 1, "velocity": 1}, {"spring": 4, "dashpot": "1/20"}, {"contact": "1e-9"}, BAR, "fixed"],
    "motion": [{"motion": "velocity", "velocity": "1/3", "name": "cap"}, CUSHION, {"contact": "1/4"}, ROD, BAR],
    "right": ["fixed", BAR, {"rod": 1, "velocity": 1}, "contact", CUSHION, {"mass": 2, "name": "cap", "velocity": 0}],
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("where", [pytest.param(k, marks=pytest.mark.slow) if k == "rod" else k for k in LIFTED])
def test_a_cushion_without_mass_lifts_off_as_it_should(where: str) -> None:
    parts = LIFTED[where]
    named = [part["name"] for part in parts if isinstance(part, dict) and "name" in part]
    load = [{"at": "cap", "times": [0, "1.1"], "steps": ["1/2", "-1/5"]}] if where in ("ground", "right") else []
    output = {"until": 5, "strain": ["1/2", "3/2"], "velocity": ["1/3", *named], "displacement": ["4/3", *named]}
    table = {"name": where, "system": {"type": "chain", "parts": parts}, "load": load, "output": output}
    assert wrong(table) == []
    assert any(event.kind == "opens" for event in events(lower(Scene(**table))))


def beside_a_light_mass(until: str, where: str = "2.8", **mass: Any) -> dict[str, Any]:
    """A rod, a mass that dies away at a rate of 520, a rod and a body that strikes another rod."""
    parts = [
        {"rod": 1, "impedance": "1/5", "velocity": 1},
        {"mass": "1/100", "velocity": 1, **mass},
        {"rod": 1, "impedance": 5, "velocity": 1},
        {"mass": 1, "velocity": 1},
        "contact",
        {"rod": 1, "impedance": 5},
        "fixed",
    ]
    output = {"until": until, "strain": [where]}
    return {"name": "light", "system": {"type": "chain", "parts": parts}, "output": output}


@pytest.mark.slow
def test_what_a_light_mass_sends_later_than_it_matters_hides_no_contact() -> None:
    """Up to the horizon its last series would have to bear exp(520); a shorter horizon asks for less."""
    (soon,) = events(lower(Scene(**beside_a_light_mass("4.9"))))
    (found,) = events(lower(Scene(**beside_a_light_mass("10.9"))))
    assert (found.kind, found.digits) == (soon.kind, soon.digits) == ("opens", "4.1324723797398596237")


@pytest.mark.slow
@pytest.mark.parametrize("where", ["0.3", "2.2", "2.8"])
@pytest.mark.parametrize("mass", [{}, {"spring": 4}, {"mass": "1/300"}, {"mass": "1/30", "dashpot": "1/10"}])
@pytest.mark.parametrize("until", ["10.9", "4.9325", "4.1325", "7.3"])
def test_any_light_mass_near_a_contact_is_served(until: str, where: str, mass: dict[str, Any]) -> None:
    """Also just after the contact opened, at 4.1324..., and when that is seen."""
    assert wrong(beside_a_light_mass(until, where, **mass)) == []


def judged(table: Mapping[str, Any]) -> list[str]:
    """The same, where it can be decided and costs little."""
    try:
        return wrong(table)
    except (Unclear, WavesymError):
        reject()


@settings(max_examples=2)
@given(striking())
def test_any_contacts_open_and_close_as_they_should(table: Mapping[str, Any]) -> None:
    assert judged(table) == []


@pytest.mark.slow
@settings(max_examples=150)
@given(striking())
def test_many_contacts_open_and_close_as_they_should(table: Mapping[str, Any]) -> None:
    assert judged(table) == []


def test_a_gap_that_is_a_little_wider_is_seen() -> None:
    parts = [{"rod": 1, "velocity": 1}, {"contact": "1/4"}, {"rod": 2}]
    table = {"name": "bars", "system": {"type": "chain", "parts": parts}, "output": {"until": 3, "velocity": ["1+"]}}
    wider = [parts[0], {"contact": "0.2500000000001"}, parts[2]]
    assert wrong(table) == []
    assert wrong(table, {**table, "system": {"type": "chain", "parts": wider}})
