"""Dashpots that act while springs do, beyond a gap: against closed forms, a solver of their own, and each other."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import mpmath as mp
import pytest
from flint import arb

from tests.exact.test_corner_springs import chain
from tests.exact.test_corner_truth import wrong
from tests.support.cornered import engaging_chain, friction_beside_contacts, rubbing_masses, touching_chain
from tests.support.series import Unclear
from wavesym.errors import WavesymError
from wavesym.exact.contacts.events import events
from wavesym.exact.losses import losses
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link

# beside rods and between masses, to the ground, on both sides of a gap
DRAWN = (19, 30, 33, 46)

# beside contacts, friction, springs that yield; a contact that stays closed though what presses on it lets go
BESIDE = [(touching_chain, 22), (rubbing_masses, 3), (friction_beside_contacts, 3)]


def body(until: object = 3, load: object = 0, **spring: Any) -> Model:
    parts = [{"mass": 1, "velocity": 1, "name": "a"}, {"spring": 4, "only": "push", "gap": "1/2", **spring}, "fixed"]
    return chain(parts, until, ({"at": "a", "times": [0], "steps": [load]},) if load else ())


@pytest.mark.parametrize("dashpot", ["1/2", "7/2"])
def test_a_body_leaves_where_it_came_in_after_half_a_damped_period(dashpot: str) -> None:
    """Its stop pulls at last, as K s + c s' with s = 0 and s' < 0; a tenth of that is lost after the half-sine."""
    model, c = body(5, dashpot=dashpot), float(Fraction(dashpot))
    swing = math.sqrt(4 - c * c / 4)
    first, then = events(model)
    assert (first.kind, first.digits, then.kind) == ("engages", "0.50000000000000000000", "releases")
    with mp.workdps(40):
        root = mp.sqrt(4 - mp.mpf(Fraction(dashpot).numerator) ** 2 / (4 * Fraction(dashpot).denominator ** 2))
        assert abs(mp.mpf(then.digits) - mp.mpf(1) / 2 - mp.pi / root) < 1e-19
    out = math.exp(-c / 2 * math.pi / swing)
    (v, *_), _ = Reference(model).values([then.double + 0.25])
    assert v == pytest.approx(-out, rel=1e-14)
    (loss,) = losses(model)
    assert loss.dissipated.overlaps(arb((1 - out**2) / 2, 1e-14))


def test_a_body_that_is_pushed_back_leaves_where_a_root_is_found() -> None:
    """s'' + c s' + K s = -F from s = 0 with the speed it has then, and s = 0 again: by a root of another program."""
    model = body(3, load="-1/2", dashpot=3)
    first, then = events(model)
    with mp.workdps(40):
        comes = 2 - mp.sqrt(2)  # tau - tau^2/4 = 1/2
        speed, decay, swing = 1 - comes / 2, mp.mpf(3) / 2, mp.sqrt(4 - mp.mpf(9) / 4)

        def stretch(w: Any) -> Any:
            wave = (speed + decay / 8) / swing * mp.sin(swing * w) + mp.cos(swing * w) / 8
            return mp.exp(-decay * w) * wave - mp.mpf(1) / 8

        assert abs(mp.mpf(first.digits) - comes) < 1e-19
        assert abs(mp.mpf(then.digits) - comes - mp.findroot(stretch, (0.5, 1.5))) < 1e-19


def test_the_end_of_a_rod_is_slowed_down_at_once_and_keeps_its_way() -> None:
    """Without mass its velocity jumps, from 1 to Z/(Z + c): what the front in its rod then says."""
    parts = ["absorbing", {"rod": 1, "velocity": 1, "impedance": 2}, {"joint": True, "name": "a"}]
    model = chain([*parts, {"spring": 4, "only": "push", "gap": "1/4", "dashpot": 3}, "fixed"], "1/2")
    assert [(event.kind, event.double) for event in events(model)] == [("engages", 0.25)]
    before, after = Reference(model).values([math.nextafter(0.25, 0), 0.25])[0]
    assert before == 1
    assert after == pytest.approx(2 / 5, rel=1e-15)


@pytest.mark.parametrize("gap", ["1/2", "0"])
def test_what_only_touches_does_not_engage(gap: str) -> None:
    """At rest at its gap as a swing turns, known in balls; thrown up to it, known exactly; and held there at rest."""
    stop = {"spring": 9, "only": "push", "gap": gap, "dashpot": 5}
    if gap == "1/2":
        swings = chain(["fixed", {"spring": 4}, {"mass": 1, "velocity": 1, "name": "a"}, stop, "fixed"], 5)
        thrown = body(2, load=-1, **stop)
        assert [event.kind for model in (swings, thrown) for event in events(model)] == []
        assert Reference(swings).values([4.0])[1] == [pytest.approx(math.sin(8) / 2, rel=1e-14)]
    held = chain([{"mass": 1, "velocity": 0, "name": "a"}, {**stop, "gap": 0}, "fixed"], 3)
    assert events(held) == ()
    late = {"at": "a", "times": [1], "ramps": [-1]}
    pulled = chain([{"mass": 1, "velocity": 0, "name": "a"}, {**stop, "gap": 0}, "fixed"], 3, (late,))
    assert [(event.kind, event.double) for event in events(pulled)] == [("releases", 1.0)]


