"""Chains with corners against a solver that shares nothing with the package: events to 18 digits, values to a bit."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest
from flint import ctx

from tests.support.cornered import breaking_chain, damped_chain, rubbing_masses, seeded, sliding_chain, touching_chain
from tests.support.judging import BITS, CLOSE, wrong_events, wrong_values
from tests.support.piecewise import PiecewiseChain
from tests.support.series import Unclear
from wavesym.errors import WavesymError
from wavesym.exact.contacts.events import events
from wavesym.exact.losses import losses
from wavesym.exact.reference import Reference
from wavesym.scene import Scene, lower

# beside linear springs, between rods, on a mass and without one; a chain that is its own mirror image
KEPT = (82, 16, 29, 89, 118)

# springs of one side, with gaps on both, that yield: beside rods, between masses, to the ground
SPRUNG = (8, 5, 10, 19, 22, 25)

# the instant at which another node sticks arrives, and what rubs stays as it is: no event
LASTING = 72

# dashpots beside springs that yield
DAMPED = (1, 5, 11, 52)

# contacts beside springs: many events of both; one that yields while a contact far from it is vague
TOUCHING = (6, 18, 69, 85, 134, 186)

# friction between masses, with a spring beside it, of a joint without mass, beside a rod; on a belt that jumps or is
# accelerated; slipping the other way at once; at an instant that is exact
SLIDING = (0, 12, 41, 42, 45, 51, 74, 104)

# a joint without mass comes to rest on a mass, with a force that is just R then
RESTING = (7, 22, 37, 44)

# friction beside springs that yield, engage, and other friction
RUBBING = (4, 38, 49, 51)

# a mass that breaks away at once, at a front, turning round; masses on a belt and beside rods
BREAKING = (9, 3, 11, 33, 38)


def wrong(table: Mapping[str, Any], claimed: Mapping[str, Any] | None = None, first: str = "-1") -> list[str]:
    """What is not as the truth has it; `claimed` is another scene to take the package's word for."""
    model = lower(Scene(**(claimed or table)))
    until = Fraction(model.horizon())
    made = PiecewiseChain(table, until)
    taus = [float(until) * part for part in (0.1234, 0.377, 0.71, 0.97)]
    # two sides of a gap are two springs of one place
    faults = [*wrong_events(model, made, lambda place: place.rstrip("+-"), first), *wrong_values(model, made, taus)]
    with ctx.workprec(BITS):
        for loss in losses(model):
            here = (loss.link.place.rstrip("+-"), loss.link.law)
            taken = list(zip(made.corners, made.dissipated(), strict=True))
            true = [energy for (place, law), energy in taken if (place.rstrip("+-"), law) == here]
            true += [one + other for one, other in pairwise(true)]  # of a gap, whose sides are told as one
            if not any(abs(loss.dissipated - energy) <= CLOSE for energy in true):
                faults.append(f"at {here}: {loss.dissipated} dissipated, not {true}")
    return faults


def drawn(seed: int) -> dict[str, Any]:
    """A chain with friction alone."""
    return seeded(seed, ["linear"])


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", KEPT)
def test_what_rubs_slips_and_sticks_as_it_should(seed: int) -> None:
    assert wrong(drawn(seed)) == []


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", SPRUNG)
def test_springs_with_laws_change_branches_as_they_should(seed: int) -> None:
    assert wrong(seeded(seed)) == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", DAMPED)
def test_dashpots_beside_springs_that_yield_act_all_the_time(seed: int) -> None:
    assert wrong(damped_chain(seed)) == []


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", TOUCHING)
def test_contacts_beside_springs_open_and_close_as_they_should(seed: int) -> None:
    assert wrong(touching_chain(seed)) == []


