"""When contacts end: the paper's collision, and cases whose answer is known without computing."""

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

import wavesym
from tests.support.drawn import systems
from tests.support.truth import Truth
from wavesym.errors import CostError
from wavesym.exact.contacts import cost, schedule
from wavesym.exact.contacts.course import UndecidedError
from wavesym.exact.contacts.events import contact_ends
from wavesym.exact.contacts.search import Search
from wavesym.numbers.doubles import fraction, middle, rational
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.scene import lower


def collision(kappa, velocity, until=10, **output):
    system = {"type": "collision", "m": 2 * len(kappa), "kappa": kappa, "velocity": velocity}
    return wavesym.Scene(name="collision", system=system, output={"until": until, **(output or {"strain": [2]})})


def test_the_papers_collision():
    (end,) = contact_ends(lower(collision(["1/10", "1/5"], [1, "-1/2"])))
    assert end.x == 2
    assert end.digits == "8.9018784785056660529"  # numerics, section 8; the paper reads 8.85 off its figure


@pytest.mark.quick(1)
@pytest.mark.parametrize("kappa", [["1/7", "1/5", "2/3"], ["1/5", "1000001/5000000", "1/5"]])
def test_the_strain_is_zero_there_and_negative_before(kappa):
    scene = collision(kappa, [1, "1/4", -1], until=12, strain=[2, 4])
    response = wavesym.evaluator(scene)
    ends = {end.x: end.double for end in contact_ends(lower(scene))}
    for x in (2, 4):
        taus = np.linspace(0, ends[x] - 1e-9, 2001)
        values = response(taus)[x // 2 - 1]
        assert values.max() < 0, x
    from scipy.optimize import brentq  # slow to import

    late = brentq(lambda tau: response(tau)[0], ends[2] - 1e-3, ends[2] + 1e-3, xtol=1e-13)
    assert abs(late - ends[2]) < 1e-12 or response(ends[2])[0] > 0  # a root, or a jump over 0


def test_equal_bodies_mirror():
    """A collision of three equal bodies, the middle one at rest: both contacts end together."""
    left, right = contact_ends(lower(collision(["1/3"] * 3, [1, 0, -1], until=15, strain=[2, 4])))
    assert left.digits == right.digits


def test_what_cannot_reach_an_output_is_not_reported():
    scene = collision(["1/10", "1/5"], [1, "-1/2"], until=Fraction(89, 10), strain=["0.5"])
    assert contact_ends(lower(scene)) == ()  # it opens at 8.90, 1.5 rods away


def test_bodies_at_one_speed_do_not_collide():
    assert contact_ends(lower(collision(["1/10", "1/5"], [1, 1]))) == ()


def test_rates_that_nearly_meet_move_the_end_no_further_than_they_differ():
    (equal,) = contact_ends(lower(collision(["1/5", "1/5"], [1, "-1/2"])))
    (near,) = contact_ends(lower(collision(["1/5", "2000000001/10000000000"], [1, "-1/2"])))
    assert 0 < abs(near.double - equal.double) < 1e-7


def undecided(search):
    raise UndecidedError(0, True, fmpq(1))


def test_a_contact_of_which_no_number_of_bits_tells_is_refused(monkeypatch):
    model = lower(wavesym.Scene.from_toml("collision_m4"))
    assert contact_ends(model)
    schedule.first_opening.cache_clear()
    monkeypatch.setattr(Search, "steps", undecided)
    with pytest.raises(schedule.GrazingError, match=r"contact at 2: 896 bits do not show the sign of its force"):
        contact_ends(model)


def test_a_search_that_would_take_long_is_refused(monkeypatch):
    schedule.first_opening.cache_clear()
    monkeypatch.setattr(cost, "MOST_MOVES", 10)
    with pytest.raises(CostError, match=r"contacts are looked for 4.4e\+01 times, the limit is 10"):
        contact_ends(lower(wavesym.Scene.from_toml("collision_m4")))


def seen(scene, x, tau, reach):
    """Whether a contact opens at `tau`: its strain, solved exactly, is negative before, and positive just after.

    With `tau` infinite, whether it is negative up to `reach`. Before waves come it is neither.
    """
    exact = Truth(collision(scene.system.kappa, scene.system.velocity, reach + 1, strain=[x]), reach + 1)
    fronts = exact.arrivals(0)
    if not fronts:
        return tau == math.inf
    end = min(tau, reach)
    little = Fraction(1, 2**60)
    between = [fronts[0] + (end - fronts[0]) * k / 200 for k in range(1, 200)]
    before = [*between, *(front - little for front in fronts[1:]), *(front + little for front in fronts), end - little]
    if fronts[0] < end and not all(exact.value(0, t) < 0 for t in before if fronts[0] < t < end):
        return False
    return tau == math.inf or exact.value(0, tau + little) > 0


def ends(scene, real=DOUBLE):
    """The ends by place."""
    return {end.x: fraction(middle(end.tau)) for end in contact_ends(lower(scene), real)}


@settings(max_examples=25, deadline=None)
@given(systems(kinds=["collision"]), st.sampled_from([4, 9, 13]))
def test_ends_are_those_of_the_exact_strain_and_the_first(system, until):
    contacts = range(2, system["m"], 2)
    scene = collision(system["kappa"], system["velocity"], until, strain=list(contacts))
    found = ends(scene)
    for x in contacts:
        assert seen(scene, x, found.get(x, math.inf), Fraction(until)), x


def test_an_end_that_is_said_to_be_elsewhere_is_noticed():
    scene = collision(["1/10", "1/5"], [1, "-1/2"])
    (tau,) = ends(scene).values()
    assert seen(scene, 2, tau, Fraction(10))
    for wrong in (tau - Fraction(1, 10**17), tau + Fraction(1, 10**17), Fraction(8), Fraction(0), math.inf):
        assert not seen(scene, 2, wrong, Fraction(10))


def test_balls_that_tell_nothing_are_no_ends():
    """Two ratios nearly equal: with few bits their families hide the sum, and contact 6 was said to open at 8.226."""
    kappa = ["5/3", 3, "3000000000001/1000000000000", "8/7"]
    scene = collision(kappa, [0, -1, -3, -3], 14, strain=[2, 4, 6])
    found = ends(scene)
    assert sorted(found) == [2, 4, 6]
    assert all(seen(scene, x, tau, Fraction(14)) for x, tau in found.items())


@pytest.mark.parametrize("until", [50, 17])
def test_heavy_bodies_part_late(until):
    scene = collision(["1/60", "1/40"], [1, 0], until)
    assert seen(scene, 2, ends(scene).get(2, math.inf), Fraction(until))
    assert bool(ends(scene)) == (until == 50)


@pytest.mark.slow
def test_ends_move_in_proportion_to_what_little_ratios_differ_by():
    """Down to 1e-15, where families of rates that differ so little cancel almost all of each other."""
    (equal,) = ends(collision(["1/5", "1/5"], [1, "-1/2"], 12)).values()
    slopes = []
    for digits in range(6, 16):
        difference = Fraction(1, 10**digits)
        (near,) = ends(collision(["1/5", Fraction(1, 5) + difference], [1, "-1/2"], 12)).values()
        slopes.append((near - equal) / difference)
    for digits, (one, other) in enumerate(pairwise(slopes), 6):
        # the next term of the series is in proportion to the difference; 20 digits of tau are known
        assert abs(one / other - 1) < 10.0 ** (1 - digits) + 10.0 ** (digits - 20)


@pytest.mark.parametrize("place", ["2", "5/2", "7/2"])
def test_horizons_just_before_and_after_an_end_matters(place):
    """The opening reaches x = 2 + d a time d later, and counts for a horizon from then on."""
    distance = Fraction(place) - 2
    (exact,) = ends(collision(["1/10", "1/5"], [1, "-1/2"], 20)).values()
    for little in (Fraction(1, 10**4), Fraction(1, 10**12)):
        for real in (DOUBLE, SINGLE):
            # a horizon in single precision ends at the next single above
            late = collision(["1/10", "1/5"], [1, "-1/2"], exact + distance + little, displacement=[place])
            assert sorted(ends(late, real)) == [2]
            early = collision(["1/10", "1/5"], [1, "-1/2"], exact + distance - little, displacement=[place])
            rounded_up = real.not_below(rational(exact + distance - little)) > exact + distance
            assert sorted(ends(early, real)) == [2] * rounded_up
            assert rounded_up == (real is SINGLE and little < Fraction(1, 10**6))


def test_a_contact_between_bodies_at_one_speed_closes_when_waves_come():
    """Contact 4 is first met at tau = 2, by what contact 2 sent."""
    scene = collision(["1/3", "1/2", 1], [1, 0, 0], 12, strain=[2, 4])
    found = ends(scene)
    assert sorted(found) == [2, 4]
    assert all(seen(scene, x, tau, Fraction(12)) for x, tau in found.items())
    assert ends(collision(["1/3", "1/2", 1], [1, 0, 0], "199/100", strain=[4])) == {}


def test_a_contact_that_was_only_just_met_has_not_opened():
    scene = collision(["1/2", 1, "1/3", 2], [1, 0, 0, 0], "4001/1000", strain=[6])
    assert seen(scene, 6, math.inf, Fraction(4001, 1000))
    assert ends(scene) == {}


# with this ratio the strain of contact 2 comes within 1e-27 of 0 at tau = 6.3378, and falls again
TOUCHES = Fraction("1.9728944693640106904700")


@pytest.mark.quick(1)
@pytest.mark.parametrize("digits", [4, 6])
def test_a_strain_that_nearly_touches_zero_is_told_from_one_that_crosses_it(digits):
    little = Fraction(1, 10**digits)
    more, less = (collision([1, ratio, "1/10"], [1, 0, 0], 7) for ratio in (TOUCHES + little, TOUCHES - little))
    assert ends(more) == {}
    assert seen(more, 2, math.inf, Fraction(7))
    assert seen(less, 2, ends(less)[2], Fraction(7))
