"""Each term of the closed form's proof is needed: its kernel, run with numbers that count, loses as much."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf

import pytest
from flint import arb, arb_poly, fmpq

from tests.support.counted import Counted
from wavesym.exact.tables.signal import Arrival, Signal
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, SINGLE, Real
from wavesym.programs.closed_form import _largest, _segment_errors, _underflows, closed_form

CLOSE = arb(fmpq(1002, 1000))  # the proof's second order, and a little
# in which nothing is rounded, but what is small underflows
EXACT = Real("exact", 8, fmpq(0), DOUBLE.smallest, DOUBLE.largest, DOUBLE.next_after)


def arrival(time, rate, powers) -> Arrival:
    return Arrival(fmpq(time), {fmpq(rate): [fmpq(c) for c in powers]})


def alone(k: int, size: fmpq | int = 1) -> list[fmpq]:
    """c_k all but alone, not as the highest power, which Horner's rule treats a little better."""
    tiny = fmpq(1, 10**60)
    return [tiny] * k + [fmpq(size), tiny]


NOTHING = arrival(0, 0, [0])


def computed(arrivals: Sequence[Arrival], tau: fmpq, u: fmpq | int = 0) -> Counted:
    """What closed.c and schemes/closed_form.py add up at tau; exp is within two units in the last place.

    The excess is less than u w, and what it loses by underflow is nothing next to that.
    """
    total = Counted.exact(0, u)
    for arrival in arrivals:
        w = Counted.exact(tau - arrival.time, u) + 0 + 0
        for rate, powers in sorted(arrival.increment.items()):
            polynomial = Counted.nearest(powers[-1], u)
            for c in powers[-2::-1]:
                polynomial = polynomial * w + Counted.nearest(c, u)
            decay = (-arb(rate) * w.size).exp()
            total = total + polynomial * (Counted.nearest(rate, u) * w).through(decay, decay, ulps=2)
    return total


def proved(arrivals: Sequence[Arrival], until: fmpq | int, real: Real) -> list[arb | None]:
    return _segment_errors(Signal("made", tuple(arrivals)), fmpq(until), real)


@pytest.mark.parametrize("real", [DOUBLE, SINGLE], ids=lambda real: real.name)
@pytest.mark.parametrize("after", [0, 1, 5])
@pytest.mark.parametrize("rate", [fmpq(0), fmpq(1, 3), fmpq(3)], ids=str)
@pytest.mark.parametrize("k", [0, 1, 2, 7])
def test_rounding_is_what_is_counted(k, rate, after, real):
    """A term where it is largest, with additions after it; second order included.

    Before it nothing is added, as the first addition of all, to 0, is exact.
    """
    until = k / rate if k and rate else fmpq(1, 2**20)
    arrivals = [NOTHING, arrival(0, rate, alone(k)), *[NOTHING] * after]
    count = computed(arrivals, until, real.roundoff).error(real.roundoff, 0)
    assert count <= proved(arrivals, until, real)[-1] <= CLOSE * count + real.smallest * 100


def test_many_additions_are_more_than_so_many_roundings():
    """(1 + u)**n - 1, which for n u near 1/8 is 6 % more than n u."""
    coarse = Real("coarse", 8, fmpq(1, 2**13), DOUBLE.smallest, DOUBLE.largest, DOUBLE.next_after)
    arrivals = [NOTHING, arrival(0, 0, alone(0)), *[NOTHING] * 1000]
    count = computed(arrivals, fmpq(1), coarse.roundoff).error(coarse.roundoff, 0)
    assert count <= proved(arrivals, 1, coarse)[-1] <= fmpq(11, 10) * count


def test_more_additions_than_half_of_1_over_u_are_refused():
    coarse = Real("coarse", 8, fmpq(1, 64), DOUBLE.smallest, DOUBLE.largest, DOUBLE.next_after)
    assert [error is None for error in proved([NOTHING] * 40, 1, coarse)] == [False] * 31 + [True] * 9


