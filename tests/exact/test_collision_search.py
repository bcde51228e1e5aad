"""The search for the end of a contact, in strains made by hand whose zeros are known."""

from fractions import Fraction
from functools import partial
from math import factorial

import pytest
from flint import arb, arb_poly, ctx, fmpq

from wavesym.exact.contacts.collision import _compressed_at_first, _first_return, _not_compressed, _Series, _zero
from wavesym.exact.tables.ball import Segment
from wavesym.exact.tables.signal import Arrival, Signal
from wavesym.numbers.balls import precise

# a zero that a polynomial crosses at a slope of about 1 is known to some widths of the search
NEAR = fmpq(1, 2**76)


@pytest.fixture(autouse=True)
def _precision():
    with ctx.workprec(256):
        yield


def q(number):
    return number if isinstance(number, fmpq) else fmpq(*Fraction(number).as_integer_ratio())


def increment(**families):
    """From powers by rate: `increment(r0=[-1], r2=[1, 3])`."""
    return {fmpq(int(rate[1:])): [q(c) for c in powers] for rate, powers in families.items()}


def strain(*arrivals):
    return Signal("strain", tuple(Arrival(q(time), gained) for time, gained in arrivals))


def opens(signal, until):
    return precise(partial(_first_return, signal, q(until)), most=1 << 13)


def test_a_strain_that_never_comes_is_no_contact():
    assert opens(strain(), 9) == arb.pos_inf()


@pytest.mark.parametrize(
    "pulled",
    [
        increment(r0=[1]),
        increment(r0=["1/1000"]),
        increment(r0=[0, 1]),
        increment(r0=[0, 0, 1]),
        increment(r0=[1], r1=[-1]),
        increment(r0=[-1, 1], r1=[1]),  # w - 1 + exp(-w): w**2/2
    ],
)
def test_a_contact_that_is_pulled_at_first_opens_then(pulled):
    assert opens(strain(("5/3", pulled)), 9).contains(fmpq(5, 3))


@pytest.mark.parametrize(
    "compressed",
    [
        increment(r0=[-1]),
        increment(r0=["-1/1000"]),
        increment(r0=[0, -1]),
        increment(r0=[0, 0, -1]),
        increment(r0=[0, 0, 0, -1]),
        increment(r0=[-1], r1=[1]),
        increment(r0=[-1], r1=[1, 1]),
        increment(r0=[-1], r7=[1, 7]),
        increment(r2=[-1]),
        increment(r300=[1], r299=[-1]),
    ],
)
@pytest.mark.parametrize("until", [1, 3, 20])
def test_a_contact_that_stays_compressed_does_not_open(compressed, until):
    assert opens(strain((0, compressed)), until) == arb.pos_inf()


def test_the_first_slope_that_is_not_0_tells_for_how_long_a_contact_is_compressed():
    # -w + w**2/3 falls until 3/2, and the search halves 1; -w + 2 w**2 until 1/4, and the bound -1 + 4 w is 0 there
    assert _compressed_at_first(increment(r0=[0, -1, "1/3"])) == 1
    assert _compressed_at_first(increment(r0=[0, -1, 2])) == fmpq(1, 8)
    assert _compressed_at_first(increment(r0=[0, 0, -1, 2])) == fmpq(1, 8)  # -2 + 12 w
    assert _compressed_at_first(increment(r0=[-1, 9])) == 0
    assert _compressed_at_first(increment(r0=[1])) is None
    assert _compressed_at_first(increment(r0=[0, 0, 1])) is None


@pytest.mark.parametrize(
    ("signal", "tau"),
    [
        (strain((0, increment(r0=[-1, 1]))), 1),
        (strain((0, increment(r0=["-1/3", 1]))), "1/3"),
        (strain(("3/2", increment(r0=[-2, "1/2"]))), "11/2"),
        (strain((0, increment(r0=[0, -1, 1]))), 1),
        (strain((0, increment(r0=[0, -1, 16]))), "1/16"),
        (strain((0, increment(r0=[0, 0, -3, 1]))), 3),
        (strain((0, increment(r0=[-6, 11, -6, 1]))), 1),  # 1, 2 and 3: the first of them
        (strain((0, increment(r0=[-1])), (2, increment(r0=[-1])), (4, increment(r0=[0, 1]))), 6),
        (strain((0, increment(r0=[-4, 1])), (2, increment(r0=[-4])), (4, increment(r0=[1]))), 7),
        (strain((0, increment(r1=[-1, 1]))), 1),  # exp(-w) (w - 1)
    ],
)
def test_a_zero_is_found(signal, tau):
    assert abs(opens(signal, 9) - q(tau)) < NEAR


