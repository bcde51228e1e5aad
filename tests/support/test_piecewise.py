"""The truth for contacts against published and elementary numbers, and the Laplace expansion where there are none."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx, fmpq
from hypothesis import given, settings

from tests.support.chains import chains
from tests.support.laplace import Laplace
from tests.support.piecewise import PiecewiseChain
from tests.support.series import Unclear
from tests.support.striking import seeded

DIGITS = 25


def scene(*parts: Any, load: Any = ()) -> dict[str, Any]:
    return {"system": {"type": "chain", "parts": list(parts)}, "load": list(load)}


def events(made: PiecewiseChain) -> list[tuple[str, str, fmpq]]:
    return [(event.place, event.kind, event.tau) for event in made.events]


def near(one: arb | fmpq, other: arb | fmpq) -> bool:
    return bool(abs(arb(one) - arb(other)) < arb(10) ** -DIGITS)


@pytest.fixture(autouse=True)
def digits():
    with ctx.workprec(200):
        yield


@settings(max_examples=5)
@given(chains(3))
def test_without_contacts_it_is_the_laplace_expansion(table: dict[str, Any]) -> None:
    made, expansion = PiecewiseChain(table, 3), Laplace(table, 3)
    for quantity in ("velocity", "strain", "displacement"):
        for place in table["output"][quantity]:
            for tau in (Fraction(1, 7), Fraction(8, 5), Fraction(299, 100)):
                found, true = made.value(quantity, place, tau), expansion.terms(quantity, place).value(tau, DIGITS)
                assert abs(found - true) < arb(10) ** -DIGITS * (1 + abs(true))


@pytest.mark.parametrize("ratio", ["1/4", 1, 3])
def test_a_rigid_mass_leaves_a_free_rod_after_two_delays(ratio: object) -> None:
    """Of mass ratio a, with the restitution (1 - e^-2a)/a - e^-2a."""
    a = Fraction(str(ratio))
    made = PiecewiseChain(scene({"mass": str(1 / a), "velocity": 1, "name": "body"}, "contact", {"rod": 1}), 5)
    assert events(made) == [("0", "opens", 2)]
    left = made.value("velocity", "body", Fraction(4))
    exact = arb(a.numerator) / a.denominator
    assert near((1 - left) / exact - left, (1 - (-2 * exact).exp()) / exact - (-2 * exact).exp())


def test_two_bars_of_one_section() -> None:
    """The force lasts 2 l1/c, the ends part at 2 l2/c; then the first is at rest, the other moves with v l1/l2."""
    made = PiecewiseChain(scene({"rod": 1, "velocity": 3}, {"contact": "1/2"}, {"rod": "5/2"}), 7)
    start = fmpq(1, 6)
    assert [event[:2] for event in events(made)] == [("1", "closes"), ("1", "opens")]
    assert all(near(event.tau, tau) for event, tau in zip(made.events, (start, start + 5), strict=True))
    assert made.value("velocity", "1/2", Fraction(6)) == 0
    moved = [made.value("displacement", "7/2", Fraction(tau)) for tau in ("1/6", "31/6")]
    assert near((moved[1] - moved[0]) / 5, fmpq(6, 5))


def test_a_bar_that_bounces() -> None:
    """Doyen, Ern and Piperno 2011: E 900, density 1, length 10, gravity 10, dropped from 5, in the falling frame."""
    bar = {"rod": 10, "speed": 30, "impedance": 30}
    load = [{"at": "ground", "times": [0], "steps": [10]}]
    made = PiecewiseChain(scene({"motion": "acceleration", "name": "ground"}, {"contact": 5}, bar, load=load), 6)
    contact = [fmpq(1), fmpq(5, 3), fmpq(11, 3), fmpq(13, 3)]
    assert len(made.events) == len(contact)
    assert all(near(event.tau, tau) for event, tau in zip(made.events, contact, strict=True))
    for tau, height in (("1/2", "15/4"), ("2", "5/3"), ("7/3", "40/9"), ("3", "40/9"), ("5", "40/9")):
        fallen = 5 - 5 * Fraction(tau) ** 2 - Fraction(height)
        assert near(made.value("displacement", "0+", Fraction(tau)), -fmpq(*fallen.as_integer_ratio()))


def test_what_strikes_a_fixed_bar_strikes_it_again() -> None:
    """From p(tau) = sum_k H(tau - 2k) e^-(tau - 2k) L_k(2 (tau - 2k)): it leaves where p(tau) + p(tau - 2) = 0."""
    made = PiecewiseChain(scene({"mass": 1, "velocity": 1}, "contact", {"rod": 1}, "fixed"), 6)
    assert [event.kind for event in made.events] == ["opens", "closes", "opens"]
    w = arb(made.events[0].tau) - 2
    assert near((-w).exp() * (1 - 2 * w) + (-w - 2).exp() + (-w).exp(), 0)


def test_events_by_symmetry_are_at_one_instant() -> None:
    half = [{"mass": 1, "velocity": 1}, "contact", {"rod": 1}]
    made = PiecewiseChain(scene(*half, "contact", {"rod": 1}, "contact", {"mass": 1, "velocity": -1}), 5)
    assert len(made.events) == 7
    outer = [[event.tau for event in made.events if event.place == place] for place in ("0", "2")]
    assert outer[0] == outer[1]


def test_a_contact_without_force_waits_for_what_parts_it() -> None:
    """Two bars at rest that touch; the force on the second is 0 until a load pulls it away."""
    load = [{"at": "end", "times": [1], "steps": [1]}]
    parts = [{"rod": 1}, "contact", {"rod": 1}, {"joint": True, "name": "end"}]
    assert events(PiecewiseChain(scene(*parts, load=load), 4)) == [("1", "opens", 2)]


@pytest.mark.slow
def test_drawn_scenes_are_decided_and_many_things_happen() -> None:
    found = []
    for seed in (1, 5, 14, 18):
        table = seeded(seed)
        found.append(len(PiecewiseChain(table, Fraction(str(table["output"]["until"]))).events))
    assert sum(found) >= 15


def test_what_only_touches_is_unclear() -> None:
    """The gap 1/2 - tau + tau^2/2 is 0 at tau = 1, and nowhere negative."""
    wall = {"motion": "velocity", "velocity": 1, "name": "wall"}
    load = [{"at": "wall", "times": [0], "ramps": [-1]}]
    with pytest.raises(Unclear):
        PiecewiseChain(scene(wall, {"contact": "1/2"}, {"rod": "3/2"}, load=load), 2)
