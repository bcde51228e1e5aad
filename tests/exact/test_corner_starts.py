"""Laws exactly at their corner while all is at rest: what comes first decides, however smoothly it comes."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest
from flint import arb, ctx

from tests.exact.test_corner_truth import wrong
from wavesym.exact.contacts.events import events
from wavesym.exact.reference import Reference
from wavesym.scene import Scene, lower

LAWS: dict[str, tuple[Any, str, dict[str, Any]]] = {
    "push": ({"spring": 2, "only": "push"}, "0", {}),
    "pull": ({"spring": 2, "only": "pull"}, "0", {}),
    "backlash": ({"spring": 2, "gap": [0, "1/8"]}, "0", {}),
    "yields pulled": ({"spring": 2, "yield": "1/2", "preload": "1/2"}, "1/2", {}),
    "yields pushed": ({"spring": 2, "yield": ["1/3", "1/2"], "preload": "-1/2"}, "-1/2", {}),
    "slips one way": ({"spring": 1}, "1/2", {"friction": "1/2"}),
    "slips the other way": ({"spring": 1}, "-1/2", {"friction": "1/2"}),
    "contact": ("contact", "0", {}),
}
"""What is between the ground and a mass; the load that strains it up to its corner; what else the mass has."""

BESIDE: dict[str, list[Any]] = {
    "nothing": [],
    "a rod": [{"rod": 1, "impedance": "1/2"}, {"mass": 1, "velocity": 0}],
    "a contact": [{"spring": "1/3"}, {"mass": "5/3", "velocity": 0, "name": "n"}, "contact", {"rod": 1}, "absorbing"],
}
"""The other neighbours of the mass: the contact has no force at first, either."""


def scene(law: str, comes: str, way: int, beside: str) -> dict[str, Any]:
    """A jump or a ramp acts on the mass; or a wave comes to it at 1/2, which begins as a parabola."""
    part, strain, own = LAWS[law]
    ground = ["fixed", {"spring": 1}, {"mass": 1, "velocity": 0}, {"rod": 1}] if part == "contact" else ["fixed"]
    far = [{"rod": "1/2"}, {"mass": 1, "velocity": 0, "name": "far"}] if comes == "wave" else BESIDE[beside]
    parts = [*ground, part, {"mass": "5/2", "velocity": 0, "name": "m", **own}, *far]
    at, how = ("far", "ramps") if comes == "wave" else ("m", f"{comes}s")
    loads = [{"at": "m", "times": [0], "steps": [strain]}, {"at": at, "times": [0], how: [way]}]
    output = {"until": 4, "displacement": ["m"], "velocity": ["m"]}
    return {"name": "corner", "system": {"type": "chain", "parts": parts}, "load": loads, "output": output}


EVERY = [*product(LAWS, ["step", "ramp"], [1, -1], BESIDE), *product(LAWS, ["wave"], [1, -1], ["a rod"])]
SOME = [each for each in EVERY if each[1:] == ("ramp", 1, "a contact")] + [("slips one way", "wave", -1, "a rod")]


@pytest.mark.quick(5)
@pytest.mark.parametrize(
    ("law", "comes", "way", "beside"),
    [each if each in SOME else pytest.param(*each, marks=pytest.mark.slow) for each in EVERY],
)
def test_what_comes_first_decides(law: str, comes: str, way: int, beside: str) -> None:
    assert wrong(scene(law, comes, way, beside), first="0") == []


@pytest.mark.slow
def test_a_limit_that_is_relieved_as_the_square_of_time_is_touched_and_met_again() -> None:
    """u = -(1 - cos w tau)/40 until 1, with w^2 = 40, which touches 0 at 2 pi/w; then u'' = -40 u, up to 0."""
    parts = [{"mass": 1, "velocity": 0, "name": "m"}, {"spring": 40, "yield": [0, 10], "preload": -10}, "fixed"]
    loads = [{"at": "m", "times": [0, 1], "steps": [9, 1]}]
    output = {"until": 4, "displacement": ["m"], "velocity": ["m"]}
    model = lower(Scene(name="lifted", system={"type": "chain", "parts": parts}, load=loads, output=output))
    (yields,) = events(model)
    (velocity,), (displacement,) = Reference(model).values([2.0])
    with ctx.workprec(200):
        met, fast = arb("0.5") + 2 * arb.pi() / arb(40).sqrt(), (arb(40).sqrt() / 2).sin() / arb(10).sqrt()
        assert yields.kind == "yields"
        assert abs(yields.tau - met) < arb("1e-40")
        assert abs(arb(velocity) - abs(fast)) < arb(2) ** -52
        assert abs(arb(displacement) - abs(fast) * (2 - met)) < arb(2) ** -52


def test_an_idle_spring_at_its_gap_leaves_a_contact_its_first_power() -> None:
    """v' + v = tau until 1, then -1; the contact, with the force v of the rod, opens as v = 0."""
    parts = ["fixed", {"spring": 2, "only": "push"}, {"mass": 1, "velocity": 0, "name": "m"}]
    loads = [{"at": "m", "times": [0, 1], "steps": [0, -2], "ramps": [1, -1]}]
    output = {"until": "3/2", "velocity": ["m"]}
    system = {"type": "chain", "parts": [*parts, "contact", {"rod": 1}, "absorbing"]}
    lets_go, opens = events(lower(Scene(name="idle", system=system, load=loads, output=output)))
    assert (lets_go.kind, lets_go.double, opens.kind) == ("releases", 0, "opens")
    with ctx.workprec(200):
        assert abs(opens.tau - (1 + (1 + arb(-1).exp()).log())) < arb("1e-40")


def test_a_ramp_into_a_spring_at_its_gap_swings_about_its_balance() -> None:
    """u = tau - sin tau for tau > 0 under a ramp of 1, with K = M = 1."""
    parts = ["fixed", {"spring": 1, "only": "pull"}, {"mass": 1, "velocity": 0, "name": "m"}]
    loads = [{"at": "m", "times": [0], "ramps": [1]}]
    output = {"until": 3, "displacement": ["m"]}
    model = lower(Scene(name="swing", system={"type": "chain", "parts": parts}, load=loads, output=output))
    assert events(model) == ()
    ((value,),) = Reference(model).values([2.0])
    with ctx.workprec(200):
        assert abs(arb(value) - (2 - arb(2).sin())) < arb(2) ** -52