@pytest.mark.parametrize("rate", [1, 5, 40, 1000])
def test_a_zero_among_decays_is_found(rate):
    """1 - 2 exp(-g w) and exp(-g w) - 2 exp(-2 g w) are 0 where exp(g w) = 2."""
    for families in ({fmpq(0): [fmpq(1)], fmpq(rate): [fmpq(-2)]}, {fmpq(rate): [fmpq(1)], fmpq(2 * rate): [fmpq(-2)]}):
        found = opens(strain((3, families)), 9)
        assert abs(found - 3 - arb.const_log2() / rate) < NEAR


@pytest.mark.parametrize("level", ["1", "1/3"])
def test_a_jump_to_exactly_0_opens(level):
    down, up = increment(r0=[f"-{level}"]), increment(r0=[level])
    assert opens(strain((0, down), (2, up)), 9) == 2
    assert opens(strain((0, down), (2, up), (4, down)), 9) == 2
    assert opens(strain((0, down), (2, up)), 2) == 2  # at the end of the horizon too


def test_a_jump_over_0_opens_and_one_below_does_not():
    down = increment(r0=["-1/3"])
    tiny = fmpq(1, 2**1500)
    for above, until in ((fmpq(1), 9), (tiny, 9), (tiny, 2)):
        assert opens(strain((0, down), (2, increment(r0=[fmpq(1, 3) + above]))), until) == 2
    assert opens(strain((0, down), (2, increment(r0=[fmpq(1, 3) - tiny]))), 9) == arb.pos_inf()


def test_what_begins_compressed_and_closes_a_gap_at_once_is_touched():
    """-1 + w reaches 0 where it falls to -1 again: it touched."""
    touched = strain((0, increment(r0=[-1, 1])), (1, increment(r0=[-1])))
    assert abs(opens(touched, 9) - 1) < NEAR
    short = strain((0, increment(r0=[-1, 1])), ("999999/1000000", increment(r0=[-3, -1])))
    assert opens(short, 9) == arb.pos_inf()


@pytest.mark.parametrize("bits", [10, 14])
def test_a_strain_that_nearly_touches_is_told_from_one_that_does(bits):
    """-(w - 1)**2, a little higher or lower."""
    little = fmpq(1, 2**bits)
    over = opens(strain((0, increment(r0=[little - 1, 2, -1]))), 9)
    assert abs(over - (1 - arb(little).sqrt())) < NEAR * 2**bits
    assert opens(strain((0, increment(r0=[-little - 1, 2, -1]))), 9) == arb.pos_inf()


class TooMany(Exception):
    pass


@pytest.mark.parametrize("little", [fmpq(0), fmpq(1, 2**60), fmpq(-1, 2**60)])
def test_a_strain_that_touches_takes_no_longer(little, monkeypatch):
    """Halving an interval should halve the square of its distance to a double zero, not count all such lengths."""
    at, calls = _Series.at, []

    def counted(self, u):
        calls.append(u)
        if len(calls) > 5000:
            raise TooMany
        return at(self, u)

    monkeypatch.setattr(_Series, "at", counted)
    found = opens(strain((0, increment(r0=[little - 1, 2, -1]))), 9)
    if little < 0:
        assert found == arb.pos_inf()
    else:
        assert abs(found - (1 - arb(little).sqrt())) < fmpq(1, 2**60)


@pytest.mark.parametrize("bits", [64, 128, 256])
def test_a_series_is_off_by_what_is_cut_off(bits):
    """Three families whose remainders have one sign: the error comes within 5 % of the bound."""
    length = fmpq(1, 2)
    families = {fmpq(0): [7, 0, 5], fmpq(1): [3, 4], fmpq(2): [1, 1, 9]}
    with ctx.workprec(bits):
        series = _Series.of({rate: arb_poly(powers) for rate, powers in families.items()}, length, ctx.prec)
    terms = series.polynomial.length() - 2
    assert factorial(terms) >= 2**bits > factorial(terms - 1)
    with ctx.workprec(8 * bits):
        worst = arb(0)
        for k in range(33):
            u = length * k / 32
            exact = sum(
                ((-arb(rate * u)).exp() * arb_poly(powers)(arb(u)) for rate, powers in families.items()), arb(0)
            )
            cut = sum(
                (
                    sum(((-arb(rate * u)) ** j / factorial(j) for j in range(terms)), arb(0)) * arb_poly(powers)(arb(u))
                    for rate, powers in families.items()
                ),
                arb(0),
            )
            assert series.polynomial(arb(u)).contains(cut)
            assert series.at(arb(u)).contains(exact)
            worst = worst.max(abs(exact - cut))
        assert worst <= series.error
        assert series.error < worst * fmpq(105, 100)


