"""When contacts end: the paper's collision, and cases whose answer is known without computing."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import brentq

import wavesym
from wavesym.errors import CostError
from wavesym.evaluators import contact
from wavesym.evaluators.contact import contact_ends


def collision(kappa, velocity, until=10, **output):
    system = {"type": "collision", "m": 2 * len(kappa), "kappa": kappa, "velocity": velocity}
    return wavesym.Scene(name="collision", system=system, output={"until": until, **(output or {"strain": [2]})})


def test_the_papers_collision():
    (end,) = contact_ends(collision(["1/10", "1/5"], [1, "-1/2"]))
    assert end.x == 2
    assert end.digits == "8.9018784785056660529"  # numerics, section 8; the paper reads 8.85 off its figure


@pytest.mark.parametrize("kappa", [["1/7", "1/5", "2/3"], ["1/5", "1000001/5000000", "1/5"]])
def test_the_strain_is_zero_there_and_negative_before(kappa):
    scene = collision(kappa, [1, "1/4", -1], until=12, strain=[2, 4])
    response = wavesym.evaluator(scene)
    ends = {end.x: end.double for end in contact_ends(scene)}
    for x in (2, 4):
        taus = np.linspace(0, ends[x] - 1e-9, 2001)
        values = response(taus)[x // 2 - 1]
        assert values.max() < 0, x
    late = brentq(lambda tau: response(tau)[0], ends[2] - 1e-3, ends[2] + 1e-3, xtol=1e-13)
    assert abs(late - ends[2]) < 1e-12 or response(ends[2])[0] > 0  # a root, or a jump over 0


def test_equal_bodies_mirror():
    """A collision of three equal bodies, the middle one at rest: both contacts end together."""
    left, right = contact_ends(collision(["1/3"] * 3, [1, 0, -1], until=15, strain=[2, 4]))
    assert left.digits == right.digits


def test_what_cannot_reach_an_output_is_not_reported():
    scene = collision(["1/10", "1/5"], [1, "-1/2"], until=Fraction(89, 10), strain=["0.5"])
    assert contact_ends(scene) == ()  # it opens at 8.90, 1.5 rods away


def test_bodies_at_one_speed_do_not_collide():
    assert contact_ends(collision(["1/10", "1/5"], [1, 1])) == ()


def test_rates_that_nearly_meet_move_the_end_no_further_than_they_differ():
    (equal,) = contact_ends(collision(["1/5", "1/5"], [1, "-1/2"]))
    (near,) = contact_ends(collision(["1/5", "2000000001/10000000000"], [1, "-1/2"]))
    assert 0 < abs(near.double - equal.double) < 1e-7


def test_a_search_that_does_not_end_is_refused(monkeypatch):
    scene = wavesym.Scene.from_toml("collision_m4")
    assert contact.contact_ends(scene)
    monkeypatch.setattr(contact, "_first_return", lambda strain, until: None)  # no precision tells
    with pytest.raises(CostError, match=r"output.until: when the contact at x = 2 opens takes minutes"):
        contact.contact_ends(scene)


def test_a_contact_whose_table_would_be_large_is_refused(monkeypatch):
    monkeypatch.setattr(contact, "_MOST_COEFFICIENTS", 10)
    with pytest.raises(CostError, match="coefficients"):
        contact.contact_ends(wavesym.Scene.from_toml("collision_m4"))