def test_every_term_adds_its_own():
    """Several powers, rates and arrivals, whose weights grow from segment to segment."""
    arrivals = [
        arrival(0, fmpq(1, 2), [1, -2, 3]),
        Arrival(fmpq(1), {fmpq(0): [fmpq(-5), fmpq(1)], fmpq(1, 2): [fmpq(4)]}),
        arrival(2, 0, [0, 0, 1]),
    ]
    u, until = DOUBLE.roundoff, fmpq(5, 2)
    for n, (start, end) in enumerate(pairwise([0, 1, 2, until])):
        taus = [start + fmpq(end - start) * j / 16 for j in range(17)]
        count = max(float(computed(arrivals[: n + 1], tau, u).rounding) for tau in taus)
        assert count <= float(proved(arrivals, until, DOUBLE)[n] / u) <= 1.3 * count


def test_additions_are_counted_in_the_order_of_programs():
    """A large family that is added first is rounded by all that come after it, however the table lists them."""
    rates = [fmpq(k, 3) for k in range(9)]
    sizes = [fmpq(1000)] + [fmpq(1, 10**9)] * 8
    listed = {rate: [size] for rate, size in zip(rates, sizes, strict=True)}
    other = dict(reversed(listed.items()))
    (bound,), (other_bound,) = (proved([Arrival(fmpq(0), families)], 1, DOUBLE) for families in (listed, other))
    assert str(bound) == str(other_bound)
    assert bound > 1000 * (8 + 7) * arb(fmpq(1, 2**53))


@pytest.mark.parametrize("rate", [fmpq(0), fmpq(1, 3), fmpq(3)], ids=str)
def test_what_came_long_ago_is_as_wrong_as_it_is_large_by_now(rate):
    """Just where the last of three segments begins, so that no term is taken where it is larger."""
    u, until = DOUBLE.roundoff, fmpq(7, 2)
    arrivals = [NOTHING, arrival(1, rate, alone(3)), arrival(until, 0, [0])]
    count = computed(arrivals, until, u).error(u, 0)
    assert count <= proved(arrivals, until, DOUBLE)[-1] <= CLOSE * count


@pytest.mark.parametrize("k", [0, 1, 4])
@pytest.mark.parametrize("size", [fmpq(1, 10**60), fmpq(1), fmpq(1000)], ids=float)
def test_underflow_is_what_is_counted(k, size):
    """At w = 1 the proof gives a factor of 2 away, elsewhere more."""
    for families in (1, 2):
        arrivals = [arrival(0, fmpq(rate, 1000), alone(k, size)) for rate in range(families)]
        for until in (fmpq(1), fmpq(1, 4), fmpq(3), fmpq(100)):
            count = computed(arrivals, until).error(0, EXACT.smallest)
            bound = proved(arrivals, until, EXACT)[-1]
            assert count <= bound
            assert until != 1 or bound <= CLOSE * 2 * count


def test_what_has_underflowed_stays_wrong_in_all_later_segments():
    first, second = arrival(0, 1, [1, 1]), arrival(1000, 1, [1])
    before, after = proved([first, second], 2000, EXACT)
    assert before == proved([first], 2000, EXACT)[0]
    assert (after - before - proved([second], 2000, EXACT)[0]).contains(0)


@pytest.mark.parametrize("rate", [fmpq(0), fmpq(1, 2), fmpq(3), fmpq(100)], ids=str)
@pytest.mark.parametrize("k", [0, 1, 5])
@pytest.mark.parametrize("length", [fmpq(1, 100), fmpq(2), fmpq(40)], ids=str)
def test_the_largest_value_of_a_term_is_found(k, rate, length):
    """At w = k / rate, or at the end of the segment where that comes first."""
    found = _largest(rate, arb_poly([0] * k + [3]), arb(length))
    grid = [arb(length * j**3 / 300**3) for j in range(301)]
    values = [3 * w**k * (-w * arb(rate)).exp() for w in grid]
    assert all(value.lower() <= found for value in values)
    assert any(found <= value * fmpq(101, 100) for value in values)