def test_what_is_cut_off_is_in_every_value():
    told = _Series(arb_poly([2, 1]), arb(fmpq(1, 4))).at(arb(3))
    assert told.contains(arb(fmpq(21, 4)))
    assert told.contains(arb(fmpq(19, 4)))
    assert told.rad() < fmpq(26, 100)


def series(*coefficients, error=0):
    return _Series(arb_poly(list(coefficients)), arb(error))


@pytest.mark.parametrize(
    ("found", "negative"),
    [
        (series(-1, fmpq(1, 2)), True),
        (series(-1, 2), False),  # 1 at t = 1
        (series(-1, -2), False),  # 1 at t = -1
        (series(-1, 0, -2), True),
        (series(-1, 0, 2), False),
        (series(-1, 0, 0, -2), False),
        (series(-1, fmpq(1, 4), fmpq(1, 4), fmpq(-1, 4), -9), True),
        (series(-1, error=fmpq(1, 2)), True),
        (series(-1, error=2), False),
        (series(), False),
    ],
)
def test_an_odd_power_is_positive_on_one_side(found, negative):
    """In powers of t on [-1, 1]; half as long around 1 it is the same in other powers."""
    assert found.negative(fmpq(-1), fmpq(1)) == negative
    moved = _Series(found.polynomial(arb_poly([-2, 2])), found.error)
    assert moved.negative(fmpq(1, 2), fmpq(3, 2)) == negative


@pytest.mark.parametrize(("bits", "told"), [(86, False), (88, False), (90, True), (94, True)])
def test_a_value_that_is_too_blurred_tells_nothing(bits, told):
    """Of -1 + u, whose size is 2, a radius of 2/2**90 is allowed: less than the width, 2**-80, moves a zero."""
    for blurred in (
        series(arb(-1, fmpq(1, 2**bits)), 1),
        series(-1, 1, error=fmpq(1, 2**bits)),
        series(arb(1, fmpq(1, 2**bits)) * -1, 1),
    ):
        found = _zero(blurred, fmpq(2))
        assert (found is not None) == told
        if told:
            assert abs(found - 1) < fmpq(1, 2**78)


def test_a_coefficient_that_is_all_radius_does_not_count_as_size():
    assert _zero(series(arb(0, fmpq(1, 2**70))), fmpq(1)) is None
    assert _zero(series(arb(0, 1), arb(0, 1)), fmpq(1)) is None
    assert series(arb(-1, fmpq(1, 2)), arb(3, 2), arb(0, 5)).vague <= fmpq(3, 2**91)
    assert series(-1, 3, 0).vague == fmpq(4, 2**90)


def test_a_series_that_stays_below_0_has_no_zero():
    assert _zero(series(-1, 1), fmpq(1) - fmpq(1, 2**70)) == arb.pos_inf()
    assert abs(_zero(series(-1, 1), fmpq(1)) - 1) < fmpq(1, 2**78)
    assert _zero(series(-1, 1, error=fmpq(1, 2)), fmpq(1, 4)) == arb.pos_inf()
    assert _zero(series(-1, 1, error=fmpq(1, 2)), fmpq(3, 4)) is None


@pytest.mark.parametrize("bits", [10, 60, 300])
def test_of_families_that_cancel_only_the_sum_tells(bits):
    """(exp(-w) - exp(-(1 + d) w))/d - 1/4, nearly w exp(-w) - 1/4, with d = 2**-bits."""
    d = fmpq(1, 2**bits)
    found = opens(strain((0, {fmpq(0): [fmpq(-1, 4)], fmpq(1): [1 / d], 1 + d: [-1 / d]})), 9)
    with ctx.workprec(1024):

        def exact(w):
            return ((-w).exp() - (-(1 + arb(d)) * w).exp()) / arb(d) - fmpq(1, 4)

        assert exact(found.mid() - NEAR) < 0
        assert exact(found.mid() + NEAR) > 0
        assert abs(found - fmpq(357, 1000)) < fmpq(1, 1000)


def test_the_search_begins_where_it_is_told_to():
    piece = Segment(fmpq(0), {fmpq(0): arb_poly([-2, 3, -1])})  # 0 at 1 and 2
    assert abs(_not_compressed(piece, fmpq(0), fmpq(9), ctx.prec) - 1) < NEAR
    assert _not_compressed(piece, fmpq(5, 2), fmpq(9), ctx.prec) == arb.pos_inf()
    assert _not_compressed(piece, fmpq(0), fmpq(99, 100), ctx.prec) == arb.pos_inf()


@pytest.mark.parametrize("compressed", [increment(r0=[0, 0, 0, -1]), increment(r0=[-1], r1=[1, 1])])
def test_a_contact_that_is_only_just_compressed_does_not_open(compressed):
    """Its slope tells that it is compressed until w = 1, which is beyond the end."""
    assert opens(strain((4, compressed)), "4001/1000") == arb.pos_inf()
