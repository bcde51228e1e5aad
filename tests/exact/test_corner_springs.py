"""Springs that act on one side, with gaps, and springs that yield: against closed forms."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from flint import arb, arb_poly, fmpq

from wavesym.errors import SceneError
from wavesym.exact.contacts.events import contact_schedule, events
from wavesym.exact.contacts.springs import CornerSpring, SpringState
from wavesym.exact.first_arrivals import first_arrivals
from wavesym.exact.joints.enclosure import Enclosure
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.scene import Scene, lower


def chain(
    parts: list[Any], until: object, loads: tuple[dict[str, Any], ...] = (), at: tuple[str, ...] = ("a",)
) -> Model:
    output = {"until": until, "tolerance": 1e-9, "displacement": list(at), "velocity": list(at)}
    return lower(Scene(name="springs", system={"type": "chain", "parts": parts}, load=list(loads), output=output))


def happenings(model: Model) -> list[tuple[str, float]]:
    return [(event.kind, event.double) for event in events(model)]


def body(spring: dict[str, Any], until: object = 5, velocity: object = 1) -> Model:
    return chain([{"mass": 1, "velocity": velocity, "name": "a"}, {"spring": 4, **spring}, "fixed"], until)


def test_a_body_meets_a_spring_and_leaves_it() -> None:
    """Half a period of 2 rad, which reverses it."""
    model = body({"only": "push", "gap": "1/2"})
    assert happenings(model) == [("engages", 0.5), ("releases", pytest.approx(0.5 + math.pi / 2, rel=1e-16))]
    (event, _) = events(model)
    assert event.digits == "0.50000000000000000000"
    assert event.subject == "spring at x = 0"
    taus = np.array([0.25, 1.0, 2.0, 3.0])
    v, x = Reference(model).values(taus.tolist())
    inside = (taus > 0.5) & (taus < 0.5 + math.pi / 2)
    w = taus - 0.5
    left = 0.5 - (w - math.pi / 2)
    assert x == pytest.approx(np.where(taus < 0.5, taus, np.where(inside, 0.5 + np.sin(2 * w) / 2, left)), rel=1e-15)
    assert v == pytest.approx(np.where(taus < 0.5, 1, np.where(inside, np.cos(2 * w), -1)), rel=1e-15)


def test_what_rests_at_its_gap_beside_what_moves_does_nothing() -> None:
    """Friction holds the mass between them; the second spring carries nothing, and stays engaged."""
    parts = [{"mass": 3, "velocity": "-5/4", "name": "a"}, {"spring": 8, "gap": [-1, 0]}]
    held = {"mass": 1, "name": "b", "friction": 1000}
    assert happenings(chain([*parts, held, {"spring": 3, "gap": ["-2/3", 0]}, "fixed"], "1/2")) == []


@pytest.mark.slow
def test_backlash_has_a_period() -> None:
    """Twice half a period of the spring, and twice the way through the gap."""
    found = happenings(body({"gap": ["-1/2", "1/4"]}, 8))
    swing, way = math.pi / 2, 0.75
    begin = [0.5 + k * (swing + way) for k in range(4)]
    expected = [each for start in begin for each in (("engages", start), ("releases", start + swing)) if each[1] < 8]
    assert [kind for kind, _ in found] == [kind for kind, _ in expected]
    assert [tau for _, tau in found] == pytest.approx([tau for _, tau in expected], rel=1e-15)


def test_a_spring_yields_and_keeps_a_set() -> None:
    """The limit 3/4 is met at asin(3/8)/2 with v = cos(2 t) and held until the body has come to rest."""
    model = body({"yield": "3/4"}, 3)
    begin = math.asin(3 / 8) / 2
    speed = math.sqrt(1 - (3 / 8) ** 2)
    found = happenings(model)[:2]
    assert [kind for kind, _ in found] == ["yields", "holds"]
    assert [tau for _, tau in found] == pytest.approx([begin, begin + speed / 0.75], rel=1e-15)
    (v, *_), (x, *_) = Reference(model).values([begin + speed / 0.75])
    assert abs(v) < 1e-15  # the instant is rounded
    assert x == pytest.approx(3 / 16 + speed**2 / 1.5, rel=1e-15)


def test_a_pile_is_driven_into_soil_that_yields() -> None:
    """A rod without end of impedance 2, velocity 1, on a toe K = 4, R = 1: Z q + K z = Z v until z = R/K."""
    parts = ["absorbing", {"rod": 10, "impedance": 2, "velocity": 1}, {"joint": True, "name": "a"}]
    model = chain([*parts, {"spring": 4, "yield": 1}, "fixed"], 8)
    (kind, tau), *rest = happenings(model)
    assert (kind, rest) == ("yields", [])
    assert tau == pytest.approx(math.log(2) / 2, rel=1e-15)
    v, x = Reference(model).values([0.2, 4.0])
    assert v == pytest.approx([math.exp(-0.4), 0.5], rel=1e-15)
    assert x == pytest.approx([(1 - math.exp(-0.4)) / 2, 0.25 + (4 - math.log(2) / 2) / 2], rel=1e-15)


def test_a_stretch_is_exactly_its_limit_only_where_it_certainly_yields_at_the_end() -> None:
    """Pulled at any rate that is not excluded from any stretch within, a spring with the limit 1 ends where it may."""
    spring = CornerSpring(0, 1, fmpq(1), fmpq(1), 0, fmpq(0), (fmpq(1), fmpq(1)), fmpq(0))
    unknown, length, limit = fmpq(1, 8), fmpq(1), fmpq(1)
    certain = []
    for rate in (fmpq(-1, 4), fmpq(1, 100), fmpq(1, 10), fmpq(1, 3), fmpq(3)):
        for error in (fmpq(0), fmpq(1, 5), fmpq(1, 2)):
            pulled = Enclosure(arb_poly([arb(rate)]), arb(error))
            state = SpringState(arb(limit - unknown).union(arb(limit)))
            end = spring.yielding_motion(state, 1, pulled, length).at_end(length)
            drawn = [(start, v) for start in (limit - unknown, limit) for v in (rate - error, rate + error) if v >= 0]
            ends = {min(start + v * length, limit) for start, v in drawn}  # what yields goes no further back
            assert all(arb(end.stretch).contains(arb(each)) for each in ends)
            certain.append(end.is_exact)
            assert not certain[-1] or (ends == {limit} == {end.stretch} and rate >= error)
    assert {True, False} == set(certain)


@pytest.mark.parametrize("law", [{"gap": [0, 0]}, {"yield": 1000}, {"gap": [-1000, 1000]}])
def test_where_no_corner_is_met_values_are_those_of_the_linear_scene(law: dict[str, Any]) -> None:
    """To the last bit; with a gap of 0 on both sides a spring changes sides, and does the same."""
    linear = {} if "gap" in law and law["gap"][0] == 0 else law
    spring: dict[str, Any] = {"spring": 4} if linear in ({}, {"yield": 1000}) else {"dashpot": "1/3"}
    parts = [{"mass": 1, "velocity": 1, "name": "a"}, {"rod": 1}, {"mass": 2, "name": "b"}]
    ends: list[dict[str, Any]] = [{"spring": 4, **law}, spring]
    if "dashpot" in spring:  # nothing touches the spring: it is as if it were not there
        parts[2] = {"mass": 2, "name": "b", "dashpot": "1/3"}
        with_law, without = chain([*parts, ends[0], "fixed"], 6, at=("a", "b")), chain(parts, 6, at=("a", "b"))
    else:
        with_law, without = (chain([*parts, end, "fixed"], 6, at=("a", "b")) for end in ends)
    taus = [0.3, 1.0, 2.7, 3.1, 5.9]
    assert Reference(with_law).values(taus) == Reference(without).values(taus)


def test_the_rest_of_a_spring_on_the_wrong_side_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(CornerSpring, "rest", property(lambda spring: -spring.side * spring.gap))
    model = body({"only": "push", "gap": "1/3"})
    assert happenings(model) != [("engages", 1 / 3), ("releases", pytest.approx(1 / 3 + math.pi / 2, rel=1e-16))]


@pytest.mark.parametrize(
    ("spring", "line"),
    [
        ({"spring": 4, "only": "up"}, r'only: "up" is not a side; write "push" or "pull"'),
        ({"dashpot": 4, "only": "push"}, r"only: a law of a spring, and there is none; write spring = K too"),
        ({"spring": 4, "gap": 1}, r"gap: of one side alone; write only"),
        ({"spring": 4, "gap": [1, 0]}, r"gap: a list is not in order"),
        ({"spring": 4, "yield": [1, -2]}, r"yield: a list has a negative number"),
        ({"spring": 4, "yield": 1, "only": "pull"}, r"yield: not together with only"),
        ({"spring": 4, "yield": [1, 2, 3]}, r"yield: a list are 3 numbers; write two"),
    ],
)
def test_what_is_no_law_is_said_in_a_line(spring: dict[str, Any], line: str) -> None:
    with pytest.raises(SceneError, match=line):
        chain([{"mass": 1, "name": "a"}, spring, "fixed"], 3)


@pytest.mark.parametrize(
    ("parts", "line"),
    [
        ([{"mass": 1, "friction": 1}, {"friction": 1}, "fixed"], "nothing says what each takes"),
        ([{"mass": 1, "friction": 1}, {"friction": 1}, {"mass": 1, "friction": 1}], "nothing says what each takes"),
        ([{"mass": 1, "friction": 1}, {"dashpot": 1}, {"joint": True}, {"rod": 1}], "not proved"),
    ],
)
def test_friction_that_is_not_proved_is_refused_in_a_line(parts: list[Any], line: str) -> None:
    with pytest.raises(SceneError, match=line):
        chain(parts, 3)


@pytest.mark.quick(1)
@pytest.mark.parametrize("limit", ["1/3", "1/4", "1"])
def test_what_yields_beside_a_spring_holds_when_it_comes_to_rest(limit: str) -> None:
    """A mass between a spring that yields and one that does not: until it rests, in closed form."""
    spring = {"mass": 1, "velocity": 1, "spring": 20, "name": "a"}
    model = chain(["fixed", {"spring": 100, "yield": limit}, spring], "2/5")
    with mp.workdps(30):
        most = mp.mpf(Fraction(limit).numerator) / Fraction(limit).denominator
        both, own = mp.sqrt(120), mp.sqrt(20)
        yields = mp.asin(both * most / 100) / both
        rate, away = mp.cos(both * yields), most / 100 + most / 20
        holds = yields + mp.atan(rate / (own * away)) / own
        (first, then, *_) = events(model)
        assert (first.kind, then.kind) == ("yields", "holds")
        assert abs(mp.mpf(first.digits) - yields) < 1e-19
        assert abs(mp.mpf(then.digits) - holds) < 1e-19


@pytest.mark.slow
def test_a_toe_that_takes_no_pull_is_known_closely() -> None:
    """Its guard is flat where a blow comes that rises as a power: no event may be known to half of the bits alone."""
    ram = [{"mass": 4, "velocity": 1}, {"spring": 3, "only": "push"}, {"mass": "1/2"}]
    toe = [{"joint": True, "name": "a"}, {"spring": 1, "dashpot": "1/3", "yield": [0, "1/4"]}, "fixed"]
    model = chain([*ram, {"rod": 1}, {"rod": 1}, *toe], 5)
    known = contact_schedule(model, fmpq(5))
    assert known is not None
    (change, *_) = known.changes
    assert change.high - change.low < fmpq(1, 2**400)


@pytest.mark.slow
def test_what_begins_at_once_arrives_at_once() -> None:
    """Not after the moment in which it is left open what the spring does."""
    rod = {"rod": "12 m", "A": "0.09 m^2", "E": "30 GPa", "rho": "2500 kg/m^3"}
    parts = [
        {"mass": "2000 kg", "velocity": "4 m/s"},
        {"spring": "200 MN/m", "only": "push"},
        {"mass": "400 kg", "name": "cap"},
        rod,
        {"joint": True, "name": "toe"},
        {"spring": "200 MN/m", "yield": ["0 N", "600 kN"]},
        "fixed",
    ]
    output = {"until": "25 ms", "displacement": ["cap", "toe"]}
    model = lower(Scene(name="pile", units={}, system={"type": "chain", "parts": parts}, output=output))
    assert first_arrivals(model) == [0, 1]