def test_of_several_terms_the_largest_values_are_added():
    terms = [_largest(fmpq(1), arb_poly([0] * k + [c]), arb(9)) for k, c in enumerate([5, 2, 7])]
    assert float(_largest(fmpq(1), arb_poly([5, 2, 7]), arb(9))) == pytest.approx(float(sum(terms, arb(0))), rel=1e-14)


def test_of_a_ball_the_largest_number_counts():
    wide = arb_poly([arb(5, 1), arb(0, 2)])
    for found, largest in (
        (_largest(fmpq(0), wide, arb(3)), 6 + 2 * 3),
        (_underflows(wide, arb(3)), 3 * ((4 * 6 + 2) + (4 * 2 + 2) * 3)),
    ):
        assert largest <= found <= largest * CLOSE


def test_what_might_overflow_is_refused():
    """Each number is in range, the sum is not; or it is a power of w that is not, late on the horizon."""
    huge = [arrival(n, 0, [fmpq(2) ** 1023 * 9 / 10]) for n in range(4)]
    assert proved(huge, 5, DOUBLE) == [None] * 4
    assert proved([huge[0], arrival(1, 0, [1])], 5, DOUBLE) == [None, None]
    late = [arrival(0, 0, [1]), arrival(1, 1, [0, 0, 0, 1])]
    assert [error is None for error in proved(late, fmpq(2) ** 300, DOUBLE)] == [False, True]
    assert None not in proved(late, fmpq(2) ** 290, DOUBLE)
    # the factor of what cannot be is not taken from the segment, nor from w < 1
    early = [arrival(0, 1, [fmpq(2) ** 1000, 0, 1]), arrival(fmpq(1, 2), 1, [1])]
    assert proved(early, fmpq(1, 2) + fmpq(1, 4), DOUBLE) == [None, None]
    form = closed_form([Signal("small", (NOTHING, arrival(1, 0, [1]))), Signal("huge", tuple(huge))], 5.0)
    assert form.outputs[0].bound < 1e-14
    assert form.error_bound == inf


def test_the_bound_is_the_error_over_the_largest_value():
    """1/100 from tau = 0 on, from tau = 1 on 4 in all, from tau = 2 on 0.

    The bound is the largest so far, in two digits, rounded up.
    """
    arrivals = (arrival(0, 0, [fmpq(1, 100)]), arrival(1, 0, [fmpq(399, 100)]), arrival(2, 0, [-4]))
    (output,) = closed_form([Signal("made", arrivals)], 3.0).outputs
    assert output.largest == 4.0
    assert output.bound == output.pulse_bounds[-1]
    for error, reached in zip(proved(arrivals, 3, DOUBLE), output.pulse_bounds, strict=True):
        assert error <= 4 * arb(reached) <= error * fmpq(11, 10)


@pytest.mark.parametrize("real", [DOUBLE, SINGLE], ids=lambda real: real.name)
def test_a_pulse_starts_at_the_next_number_and_knows_how_late_that_is(real):
    time = fmpq(1, 3)
    form = closed_form([Signal("made", (arrival(time, fmpq(1, 10), [fmpq(1, 7), 2]),))], 1.0, real)
    ((pulse,),) = [output.pulses for output in form.outputs]
    assert rational(real.next_after(pulse.start, 0.0)) < time <= rational(pulse.start)
    late = rational(pulse.start) - time
    assert abs(rational(pulse.excess) - late) <= late * real.roundoff
    (family,) = pulse.families
    assert (family.rate, *family.powers) == tuple(real.nearest(c) for c in (fmpq(1, 10), fmpq(1, 7), fmpq(2)))


@pytest.mark.parametrize("real", [DOUBLE, SINGLE], ids=lambda real: real.name)
def test_it_is_checked_around_every_start_and_between(real):
    arrivals = (arrival(1, 0, [1]), arrival(fmpq(5, 2), 0, [1]))
    form = closed_form([Signal("made", arrivals), Signal("zero", ())], 3.0, real)
    before = [real.next_after(start, 0.0) for start in (1.0, 2.5, 3.0)]
    assert form.check_points == sorted([0.0, 0.5, before[0], 1.0, 1.75, before[1], 2.5, 2.75, before[2], 3.0])