@pytest.mark.parametrize("law", [{"dashpot": 3}, {}], ids=["damped", "plain"])
def test_a_stiff_stop_that_comes_to_rest_at_its_gap_stays_on_its_branch(law: dict[str, Any]) -> None:
    """Its stretch decays to exp(-400) of 1e-3 before a wave takes it away: as steps of the midpoint rule move it."""
    stiffness, steady = 1000, 0 if law else 1
    parts = [{"rod": 1}, {"joint": True, "name": "a", "dashpot": steady}, {"spring": stiffness, "only": "push", **law}]
    pulse = {"at": "a", "times": [0, "1/3"], "steps": [1, -1]}
    model = chain([*parts, "fixed"], "11/4", (pulse,))
    assert [(event.kind, event.digits) for event in events(model)] == [("releases", "2.3333333333333333333")]
    steps = 4000  # in which a wave comes back from the free end
    step, place, sent, seen = 2 / steps, 0.0, [0.0] * steps, []
    for k in range(11 * steps // 8):
        pushed = ((k + 0.5) * step < 1 / 3) + 2 * sent[k]
        rate = (pushed - stiffness * place) / (1 + steady + law.get("dashpot", 0) + stiffness * step / 2)
        if place + rate * step / 2 <= 0:
            rate = pushed / (1 + steady)
        sent.append(rate - sent[k])
        place += rate * step
        seen.append(place)
    _, places = Reference(model).values([0.25, 2.25, 2.5, 2.75])
    assert list(places) == pytest.approx([seen[round(tau / step) - 1] for tau in (0.25, 2.25, 2.5, 2.75)], abs=2e-6)


def test_two_stops_of_one_body_act_as_one() -> None:
    """At the same instants, to the last bit of one with the sum of both."""
    both = [{"mass": 1, "velocity": 1, "name": "a"}, {"spring": 3, "only": "push", "gap": "1/3", "dashpot": 1}, "fixed"]
    part = {"mass": 1, "velocity": 1, "name": "a", "spring": 2, "only": "pull", "gap": "1/3", "dashpot": "1/2"}
    one = chain([{**both[0]}, {"spring": 5, "only": "push", "gap": "1/3", "dashpot": "3/2"}, "fixed"], 3)
    two = chain([part, *both[1:]], 3)
    assert [event.kind for event in events(two)] == ["engages", "engages", "releases", "releases"]
    assert Reference(one).values([0.5, 1.1, 2.5]) == Reference(two).values([0.5, 1.1, 2.5])


def test_without_a_dashpot_or_what_meets_it_nothing_changes() -> None:
    """Dashpots of 0, and gaps that nothing reaches: the same events and values, to the last bit."""
    taus = [0.3, 1.0, 2.7, 3.1, 5.9]
    parts = [{"mass": 1, "velocity": 1, "name": "a"}, {"rod": 1}, {"mass": 2, "name": "b"}]
    law: dict[str, Any] = {"spring": 4, "gap": ["-1/8", "1/16"]}
    with_law, without = (chain([*parts, end, "fixed"], 6, at=("a", "b")) for end in ({**law, "dashpot": 0}, law))
    assert [(e.kind, e.tau.str()) for e in events(with_law)] == [(e.kind, e.tau.str()) for e in events(without)]
    assert Reference(with_law).values(taus) == Reference(without).values(taus)
    beside = [{**parts[0], "gap": [-99, 99], "spring": 4, "dashpot": 7}, *parts[1:]]
    assert Reference(chain(beside, 6, at=("a", "b"))).values(taus) == Reference(chain(parts, 6, at=("a", "b"))).values(
        taus
    )


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", DRAWN)
def test_dashpots_act_while_springs_do(seed: int) -> None:
    assert wrong(engaging_chain(seed)) == []


@pytest.mark.slow
@pytest.mark.parametrize(("draw", "seed"), BESIDE)
def test_dashpots_act_while_springs_do_beside_other_corners(draw: Any, seed: int) -> None:
    assert wrong(engaging_chain(seed, draw)) == []


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, 50, 10))
def test_drawn_dashpots_act_while_springs_do(start: int) -> None:
    refused = 0
    for seed in range(start, start + 10):
        try:
            assert wrong(engaging_chain(seed)) == [], seed
        except (WavesymError, Unclear):
            refused += 1
    assert refused <= 1


STOPPED: dict[str, Any] = {"mass": 1, "velocity": 1, "name": "a"}


def stopped(gap: str) -> dict[str, Any]:
    parts = [{"rod": 1, "impedance": "1/2"}, STOPPED, {"spring": 4, "only": "push", "gap": gap, "dashpot": 2}, "fixed"]
    output = {"until": 3, "tolerance": 1e-9, "velocity": ["a", "0"]}
    return {"name": "stopped", "system": {"type": "chain", "parts": parts}, "output": output}


def test_a_dashpot_that_acts_all_the_time_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    assert wrong(stopped("1/3")) == []
    # another gap: what was found once is kept
    monkeypatch.setattr(Link, "steady_damping", property(lambda link: link.damping))
    assert wrong(stopped("2/5"))


def test_a_gap_that_is_slightly_off_is_seen() -> None:
    assert wrong(stopped("1/3"), stopped(str(Fraction(1, 3) + Fraction(1, 10**16))))
