"""Stiff springs: where stretches are cut, what comes out of it, and what is refused, with its count."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest
from flint import arb, ctx, fmpq
from hypothesis import example, given, settings
from hypothesis import strategies as st

import wavesym
from tests.exact.test_chain_truth import missed, wrong_values
from wavesym.errors import CostError
from wavesym.exact.breakpoints import MOST_BREAKPOINTS, Breakpoints
from wavesym.exact.contacts.events import events
from wavesym.exact.joints import relaxation
from wavesym.exact.joints.joint_law import SWING, JointLaw
from wavesym.exact.motion import Motion
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.scene import lower

GROUND = [{"mass": 1, "name": "body", "spring": "K"}]
BETWEEN = [{"mass": 1, "name": "body"}, {"spring": "K"}, {"mass": 2}]
LIGHT = [{"joint": True, "name": "body", "spring": "K"}]


def table(middle: list[dict[str, Any]], stiffness: int, lengths: tuple[str, str], until: object) -> dict[str, Any]:
    """Something in the middle of two rods, pushed."""
    held = [{key: stiffness if value == "K" else value for key, value in part.items()} for part in middle]
    return {
        "name": "stiff",
        "system": {"type": "chain", "parts": ["fixed", {"rod": lengths[0]}, *held, {"rod": lengths[1]}]},
        "load": [{"at": "body", "times": [0, "1/3"], "steps": [1, -2]}],
        "output": {"until": until, "velocity": ["body"], "strain": ["1/2"]},
    }


def model(made: dict[str, Any]) -> Model:
    return lower(wavesym.Scene(**made))


def until(made: dict[str, Any]) -> fmpq:
    return fmpq(*Fraction(str(made["output"]["until"])).as_integer_ratio())


@pytest.mark.quick(1)
@pytest.mark.parametrize("stiffness", [10**4, 10**6])
@pytest.mark.parametrize("middle", [GROUND, BETWEEN], ids=["to ground", "between"])
def test_stiff_springs_are_right_to_the_last_bit(middle: list[dict[str, Any]], stiffness: int) -> None:
    assert wrong_values(table(middle, stiffness, ("1", "1.001"), "5/4"), most=3) == []


def test_a_massless_point_on_a_stiff_spring_is_right_to_the_last_bit() -> None:
    assert wrong_values(table(LIGHT, 2000, ("1", "1"), "5/4"), most=3) == []


@pytest.mark.quick(1)
@pytest.mark.parametrize("lengths", [("1", "1"), ("3/4", "0.707")])
def test_programs_of_stiff_springs_keep_their_bound(lengths: tuple[str, str]) -> None:
    assert missed(table(GROUND, 10**6, lengths, 1), "1e-9") <= 1


def test_without_cuts_pieces_refuse(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the cuts are for."""
    monkeypatch.setattr(JointLaw, "longest", None)
    with pytest.raises(CostError, match="bits would be needed for pieces"):
        missed(table(GROUND, 10**6, ("1", "1"), 1), "1e-9")


LENGTHS = st.sampled_from(["1", "3/2", "1.001", "1.414213562"])


@settings(max_examples=25)
@given(st.integers(2, 6), LENGTHS, LENGTHS, st.sampled_from([GROUND, BETWEEN, LIGHT]))
@example(6, "1", "1.001", GROUND)
def test_cuts_are_no_further_apart_than_a_series_bears(
    exponent: int, left: str, right: str, middle: list[dict[str, Any]]
) -> None:
    """Nor has a joint fewer knots than without them; what begins anew at one end of a rod does so at the other."""
    stiffness = 10 ** min(exponent, 3 if middle is LIGHT else 9)
    known = model(table(middle, stiffness, (left, right), 4))
    until = fmpq(4)
    cut = Breakpoints(known, until).joints
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(JointLaw, "longest", None)
        natural = Breakpoints(known, until).joints
    network = known.network
    for number, times in cut.items():
        assert set(natural[number][:-1]) <= set(times)
        law = JointLaw.assemble(network, network.joints[number])
        if law.springs:
            assert all((high - low) * law.fastest <= SWING for low, high in pairwise(times))
        for end, _ in network.joints[number].ends:
            other = network.joint_of[network.point_at(network.opposite_end(end))]
            far = {time + network.bars[end.bar].delay for time in times[1:-1]}
            assert {time for time in far if time <= min(until, cut[other][-2])} <= set(cut[other])


@pytest.mark.parametrize("right", ["1", "1.5", "1.414213562"])
def test_soft_springs_are_not_cut(right: str) -> None:
    known = model(table(BETWEEN, 36, ("1", right), 6))
    assert any(law.longest for law in (JointLaw.assemble(known.network, joint) for joint in known.network.joints))
    cut = dict(Breakpoints(known, fmpq(6)).joints)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(JointLaw, "longest", None)
        assert dict(Breakpoints(known, fmpq(6)).joints) == cut


@pytest.mark.parametrize(("middle", "right"), [(GROUND, "1"), (GROUND, "1.5")])
def test_what_would_be_cut_too_often_is_refused_at_once(middle: list[dict[str, Any]], right: str) -> None:
    known = model(table(middle, 10**12, ("1", right), 20))
    with pytest.raises(CostError, match=rf"a rate of up to .* stretches .*the limit is {MOST_BREAKPOINTS}"):
        Motion(known, fmpq(20))


