"""Values in balls and how they are rounded: right-hand limits, ends of horizons, numbers as small as there are."""

from collections import deque
from fractions import Fraction
from functools import partial

import pytest
from flint import arb, arb_poly, ctx, fmpq

import wavesym
from tests.support.truth import Truth
from wavesym.errors import RangeError
from wavesym.exact import reference
from wavesym.exact.reference import Reference
from wavesym.exact.tables import ball as room
from wavesym.exact.tables.ball import Balls, Segment, largest, segments, shift, values
from wavesym.exact.tables.signal import Arrival, Signal
from wavesym.numbers.balls import precise
from wavesym.scene import lower

SMALLEST = Fraction(2) ** -1074


@pytest.fixture(autouse=True)
def _precision():
    with ctx.workprec(128):
        yield


def polynomial(start, *coefficients):
    return Segment(fmpq(start), {fmpq(0): arb_poly(list(coefficients))})


def test_a_segment_is_the_sum_of_its_families():
    segment = Segment(fmpq(3), {fmpq(0): arb_poly([1, 2]), fmpq(2): arb_poly([0, 3]), fmpq(1, 2): arb_poly([-5])})
    for u in (fmpq(0), fmpq(1, 3), fmpq(7)):
        x = arb(u)
        exact = 1 + 2 * x + 3 * x * (-2 * x).exp() - 5 * (-x / 2).exp()
        assert segment.evaluate(u).overlaps(exact)
        assert segment.evaluate(u).rad() < fmpq(1, 2**110)
        families = shift(segment.families, segment.families.values(), fmpq(1))
        later = Segment(fmpq(4), dict(zip(segment.families, families, strict=True)))
        assert later.evaluate(u).overlaps(segment.evaluate(u + 1))
        assert later.evaluate(u).rad() < fmpq(1, 2**110)


def test_a_signal_carries_what_came_before():
    gained = ({fmpq(1): [fmpq(2)]}, {fmpq(0): [fmpq(1)], fmpq(1): [fmpq(0), fmpq(3)]}, {fmpq(2): [fmpq(-1)]})
    times = (fmpq(1), fmpq(5, 3), fmpq(7, 2))
    made = Balls(segments(Signal("made", tuple(map(Arrival, times, gained))), ctx.prec))
    assert made.evaluate(fmpq(999, 1000)) == 0
    for tau in (fmpq(1), fmpq(3, 2), fmpq(5, 3), fmpq(3), fmpq(7, 2), fmpq(9)):
        exact = arb(0)
        for time, increment in zip(times, gained, strict=True):
            w = arb(tau - time)
            for rate, powers in increment.items() if tau >= time else ():
                exact += (-w * arb(rate)).exp() * sum((c * w**k for k, c in enumerate(powers)), arb(0))
        assert made.evaluate(tau).overlaps(exact)
        assert made.evaluate(tau).rad() < fmpq(1, 2**100)


def test_at_a_jump_the_value_is_the_one_after_it():
    balls = Balls([polynomial(1, 5), polynomial(2, 7, 1), polynomial(4, 0)])
    found = [
        balls.evaluate(tau) for tau in (fmpq(0), fmpq(999, 1000), fmpq(1), fmpq(1999, 1000), fmpq(2), fmpq(3), fmpq(4))
    ]
    assert [float(value.mid()) for value in found] == [0, 0, 5, 5, 7, 8, 0]


def test_only_what_has_no_terms_is_zero_throughout():
    assert Balls([]).zero
    assert Balls([polynomial(0), polynomial(1)]).zero
    assert not Balls([polynomial(0), polynomial(1, 1)]).zero
    assert not Balls([polynomial(0, arb(0, 1))]).zero


@pytest.mark.parametrize(
    ("made", "until", "size"),
    [
        ([], 3, 0),
        ([polynomial(0, 1, 1)], 3, 4),  # at the end of the horizon
        ([polynomial(0, 1, 1), polynomial(1, 0)], 3, 2),  # at the end of a segment
        ([polynomial(0, 1, -1), polynomial(1, 0)], 3, 1),  # at its start
        ([polynomial(0, 0, -4, 4), polynomial(1, 0)], 3, 1),  # in its middle, below 0
        ([polynomial(0, 0, 0, 16, -32, 16)], 1, 1),
        ([polynomial(0, fmpq(27, 256), 0, 0, 1, -1)], 1, fmpq(27, 128)),  # at three quarters
        ([polynomial(0, fmpq(27, 256), 1, -3, 3, -1)], 1, fmpq(27, 128)),  # w (1 - w)**3, at a quarter
        ([polynomial(0, 1), polynomial(3, -9)], 3, 9),  # a jump at the end of the horizon
    ],
)
def test_the_largest_value_is_looked_for_inside_the_horizon(made, until, size):
    found = Balls(made).largest(fmpq(until))
    assert found <= size
    assert found > arb(size) * fmpq(999999, 1000000) - fmpq(1, 10**30)


def test_a_largest_value_is_a_lower_bound_of_what_is_in_the_ball():
    for value in (3, -3):
        assert Balls([polynomial(0, arb(value, 1))]).largest(fmpq(1)) <= 2
        assert Balls([polynomial(0, arb(value, 1))]).largest(fmpq(1)) > fmpq(199, 100)


def test_the_largest_value_of_a_blurred_output_takes_more_bits():
    made = deque([[polynomial(0, arb(0, 1))], [polynomial(0, arb(2, 1))]])
    assert largest(lambda bits: made.popleft(), 1.0) <= 1
    assert not made
    assert largest(lambda bits: [polynomial(0)], 1.0) == 0