@pytest.mark.slow
def test_springs_beside_contacts_that_nothing_makes_yield_are_linear() -> None:
    def scene(law: dict[str, Any]) -> Scene:
        parts = [{"rod": 1, "velocity": 1, "impedance": 2}, "contact", {"joint": True, "dashpot": "1/10"}]
        parts += [{"spring": 4, **law}, {"mass": 1, "name": "n"}, {"rod": 2}]
        output = {"until": 9, "displacement": ["n", "0"]}
        return Scene(name="struck", system={"type": "chain", "parts": parts}, output=output)

    linear, yielding = lower(scene({})), lower(scene({"yield": 1000}))
    assert [(e.kind, e.double) for e in events(linear)] == [(e.kind, e.double) for e in events(yielding)]
    taus = [k / 7 for k in range(63)]
    assert Reference(linear).values(taus) == Reference(yielding).values(taus)


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", [*SLIDING, *RESTING])
def test_what_rubs_on_another_part_slips_and_sticks_as_it_should(seed: int) -> None:
    assert wrong(sliding_chain(seed), first="0") == []


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", RUBBING)
def test_friction_beside_springs_slips_and_sticks_as_it_should(seed: int) -> None:
    assert wrong(rubbing_masses(seed)) == []


@pytest.mark.quick(1)
@pytest.mark.parametrize("mass", ["11/5", "1/3"])
def test_what_comes_to_rest_on_two_masses_that_stick_goes_back(mass: str) -> None:
    """Their common velocity was rounded as they were parted from the third one, which then slid the wrong way."""
    rods, plate = {"rod": 1}, {"mass": 1, "name": "b", "velocity": 3}
    parts = [rods, {"mass": mass, "name": "a", "velocity": "1/2"}, {"friction": 10}, plate]
    parts += [{"friction": "1/4"}, {"mass": 1, "name": "c", "velocity": 3}, rods]
    output = {"until": 3, "tolerance": 1e-9, "velocity": ["a", "c"]}
    assert wrong({"name": "three", "system": {"type": "chain", "parts": parts}, "output": output}) == []


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", BREAKING)
def test_friction_that_bears_more_at_rest_breaks_away_as_it_should(seed: int) -> None:
    assert wrong(breaking_chain(seed), first="0") == []


@pytest.mark.slow
def test_a_limit_at_rest_that_is_slightly_off_is_seen() -> None:
    table = breaking_chain(3)
    parts = [
        {**part, "breakaway": str(Fraction(part["breakaway"]) + Fraction(1, 10**16))} if "breakaway" in part else part
        for part in table["system"]["parts"]
    ]
    assert wrong(table, table | {"system": {"type": "chain", "parts": parts}}, first="0")


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, 100, 20))
def test_drawn_friction_with_two_limits_does_as_it_should(start: int) -> None:
    for seed in range(start, start + 20):
        assert wrong(breaking_chain(seed), first="0") == [], seed


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, 100, 20))
def test_drawn_friction_between_parts_does_as_it_should(start: int) -> None:
    for seed in range(start, start + 20):
        assert wrong(sliding_chain(seed), first="0") == [], seed


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, 50, 10))
def test_drawn_contacts_beside_springs_do_as_they_should(start: int) -> None:
    refused = 0
    for seed in range(start, start + 10):
        try:
            assert wrong(touching_chain(seed)) == [], seed
        except (WavesymError, Unclear):
            refused += 1
    assert refused <= 1


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, 50, 10))
def test_drawn_springs_change_branches_as_they_should(start: int) -> None:
    refused = 0
    for seed in range(start, start + 10):
        try:
            assert wrong(seeded(seed)) == [], seed
        except (WavesymError, Unclear):
            refused += 1
    assert refused <= 1


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, 120, 20))
def test_drawn_chains_slip_and_stick_as_they_should(start: int) -> None:
    refused = 0
    for seed in range(start, start + 20):
        try:
            assert wrong(drawn(seed)) == [], seed
        except (WavesymError, Unclear):
            refused += 1
    assert refused <= 4