def settling(stiffness: int, until: object) -> dict[str, Any]:
    """A body on a stiff spring before a rod: s^2 + K s + K decays at about K and at about 1."""
    parts = [{"mass": 1, "name": "body"}, {"spring": stiffness}, {"joint": True}, {"rod": 1}, "fixed"]
    return table(LIGHT, 1, ("1", "1"), until) | {"system": {"type": "chain", "parts": parts}}


SETTLING = [table(LIGHT, 50_000, ("1", "1"), "7/4"), table(LIGHT, 10**12, ("1", "1"), "7/4"), settling(50_000, "7/4")]


@pytest.mark.quick(1)
@pytest.mark.parametrize("made", SETTLING, ids=["massless", "stiffest", "body"])
def test_what_dies_away_early_in_a_window_is_followed_no_longer(made: dict[str, Any]) -> None:
    """A minute of series on thousands of stretches before; the bound holds against a solver that knows no joints."""
    assert Breakpoints(model(made), fmpq(7, 4)).stretches < 1000
    assert missed(made, "1e-9") <= 1


@pytest.mark.quick(1)
@pytest.mark.parametrize("made", SETTLING[:2], ids=["massless", "stiffest"])
def test_values_are_right_to_the_last_bit_where_what_is_fast_has_died_away(made: dict[str, Any]) -> None:
    assert wrong_values(made, most=3) == []


def test_what_has_not_died_away_is_in_the_radii(monkeypatch: pytest.MonkeyPatch) -> None:
    """Left out after exp(-20) the bound still holds; after exp(-5) too little is known for any."""
    made = SETTLING[2]
    monkeypatch.setattr(relaxation, "_SETTLED", 20)
    assert missed(made, "1e-9") <= 1
    monkeypatch.setattr(relaxation, "_SETTLED", 5)
    with pytest.raises(CostError, match="to fit pieces, more than 1024 bits would be needed"):
        missed(made, "1e-9")


def cushions(lengths: tuple[str, str], until: object, stiffness: int = 50_000) -> dict[str, Any]:
    """A body on a stiff spring before a rod, and a stiff spring before the next one."""
    joint, spring = {"joint": True}, {"spring": stiffness}
    parts = [{"mass": 1, "name": "body"}, spring, joint, {"rod": lengths[0]}, joint, spring, joint, {"rod": lengths[1]}]
    return table(LIGHT, 1, lengths, until) | {"system": {"type": "chain", "parts": [*parts, "fixed"]}}


UNEQUAL = [
    cushions(("1", "3/2"), "1.7"),
    cushions(("3/2", "1"), "1.7"),
    cushions(("1", "1.414213562"), 3),
    cushions(("1", "3/2"), "7/4", 10**12),
    table(LIGHT, 50_000, ("1", "3/2"), 3),
]


@pytest.mark.quick(1)
@pytest.mark.parametrize("made", UNEQUAL, ids=["longer", "shorter", "no measure", "stiffest", "massless"])
def test_between_unequal_rods_cuts_end_when_what_is_fast_has_died_away(made: dict[str, Any]) -> None:
    """A front that no cut has made is followed by cuts for a while; half a minute of cuts throughout before."""
    assert Breakpoints(model(made), until(made)).stretches < 1500
    assert missed(made, "1e-9") <= 1


@pytest.mark.slow
def test_values_between_unequal_rods_are_right_to_the_last_bit() -> None:
    assert wrong_values(UNEQUAL[0], most=3) == []


@pytest.mark.parametrize("made", UNEQUAL, ids=["longer", "shorter", "no measure", "stiffest", "massless"])
def test_what_begins_anew_at_one_end_of_a_rod_does_so_at_the_other_where_cuts_end(made: dict[str, Any]) -> None:
    """No polynomial of one joint may serve another beyond the stretch it was made for."""
    known = model(made)
    cut, network = Breakpoints(known, until(made)).joints, known.network
    for number, times in cut.items():
        for end, _ in network.joints[number].ends:
            other = network.joint_of[network.point_at(network.opposite_end(end))]
            far = {time + network.bars[end.bar].delay for time in times[1:-1]}
            assert {time for time in far if other in cut and time <= cut[other][-2]} <= set(cut.get(other, ()))


def test_a_contact_beside_a_stiff_spring_opens_when_the_body_turns() -> None:
    """Until something comes back q'' + q' + K q = 0 with q(0) = 1: it is 0 at atan(2 w)/w, w^2 = K - 1/4."""
    parts = [{"mass": 1, "spring": 10**4, "velocity": 1}, {"rod": 1}, "contact", {"rod": "3/2"}]
    scene = wavesym.Scene(
        name="turns", system={"type": "chain", "parts": parts}, output={"until": "1.2", "velocity": ["1-"]}
    )
    (event,) = events(lower(scene))
    with ctx.workprec(200):
        w = (arb(10**4) - arb(1) / 4).sqrt()
        assert abs(event.tau - (1 + (2 * w).atan() / w)) < arb(10) ** -20
        since = arb(1) / 10  # the end that has come off moves twice as fast as the wave that comes
        true = 2 * (-since / 2).exp() * ((w * since).cos() - (w * since).sin() / (2 * w))
    (value,) = Reference(lower(scene)).values([1.1])[0]
    late = arb(fmpq(*Fraction(1.1).as_integer_ratio()) - fmpq(11, 10))
    assert abs(value - true) <= abs(late) * 2100 + abs(true) * 2.0**-52