def test_bits_are_doubled_until_they_tell():
    asked = []

    def attempt(enough, bits):
        asked.append(bits)
        return "told" if ctx.prec == bits >= enough else None

    assert precise(partial(attempt, 500), 100) == "told"
    assert asked == [100, 200, 400, 800]
    assert ctx.prec == 128
    asked.clear()
    assert precise(partial(attempt, 400), 100, 400) == "told"
    asked.clear()
    with pytest.raises(ArithmeticError, match="more than 400 bits would be needed, the limit is 400"):
        precise(partial(attempt, 401), 100, 400)
    assert asked == [100, 200, 400]
    asked.clear()
    assert precise(lambda bits: 0) == 0  # a result that is false is one
    precise(partial(attempt, 1))
    assert asked == [128]


def constant(*balls):
    """Segments of one value that come from ever smaller balls, one for each attempt."""
    made = deque(balls)
    return lambda bits: [polynomial(0, made.popleft() if len(made) > 1 else made[0])]


def test_a_ball_across_the_middle_of_two_doubles_takes_more_bits():
    half = 1 + arb(2) ** -53
    source = constant(arb(half.mid(), 2.0**-60), half + arb(2) ** -100)
    assert values(source, [0.5]) == [1 + 2.0**-52]
    assert values(constant(half - arb(2) ** -100), [0.5]) == [1.0]
    assert values(constant(half), [0.5]) == [1.0]  # a tie, exactly known, goes to the even one


def test_a_ball_smaller_than_all_doubles_is_rounded_from_its_middle():
    tiny = arb(2) ** -1077
    tie = arb(2) ** -1075  # half of the smallest double
    assert values(constant(arb(tie.mid(), tiny.mid())), [0.0]) == [0.0]
    assert values(constant(arb((3 * tie).mid(), tiny.mid())), [0.0]) == [2 * float(SMALLEST)]
    # a quarter of the smallest double is not small enough
    source = constant(arb(tie.mid(), (2 * tiny).mid()), 3 * tie / 2)
    assert values(source, [0.0]) == [float(SMALLEST)]


def test_no_value_is_a_negative_zero():
    for tiny in (arb(0), -(arb(2) ** -1080), -arb(0), arb(0, 2.0**-1074) * arb(2) ** -20):
        (value,) = values(constant(tiny), [0.0])
        assert str(value) == "0.0"
    assert values(constant(-(arb(2) ** -1074)), [0.0]) == [-float(SMALLEST)]


def test_a_value_beyond_all_doubles_is_no_value():
    with pytest.raises(RangeError, match="largest double"):
        values(constant(arb(2) ** 1024), [0.0])
    assert values(constant(arb(2) ** 1023), [0.0]) == [2.0**1023]


def far(weight, x=8, quantity="velocity", until=20):
    system = {"type": "drive", "m": 8, "kappa": [1] * 8, "inertia": [1] * 9}
    load = [{"body": 1, "times": [0], "steps": [weight]}]
    return wavesym.Scene(name="far", system=system, load=load, output={"until": until, quantity: [x]})


def nearest(scene, tau):
    """The double nearest to the exact value."""
    ball = Truth(scene, scene.output.until).value(0, Fraction(tau), 400)
    mantissa, exponent = (int(part) for part in ball.mid().man_exp())
    value = Fraction(mantissa) * Fraction(2) ** exponent
    return value.numerator / value.denominator


@pytest.mark.quick(1)
@pytest.mark.parametrize("route", ["tables", "windows"])
@pytest.mark.parametrize("weight", ["1", "-1e-200", "1e-252", "-1e-255", "-1e-300"])
def test_values_just_behind_a_far_front_are_right_to_the_last_bit(weight, route, monkeypatch):
    """They grow like w**9 there: down to 1e-138, and with small loads to numbers with few bits and to none."""
    monkeypatch.setattr(reference, "_MODERATE", 10**6 if route == "tables" else 0)
    short = Fraction(9)  # the exact solver need not go further
    taus = [8.0, *(8 + 2.0**-k for k in (49, 48, 45, 40, 33, 28, 25, 20, 10))]
    made = Reference(lower(far(weight)))
    assert (made.signals is None) == (route == "windows")
    (found,) = made.values(taus)
    expected = [nearest(far(weight, until=short), tau) + 0.0 for tau in taus]
    assert [value.hex() for value in found] == [value.hex() for value in expected]
    assert found[0] == 0.0
    if weight == "1":
        assert f"{found[taus.index(8 + 2.0**-25)]:.5e}" == "1.30836e-71"
    if weight in ("1e-252", "-1e-255"):
        assert any(0 < abs(value) < 2.0**-1022 for value in found)


def test_values_at_the_smallest_times_are_right():
    """Velocity of a body just after its moment, q = tau - tau**2/2 + ...: at denormal tau the double itself."""
    taus = [5e-324, 1e-323, 2.0**-1070, 1e-310, 1e-300, 1e-17, 2.0**-53]
    (found,) = Reference(lower(far("1", x=0, until=1))).values(taus)
    assert found[:6] == taus[:6]
    assert found == [nearest(far("1", x=0, until=1), tau) for tau in taus]


def test_a_wrong_rounding_is_caught(monkeypatch):
    monkeypatch.setattr(room, "rounded_ball", lambda ball: float(ball.mid()))
    with pytest.raises(AssertionError):
        test_a_ball_across_the_middle_of_two_doubles_takes_more_bits()