def test_what_goes_on_as_it_was_has_no_event() -> None:
    assert wrong(drawn(LASTING)) == []


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", KEPT[:2])
def test_a_limit_that_is_slightly_off_is_seen(seed: int) -> None:
    table = drawn(seed)
    parts = [
        {**part, "friction": str(Fraction(str(part["friction"])) + Fraction(1, 10**16))}
        if isinstance(part, dict) and "friction" in part
        else part
        for part in table["system"]["parts"]
    ]
    assert wrong(table, table | {"system": {"type": "chain", "parts": parts}})


@pytest.mark.quick(1)
@pytest.mark.parametrize("friction", ["1/4", "3/10"])
def test_what_turns_round_beyond_its_limit_slips_on(friction: str) -> None:
    """It is pulled by 0.36 as it comes to rest: left vague, its friction hid on which side of 0 its velocity was."""
    parts = [
        {"mass": 1, "velocity": 1, "friction": friction, "name": "a"},
        {"spring": 3, "yield": "1/2"},
        {"mass": 2, "velocity": 0},
        {"spring": 1, "dashpot": "1/4"},
        {"rod": 1},
        "absorbing",
    ]
    system = {"type": "chain", "parts": parts}
    assert wrong({"name": "turning", "system": system, "output": {"until": 3, "displacement": ["a"]}}) == []


def test_the_middle_of_a_mirrored_chain_without_rods_stays_at_rest() -> None:
    """What is 0 throughout is measured against the largest wave, and there is none."""
    outer: dict[str, Any] = {"mass": 1, "friction": "1/4"}
    spring = {"spring": 2, "yield": "1/2"}
    middle = {"mass": 2, "velocity": 0, "name": "a"}
    parts = [outer | {"velocity": -1, "name": "b"}, spring, middle, spring, outer | {"velocity": 1}]
    table = {"name": "mirrored", "system": {"type": "chain", "parts": parts}}
    assert wrong(table | {"output": {"until": 1, "displacement": ["a", "b"], "velocity": ["a"]}}) == []


def test_what_friction_holds_throughout_beside_what_turns_round_stays_at_rest() -> None:
    """As one mass turns round, what is not known of it may be in the other, which is 0 against no wave."""
    parts = [
        {"mass": "3/2", "velocity": 0, "name": "m0", "friction": "5/6"},
        {"spring": "11/3", "only": "pull", "gap": "1/4", "friction": "1/2"},
        {"mass": "2/5", "velocity": 0, "name": "m1", "spring": "11/3"},
        {"spring": 1, "only": "push", "gap": "1/4"},
        "fixed",
    ]
    load = [{"at": "m1", "times": [1, 4], "steps": [-2, "1/3"], "ramps": [0, "-4/3"]}]
    output = {"until": 6, "displacement": ["m0", "m1"], "velocity": ["m0"]}
    assert wrong({"name": "held", "system": {"type": "chain", "parts": parts}, "load": load, "output": output}) == []


def test_a_spring_begins_to_yield_beside_one_that_yields_already() -> None:
    """One joint, as friction holds the mass between them: neither keeps the other from going on."""
    parts = [
        {"mass": 2, "velocity": "-5/3", "name": "a", "spring": 9, "yield": 2},
        {"spring": 1},
        {"mass": 2, "velocity": 2, "name": "b", "friction": 1000},
        {"spring": "29/4", "yield": [3, "11/4"]},
        {"mass": "3/2", "velocity": "-3/4", "name": "c", "spring": "7/2", "only": "push"},
    ]
    pushed = {"at": "c", "times": ["3/2", 2], "steps": [-2, "5/2"], "ramps": [-2, 0]}
    output = {"until": "13/5", "tolerance": 1e-9, "velocity": ["a", "c"], "displacement": ["a", "c"]}
    table = {"name": "x", "system": {"type": "chain", "parts": parts}, "load": [pushed], "output": output}
    assert wrong(table) == []
